//! Samples a region of the picture into the input of a model.

use super::region::Region;
use crate::image::ImageView;

/// The pixels outside the picture.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Border {
    /// Black.
    Black,
    /// The nearest pixel of the picture.
    Nearest,
}

/// Fills `tensor` (`size` x `size` x RGB, 0..1) with the region, bilinear, straight from the picture's bytes.
pub(super) fn crop(image: &ImageView<'_>, region: Region, size: usize, border: Border, tensor: &mut [f32]) {
    let (sin, cos) = region.rotation.sin_cos();
    let step = region.side / size as f32;
    let first = region.to_image([0.0, 0.0]);
    let sampler = Sampler::new(image, border);
    for (row, line) in tensor.chunks_exact_mut(3 * size).enumerate() {
        let start = [first[0] - row as f32 * step * sin, first[1] + row as f32 * step * cos];
        for (column, pixel) in line.chunks_exact_mut(3).enumerate() {
            let along = column as f32 * step;
            pixel.copy_from_slice(&sampler.at(start[0] + along * cos, start[1] + along * sin));
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
