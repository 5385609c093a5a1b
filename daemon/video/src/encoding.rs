//! How a V4L2 device sends its pictures, and how they come into a frame. They come as they are, so that nothing is converted that nobody looks at, or
//! are decoded straight into it.

use crate::{OpenError, jpeg};
use andon_host::config::Encoding as Configured;
use andon_host::video::pipe::PictureFormat;
use opencv::core::{Mat, MatTraitConst, MatTraitConstManual, ToInputArray, Vec2b, Vec3b};
use opencv::imgcodecs;
use opencv::videoio::{VideoCapture, VideoCaptureTrait};
use shm_schemas::{ColourFormat, FrameHeader};

use crate::recording::read_in_place;

/// So many damaged pictures in a row are more than a cable that was touched.
const MAX_DAMAGED: u32 = 30;

/// What the end of a frame holds until a picture is decoded into it, because OpenCV does not say whether it has done so. They are pixels in turn
/// green and magenta. No JPEG of a camera shows that, where two pixels at least share their colour.
const UNTOUCHED: [u8; 12] = [0, 255, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255];

/// An encoding that this program reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    Yuyv,
    Nv12,
    Mjpeg,
    /// Whatever the device sends, converted by OpenCV.
    Converted,
}

impl Encoding {
    /// The encodings that the configuration allows, the one that takes least work first.
    pub(crate) fn allowed(configured: Configured) -> &'static [Self] {
        match configured {
            Configured::Auto => &[Self::Yuyv, Self::Nv12, Self::Mjpeg, Self::Converted],
            Configured::Yuyv => &[Self::Yuyv],
            Configured::Nv12 => &[Self::Nv12],
            Configured::Mjpeg => &[Self::Mjpeg],
        }
    }

    /// V4L2's four letters; `None` where OpenCV chooses.
    pub(crate) fn letters(self) -> Option<[char; 4]> {
        match self {
            Self::Yuyv => Some(['Y', 'U', 'Y', 'V']),
            Self::Nv12 => Some(['N', 'V', '1', '2']),
            Self::Mjpeg => Some(['M', 'J', 'P', 'G']),
            Self::Converted => None,
        }
    }

    /// Bytes of a frame: its pixels, and room for the JPEG that they come from. No camera sends a byte for each pixel.
    pub(crate) fn frame_bytes(self, format: PictureFormat) -> usize {
        let pixels = format.width as usize * format.height as usize;
        self.colour_bytes(format) + if self == Self::Mjpeg { pixels } else { 0 }
    }

    /// Bytes of the pixels of a frame.
    fn colour_bytes(self, format: PictureFormat) -> usize {
        let pixels = format.width as usize * format.height as usize;
        match self {
            Self::Yuyv => 2 * pixels,
            Self::Nv12 => pixels + pixels / 2,
            Self::Mjpeg | Self::Converted => 3 * pixels,
        }
    }

    /// Enters the layout of a frame into its header.
    pub(crate) fn describe(self, format: PictureFormat, header: &mut FrameHeader) {
        let (bytes, colour_format) = match self {
            Self::Yuyv => (2, ColourFormat::Yuyv),
            Self::Nv12 => (1, ColourFormat::Nv12),
            Self::Mjpeg | Self::Converted => (3, ColourFormat::Bgr8),
        };
        (header.width, header.height, header.stride) = (format.width, format.height, bytes * format.width);
        header.colour_format = colour_format.code();
    }
}

/// The first allowed encoding in which the device sends what is wanted. `ask` asks for one, and says why it does not do.
///
/// # Errors
/// Why the first one does not do.
pub(crate) fn choose<T>(
    allowed: &[Encoding],
    mut ask: impl FnMut(Encoding) -> Result<T, OpenError>,
) -> Result<T, OpenError> {
    let mut refused = None;
    for encoding in allowed {
        match ask(*encoding) {
            Err(error @ OpenError::Refused(_)) => refused = refused.or(Some(error)),
            answer => return answer,
        }
    }
    Err(refused.unwrap_or_else(|| OpenError::Refused("no encoding is allowed".into())))
}

/// Reads pictures of one encoding.
#[derive(Default)]
pub(crate) struct Reader {
    /// The newest picture as it was sent, where it has to be decoded.
    jpeg: Mat,
    /// How long it is behind the pixels of the newest frame; 0 where it is not there.
    pub(crate) jpeg_bytes: u32,
    /// Pictures that were damaged since the last good one.
    pub(crate) damaged: u32,
}

