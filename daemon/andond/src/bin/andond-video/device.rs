//! V4L2 devices, by OpenCV.

use std::fs::File;
use std::io::ErrorKind;
use std::path::Path;
use std::time::Instant;

use andond::config::Camera;
use andond::video::pipe::PictureFormat;
use andond::video::source::{OpenError, Source};
use opencv::videoio::{self, VideoCapture, VideoCaptureTrait, VideoCaptureTraitConst};

use crate::sources::{format_of, read_in_place};

/// `V4L2_EXPOSURE_MANUAL` and `V4L2_EXPOSURE_APERTURE_PRIORITY`, which OpenCV hands on as they are.
const MANUAL: f64 = 1.0;
const AUTOMATIC: f64 = 3.0;

/// `V4L2_CID_EXPOSURE_ABSOLUTE` counts in 100 µs.
const EXPOSURE_UNIT_US: f64 = 100.0;

/// Cameras round their rates: 29.97 Hz is 30 Hz. The next one that a camera has is a half or two thirds.
const RATE_SHARE: f64 = 0.95;

/// A V4L2 device.
pub(crate) struct Device {
    capture: VideoCapture,
    format: PictureFormat,
    opened: Instant,
}

impl Device {
    /// Opens `/dev/videoN` with the configured size, rate and exposure; the device answers with the nearest that it has.
    pub(crate) fn open(camera: &Camera) -> Result<Self, OpenError> {
        let path = &camera.device;
        reachable(path)?;
        let gone = |error: opencv::Error| OpenError::Gone(format!("{}: {error}", path.display()));
        let mut capture = VideoCapture::from_file(path, videoio::CAP_V4L2).map_err(gone)?;
        if !capture.is_opened().unwrap_or(false) {
            return Err(OpenError::Gone(format!(
                "{}: it is no camera that pictures can be had from, or another program is using it",
                path.display()
            )));
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
        Ok(Self { capture, format: PictureFormat { count: 0, ..format }, opened: Instant::now() })
    }
}

/// Whether there is such a device, and this user may use it.
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

/// Fixes the exposure, or leaves it to the camera. What was fixed before stays in the device until it is told otherwise.
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
        "it does not take a fixed exposure of {exposure_us} µs; `v4l2-ctl --list-ctrls` says which it takes"
    )))
}

/// The calibration and the room in shared memory are for the configured size, the method for the rate.
fn fits(has: PictureFormat, camera: &Camera) -> Result<(), OpenError> {
    let fits = (has.width, has.height) == (camera.width, camera.height)
        && has.rate_hz >= RATE_SHARE * f64::from(camera.rate_hz);
    if fits {
        return Ok(());
    }
    Err(OpenError::Refused(format!(
        "{} gives {} x {} pixels at {} Hz instead of {} x {} at {} Hz",
        camera.device.display(),
        has.width,
        has.height,
        has.rate_hz,
        camera.width,
        camera.height,
        camera.rate_hz
    )))
}

impl Source for Device {
    fn format(&self) -> PictureFormat {
        self.format
    }

    fn next_picture(&mut self, picture: &mut [u8]) -> Result<Option<u64>, String> {
        if !read_in_place(&mut self.capture, self.format, picture)? {
            return Err("the camera sends no more pictures; is it still plugged in?".into());
        }
        Ok(Some(self.opened.elapsed().as_nanos() as u64))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn gives(width: u32, rate_hz: f64) -> Result<(), OpenError> {
        let camera = Camera { width: 1280, height: 720, rate_hz: 30.0, ..Camera::default() };
        fits(PictureFormat { width, height: 720, rate_hz, count: 0 }, &camera)
    }

    #[test]
    fn a_camera_that_rounds_its_rate_fits_and_one_of_another_size_or_half_the_rate_does_not() {
        assert_eq!(gives(1280, 29.97), Ok(()));
        for refused in [gives(640, 30.0), gives(1280, 15.0)] {
            let error = refused.unwrap_err();
            assert!(matches!(error, OpenError::Refused(_)), "{error:?}");
            assert!(error.to_string().ends_with("instead of 1280 x 720 at 30 Hz"), "{error}");
        }
    }

    #[test]
    fn a_device_that_is_not_there_may_come_back() {
        assert!(matches!(reachable(Path::new("/dev/video-of-nobody")), Err(OpenError::Gone(_))));
    }
}
