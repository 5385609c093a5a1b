//! Pictures of frames as JPEG, with everything black that the masks cover.

use andon_host::config::Record;
use andon_host::video::frame::view;
use andon_perception::{ImageView, MAX_SIDE_PX, PerceptionError, PixelFormat};
use opencv::core::{BORDER_CONSTANT, CV_8UC1, Mat, Point, Scalar, Size, Vec3b, Vector};
use opencv::prelude::*;
use opencv::{imgcodecs, imgproc};
use prost::Message as _;
use shm_schemas::FrameHeader;
use turbojpeg::{DecompressHeader, Image, Subsamp, read_header};

use crate::viewer::{CompressedImage, timestamp};
use crate::writer::Entry;

/// Why a frame has no picture.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The header promises something else than there is.
    #[error(transparent)]
    Frame(#[from] PerceptionError),
    /// It cannot be masked or decoded.
    #[error("a picture cannot be made: {0}")]
    OpenCv(#[from] opencv::Error),
    /// What should be one is none.
    #[error("this is no JPEG picture")]
    NoJpeg,
    /// It would take more memory than any picture of a recorder.
    #[error(
        "it says that it has {width} x {height} pixels, and no recorder writes one of more than {MAX_SIDE_PX} x {MAX_SIDE_PX}"
    )]
    TooLarge {
        /// The columns that it promises.
        width: usize,
        /// The rows that it promises.
        height: usize,
    },
    /// It has more or fewer pixels than its size says.
    #[error("a picture has other pixels than the {width} x {height} that it says")]
    OtherPixels {
        /// The columns that it says it has.
        width: usize,
        /// The rows that it says it has.
        height: usize,
    },
    /// It cannot be encoded.
    #[error("a picture cannot be encoded: {0}")]
    Jpeg(#[from] turbojpeg::Error),
}

/// A picture as blue, green and red, row by row without gaps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decoded {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Three bytes for each pixel.
    pub pixels: Vec<u8>,
}

/// Makes pictures of frames.
pub struct PictureMaker {
    quality: u8,
    masks: Masks,
    /// The newest frame that was not encoded where it lay, as blue, green and red.
    converted: Vec<u8>,
}

impl PictureMaker {
    /// As the configuration says.
    #[must_use]
    pub fn new(record: &Record) -> Self {
        Self { quality: record.quality, masks: Masks::new(record), converted: Vec::new() }
    }

    /// The colour plane of a frame as JPEG. It is what the camera `sent` where all of that may be seen and [`decode`] takes it. Else it is encoded, and what
    /// may not be seen is black before.
    ///
    /// # Errors
    /// A frame that is none, and what OpenCV or libjpeg-turbo says.
    pub fn jpeg(
        &mut self,
        header: &FrameHeader,
        colour: &[u8],
        sent: Option<&[u8]>,
    ) -> Result<Vec<u8>, PictureError> {
        let frame = view(header, colour)?;
        let (quality, is_whole) = (self.quality, !self.masks.hides());
        if let Some(sent) = sent.filter(|sent| is_whole && size_of(sent).is_ok()) {
            return Ok(sent.to_vec());
        }
        let image = match readable(frame.format()) {
            // Most frames are encoded where they lie.
            Some(format) if is_whole => image_of(&frame, frame.data(), frame.stride(), format),
            _ => self.convert(&frame)?,
        };
        compress(image, quality)
    }

    /// A frame as blue, green and red, without what may not be seen.
    fn convert(&mut self, frame: &ImageView<'_>) -> Result<Image<&[u8]>, PictureError> {
        frame.write_packed_bgr(&mut self.converted)?;
        // A frame has at most 8192 x 8192 pixels.
        let size = Size::new(frame.width() as i32, frame.height() as i32);
        self.masks.hide(size, &mut self.converted)?;
        Ok(image_of(frame, &self.converted, 3 * frame.width(), turbojpeg::PixelFormat::BGR))
    }
}

/// The pixels of a frame for libjpeg-turbo.
fn image_of<'a>(
    frame: &ImageView<'_>,
    pixels: &'a [u8],
    pitch: usize,
    format: turbojpeg::PixelFormat,
) -> Image<&'a [u8]> {
    Image { pixels, width: frame.width(), height: frame.height(), pitch, format }
}

