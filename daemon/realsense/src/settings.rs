//! What to open, and how.

use std::path::PathBuf;

use crate::frame::PixelFormat;

/// What to open, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The folder that `provision.py` has put librealsense into.
    pub library: PathBuf,
    /// Where the frames come from.
    pub origin: Origin,
    /// Whether depth is captured too.
    pub depth: bool,
}

/// Where the frames come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// A camera that is attached.
    Camera(Camera),
    /// A recording made by the SDK or its viewer.
    Recording(Recording),
}

/// How an attached camera is set.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Which camera, by the serial number on its label; `None` when just one is attached.
    pub serial: Option<String>,
    /// Width and height of the colour picture.
    pub colour_size: [u32; 2],
    /// Bytes of the colour picture. [`PixelFormat::Yuyv`] is what the sensor sends; the SDK computes the others from it.
    pub colour_format: PixelFormat,
    /// Width and height of the depth picture.
    pub depth_size: [u32; 2],
    /// Pictures a second of both.
    pub rate_hz: u32,
    /// Exposure time of the colour sensor in microseconds; `None` leaves it to the camera. Under mains light a multiple
    /// of half its period (10000 at 50 Hz, 8333 at 60 Hz) does not flicker.
    pub exposure_us: Option<u32>,
    /// Exposure time of the stereo pair in microseconds; `None` leaves it to the camera.
    pub depth_exposure_us: Option<u32>,
    /// Power of the pattern projector in milliwatts; 0 switches it off, `None` leaves it at the camera's default.
    pub laser_mw: Option<u32>,
}

impl Default for Camera {
    /// The mode of the paper's camera: a D435i gives colour and depth in it over USB 3.
    fn default() -> Self {
        Self {
            serial: None,
            colour_size: [1280, 720],
            colour_format: PixelFormat::Rgb8,
            depth_size: [1280, 720],
            rate_hz: 30,
            exposure_us: None,
            depth_exposure_us: None,
            laser_mw: None,
        }
    }
}

/// How a recording is played.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// The `.bag` file.
    pub file: PathBuf,
    /// Begin again at the end.
    pub repeat: bool,
    /// How fast.
    pub pace: Pace,
}

/// How fast a recording is played.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// This many times as fast as it was recorded; frames that are not fetched in time are lost.
    Times(f32),
    /// As fast as its frames are fetched; none is lost.
    AsFetched,
}