impl Reader {
    /// Writes the next picture into a frame; false when the device sends no more.
    ///
    /// # Errors
    /// A message for a technician.
    pub(crate) fn read(
        &mut self,
        capture: &mut VideoCapture,
        encoding: Encoding,
        format: PictureFormat,
        frame: &mut [u8],
    ) -> Result<bool, String> {
        let PictureFormat { width, height, .. } = format;
        match encoding {
            Encoding::Yuyv => read_in_place::<Vec2b>(capture, [height, width], frame),
            Encoding::Nv12 => read_in_place::<u8>(capture, [height + height / 2, width], frame),
            Encoding::Converted => read_in_place::<Vec3b>(capture, [height, width], frame),
            Encoding::Mjpeg => {
                self.damaged = 0;
                let (picture, room) = frame.split_at_mut(encoding.colour_bytes(format).min(frame.len()));
                while capture.read(&mut self.jpeg).map_err(|error| error.to_string())? {
                    if decode(&self.jpeg, format, picture)? {
                        let jpeg = self.jpeg.data_bytes().map_err(|error| error.to_string())?;
                        self.jpeg_bytes = keep(jpeg, room);
                        return Ok(true);
                    }
                    self.damaged += 1;
                    if self.damaged == MAX_DAMAGED {
                        return Err(
                            "the camera sends damaged pictures; try another cable or port, or a lower rate"
                                .into(),
                        );
                    }
                }
                Ok(false)
            }
        }
    }
}

/// Decodes a JPEG into a frame; false where it is damaged.
fn decode(
    jpeg: &(impl MatTraitConst + ToInputArray),
    format: PictureFormat,
    frame: &mut [u8],
) -> Result<bool, String> {
    let message = |error: opencv::Error| error.to_string();
    // What is cut short is decoded, with grey in place of the rest.
    if !ends_as_jpeg(jpeg.data_bytes().map_err(message)?) {
        return Ok(false);
    }
    let Some(end) = frame.last_chunk_mut() else { return Ok(false) };
    *end = UNTOUCHED;
    let at = frame.as_ptr();
    let mut picture =
        Mat::new_rows_cols_with_bytes_mut::<Vec3b>(format.height as i32, format.width as i32, frame)
            .map_err(message)?;
    let decoded = imgcodecs::imdecode_to(jpeg, imgcodecs::IMREAD_COLOR, &mut picture);
    // A picture of another size lies in memory of its own.
    let is_in_place = decoded.is_ok_and(|decoded| decoded.data() == at);
    Ok(is_in_place && !frame.ends_with(&UNTOUCHED))
}

/// Puts a JPEG into the room behind the pixels, and says how long it is. 0 where it does not fit, or not every program reads it.
fn keep(jpeg: &[u8], room: &mut [u8]) -> u32 {
    let jpeg = without_filling(jpeg);
    match room.get_mut(..jpeg.len()) {
        Some(place) if is_for_every_program(jpeg) => {
            place.copy_from_slice(jpeg);
            // A frame has fewer bytes than this counts: each of its rows does.
            jpeg.len() as u32
        }
        _ => 0,
    }
}

/// Whether the segments before the picture follow each other, and its tables are among them (ITU-T T.81, DHT before SOS). In Motion JPEG these may be
/// left out, because all pictures have the same: libjpeg-turbo knows them, and not every program does. Some cameras put stray bytes between segments,
/// which OpenCV skips.
fn is_for_every_program(file: &[u8]) -> bool {
    let Some(mut rest) = file.strip_prefix(&jpeg::START) else { return false };
    let mut has_tables = false;
    while let Some((kind, after)) = jpeg::next_marker(rest) {
        match kind {
            jpeg::SCAN => return has_tables,
            // Nothing comes before the picture that has no length.
            kind if jpeg::is_alone(kind) => return false,
            kind => has_tables |= kind == jpeg::TABLES,
        }
        rest = after;
    }
    false
}

/// Whether the last bytes are the marker of an end.
fn ends_as_jpeg(bytes: &[u8]) -> bool {
    without_filling(bytes).ends_with(&[0xff, 0xd9])
}

