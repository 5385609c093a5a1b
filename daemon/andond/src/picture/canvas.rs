//! A picture that is drawn on, in pixels: x right, y down.

use opencv::core::{Mat, MatTraitConstManual, Point, Scalar, Size, Vec3b};
use opencv::imgproc;

/// Blue, green, red.
pub(super) type Colour = [u8; 3];

pub(super) const WHITE: Colour = [255, 255, 255];
pub(super) const GREEN: Colour = [80, 200, 60];
pub(super) const RED: Colour = [40, 40, 230];
pub(super) const AMBER: Colour = [0, 170, 255];
pub(super) const BLUE: Colour = [230, 160, 40];
pub(super) const GREY: Colour = [140, 130, 130];
pub(super) const DARK: Colour = [40, 30, 30];

/// The length of a dash and of the gap after it.
const DASH_PX: f32 = 5.0;

/// How high the picture is drawn at least, in pixels, so that what is written beside it is legible from a metre away.
const MIN_HEIGHT: f32 = 720.0;

/// A film's picture, enlarged where it is small, with a panel beside it and a strip below.
pub(super) struct Canvas {
    pixels: Vec<u8>,
    width: usize,
    height: usize,
    /// The size of the film's picture.
    source: [i32; 2],
    /// How many pixels here are one of the film.
    scale: f32,
    /// The first letters of the names on the newest picture, and how wide each name is.
    names: Vec<([f32; 2], f32)>,
}

/// The size of the letters of a name: their scale, and in pixels their width and the distance of two lines.
const NAME: (f64, f32, f32) = (0.7, 12.0, 26.0);

impl Canvas {
    /// A canvas for pictures of this size, with a panel of this width and a strip of this height.
    pub(super) fn new(width: u32, height: u32, panel: usize, strip: usize) -> Self {
        let scale = (MIN_HEIGHT / height as f32).max(1.0);
        let scaled = |length: u32| (scale * length as f32).round() as usize;
        // Codecs want even sides.
        let [width_px, height_px] =
            [scaled(width) + panel, scaled(height) + strip].map(|px| px.next_multiple_of(2));
        Self::with([width_px, height_px], [width, height], scale)
    }

    /// A canvas of just this size. A picture that is not as high is shown at its top.
    pub(super) fn at_its_size(picture: [u32; 2], height: u32) -> Self {
        Self::with([picture[0], height].map(|length| length as usize), picture, 1.0)
    }

    fn with([width, height]: [usize; 2], picture: [u32; 2], scale: f32) -> Self {
        let source = picture.map(|length| length as i32);
        Self { pixels: DARK.repeat(width * height), width, height, source, scale, names: Vec::new() }
    }

    pub(super) fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    pub(super) fn size(&self) -> [u32; 2] {
        [self.width as u32, self.height as u32]
    }

    /// Right and lower end of the picture: where the panel and the strip begin.
    pub(super) fn picture_end(&self) -> [f32; 2] {
        self.source.map(|length| (self.scale * length as f32).round())
    }

    /// Shows the film's picture, and clears the rest.
    pub(super) fn show(&mut self, picture: &[u8]) -> opencv::Result<()> {
        self.names.clear();
        let [columns, rows] = self.source;
        let small = Mat::new_rows_cols_with_bytes::<Vec3b>(rows, columns, picture)?;
        let [right, bottom] = self.picture_end().map(|length| length as i32);
        let mut large = Mat::default();
        imgproc::resize(&small, &mut large, Size::new(right, bottom), 0.0, 0.0, imgproc::INTER_LINEAR)?;
        for pixel in self.pixels.chunks_exact_mut(3) {
            pixel.copy_from_slice(&DARK);
        }
        let rows = self.pixels.chunks_exact_mut(3 * self.width);
        for (to, from) in rows.zip(large.data_bytes()?.chunks_exact(3 * right as usize)) {
            to[..from.len()].copy_from_slice(from);
        }
        Ok(())
    }

    /// A line between two points of the film's picture.
    pub(super) fn line(
        &mut self,
        from: [f32; 2],
        to: [f32; 2],
        colour: Colour,
        thickness: i32,
    ) -> opencv::Result<()> {
        let [from, to] = [from, to].map(|at| self.placed(at));
        self.draw(|mat| {
            imgproc::line(mat, point(from), point(to), scalar(colour), thickness, imgproc::LINE_AA, 0)
        })
    }