/// What libjpeg-turbo calls a format, if it reads it.
fn readable(format: PixelFormat) -> Option<turbojpeg::PixelFormat> {
    match format {
        PixelFormat::Bgr8 => Some(turbojpeg::PixelFormat::BGR),
        PixelFormat::Rgb8 => Some(turbojpeg::PixelFormat::RGB),
        PixelFormat::Bgra8 => Some(turbojpeg::PixelFormat::BGRA),
        PixelFormat::Rgba8 => Some(turbojpeg::PixelFormat::RGBA),
        PixelFormat::Gray8 => Some(turbojpeg::PixelFormat::GRAY),
        PixelFormat::Yuyv | PixelFormat::Nv12 => None,
    }
}

/// Two by two pixels share their colour, which nobody sees, and there is half as much to encode.
fn compress(image: Image<&[u8]>, quality: u8) -> Result<Vec<u8>, PictureError> {
    // Grey has no colour to be shared, and libjpeg-turbo makes none of it.
    let subsampling = match image.format {
        turbojpeg::PixelFormat::GRAY => Subsamp::Gray,
        _ => Subsamp::Sub2x2,
    };
    // It swaps no colours before it begins, as OpenCV does, and encodes in four fifths of the time.
    Ok(turbojpeg::compress(image, i32::from(quality), subsampling)?.to_vec())
}

/// What may be seen of a picture.
struct Masks {
    /// The size of the pictures that the polygons are drawn on.
    size: Option<Size>,
    /// What may be seen; everything where it is empty.
    bench: Vector<Point>,
    masks: Vector<Vector<Point>>,
    /// White where nothing may be seen, of the size of the newest frame.
    hidden: Mat,
}

impl Masks {
    fn new(record: &Record) -> Self {
        let polygon = |corners: &Vec<[u32; 2]>| -> Vector<Point> {
            // The configuration allows at most 8192.
            corners.iter().map(|&[x, y]| Point::new(x as i32, y as i32)).collect()
        };
        Self {
            size: record.size.map(|[width, height]| Size::new(width as i32, height as i32)),
            bench: polygon(&record.bench),
            masks: record.masks.iter().map(polygon).collect(),
            hidden: Mat::default(),
        }
    }

    fn hides(&self) -> bool {
        !(self.bench.is_empty() && self.masks.is_empty())
    }

    fn hide(&mut self, size: Size, pixels: &mut [u8]) -> opencv::Result<()> {
        if !self.hides() {
            return Ok(());
        }
        if self.hidden.size()? != size {
            self.hidden = self.hidden_of(size)?;
        }
        let mut picture = Mat::new_rows_cols_with_bytes_mut::<Vec3b>(size.height, size.width, pixels)?;
        picture.set_to(&Scalar::all(0.0), &self.hidden).map(drop)
    }

    /// White where nothing may be seen. That is everything, where the polygons were drawn on a picture of another size.
    fn hidden_of(&self, size: Size) -> opencv::Result<Mat> {
        let is_limited = !self.bench.is_empty();
        let (black, white) = (Scalar::all(0.0), Scalar::all(255.0));
        if self.size != Some(size) {
            return Mat::new_size_with_default(size, CV_8UC1, white);
        }
        let outside = if is_limited { white } else { black };
        let mut hidden = Mat::new_size_with_default(size, CV_8UC1, outside)?;
        if is_limited {
            fill(&mut hidden, &self.bench, black)?;
        }
        for mask in &self.masks {
            fill(&mut hidden, &mask, white)?;
        }
        // JPEG spreads a pixel over its block of 16: what lies at the border of a mask must not show through it.
        let mut wider = Mat::default();
        let kernel = Mat::new_rows_cols_with_default(5, 5, CV_8UC1, Scalar::all(1.0))?;
        imgproc::dilate(&hidden, &mut wider, &kernel, Point::new(-1, -1), 1, BORDER_CONSTANT, black)?;
        Ok(wider)
    }
}

/// Fills a polygon. In several at once OpenCV would leave out what lies in two of them.
fn fill(picture: &mut Mat, polygon: &Vector<Point>, colour: Scalar) -> opencv::Result<()> {
    let alone: Vector<Vector<Point>> = [polygon.clone()].into_iter().collect();
    imgproc::fill_poly_def(picture, &alone, colour)
}

/// The picture in a message of the topic [`crate::Topic::Picture`].
///
/// # Errors
/// As [`decode`].
pub fn picture_in(message: &Entry) -> Result<Decoded, PictureError> {
    decode(&jpeg_in(message.data.as_ref())?.0)
}

/// The file of the picture in a message of the topic [`crate::Topic::Picture`], as it is, with its width and height. Nothing of it is decoded.
///
/// # Errors
/// Bytes that are no JPEG, and one that is too large.
pub fn jpeg_in(message: &[u8]) -> Result<(Vec<u8>, [u32; 2]), PictureError> {
    let image = CompressedImage::decode(message).map_err(|_| PictureError::NoJpeg)?;
    let size = size_of(&image.data)?;
    Ok((image.data, size))
}

