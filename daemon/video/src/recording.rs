//! Films, read by OpenCV.

use std::path::{Path, PathBuf};

use andon_host::video::pipe::PictureFormat;
use andon_learn::file;
use opencv::core::{self, DataType, Mat, MatTraitConst, MatTraitConstManual as _, Vec3b};
use opencv::videoio::{self, VideoCapture, VideoCaptureTrait, VideoCaptureTraitConst};

use crate::container::{self, Turn};
use crate::folder::{Folder, is_picture};
use crate::source::Source;

/// The rate of a film or a device that does not tell its own.
const DEFAULT_RATE_HZ: f64 = 30.0;

/// Opens a film, a picture, or a folder of pictures that is played at `rate_hz`.
pub(crate) fn open(path: &Path, rate_hz: f64) -> Result<Box<dyn Source>, String> {
    if path.is_dir() {
        return Ok(Box::new(Folder::open(path, rate_hz)?));
    }
    if !path.exists() {
        return Err("no such file; give a film or a folder of pictures".into());
    }
    if is_picture(path) {
        return Ok(Box::new(Folder::of_one(path, rate_hz)?));
    }
    // The decoder would wait for the writer of a pipe.
    let film = file::open(path).map_err(|error| error.to_string())?;
    if film.metadata().is_ok_and(|film| film.len() == 0) {
        return Err("the file is empty: copy the film again".into());
    }
    if let Some(other) = file::other_than_film(film).map_err(|error| error.to_string())? {
        return Err(other.into());
    }
    Ok(Box::new(Film::open(path)?))
}

/// A path by which FFmpeg means a file: what stands before a colon, as in `10:15:00.mp4`, is a protocol to it.
fn absolute(path: &Path) -> Result<PathBuf, String> {
    std::path::absolute(path).map_err(|error| error.to_string())
}

/// Lets OpenCV write the next picture of `capture` into the caller's memory, in so many rows and columns of `Pixel`; false at the end.
pub(crate) fn read_in_place<Pixel: DataType>(
    capture: &mut VideoCapture,
    [rows, columns]: [u32; 2],
    picture: &mut [u8],
) -> Result<bool, String> {
    let at = picture.as_ptr();
    let mut mat = Mat::new_rows_cols_with_bytes_mut::<Pixel>(rows as i32, columns as i32, picture)
        .map_err(|error| error.to_string())?;
    let read = capture.read(&mut mat).map_err(|error| error.to_string())?;
    // OpenCV keeps the given buffer while size and type fit, and allocates another one when they do not.
    if read && mat.data() != at {
        return Err("the pictures change their size or colour format in mid-stream".into());
    }
    Ok(read)
}

fn property(capture: &VideoCapture, property: i32) -> f64 {
    capture.get(property).unwrap_or(0.0)
}

pub(crate) fn format_of(capture: &VideoCapture) -> Result<PictureFormat, String> {
    let width = property(capture, videoio::CAP_PROP_FRAME_WIDTH);
    let height = property(capture, videoio::CAP_PROP_FRAME_HEIGHT);
    let rate_hz = property(capture, videoio::CAP_PROP_FPS);
    if !(width >= 1.0 && height >= 1.0) {
        return Err("it holds no pictures".into());
    }
    Ok(PictureFormat {
        width: width as u32,
        height: height as u32,
        rate_hz: if rate_hz.is_finite() && rate_hz > 0.0 { rate_hz } else { DEFAULT_RATE_HZ },
        count: property(capture, videoio::CAP_PROP_FRAME_COUNT).max(0.0) as u64,
    })
}

/// How many pictures a film has by its own account; `None` if it gives no number.
pub(crate) fn count_of(path: &Path) -> Option<u64> {
    let capture = VideoCapture::from_file(path, videoio::CAP_FFMPEG).ok()?;
    capture
        .is_opened()
        .unwrap_or(false)
        .then(|| format_of(&capture).ok().map(|format| format.count))
        .flatten()
}

/// A video file.
struct Film {
    capture: VideoCapture,
    /// As the pictures are shown.
    format: PictureFormat,
    turn: Turn,
    /// The picture as it was recorded, and mirrored, where it is turned.
    recorded: [Mat; 2],
    /// The file is shorter than its container says.
    is_cut: bool,
    shown: u64,
    times: Times,
}

/// The times at which the pictures of a film are due.
#[derive(Default)]
struct Times {
    /// The container's time of the first picture.
    first_ms: Option<f64>,
    /// The times of the container do not keep to the rate.
    vary: bool,
    newest_ns: Option<u64>,
}

