//! Samples a region of the picture into the input of a model.
//!
//! Where the region is much larger than the input, it is first shrunk by averaging. Each pixel of the input is then the mean of all that it stands
//! for. Picked out one by one, pixels would bring their noise with them, and the models find no hand in it.

use super::region::Region;
use crate::error::{PerceptionError, while_doing};
use crate::image::ImageView;
use crate::pixel_format::PixelFormat;
use opencv::core::{self, Mat, Rect, Scalar, Size, ToInputArray};
use opencv::{imgproc, prelude::*};

/// Up to this step, in pixels of the picture, sampling between four pixels averages away as much noise as the mean over a step. It costs half as
/// much. Beyond it, pixels are skipped.
const SKIPS: f32 = 1.5;

/// Twice the largest picture. OpenCV counts places in 1/1024 of a pixel, in 32 bits.
const FAR_PX: f32 = 16384.0;

/// The pixels outside the picture.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Border {
    /// Black.
    Black,
    /// The nearest pixel of the picture.
    Nearest,
}

impl Border {
    /// OpenCV's number.
    fn code(self) -> i32 {
        match self {
            Self::Black => core::BORDER_CONSTANT,
            Self::Nearest => core::BORDER_REPLICATE,
        }
    }
}

/// Cuts regions out of pictures.
#[derive(Default)]
pub(super) struct Cropper {
    /// The part of the picture that holds the region, where its colours have to be computed.
    converted: Mat,
    /// The part of the picture that holds the region, shrunk to the scale of the model's input.
    shrunk: Mat,
    /// The region as the model sees it, in the format of the picture.
    turned: Mat,
    /// The same as red, green and blue.
    rgb: Mat,
}

impl Cropper {
    /// Fills `tensor` (`size` x `size` x RGB, 0..1) with the region.
    ///
    /// # Errors
    /// [`PerceptionError::OpenCv`].
    pub(super) fn crop(
        &mut self,
        image: &ImageView<'_>,
        region: Region,
        size: usize,
        border: Border,
        tensor: &mut [f32],
    ) -> Result<(), PerceptionError> {
        self.cut(image, within_reach(region), size, border)
            .and_then(|format| self.fill(format, size, tensor))
            .map_err(while_doing("cutting a region out of a picture"))
    }

    /// Returns the format in which it shows the region. Of a picture whose colours have to be computed, only those around the region are.
    fn cut(
        &mut self,
        image: &ImageView<'_>,
        region: Region,
        size: usize,
        border: Border,
    ) -> opencv::Result<PixelFormat> {
        if image.format().rgb_offsets().is_some() {
            image.with_pixels(|pixels| self.turn(pixels, region, size, border))?;
            return Ok(image.format());
        }
        let part =
            Window::around(region, [image.width() as i32, image.height() as i32]).with_whole_colours(image);
        let mut converted = std::mem::take(&mut self.converted);
        image.write_bgr(part.rect(), &mut converted)?;
        let centre = [region.centre[0] - part.left as f32, region.centre[1] - part.top as f32];
        let outcome = self.turn(&converted, Region { centre, ..region }, size, border);
        self.converted = converted;
        outcome.map(|()| PixelFormat::Bgr8)
    }

    /// Writes the region as red, green and blue, 0..1.
    fn fill(&mut self, format: PixelFormat, size: usize, tensor: &mut [f32]) -> opencv::Result<()> {
        let code = match format {
            PixelFormat::Gray8 => imgproc::COLOR_GRAY2RGB,
            PixelFormat::Bgra8 => imgproc::COLOR_BGRA2RGB,
            PixelFormat::Rgba8 => imgproc::COLOR_RGBA2RGB,
            _ => imgproc::COLOR_BGR2RGB,
        };
        let rgb = if format == PixelFormat::Rgb8 {
            &self.turned
        } else {
            imgproc::cvt_color_def(&self.turned, &mut self.rgb, code)?;
            &self.rgb
        };
        let mut tensor = Mat::new_rows_cols_with_data_mut(size as i32, 3 * size as i32, tensor)?;
        let mut tensor = tensor.reshape_mut(3, 0)?;
        rgb.convert_to(&mut tensor, core::CV_32F, 1.0 / 255.0, 0.0)
    }

