//! V4L2 devices, read by OpenCV.

use std::fs::File;
use std::io::ErrorKind;
use std::path::Path;
use std::time::Instant;

use crate::OpenError;
use andon_host::config::Camera;
use andon_host::video::pipe::PictureFormat;
use opencv::videoio::{self, VideoCapture, VideoCaptureTrait, VideoCaptureTraitConst, VideoWriter};
use shm_schemas::FrameHeader;

use crate::encoding::{self, Encoding, Reader};
use crate::recording::format_of;
use crate::source::Source;

/// `V4L2_EXPOSURE_MANUAL` and `V4L2_EXPOSURE_APERTURE_PRIORITY`, which OpenCV passes on unchanged.
const MANUAL: f64 = 1.0;
const AUTOMATIC: f64 = 3.0;

/// The unit of `V4L2_CID_EXPOSURE_ABSOLUTE` is 100 µs.
const EXPOSURE_UNIT_US: f64 = 100.0;

/// Cameras round their rates: 29.97 Hz is 30 Hz. The next lower rate of a camera is a half or two thirds.
const MIN_RATE_SHARE: f64 = 0.95;

/// A V4L2 device.
pub(crate) struct Device {
    capture: VideoCapture,
    format: PictureFormat,
    encoding: Encoding,
    reader: Reader,
    opened: Instant,
}

impl Device {
    /// Opens `/dev/videoN` with the configured size, rate and exposure, in the first encoding in which it has them. The device chooses the
    /// nearest values that it offers, which must fit the configuration.
    pub(crate) fn open(camera: &Camera) -> Result<Self, OpenError> {
        reachable(&camera.device)?;
        encoding::choose(Encoding::allowed(camera.encoding), |encoding| Self::open_as(camera, encoding))
    }

    fn open_as(camera: &Camera, encoding: Encoding) -> Result<Self, OpenError> {
        let path = camera.device.display();
        let gone = |error: opencv::Error| OpenError::Gone(format!("{path}: {error}"));
        let mut capture = VideoCapture::from_file(&camera.device, videoio::CAP_V4L2).map_err(gone)?;
        if !capture.is_opened().unwrap_or(false) {
            return Err(OpenError::Gone(format!(
                "{path}: this is not a camera that sends pictures, or another program is using it"
            )));
        }
        if let Some([a, b, c, d]) = encoding.letters() {
            let letters = VideoWriter::fourcc(a, b, c, d).map_err(gone)?;
            // Asked back as well: a device that refuses keeps its own encoding.
            let is_taken = capture.set(videoio::CAP_PROP_FOURCC, letters.into()).unwrap_or(false)
                && capture.get(videoio::CAP_PROP_FOURCC).is_ok_and(|taken| taken as i32 == letters)
                && capture.set(videoio::CAP_PROP_CONVERT_RGB, 0.0).unwrap_or(false);
            if !is_taken {
                return Err(OpenError::Refused(format!(
                    "{path} does not send {a}{b}{c}{d}; `v4l2-ctl --list-formats-ext` lists what it offers"
                )));
            }
        }
        for (property, value) in [
            (videoio::CAP_PROP_FRAME_WIDTH, f64::from(camera.width)),
            (videoio::CAP_PROP_FRAME_HEIGHT, f64::from(camera.height)),
            (videoio::CAP_PROP_FPS, f64::from(camera.rate_hz)),
        ] {
            // A device that refuses keeps its own value, which `format_of` reads back.
            let _ = capture.set(property, value);
        }
        expose(&mut capture, camera.exposure_us)?;
        let format = format_of(&capture).map_err(OpenError::Gone)?;
        fits(format, camera)?;
        let format = PictureFormat { count: 0, ..format };
        Ok(Self { capture, format, encoding, reader: Reader::default(), opened: Instant::now() })
    }
}