/// A picture out of a recording.
///
/// # Errors
/// Bytes that are no JPEG, and one that is too large, before anything of it is decoded; then what OpenCV says.
pub fn decode(jpeg: &[u8]) -> Result<Decoded, PictureError> {
    size_of(jpeg)?;
    let decoded = imgcodecs::imdecode(&Vector::from_slice(jpeg), imgcodecs::IMREAD_COLOR)?;
    // Neither is negative, and what cannot be decoded has none.
    let (width, height) = (decoded.cols().max(0) as u32, decoded.rows().max(0) as u32);
    Ok(Decoded { width, height, pixels: decoded.data_bytes()?.to_vec() })
}

/// The reverse of [`jpeg_in`]: a message with a JPEG, which was captured at this time, nanoseconds since 1970 UTC.
#[must_use]
pub fn message_of(jpeg: Vec<u8>, utc_ns: u64) -> Vec<u8> {
    let (timestamp, frame_id) = (timestamp(utc_ns), "camera".into());
    CompressedImage { timestamp, data: jpeg, format: "jpeg".into(), frame_id }.encode_to_vec()
}

/// Columns and rows of a JPEG, by the library with which OpenCV decodes it as well, so that both find the same. It refuses what OpenCV only warns of, as
/// stray bytes between segments or another version of JFIF. The recorder encodes such a picture of a camera. It does not refuse one without tables, as
/// Motion JPEG allows, which not every other program reads: of that `capture` keeps nothing.
fn size_of(jpeg: &[u8]) -> Result<[u32; 2], PictureError> {
    let header = read_header(jpeg).ok();
    // One of tables alone has no columns.
    let Some(DecompressHeader { width, height, .. }) = header.filter(|header| header.width > 0) else {
        return Err(PictureError::NoJpeg);
    };
    match width.max(height) > MAX_SIDE_PX {
        true => Err(PictureError::TooLarge { width, height }),
        // Both are far below 2^32.
        false => Ok([width as u32, height as u32]),
    }
}