    /// Fills `turned` with the region of a picture.
    fn turn(
        &mut self,
        pixels: &(impl MatTraitConst + ToInputArray),
        region: Region,
        size: usize,
        border: Border,
    ) -> opencv::Result<()> {
        let (step, grid) = (region.side / size as f32, Grid::new(region, size));
        if step <= SKIPS {
            return grid.sample(pixels, &mut self.turned, size, border);
        }
        let window = Window::around(region, [pixels.cols(), pixels.rows()]);
        let shrunk = [window.width, window.height].map(|side| ((side as f32 / step).round() as i32).max(1));
        let part = Mat::roi(pixels, window.rect())?;
        imgproc::resize(
            &part,
            &mut self.shrunk,
            Size::new(shrunk[0], shrunk[1]),
            0.0,
            0.0,
            imgproc::INTER_AREA,
        )?;
        let scale = [shrunk[0] as f32 / window.width as f32, shrunk[1] as f32 / window.height as f32];
        grid.shrunk(&window, scale).sample(&self.shrunk, &mut self.turned, size, border)
    }
}

/// The region, or one that shows the same where it lies so far outside the picture that its places cannot be counted.
fn within_reach(region: Region) -> Region {
    let reached = |value: f32, min: f32| if value.is_nan() { min } else { value.clamp(min, FAR_PX) };
    Region {
        centre: region.centre.map(|value| reached(value, -FAR_PX)),
        side: reached(region.side, 1.0),
        rotation: if region.rotation.is_finite() { region.rotation } else { 0.0 },
    }
}

/// The upright part of the picture that holds a region, in pixels.
struct Window {
    left: i32,
    top: i32,
    width: i32,
    height: i32,
}

impl Window {
    /// At least one pixel: a region may lie far outside the picture.
    fn around(region: Region, [columns, rows]: [i32; 2]) -> Self {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|corner| region.to_image(corner));
        let span = |axis: usize, length: i32| {
            let places = corners.map(|corner| corner[axis]);
            let last = length - 1;
            // The casts saturate.
            let first = (places.into_iter().fold(f32::INFINITY, f32::min).floor() as i32).clamp(0, last);
            let past = places.into_iter().fold(f32::NEG_INFINITY, f32::max).ceil() as i32;
            (first, past.clamp(first, last) - first + 1)
        };
        let ((left, width), (top, height)) = (span(0, columns), span(1, rows));
        Self { left, top, width, height }
    }

    /// A little more of the picture, so that its edges lie between pixels that share no colour, with the neighbours of its places.
    fn with_whole_colours(self, image: &ImageView<'_>) -> Self {
        let span = |first: i32, length: i32, of: usize| {
            let (first, past) = ((first - 1).max(0) & !1, (first + length + 1).min(of as i32));
            // A picture whose pixels share colours along its rows only may have an odd number of rows.
            (first, ((past - first + 1) & !1).min(of as i32 - first))
        };
        let (left, width) = span(self.left, self.width, image.width());
        let (top, height) = span(self.top, self.height, image.height());
        Self { left, top, width, height }
    }

    fn rect(&self) -> Rect {
        Rect::new(self.left, self.top, self.width, self.height)
    }
}

/// Where the pixels of the model's input lie in a picture.
struct Grid {
    first: [f32; 2],
    /// From one pixel to the next in a row.
    along: [f32; 2],
    /// From one row to the next.
    down: [f32; 2],
}

impl Grid {
    fn new(region: Region, size: usize) -> Self {
        let (sin, cos) = region.rotation.sin_cos();
        let step = region.side / size as f32;
        Self {
            first: region.to_image([0.0, 0.0]),
            along: [step * cos, step * sin],
            down: [-step * sin, step * cos],
        }
    }

    /// The same places in a part of the picture that was shrunk. Pixel centres are whole numbers; a picture begins half a pixel
    /// before the first.
    fn shrunk(self, window: &Window, scale: [f32; 2]) -> Self {
        let origin = [window.left as f32, window.top as f32];
        let scaled = |vector: [f32; 2]| [vector[0] * scale[0], vector[1] * scale[1]];
        Self {
            first: [0, 1].map(|axis| (self.first[axis] - origin[axis] + 0.5) * scale[axis] - 0.5),
            along: scaled(self.along),
            down: scaled(self.down),
        }
    }