/// Checks that the device exists and that this user may open it.
fn reachable(path: &Path) -> Result<(), OpenError> {
    match File::options().read(true).write(true).open(path) {
        Ok(_) => Ok(()),
        Err(error) if error.kind() == ErrorKind::NotFound => Err(OpenError::Gone(format!(
            "{}: no such device; is the camera plugged in? `ls /dev/video*` lists them",
            path.display()
        ))),
        Err(error) if error.kind() == ErrorKind::PermissionDenied => {
            Err(OpenError::NotAllowed(format!("{}: {error}", path.display())))
        }
        Err(error) => Err(OpenError::Gone(format!("{}: {error}", path.display()))),
    }
}

/// Fixes the exposure, or leaves it to the camera: a device keeps an exposure that an earlier program has fixed.
fn expose(capture: &mut VideoCapture, exposure_us: Option<u32>) -> Result<(), OpenError> {
    let mut set = |property, value| capture.set(property, value).unwrap_or(false);
    let Some(exposure_us) = exposure_us else {
        // Not every camera has an automatic exposure.
        let _ = set(videoio::CAP_PROP_AUTO_EXPOSURE, AUTOMATIC);
        return Ok(());
    };
    let units = (f64::from(exposure_us) / EXPOSURE_UNIT_US).round().max(1.0);
    if set(videoio::CAP_PROP_AUTO_EXPOSURE, MANUAL) && set(videoio::CAP_PROP_EXPOSURE, units) {
        return Ok(());
    }
    Err(OpenError::Refused(format!(
        "the camera does not accept a fixed exposure of {exposure_us} µs; `v4l2-ctl --list-ctrls` lists what it accepts"
    )))
}

/// Checks the size, which the calibration and the shared memory depend on, and the rate, which the method depends on.
fn fits(actual: PictureFormat, camera: &Camera) -> Result<(), OpenError> {
    let fits = (actual.width, actual.height) == (camera.width, camera.height)
        && actual.rate_hz >= MIN_RATE_SHARE * f64::from(camera.rate_hz);
    if fits {
        return Ok(());
    }
    Err(OpenError::Refused(format!(
        "{} sends {} x {} pixels at {} Hz instead of {} x {} at {} Hz; `v4l2-ctl --list-formats-ext` lists what it \
         offers",
        camera.device.display(),
        actual.width,
        actual.height,
        actual.rate_hz,
        camera.width,
        camera.height,
        camera.rate_hz
    )))
}

impl Source for Device {
    fn format(&self) -> PictureFormat {
        self.format
    }

    fn frame_bytes(&self) -> usize {
        self.encoding.frame_bytes(self.format)
    }

    fn describe(&self, header: &mut FrameHeader) {
        self.encoding.describe(self.format, header);
        header.dropped = self.reader.damaged;
        header.jpeg_bytes = self.reader.jpeg_bytes;
    }

    fn next_picture(&mut self, picture: &mut [u8]) -> Result<Option<u64>, String> {
        if !self.reader.read(&mut self.capture, self.encoding, self.format, picture)? {
            return Err("the camera sends no more pictures; is it still plugged in?".into());
        }
        Ok(Some(self.opened.elapsed().as_nanos() as u64))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn check(width: u32, rate_hz: f64) -> Result<(), OpenError> {
        let camera = Camera { width: 1280, height: 720, rate_hz: 30.0, ..Camera::default() };
        fits(PictureFormat { width, height: 720, rate_hz, count: 0 }, &camera)
    }

    #[test]
    fn a_camera_that_rounds_its_rate_fits_and_one_of_another_size_or_half_the_rate_does_not() {
        assert_eq!(check(1280, 29.97), Ok(()));
        for refused in [check(640, 30.0), check(1280, 15.0)] {
            let error = refused.unwrap_err();
            assert!(matches!(error, OpenError::Refused(_)), "{error:?}");
            assert!(error.to_string().contains("instead of 1280 x 720 at 30 Hz"), "{error}");
        }
    }

    #[test]
    fn a_device_that_is_not_there_may_come_back() {
        assert!(matches!(reachable(Path::new("/dev/video-of-nobody")), Err(OpenError::Gone(_))));
    }
}