/// Some cameras fill up with zeros.
fn without_filling(bytes: &[u8]) -> &[u8] {
    let length = bytes.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    &bytes[..length]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use opencv::core::{Scalar, Vector};

    const FORMAT: PictureFormat = PictureFormat { width: 64, height: 48, rate_hz: 30.0, count: 0 };

    fn refused(encoding: Encoding) -> OpenError {
        OpenError::Refused(format!("no {encoding:?}"))
    }

    #[test]
    fn of_the_encodings_that_fit_the_one_that_takes_least_work_is_chosen() {
        let chosen = |configured, fits: &[Encoding]| {
            choose(Encoding::allowed(configured), |encoding| {
                if fits.contains(&encoding) { Ok(encoding) } else { Err(refused(encoding)) }
            })
        };
        let all = [Encoding::Yuyv, Encoding::Nv12, Encoding::Mjpeg, Encoding::Converted];
        assert_eq!(chosen(Configured::Auto, &all), Ok(Encoding::Yuyv));
        assert_eq!(chosen(Configured::Auto, &all[2..]), Ok(Encoding::Mjpeg));
        assert_eq!(chosen(Configured::Auto, &all[3..]), Ok(Encoding::Converted));
        assert_eq!(chosen(Configured::Mjpeg, &all), Ok(Encoding::Mjpeg));
        assert_eq!(chosen(Configured::Nv12, &all[..1]), Err(refused(Encoding::Nv12)));
        assert_eq!(chosen(Configured::Auto, &[]), Err(refused(Encoding::Yuyv)));
    }

    #[test]
    fn a_camera_that_is_gone_is_not_asked_for_another_encoding() {
        let mut asked = 0;
        let answer: Result<(), _> = choose(Encoding::allowed(Configured::Auto), |_| {
            asked += 1;
            Err(OpenError::Gone("unplugged".into()))
        });
        assert_eq!((answer, asked), (Err(OpenError::Gone("unplugged".into())), 1));
    }

    #[test]
    fn the_header_says_how_the_bytes_of_a_frame_are_to_be_read() {
        for encoding in Encoding::allowed(Configured::Auto) {
            let mut header = FrameHeader::default();
            encoding.describe(FORMAT, &mut header);
            assert_eq!(header.colour_bytes(), Some(encoding.colour_bytes(FORMAT)), "{encoding:?}");
            let frame = vec![128; encoding.frame_bytes(FORMAT)];
            assert!(andon_host::video::frame::view(&header, &frame).is_ok(), "{encoding:?}");
        }
    }

    /// A JPEG of one colour.
    fn jpeg(width: i32, height: i32) -> Vector<u8> {
        let picture = Mat::new_rows_cols_with_default(
            height,
            width,
            opencv::core::CV_8UC3,
            Scalar::new(40.0, 120.0, 200.0, 0.0),
        );
        let mut file = Vector::new();
        imgcodecs::imencode_def(".jpg", &picture.unwrap(), &mut file).unwrap();
        file
    }

    #[test]
    fn a_jpeg_is_kept_behind_the_pixels_unless_it_does_not_fit_or_not_every_program_reads_it() {
        let file = jpeg(64, 48);
        let file = file.as_slice();
        let mut room = vec![0; file.len()];
        assert_eq!(keep(&[file, &[0; 9]].concat(), &mut room) as usize, file.len());
        assert_eq!(room, file);
        assert_eq!(keep(file, &mut room[1..]), 0);
        // Without its tables, as Motion JPEG allows: the first segment of them is skipped by its length.
        let tables = file.windows(2).position(|marker| marker == [0xff, 0xc4]).unwrap();
        let scan = file.windows(2).position(|marker| marker == [0xff, 0xda]).unwrap();
        assert_eq!(keep(&[&file[..tables], &file[scan..]].concat(), &mut room), 0);
        let mut room = vec![0; file.len() + 3];
        let with = |bytes: &[u8]| [&file[..tables], bytes, &file[tables..]].concat();
        assert_ne!(keep(&with(&[0xff]), &mut room), 0, "padding");
        assert_eq!(keep(&with(&[7, 7]), &mut room), 0, "stray bytes between two segments");
        assert_eq!(keep(&file[..tables + 3], &mut room), 0, "a segment that is cut");
        assert_eq!(keep(b"no picture", &mut room), 0);
    }

    #[test]
    fn a_jpeg_is_decoded_and_a_damaged_one_or_one_of_another_size_is_noticed() {
        let decoded = |file: &[u8]| {
            let mut frame = vec![7; Encoding::Mjpeg.colour_bytes(FORMAT)];
            let is_whole = decode(&Mat::from_slice(file).unwrap(), FORMAT, &mut frame).unwrap();
            (is_whole, [frame[0], frame[1], frame[2]])
        };
        let file = jpeg(64, 48);
        let (is_whole, pixel) = decoded(file.as_slice());
        assert!(
            is_whole && pixel.iter().zip([40, 120, 200]).all(|(value, sent)| value.abs_diff(sent) < 4),
            "{pixel:?}"
        );
        assert!(decoded(&[file.as_slice(), &[0; 9]].concat()).0, "one that is filled up");
        assert!(!decoded(&file.as_slice()[..file.len() - 20]).0, "one that is cut short");
        assert!(!decoded(&[&[1; 400][..], &[0xff, 0xd9]].concat()).0, "one that is none");
        assert!(!decoded(jpeg(32, 48).as_slice()).0, "one of another size");
    }
}