    /// What the picture shows at `size` x `size` places, between four pixels.
    fn sample(
        &self,
        pixels: &impl ToInputArray,
        to: &mut Mat,
        size: usize,
        border: Border,
    ) -> opencv::Result<()> {
        let row = |axis: usize| [self.along[axis], self.down[axis], self.first[axis]];
        let places = Mat::from_slice_2d(&[row(0), row(1)])?;
        let size = Size::new(size as i32, size as i32);
        let flags = imgproc::INTER_LINEAR | imgproc::WARP_INVERSE_MAP;
        imgproc::warp_affine(pixels, to, &places, size, flags, border.code(), Scalar::default())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::workers::keep_opencv_to_one_thread;

    const WIDTH: usize = 640;
    const HEIGHT: usize = 480;

    fn view(data: &[u8]) -> ImageView<'_> {
        ImageView::new(WIDTH, HEIGHT, WIDTH, PixelFormat::Gray8, data).unwrap()
    }

    fn cropped(image: &ImageView<'_>, region: Region, size: usize, border: Border) -> Vec<f32> {
        keep_opencv_to_one_thread().unwrap();
        let mut tensor = vec![f32::NAN; size * size * 3];
        Cropper::default().crop(image, region, size, border, &mut tensor).unwrap();
        tensor
    }

    /// Brightness rises to the right by this per pixel.
    const SLOPE: f32 = 0.375;

    fn ramp() -> Vec<u8> {
        (0..WIDTH * HEIGHT).map(|index| ((index % WIDTH) as f32 * SLOPE) as u8).collect()
    }

    #[test]
    fn noise_of_single_pixels_is_averaged_away_where_the_picture_is_shrunk() {
        let noisy: Vec<u8> = (0..WIDTH * HEIGHT)
            .map(|index| if (index + index / WIDTH).is_multiple_of(2) { 80 } else { 160 })
            .collect();
        for (side, size, rotation) in [(640.0, 192, 0.0), (470.0, 224, 0.5)] {
            let region = Region { centre: [320.0, 240.0], side, rotation };
            let tensor = cropped(&view(&noisy), region, size, Border::Nearest);
            let furthest = tensor.iter().map(|value| (255.0 * value - 120.0).abs()).fold(0.0, f32::max);
            assert!(furthest < 20.0, "{side} to {size}: {furthest} grey levels from the mean");
        }
    }