/// A picture of blue, green and red as a file.
///
/// # Errors
/// A picture of other pixels than its size says; then what libjpeg-turbo says.
pub fn encode(picture: &Decoded, quality: u8) -> Result<Vec<u8>, PictureError> {
    let (width, height) = (picture.width as usize, picture.height as usize);
    if picture.pixels.len() != 3 * width * height {
        return Err(PictureError::OtherPixels { width, height });
    }
    let format = turbojpeg::PixelFormat::BGR;
    let image = Image { pixels: &picture.pixels[..], width, height, pitch: 3 * width, format };
    compress(image, quality)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use shm_schemas::ColourFormat;

    const SIZE: (u32, u32) = (320, 240);

    fn frame(pixels: impl Fn(u32, u32) -> [u8; 3]) -> (FrameHeader, Vec<u8>) {
        let (width, height) = SIZE;
        let header = FrameHeader {
            width,
            height,
            stride: 3 * width,
            colour_format: ColourFormat::Bgr8.code(),
            ..FrameHeader::default()
        };
        let bytes = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| pixels(x, y));
        (header, bytes.collect())
    }

    /// Whatever the pixels are, the brightest value that a region of the stored picture has.
    fn brightest(jpeg: &[u8], is_in: impl Fn(u32, u32) -> bool) -> u8 {
        let picture = decode(jpeg).unwrap();
        let pixels = picture.pixels.chunks_exact(3).zip(0_u32..);
        let inside = pixels.filter(|(_, at)| is_in(at % picture.width, at / picture.width));
        inside.flat_map(|(pixel, _)| pixel.iter().copied()).max().unwrap()
    }

    #[test]
    fn what_may_not_be_seen_is_black_in_the_stored_bytes() {
        let record = Record {
            size: Some([SIZE.0, SIZE.1]),
            bench: vec![[20, 20], [300, 20], [300, 220], [20, 220]],
            // What lies in both is hidden as well.
            masks: vec![
                vec![[100, 100], [150, 100], [150, 150], [100, 150]],
                vec![[120, 100], [150, 100], [150, 150], [120, 150]],
            ],
            ..Record::default()
        };
        let (header, bytes) = frame(|x, y| if (x ^ y) & 1 == 0 { [255; 3] } else { [40, 255, 90] });
        let jpeg = PictureMaker::new(&record).jpeg(&header, &bytes, None).unwrap();
        // What a lossy block leaves of black is far from anything that was there.
        const BLACK: u8 = 60;
        let is_outside = |x, y| !((20..=300).contains(&x) && (20..=220).contains(&y));
        assert!(brightest(&jpeg, is_outside) < BLACK);
        assert!(brightest(&jpeg, |x, y| (100..=150).contains(&x) && (100..=150).contains(&y)) < BLACK);
        assert!(brightest(&jpeg, |x, y| (30..90).contains(&x) && (30..90).contains(&y)) > 200);
        // With another picture behind the mask the very same bytes are stored.
        let is_hidden = |x, y| (101..150).contains(&x) && (101..150).contains(&y) || is_outside(x, y);
        let (_, other) = frame(|x, y| match is_hidden(x, y) {
            true => [7, 200, (x + y) as u8],
            false if (x ^ y) & 1 == 0 => [255; 3],
            false => [40, 255, 90],
        });
        assert_eq!(PictureMaker::new(&record).jpeg(&header, &other, None).unwrap(), jpeg);
    }

    #[test]
    fn what_the_camera_sent_is_stored_as_it_is_unless_something_may_not_be_seen() {
        let (header, bytes) = frame(|_, _| [255; 3]);
        let grey = Decoded { width: SIZE.0, height: SIZE.1, pixels: vec![128; bytes.len()] };
        let sent = encode(&grey, 50).unwrap();
        let sent = Some(sent.as_slice());
        let jpeg = PictureMaker::new(&Record::default()).jpeg(&header, &bytes, sent).unwrap();
        assert_eq!(Some(&jpeg[..]), sent);
        let masks = vec![vec![[0, 0], [320, 0], [320, 240], [0, 240]]];
        let record = Record { size: Some([SIZE.0, SIZE.1]), masks, ..Record::default() };
        let jpeg = PictureMaker::new(&record).jpeg(&header, &bytes, sent).unwrap();
        assert_eq!(brightest(&jpeg, |_, _| true), 0);
    }

    #[test]
    fn what_no_reader_of_recordings_takes_is_encoded_whoever_sent_it() {
        let (header, bytes) = frame(|_, _| [255; 3]);
        let own = PictureMaker::new(&Record::default()).jpeg(&header, &bytes, None).unwrap();
        let jfif = own.windows(5).position(|name| name == *b"JFIF\0").unwrap();
        let mut other_jfif = own.clone();
        other_jfif[jfif + 5] = 9;
        let tables = own.windows(2).position(|marker| marker == [0xff, 0xc4]).unwrap();
        let stray = [&own[..tables], &[7, 7], &own[tables..]].concat();
        for sent in [&other_jfif, &stray, &own[..100].to_vec(), &b"no picture".to_vec()] {
            assert!(matches!(decode(sent), Err(PictureError::NoJpeg)), "{} bytes", sent.len());
            let jpeg = PictureMaker::new(&Record::default()).jpeg(&header, &bytes, Some(sent)).unwrap();
            assert_eq!(jpeg, own);
        }
        // But what not every other program reads is read by these.
        let scan = own.windows(2).position(|marker| marker == [0xff, 0xda]).unwrap();
        assert!(decode(&[&own[..tables], &own[scan..]].concat()).is_ok());
    }

    #[test]
    fn of_a_picture_that_the_polygons_were_not_drawn_on_nothing_is_stored() {
        let mask = vec![[10, 10], [50, 10], [50, 50]];
        let record = Record { size: Some([640, 480]), masks: vec![mask], ..Record::default() };
        let (header, bytes) = frame(|_, _| [255; 3]);
        let jpeg = PictureMaker::new(&record).jpeg(&header, &bytes, None).unwrap();
        assert_eq!(brightest(&jpeg, |_, _| true), 0);
    }

    /// The same picture in another format, each row followed by bytes that belong to none.
    fn in_format(format: ColourFormat, bgr: &[u8]) -> (FrameHeader, Vec<u8>) {
        let pixels: Vec<Vec<u8>> = bgr.chunks_exact(3).map(|pixel| pixel_in(format, pixel)).collect();
        let (width, height) = SIZE;
        let mut bytes = Vec::new();
        for row in pixels.chunks_exact(width as usize) {
            bytes.extend(row.concat());
            bytes.extend([255; 64]);
        }
        let stride = bytes.len() as u32 / height;
        (FrameHeader { width, height, stride, colour_format: format.code(), ..FrameHeader::default() }, bytes)
    }

    fn pixel_in(format: ColourFormat, bgr: &[u8]) -> Vec<u8> {
        match format {
            ColourFormat::Rgb8 => bgr.iter().rev().copied().collect(),
            ColourFormat::Grey8 => vec![bgr[0]],
            _ => bgr.to_vec(),
        }
    }

    /// By how much the stored picture differs from the frame at most, below the block of the corner, which a mask covers.
    fn worst(jpeg: &[u8], bgr: &[u8]) -> Option<u8> {
        let picture = decode(jpeg).unwrap();
        assert_eq!((picture.width, picture.height), SIZE);
        let below = 3 * 16 * SIZE.0 as usize;
        picture.pixels[below..].iter().zip(&bgr[below..]).map(|(is, was)| is.abs_diff(*was)).max()
    }

    #[test]
    fn a_picture_looks_as_the_frame_did_in_every_format() {
        let corner = vec![vec![[0, 0], [1, 0], [0, 1]]];
        let masked = Record { size: Some([SIZE.0, SIZE.1]), masks: corner, ..Record::default() };
        let (_, colours) = frame(|x, _| [x as u8 / 2, 100, 200]);
        let (_, grey) = frame(|x, _| [x as u8 / 2; 3]);
        for record in [Record::default(), masked] {
            let mut maker = PictureMaker::new(&record);
            for (format, bgr) in
                [(ColourFormat::Bgr8, &colours), (ColourFormat::Rgb8, &colours), (ColourFormat::Grey8, &grey)]
            {
                let (header, bytes) = in_format(format, bgr);
                let worst = worst(&maker.jpeg(&header, &bytes, None).unwrap(), bgr);
                assert!(worst < Some(40), "{format:?}: {worst:?}");
            }
        }
    }

    #[test]
    fn a_picture_of_a_camera_that_sends_brightness_and_colours_is_as_bright_as_the_frame() {
        // Of BT.601, in which 16 is black and 235 is white.
        const BRIGHTNESS: u8 = 126;
        let (_, bright) = frame(|_, _| [128; 3]);
        let yuyv = ([BRIGHTNESS, 128].repeat(320 * 240), 2 * 320, ColourFormat::Yuyv);
        let nv12 = ([vec![BRIGHTNESS; 320 * 240], vec![128; 320 * 120]].concat(), 320, ColourFormat::Nv12);
        for (bytes, stride, format) in [yuyv, nv12] {
            let (width, height) = SIZE;
            let colour_format = format.code();
            let header = FrameHeader { width, height, stride, colour_format, ..FrameHeader::default() };
            let jpeg = PictureMaker::new(&Record::default()).jpeg(&header, &bytes, None).unwrap();
            assert!(worst(&jpeg, &bright) < Some(4), "{format:?}");
        }
    }

    #[test]
    fn a_frame_that_promises_more_than_it_has_is_refused() {
        let (header, bytes) = frame(|_, _| [0; 3]);
        assert!(PictureMaker::new(&Record::default()).jpeg(&header, &bytes[1..], None).is_err());
        assert!(matches!(decode(b"no picture"), Err(PictureError::NoJpeg)));
        let cut = Decoded { width: 4, height: 4, pixels: vec![0; 47] };
        assert!(matches!(encode(&cut, 80), Err(PictureError::OtherPixels { width: 4, height: 4 })));
    }

    /// A picture of 48 x 32 pixels, with these bytes after its first marker.
    fn with(bytes: &[u8]) -> Vec<u8> {
        let mut jpeg = encode(&Decoded { width: 48, height: 32, pixels: vec![90; 3 * 48 * 32] }, 80).unwrap();
        jpeg.splice(2..2, bytes.iter().copied());
        jpeg
    }

    #[test]
    fn the_size_is_that_of_the_frame_after_any_other_segments() {
        const COMMENT: [u8; 7] = [0xff, 0xff, 0xfe, 0, 4, 1, 2];
        for segments in [&[][..], &COMMENT, &[COMMENT, COMMENT].concat()] {
            let picture = decode(&with(segments)).unwrap();
            assert_eq!((picture.width, picture.height), (48, 32));
        }
    }

    #[test]
    fn what_has_no_frame_where_it_must_be_is_no_jpeg() {
        let is_none = |bytes: &[u8]| matches!(decode(bytes), Err(PictureError::NoJpeg));
        let whole = with(&[]);
        let scan = whole.windows(2).position(|marker| marker == [0xff, 0xda]).unwrap();
        for length in 0..scan {
            assert!(is_none(&whole[..length]), "{length} bytes of it");
        }
        assert!(is_none(&with(&[7])), "something before the marker");
        assert!(is_none(&with(&[0xff, 0xd9])), "an end before it");
        assert!(is_none(&with(&[0xff, 0xdb, 0, 1])), "a length that is none");
        assert!(is_none(b"\x89PNG\r\n"));
    }
}
