//! The byte stream between `andond` and `andond-video`: a header, then pictures.
//!
//! Both ends come from the same build on the same machine, so the stream has no version of its own. The magic number only tells a
//! stream from anything else.

use andon_perception::MAX_SIDE_PX;
use std::io::{self, Read, Write};

const MAGIC: u32 = 0x4d4c_4946; // "FILM"

/// Size and rate of the pictures of a stream. They have three bytes per pixel, blue first, and no padding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureFormat {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Pictures per second.
    pub rate_hz: f64,
    /// Number of pictures, 0 if unknown.
    pub count: u64,
}

impl PictureFormat {
    /// Bytes of one picture.
    pub fn bytes(&self) -> usize {
        self.width as usize * self.height as usize * 3
    }
}

/// The reading end.
pub struct PipeReader<R> {
    from: R,
    format: PictureFormat,
    picture: Vec<u8>,
}

impl<R: Read> PipeReader<R> {
    /// Reads the header. Fails when the other end has failed before its first picture.
    pub fn new(mut from: R) -> io::Result<Self> {
        let mut header = [0; 28];
        from.read_exact(&mut header)?;
        let word =
            |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
        let long = |at: usize| u64::from(word(at)) | u64::from(word(at + 4)) << 32;
        let (width, height) = (word(4), word(8));
        if word(0) != MAGIC || width == 0 || height == 0 || width.max(height) as usize > MAX_SIDE_PX {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "not a stream of pictures"));
        }
        let format = PictureFormat { width, height, rate_hz: f64::from_bits(long(12)), count: long(20) };
        Ok(Self { from, format, picture: vec![0; format.bytes()] })
    }

    /// Size and rate from the header.
    pub fn format(&self) -> PictureFormat {
        self.format
    }

    /// Advances to the next picture and returns its time since the first in nanoseconds, `None` at a clean end.
    pub fn advance(&mut self) -> io::Result<Option<u64>> {
        let mut pts = [0; 8];
        self.from.read_exact(&mut pts)?;
        let pts = u64::from_le_bytes(pts);
        if pts == END {
            return Ok(None);
        }
        self.from.read_exact(&mut self.picture)?;
        Ok(Some(pts))
    }

    /// The picture that [`PipeReader::advance`] has reached.
    pub fn picture(&self) -> &[u8] {
        &self.picture
    }
}

/// Stands in place of a time and ends the stream. A stream without it was cut off.
const END: u64 = u64::MAX;

/// The writing end.
pub struct PipeWriter<W: Write> {
    to: W,
}

impl<W: Write> PipeWriter<W> {
    /// Writes the header.
    pub fn new(mut to: W, format: PictureFormat) -> io::Result<Self> {
        let mut header = Vec::with_capacity(28);
        header.extend(MAGIC.to_le_bytes());
        header.extend(format.width.to_le_bytes());
        header.extend(format.height.to_le_bytes());
        header.extend(format.rate_hz.to_bits().to_le_bytes());
        header.extend(format.count.to_le_bytes());
        to.write_all(&header)?;
        Ok(Self { to })
    }

    /// Writes one picture.
    pub fn write_picture(&mut self, pts_ns: u64, picture: &[u8]) -> io::Result<()> {
        self.to.write_all(&pts_ns.to_le_bytes())?;
        self.to.write_all(picture)
    }

    /// Ends the stream. A writer that is dropped instead has failed, and its reader notices.
    pub fn finish(mut self) -> io::Result<()> {
        self.to.write_all(&END.to_le_bytes())?;
        self.to.flush()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const FORMAT: PictureFormat = PictureFormat { width: 2, height: 1, rate_hz: 30.0, count: 2 };

    fn stream() -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut writer = PipeWriter::new(&mut bytes, FORMAT).unwrap();
        writer.write_picture(0, &[1; 6]).unwrap();
        writer.write_picture(33, &[2; 6]).unwrap();
        writer.finish().unwrap();
        bytes
    }

    #[test]
    fn pictures_come_out_as_they_went_in() {
        let bytes = stream();
        let mut reader = PipeReader::new(bytes.as_slice()).unwrap();
        assert_eq!(reader.format(), FORMAT);
        for (pts_ns, pixel) in [(0, 1), (33, 2)] {
            assert_eq!(reader.advance().unwrap(), Some(pts_ns));
            assert_eq!(reader.picture(), [pixel; 6]);
        }
        assert_eq!(reader.advance().unwrap(), None);
    }

    #[test]
    fn a_stream_that_is_cut_off_is_an_error_not_an_end() {
        let bytes = stream();
        let mut reader = PipeReader::new(&bytes[..bytes.len() - 9]).unwrap();
        reader.advance().unwrap();
        assert!(reader.advance().is_err());
    }

    #[test]
    fn a_header_that_is_no_stream_is_refused() {
        assert!(PipeReader::new(&b"this is no film at all, it is a sentence"[..]).is_err());
        assert!(PipeReader::new(&b""[..]).is_err());
    }
}