    #[test]
    fn every_pixel_of_the_input_shows_its_place_in_the_picture_however_much_it_is_shrunk() {
        let data = ramp();
        for (side, size) in
            [(100.0, 224), (223.0, 224), (225.0, 224), (300.0, 224), (430.0, 224), (430.0, 64)]
        {
            for rotation in [0.0, 0.7, -2.0] {
                let region = Region { centre: [320.0, 240.0], side, rotation };
                let tensor = cropped(&view(&data), region, size, Border::Nearest);
                for (row, column) in [(10, 10), (size / 2, size / 3), (size - 12, size - 30)] {
                    let [x, y] = region.to_image([column, row].map(|index| index as f32 / size as f32));
                    // The corners of a turned region may lie outside the picture.
                    if !(5.0..WIDTH as f32 - 5.0).contains(&x) || !(5.0..HEIGHT as f32 - 5.0).contains(&y) {
                        continue;
                    }
                    let shown = 255.0 * tensor[3 * (row * size + column)];
                    // The ramp is cut to whole grey levels, which makes it half a level darker.
                    let expected = x * SLOPE - 0.5;
                    assert!(
                        (shown - expected).abs() < 1.0,
                        "side {side} to {size}, turned by {rotation}: {shown} instead of {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_region_outside_the_picture_is_black_or_as_its_nearest_pixel() {
        let data = vec![200; WIDTH * HEIGHT];
        for side in [100.0, 2000.0, 1e9] {
            let region = Region { centre: [-3.0 * side, 240.0], side, rotation: 0.3 };
            let black = cropped(&view(&data), region, 192, Border::Black);
            let nearest = cropped(&view(&data), region, 192, Border::Nearest);
            assert!(black.iter().all(|value| *value == 0.0), "{side}");
            assert!(nearest.iter().all(|value| (value - 200.0 / 255.0).abs() < 1e-3), "{side}");
        }
    }

    #[test]
    fn every_format_shows_its_red_green_and_blue() {
        for (format, pixel) in [
            (PixelFormat::Bgr8, [30, 20, 10, 0]),
            (PixelFormat::Rgb8, [10, 20, 30, 0]),
            (PixelFormat::Bgra8, [30, 20, 10, 99]),
            (PixelFormat::Rgba8, [10, 20, 30, 99]),
        ] {
            let data: Vec<u8> = (0..WIDTH * HEIGHT).flat_map(|_| pixel[..format.bytes()].to_vec()).collect();
            let image = ImageView::new(WIDTH, HEIGHT, WIDTH * format.bytes(), format, &data).unwrap();
            for side in [200.0, 500.0] {
                let tensor = cropped(
                    &image,
                    Region { centre: [320.0, 240.0], side, rotation: 0.4 },
                    64,
                    Border::Nearest,
                );
                let pixel = [0, 1, 2].map(|channel| (255.0 * tensor[3 * 64 * 32 + channel]).round());
                assert_eq!(pixel, [10.0, 20.0, 30.0], "{format:?}");
            }
        }
    }

    /// A picture whose blue, green and red rise in different directions, and the same as a camera sends it.
    fn colourful(format: PixelFormat) -> (Vec<u8>, Vec<u8>) {
        let bgr: Vec<u8> = (0..WIDTH * HEIGHT)
            .flat_map(|index| {
                [index % WIDTH / 4 + 40, index / WIDTH / 4 + 60, (index % WIDTH + index / WIDTH) / 8 + 50]
                    .map(|value| value as u8)
            })
            .collect();
        let yuv = |x: usize, y: usize| {
            let [b, g, r] = [0, 1, 2].map(|channel| f32::from(bgr[3 * (y * WIDTH + x) + channel]));
            let luma = 16.0 + 0.257 * r + 0.504 * g + 0.098 * b;
            [luma, 128.0 - 0.148 * r - 0.291 * g + 0.439 * b, 128.0 + 0.439 * r - 0.368 * g - 0.071 * b]
                .map(|value| value.round() as u8)
        };
        let places = |step: usize| {
            (0..HEIGHT).step_by(step).flat_map(move |y| (0..WIDTH).step_by(2).map(move |x| (x, y)))
        };
        let sent = match format {
            PixelFormat::Yuyv => places(1)
                .flat_map(|(x, y)| [yuv(x, y)[0], yuv(x, y)[1], yuv(x + 1, y)[0], yuv(x, y)[2]])
                .collect(),
            _ => {
                let brightness = (0..WIDTH * HEIGHT).map(|index| yuv(index % WIDTH, index / WIDTH)[0]);
                brightness.chain(places(2).flat_map(|(x, y)| [yuv(x, y)[1], yuv(x, y)[2]])).collect()
            }
        };
        (bgr, sent)
    }

    #[test]
    fn what_a_camera_sends_shows_the_same_as_blue_green_and_red_wherever_the_region_lies() {
        for format in [PixelFormat::Yuyv, PixelFormat::Nv12] {
            let (bgr, sent) = colourful(format);
            let bgr = ImageView::new(WIDTH, HEIGHT, 3 * WIDTH, PixelFormat::Bgr8, &bgr).unwrap();
            let sent = ImageView::new(WIDTH, HEIGHT, format.bytes() * WIDTH, format, &sent).unwrap();
            for (centre, side) in [
                ([321.3, 222.7], 230.0),
                ([321.3, 222.7], 431.0),
                ([12.0, 470.0], 180.0),
                ([320.0, 240.0], 640.0),
            ] {
                for border in [Border::Black, Border::Nearest] {
                    let region = Region { centre, side, rotation: 0.4 };
                    let [expected, seen] = [&bgr, &sent].map(|image| cropped(image, region, 192, border));
                    let off = expected.iter().zip(&seen).map(|(a, b)| 255.0 * (a - b).abs());
                    // Rounding to whole numbers twice, and a colour for two or four pixels.
                    assert!(off.fold(0.0, f32::max) < 4.0, "{format:?} {centre:?} {side}");
                }
            }
        }
    }

    #[test]
    fn a_region_that_is_none_harms_nothing() {
        let data = ramp();
        for number in [f32::NAN, f32::INFINITY, f32::MAX, -1.0, 0.0] {
            let region = Region { centre: [number; 2], side: number, rotation: number };
            cropped(&view(&data), region, 32, Border::Nearest);
        }
    }
}