    /// A line of dashes between two points of the film's picture.
    pub(super) fn dashes(&mut self, from: [f32; 2], to: [f32; 2], colour: Colour) -> opencv::Result<()> {
        let [x, y] = [0, 1].map(|axis| to[axis] - from[axis]);
        let count = (x.hypot(y) / DASH_PX).ceil().max(1.0) as usize;
        let at = |place: usize| {
            let share = place as f32 / count as f32;
            [from[0] + share * x, from[1] + share * y]
        };
        (0..count).step_by(2).try_for_each(|place| self.line(at(place), at(place + 1), colour, 2))
    }

    pub(super) fn dot(&mut self, at: [f32; 2], radius: i32, colour: Colour) -> opencv::Result<()> {
        let at = self.placed(at);
        self.draw(|mat| {
            imgproc::circle(mat, point(at), radius, scalar(colour), imgproc::FILLED, imgproc::LINE_AA, 0)
        })
    }

    pub(super) fn outline(&mut self, corners: &[[f32; 2]; 4], colour: Colour) -> opencv::Result<()> {
        for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            self.line(*from, *to, colour, 2)?;
        }
        Ok(())
    }

    /// A name at a point of the film's picture, or above the names that are there already, as those of parts at each other.
    pub(super) fn name(&mut self, at: [f32; 2], text: &str, colour: Colour) -> opencv::Result<()> {
        let (scale, letter, row) = NAME;
        let ([x, mut y], width) = (self.placed(at), letter * text.chars().count() as f32);
        let is_taken = |y: f32, ([left, other], long): &([f32; 2], f32)| {
            (y - other).abs() < row && x < left + long + letter && *left < x + width + letter
        };
        while y > row {
            let Some(([_, other], _)) = self.names.iter().find(|name| is_taken(y, name)) else { break };
            y = other - row;
        }
        self.names.push(([x, y], width));
        self.text([x, y], text, scale, colour)
    }

    /// Text on the canvas, with a dark edge, so that it can be read on any background. OpenCV's letters are ASCII.
    pub(super) fn text(
        &mut self,
        at: [f32; 2],
        text: &str,
        scale: f64,
        colour: Colour,
    ) -> opencv::Result<()> {
        for (thickness, colour) in [(4, DARK), (1, colour)] {
            self.draw(|mat| {
                let font = imgproc::FONT_HERSHEY_DUPLEX;
                let (at, colour) = (point(at), scalar(colour));
                imgproc::put_text(mat, text, at, font, scale, colour, thickness, imgproc::LINE_AA, false)
            })?;
        }
        Ok(())
    }

    /// A filled rectangle on the canvas.
    pub(super) fn bar(&mut self, at: [f32; 2], size: [f32; 2], colour: Colour) -> opencv::Result<()> {
        let end = [at[0] + size[0], at[1] + size[1]];
        self.draw(|mat| {
            let (from, to) = (point(at), point(end));
            imgproc::rectangle_points(mat, from, to, scalar(colour), imgproc::FILLED, imgproc::LINE_8, 0)
        })
    }

    /// A frame around the whole.
    pub(super) fn frame(&mut self, colour: Colour, thickness: i32) -> opencv::Result<()> {
        let end = [self.width as f32 - 1.0, self.height as f32 - 1.0];
        self.draw(|mat| {
            let (from, to) = (point([0.0; 2]), point(end));
            imgproc::rectangle_points(mat, from, to, scalar(colour), thickness, imgproc::LINE_8, 0)
        })
    }

    /// Where a point of the film's picture is on the canvas.
    fn placed(&self, at: [f32; 2]) -> [f32; 2] {
        at.map(|coordinate| self.scale * coordinate)
    }

    fn draw(
        &mut self,
        draw: impl FnOnce(&mut opencv::boxed_ref::BoxedRefMut<'_, Mat>) -> opencv::Result<()>,
    ) -> opencv::Result<()> {
        let (rows, columns) = (self.height as i32, self.width as i32);
        draw(&mut Mat::new_rows_cols_with_bytes_mut::<Vec3b>(rows, columns, &mut self.pixels)?)
    }
}

fn point([x, y]: [f32; 2]) -> Point {
    Point::new(x.round() as i32, y.round() as i32)
}

fn scalar([blue, green, red]: Colour) -> Scalar {
    Scalar::new(f64::from(blue), f64::from(green), f64::from(red), 0.0)
}
