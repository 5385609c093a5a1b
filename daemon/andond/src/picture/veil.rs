//! What may not be seen, black in pictures that are shown or saved at once, as it is in recordings.

use andon_host::config::Record;
use andon_host::video::pipe::PictureFormat;
use andon_record::picture::{PictureError, PictureMaker, decode};
use shm_schemas::{ColourFormat, FrameHeader};

/// A white picture is white where it may be seen. At the best quality JPEG leaves it so.
const SEEN: u8 = 250;

/// Hides what `record.bench` and `record.masks` say. What is hidden in a recording is asked of the very code that hides it there: a white picture
/// shows it. So both always hide the same.
pub struct Veil {
    maker: PictureMaker,
    size: [u32; 2],
    /// For each pixel of a picture of this size, whether it is hidden.
    hidden: Vec<bool>,
}

impl Veil {
    /// As the configuration says; `None` where everything may be seen.
    pub fn new(record: &Record) -> Option<Self> {
        if record.bench.is_empty() && record.masks.is_empty() {
            return None;
        }
        let maker = PictureMaker::new(&Record { quality: 100, ..record.clone() });
        Some(Self { maker, size: [0, 0], hidden: Vec::new() })
    }

    /// Blackens what may not be seen of a picture: blue, green, red, without padding.
    ///
    /// # Errors
    /// What OpenCV says; then nothing of the picture may be shown.
    pub fn hide(&mut self, format: PictureFormat, picture: &mut [u8]) -> Result<(), PictureError> {
        let size = [format.width, format.height];
        if self.size != size {
            self.hidden = self.hidden_of(size)?;
            self.size = size;
        }
        for (pixel, is_hidden) in picture.chunks_exact_mut(3).zip(&self.hidden) {
            if *is_hidden {
                pixel.fill(0);
            }
        }
        Ok(())
    }

    fn hidden_of(&mut self, [width, height]: [u32; 2]) -> Result<Vec<bool>, PictureError> {
        let colour_format = ColourFormat::Bgr8.code();
        let header =
            FrameHeader { width, height, stride: 3 * width, colour_format, ..FrameHeader::default() };
        let white = vec![u8::MAX; 3 * width as usize * height as usize];
        let shown = decode(&self.maker.jpeg(&header, &white, None)?)?;
        Ok(shown.pixels.chunks_exact(3).map(|pixel| pixel.iter().any(|level| *level < SEEN)).collect())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const FORMAT: PictureFormat = PictureFormat { width: 320, height: 240, rate_hz: 30.0, count: 0 };

    /// Pixels of a picture that was all of one colour, after the veil.
    fn veiled(record: &Record) -> Vec<[u8; 3]> {
        let mut picture = [9, 200, 90].repeat(320 * 240);
        Veil::new(record).unwrap().hide(FORMAT, &mut picture).unwrap();
        picture.chunks_exact(3).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
    }

    #[test]
    fn what_may_not_be_seen_is_black_and_the_rest_is_as_it_was() {
        let record = Record {
            size: Some([320, 240]),
            bench: vec![[20, 20], [300, 20], [300, 220], [20, 220]],
            masks: vec![vec![[100, 100], [150, 100], [150, 150], [100, 150]]],
            ..Record::default()
        };
        let pixels = veiled(&record);
        let at = |x: usize, y: usize| pixels[320 * y + x];
        for hidden in [(0, 0), (19, 120), (301, 120), (160, 221), (100, 100), (125, 125), (150, 150)] {
            assert_eq!(at(hidden.0, hidden.1), [0; 3], "{hidden:?}");
        }
        for seen in [(30, 30), (90, 120), (160, 120), (290, 210)] {
            assert_eq!(at(seen.0, seen.1), [9, 200, 90], "{seen:?}");
        }
    }

    #[test]
    fn where_everything_may_be_seen_there_is_no_veil() {
        assert!(Veil::new(&Record::default()).is_none());
    }
}
