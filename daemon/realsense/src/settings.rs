//! What to open, and how.

use std::path::PathBuf;

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
    /// A `.bag` file that the SDK or its viewer has recorded. It is played once, as fast as its frames are fetched, so that none
    /// is lost.
    Recording(PathBuf),
}

/// How an attached camera is set. The SDK converts the colour picture to RGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Which camera, by the serial number on its label; `None` when just one is attached.
    pub serial: Option<String>,
    /// Width and height of the colour picture.
    pub colour_size: [u32; 2],
    /// Width and height of the depth picture.
    pub depth_size: [u32; 2],
    /// Pictures per second of both.
    pub rate_hz: u32,
    /// Exposure time of the colour sensor in microseconds; `None` leaves it to the camera. Under mains light a multiple
    /// of half its period (10000 at 50 Hz, 8333 at 60 Hz) does not flicker.
    pub exposure_us: Option<u32>,
    /// Power of the pattern projector in milliwatts; 0 switches it off.
    pub laser_mw: u32,
}
