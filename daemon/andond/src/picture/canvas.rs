//! A picture that is drawn on, in pixels: x right, y down.

use opencv::core::{Mat, Point, Scalar, Vec3b};
use opencv::imgproc;

/// Blue, green, red.
pub(super) type Colour = [u8; 3];

pub(super) const WHITE: Colour = [255, 255, 255];
pub(super) const GREEN: Colour = [80, 200, 60];
pub(super) const RED: Colour = [40, 40, 230];
pub(super) const AMBER: Colour = [0, 170, 255];
pub(super) const BLUE: Colour = [230, 160, 40];
pub(super) const DARK: Colour = [40, 30, 30];

/// The length of a dash and of the gap after it.
const DASH_PX: f32 = 5.0;

/// A picture that is as large as the film's with a panel below.
pub(super) struct Canvas {
    pixels: Vec<u8>,
    width: u32,
    height: u32,
}

impl Canvas {
    pub(super) fn new(width: u32, height: u32) -> Self {
        Self { pixels: vec![0; width as usize * height as usize * 3], width, height }
    }

    pub(super) fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    pub(super) fn width(&self) -> usize {
        self.width as usize
    }

    /// Shows a picture of the same width at the top, and darkens the rest.
    pub(super) fn show(&mut self, picture: &[u8]) {
        let (above, below) =
            self.pixels.split_at_mut(picture.len().min(self.width as usize * self.height as usize * 3));
        above.copy_from_slice(&picture[..above.len()]);
        for pixel in below.chunks_exact_mut(3) {
            pixel.copy_from_slice(&DARK);
        }
    }

    pub(super) fn line(
        &mut self,
        from: [f32; 2],
        to: [f32; 2],
        colour: Colour,
        thickness: i32,
    ) -> opencv::Result<()> {
        self.draw(|mat| {
            imgproc::line(mat, point(from), point(to), scalar(colour), thickness, imgproc::LINE_AA, 0)
        })
    }

    /// A line of dashes.
    pub(super) fn dashes(&mut self, from: [f32; 2], to: [f32; 2], colour: Colour) -> opencv::Result<()> {
        let [x, y] = [0, 1].map(|axis| to[axis] - from[axis]);
        let count = (x.hypot(y) / DASH_PX).ceil().max(1.0) as usize;
        let at = |place: usize| {
            let share = place as f32 / count as f32;
            [from[0] + share * x, from[1] + share * y]
        };
        (0..count).step_by(2).try_for_each(|place| self.line(at(place), at(place + 1), colour, 1))
    }

    pub(super) fn dot(&mut self, at: [f32; 2], radius: i32, colour: Colour) -> opencv::Result<()> {
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

    /// Text with a dark edge, so that it can be read on any background. OpenCV's letters are ASCII.
    pub(super) fn text(
        &mut self,
        at: [f32; 2],
        text: &str,
        scale: f64,
        colour: Colour,
    ) -> opencv::Result<()> {
        for (thickness, colour) in [(3, DARK), (1, colour)] {
            self.draw(|mat| {
                let font = imgproc::FONT_HERSHEY_SIMPLEX;
                imgproc::put_text(
                    mat,
                    text,
                    point(at),
                    font,
                    scale,
                    scalar(colour),
                    thickness,
                    imgproc::LINE_AA,
                    false,
                )
            })?;
        }
        Ok(())
    }

    /// A frame around the whole.
    pub(super) fn frame(&mut self, colour: Colour, thickness: i32) -> opencv::Result<()> {
        let (right, bottom) = (self.width as f32 - 1.0, self.height as f32 - 1.0);
        let corners = [[0.0, 0.0], [right, 0.0], [right, bottom], [0.0, bottom]];
        for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            self.line(*from, *to, colour, thickness)?;
        }
        Ok(())
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