impl Times {
    /// Time of the picture at `index` in a film of this rate, in nanoseconds since the first; `container_ms` is the container's time.
    ///
    /// Containers round their times, while the rate is exact and the same on every machine. So the rate decides until a picture is half
    /// a period away from it: telephones and screen recorders write films without a fixed rate.
    fn of(&mut self, index: u64, rate_hz: f64, container_ms: f64) -> u64 {
        let by_rate_ns = index as f64 * 1e9 / rate_hz;
        let container_ns = 1e6 * (container_ms - *self.first_ms.get_or_insert(container_ms));
        // A container without times reports 0.
        self.vary |= container_ns > 0.0 && (container_ns - by_rate_ns).abs() > 0.5e9 / rate_hz;
        let ns = (if self.vary { container_ns } else { by_rate_ns }).round().max(0.0) as u64;
        let ns = self.newest_ns.map_or(ns, |newest_ns| ns.max(newest_ns + 1));
        self.newest_ns = Some(ns);
        ns
    }
}

impl Film {
    fn open(path: &Path) -> Result<Self, String> {
        let container = container::read(path);
        let mut capture = VideoCapture::from_file(absolute(path)?, videoio::CAP_FFMPEG)
            .map_err(|error| error.to_string())?;
        if !capture.is_opened().unwrap_or(false) {
            return Err("it is not a film that this machine can decode; H.264 in MP4 always works".into());
        }
        let turn = container.turn.unwrap_or_default();
        if container.turn.is_some() {
            // What is turned by the file's own words is not turned by OpenCV as well.
            let _ = capture.set(videoio::CAP_PROP_ORIENTATION_AUTO, 0.0);
        }
        let mut format = format_of(&capture)?;
        if turn.quarters % 2 == 1 {
            (format.width, format.height) = (format.height, format.width);
        }
        format.count = match container.pictures {
            Some(pictures) => pictures,
            None if container::has_a_count(path) => format.count,
            None => 0,
        };
        let recorded = [Mat::default(), Mat::default()];
        Ok(Self {
            capture,
            format,
            turn,
            recorded,
            is_cut: container.is_cut,
            shown: 0,
            times: Times::default(),
        })
    }

    /// Writes the next picture as it is shown; false after the last.
    fn read(&mut self, picture: &mut [u8]) -> Result<bool, String> {
        let Self { capture, format, turn, recorded: [read, mirrored], .. } = self;
        if *turn == Turn::default() {
            return read_in_place::<Vec3b>(capture, [format.height, format.width], picture);
        }
        let message = |error: opencv::Error| error.to_string();
        if !capture.read(read).map_err(message)? {
            return Ok(false);
        }
        if turn.is_mirrored {
            core::flip(read, mirrored, 1).map_err(message)?;
            std::mem::swap(read, mirrored);
        }
        let code = match turn.quarters {
            1 => Some(core::ROTATE_90_CLOCKWISE),
            2 => Some(core::ROTATE_180),
            3 => Some(core::ROTATE_90_COUNTERCLOCKWISE),
            _ => None,
        };
        if let Some(code) = code {
            core::rotate(read, mirrored, code).map_err(message)?;
            std::mem::swap(read, mirrored);
        }
        let bytes = read.data_bytes().map_err(message)?;
        if bytes.len() != picture.len() || read.cols() as u32 != format.width {
            return Err("the pictures change their size or colour format in mid-stream".into());
        }
        picture.copy_from_slice(bytes);
        Ok(true)
    }
}

impl Source for Film {
    fn format(&self) -> PictureFormat {
        self.format
    }

    fn next_picture(&mut self, picture: &mut [u8]) -> Result<Option<u64>, String> {
        if !self.read(picture)? {
            return self.end();
        }
        let container_ms = property(&self.capture, videoio::CAP_PROP_POS_MSEC);
        let pts_ns = self.times.of(self.shown, self.format.rate_hz, container_ms);
        self.shown += 1;
        Ok(Some(pts_ns))
    }
}

impl Film {
    /// A decoder that meets damage reports the end of the film, so the number of pictures is checked. Some programs round the length of a film:
    /// one second is tolerated.
    fn end(&self) -> Result<Option<u64>, String> {
        let PictureFormat { count, rate_hz, .. } = self.format;
        if self.is_cut || self.shown as f64 + rate_hz < count as f64 {
            let of = if count > 0 { format!(" of {count}") } else { String::new() };
            return Err(format!(
                "it breaks off after {}{of} pictures: it is damaged or was cut short, copy it again",
                self.shown
            ));
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(rate_hz: f64, container_ms: &[f64]) -> Vec<u64> {
        let mut times = Times::default();
        let pictures = (0..).zip(container_ms);
        pictures.map(|(index, container_ms)| times.of(index, rate_hz, *container_ms) / 1_000_000).collect()
    }

    #[test]
    fn a_film_of_a_fixed_rate_keeps_to_it_however_the_container_rounds() {
        assert_eq!(times(40.0, &[7.0, 32.4, 56.6, 82.0]), [0, 25, 50, 75]);
    }

    #[test]
    fn a_film_whose_container_has_no_times_keeps_to_its_rate() {
        assert_eq!(times(40.0, &[0.0, 0.0, 0.0]), [0, 25, 50]);
    }

    #[test]
    fn a_film_without_a_fixed_rate_has_the_times_of_its_container() {
        assert_eq!(times(40.0, &[0.0, 25.0, 90.0, 115.0, 140.0]), [0, 25, 90, 115, 140]);
    }
}
