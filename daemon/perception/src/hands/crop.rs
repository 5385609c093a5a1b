//! Samples a region of the picture into the input of a model.
//!
//! Where the region is much larger than the input, it is first shrunk by averaging: each pixel of the input is then the mean of
//! all that it stands for. Picked out one by one, pixels would bring their noise with them, and the models find no hand in it.

use super::region::Region;
use crate::error::{PerceptionError, while_doing};
use crate::image::ImageView;
use opencv::core::{Mat, Rect, Size};
use opencv::{imgproc, prelude::*};

/// Up to this step, in pixels of the picture, sampling between four pixels averages as much noise away as the mean over a step would,
/// and at half the cost; beyond it, pixels are skipped.
const SKIPS: f32 = 1.5;

/// The pixels outside the picture.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Border {
    /// Black.
    Black,
    /// The nearest pixel of the picture.
    Nearest,
}

/// Cuts regions out of pictures.
#[derive(Default)]
pub(super) struct Cropper {
    /// The part of the picture that holds the region, shrunk to the scale of the model's input.
    shrunk: Mat,
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
        let step = region.side / size as f32;
        // Also false for NaN.
        if step > SKIPS {
            let window = Window::around(region, image);
            self.shrink(image, &window, step).map_err(while_doing("shrinking a picture"))?;
            let data = self.shrunk.data_bytes().map_err(while_doing("reading a shrunk picture"))?;
            let (width, height) = (self.shrunk.cols() as usize, self.shrunk.rows() as usize);
            let shrunk = ImageView::new(width, height, width * image.format().bytes(), image.format(), data)?;
            let scale = [width as f32 / window.width as f32, height as f32 / window.height as f32];
            sample(&shrunk, &Grid::new(region, size).shrunk(&window, scale), size, border, tensor);
        } else {
            sample(image, &Grid::new(region, size), size, border, tensor);
        }
        Ok(())
    }

    fn shrink(&mut self, image: &ImageView<'_>, window: &Window, step: f32) -> opencv::Result<()> {
        let shrunk = |side: i32| ((side as f32 / step).round() as i32).max(1);
        let size = Size::new(shrunk(window.width), shrunk(window.height));
        image.with_pixels(|pixels| {
            let pixels = Mat::roi(pixels, Rect::new(window.left, window.top, window.width, window.height))?;
            imgproc::resize(&pixels, &mut self.shrunk, size, 0.0, 0.0, imgproc::INTER_AREA)
        })
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
    fn around(region: Region, image: &ImageView<'_>) -> Self {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|corner| region.to_image(corner));
        let span = |axis: usize, length: usize| {
            let places = corners.map(|corner| corner[axis]);
            let last = length as i32 - 1;
            // The casts saturate.
            let first = (places.into_iter().fold(f32::INFINITY, f32::min).floor() as i32).clamp(0, last);
            let past = places.into_iter().fold(f32::NEG_INFINITY, f32::max).ceil() as i32;
            (first, past.clamp(first, last) - first + 1)
        };
        let ((left, width), (top, height)) = (span(0, image.width()), span(1, image.height()));
        Self { left, top, width, height }
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

    /// Whether each of the `size` x `size` places has four neighbours in a picture with this last column and row. A pixel at the border
    /// is left out for what rounding may add. False for what is no number.
    fn lies_within(&self, last: [i32; 2], size: usize) -> bool {
        let far = (size - 1) as f32;
        [0, 1].into_iter().all(|axis| {
            let ends = [[0.0, 0.0], [far, 0.0], [0.0, far], [far, far]];
            ends.into_iter().all(|[column, row]| {
                let place = self.first[axis] + column * self.along[axis] + row * self.down[axis];
                (1.0..(last[axis] - 1) as f32).contains(&place)
            })
        })
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
}

/// Fills `tensor` with what the picture shows at the places of the grid, bilinear.
fn sample(image: &ImageView<'_>, grid: &Grid, size: usize, border: Border, tensor: &mut [f32]) {
    let sampler = Sampler::new(image, border);
    if !grid.lies_within(sampler.last, size) {
        fill(grid, size, tensor, |x, y| sampler.at(x, y));
        return;
    }
    // The compiler knows the number of bytes of a pixel then, which halves the time.
    match sampler.pixel_bytes {
        3 => fill(grid, size, tensor, |x, y| sampler.within::<3>(x, y)),
        4 => fill(grid, size, tensor, |x, y| sampler.within::<4>(x, y)),
        _ => fill(grid, size, tensor, |x, y| sampler.within::<1>(x, y)),
    }
}

/// Fills `tensor` with a colour for each place of the grid.
fn fill(grid: &Grid, size: usize, tensor: &mut [f32], colour: impl Fn(f32, f32) -> [f32; 3]) {
    for (row, line) in tensor.chunks_exact_mut(3 * size).enumerate() {
        let start = [0, 1].map(|axis| grid.first[axis] + row as f32 * grid.down[axis]);
        for (column, pixel) in line.chunks_exact_mut(3).enumerate() {
            let [x, y] = [0, 1].map(|axis| start[axis] + column as f32 * grid.along[axis]);
            pixel.copy_from_slice(&colour(x, y));
        }
    }
}

struct Sampler<'a> {
    data: &'a [u8],
    stride: usize,
    pixel_bytes: usize,
    rgb: [usize; 3],
    last: [i32; 2],
    border: Border,
}

impl<'a> Sampler<'a> {
    fn new(image: &ImageView<'a>, border: Border) -> Self {
        Self {
            data: image.data(),
            stride: image.stride(),
            pixel_bytes: image.format().bytes(),
            rgb: image.format().rgb_offsets(),
            last: [image.width() as i32 - 1, image.height() as i32 - 1],
            border,
        }
    }

    /// As [`Sampler::at`], to the bit, for a point that has four neighbours in the picture, whose pixels have `BYTES` bytes.
    fn within<const BYTES: usize>(&self, x: f32, y: f32) -> [f32; 3] {
        // Of a number over 0 the whole part is the next lower whole number.
        let (left, top) = (x as u32, y as u32);
        let (right_share, bottom_share) = (x - left as f32, y - top as f32);
        let first = top as usize * self.stride + left as usize * BYTES;
        let above = &self.data[first..first + 2 * BYTES];
        let below = &self.data[first + self.stride..first + self.stride + 2 * BYTES];
        let weights = [
            (1.0 - right_share) * (1.0 - bottom_share),
            right_share * (1.0 - bottom_share),
            (1.0 - right_share) * bottom_share,
            right_share * bottom_share,
        ];
        self.rgb.map(|offset| {
            // A grey pixel has one byte for all; the masks only tell the compiler that no offset leaves the pixel.
            let offset = offset % BYTES;
            let sum = weights[0] * f32::from(above[offset])
                + weights[1] * f32::from(above[BYTES + offset])
                + weights[2] * f32::from(below[offset])
                + weights[3] * f32::from(below[BYTES + offset]);
            sum / 255.0
        })
    }

    /// Red, green and blue at a point, 0..1.
    fn at(&self, x: f32, y: f32) -> [f32; 3] {
        let (left, top) = (x.floor(), y.floor());
        let (right_share, bottom_share) = (x - left, y - top);
        // A region may lie far outside the picture: the cast saturates.
        let (left, top) = (left as i32, top as i32);
        let weights = [
            (1.0 - right_share) * (1.0 - bottom_share),
            right_share * (1.0 - bottom_share),
            (1.0 - right_share) * bottom_share,
            right_share * bottom_share,
        ];
        let mut sum = [0.0; 3];
        for (neighbour, weight) in weights.into_iter().enumerate() {
            let x = left.saturating_add((neighbour & 1) as i32);
            let y = top.saturating_add((neighbour >> 1) as i32);
            let inside = [x.clamp(0, self.last[0]), y.clamp(0, self.last[1])];
            if self.border == Border::Black && inside != [x, y] {
                continue;
            }
            let pixel = inside[1] as usize * self.stride + inside[0] as usize * self.pixel_bytes;
            for (channel, offset) in self.rgb.into_iter().enumerate() {
                sum[channel] += weight * f32::from(self.data[pixel + offset]);
            }
        }
        sum.map(|value| value / 255.0)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::pixel_format::PixelFormat;

    const WIDTH: usize = 640;
    const HEIGHT: usize = 480;

    fn view(data: &[u8]) -> ImageView<'_> {
        ImageView::new(WIDTH, HEIGHT, WIDTH, PixelFormat::Gray8, data).unwrap()
    }

    fn cropped(image: &ImageView<'_>, region: Region, size: usize, border: Border) -> Vec<f32> {
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
    fn within_the_picture_the_fast_way_gives_the_same_bits_as_the_one_for_its_border() {
        let data: Vec<u8> = (0..WIDTH * HEIGHT * 4).map(|index| (index * 7919 % 251) as u8).collect();
        for format in [PixelFormat::Gray8, PixelFormat::Bgr8, PixelFormat::Rgb8, PixelFormat::Bgra8] {
            let image = ImageView::new(WIDTH, HEIGHT, WIDTH * format.bytes(), format, &data).unwrap();
            let region = Region { centre: [330.3, 211.7], side: 280.0, rotation: 0.4 };
            let (grid, sampler) = (Grid::new(region, 224), Sampler::new(&image, Border::Black));
            assert!(grid.lies_within(sampler.last, 224), "the fast way was not taken");
            let mut careful = vec![f32::NAN; 224 * 224 * 3];
            fill(&grid, 224, &mut careful, |x, y| sampler.at(x, y));
            assert_eq!(cropped(&image, region, 224, Border::Black), careful, "{format:?}");
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
