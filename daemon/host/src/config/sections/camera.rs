//! The section `[camera]`.

use crate::config::keys::Keys;
use crate::config::value::{Text, within, words};
use std::path::PathBuf;

/// Where the frames come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A video file.
    Video,
    /// A folder of pictures, in the order and at the times of the numbers in their names.
    Images,
    /// A V4L2 device.
    V4l2,
    /// A track file: an outside tracker's hands and objects, no pictures.
    Tracks,
    /// A RealSense camera.
    Realsense,
    /// A RealSense recording.
    Bag,
}
words!(Source {
    Source::Video = "video",
    Source::Images = "images",
    Source::V4l2 = "v4l2",
    Source::Tracks = "tracks",
    Source::Realsense = "realsense",
    Source::Bag = "bag",
});

impl Source {
    /// Whether the source is a device, which sets its own pace, and not a recording.
    #[must_use]
    pub fn is_live(self) -> bool {
        matches!(self, Self::V4l2 | Self::Realsense)
    }
}

/// The pace of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Speed {
    /// The recording's own.
    File,
    /// As fast as the readers can, with nothing dropped.
    Max,
}
words!(Speed { Speed::File = "file", Speed::Max = "max" });

/// How a V4L2 device sends its pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// The first of the others that has the configured size and rate.
    Auto,
    /// Brightness of every pixel, colour of every second one.
    Yuyv,
    /// Brightness of every pixel, colour of every fourth one.
    Nv12,
    /// A JPEG for every picture.
    Mjpeg,
}
words!(Encoding {
    Encoding::Auto = "auto",
    Encoding::Yuyv = "yuyv",
    Encoding::Nv12 = "nv12",
    Encoding::Mjpeg = "mjpeg",
});

/// `[camera]`: where the frames come from.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The kind of source.
    pub source: Source,
    /// The recording, for every source that is not live.
    pub path: Option<PathBuf>,
    /// The V4L2 device.
    pub device: PathBuf,
    /// How it sends its pictures.
    pub encoding: Encoding,
    /// Width of a live picture, pixels.
    pub width: u32,
    /// Height of a live picture, pixels.
    pub height: u32,
    /// Rate of a live camera or of an image folder, Hz.
    pub rate_hz: f32,
    /// Pace of a recording.
    pub speed: Speed,
    /// Whether a recording starts again at its end.
    pub repeat: bool,
    /// Serial number of the RealSense camera; the only one that is attached where it is `None`.
    pub serial: Option<String>,
    /// Fixed exposure of a live camera, µs; automatic where it is `None`.
    pub exposure_us: Option<u32>,
    /// Power of the RealSense projector, mW.
    pub laser_power_mw: u32,
    /// Whether depth is captured, RealSense only.
    pub depth: bool,
    /// Width of the depth picture, pixels; that of the colour picture where it is `None`.
    pub depth_width: Option<u32>,
    /// Height of the depth picture, pixels; that of the colour picture where it is `None`.
    pub depth_height: Option<u32>,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            source: Source::V4l2,
            path: None,
            device: "/dev/video0".into(),
            encoding: Encoding::Auto,
            width: 1280,
            height: 720,
            rate_hz: 30.0,
            speed: Speed::File,
            repeat: false,
            serial: None,
            exposure_us: None,
            // The D435i's own default.
            laser_power_mw: 150,
            depth: true,
            depth_width: None,
            depth_height: None,
        }
    }
}

impl Camera {
    pub(in crate::config) fn keys(&mut self, k: &mut impl Keys) {
        k.key(
            "source",
            &mut self.source,
            (),
            "Where the frames come from: a video file, a folder of pictures, a V4L2 device, or a track file of an outside tracker. It may also be a RealSense camera, or a RealSense recording (bag).",
        );
        k.optional(
            "path",
            &mut self.path,
            (),
            r#""recording.mp4""#,
            "The recording: a file for video, tracks and bag, a folder for images. These sources need it.",
        );
        k.key("device", &mut self.device, (), "The V4L2 device.");
        k.key(
            "encoding",
            &mut self.encoding,
            (),
            "How the V4L2 device sends its pictures. As they are (yuyv, nv12), they take least work but fill a USB 2 cable at 640 x 480. As JPEG (mjpeg) they take less of the cable. With auto it is the first of these in which it has the configured size and rate.",
        );
        k.key(
            "width",
            &mut self.width,
            within(64, 4096, "pixels"),
            "Width of the picture that a live camera is asked for; a recording has its own.",
        );
        k.key(
            "height",
            &mut self.height,
            within(64, 4096, "pixels"),
            "Height of the picture that a live camera is asked for; a recording has its own.",
        );
        k.key(
            "rate_hz",
            &mut self.rate_hz,
            within(1.0, 240.0, "Hz"),
            "Frames per second: the rate that a live camera is asked for, and the pace of a folder of pictures.",
        );
        k.key(
            "speed",
            &mut self.speed,
            (),
            "Pace of a recording: its own (file), or as fast as the readers can, with nothing dropped (max).",
        );
        k.key("loop", &mut self.repeat, (), "Whether a recording starts again at its end.");
        k.optional(
            "serial",
            &mut self.serial,
            Text::Name,
            r#""035422071234""#,
            "Serial number of the RealSense camera. Without it only one may be attached.",
        );
        k.optional(
            "exposure_us",
            &mut self.exposure_us,
            within(1, 165_000, "µs"),
            "10000",
            "Fixed exposure of a live camera: a multiple of 10000 does not flicker under 50 Hz light. Without it the \
             camera chooses.",
        );
        k.key(
            "laser_power_mw",
            &mut self.laser_power_mw,
            within(0, 360, "mW"),
            "Power of the RealSense projector; 0 turns it off.",
        );
        k.key(
            "depth",
            &mut self.depth,
            (),
            "Whether depth is taken from a RealSense camera or recording. Then a colour picture without depth of the same moment \
             is left out, and counts as lost.",
        );
        k.optional(
            "depth_width",
            &mut self.depth_width,
            within(64, 4096, "pixels"),
            "848",
            "Width of the depth picture that a RealSense camera is asked for. Without it depth is as wide as the colour \
             picture, which is possible up to 1280 x 720.",
        );
        k.optional(
            "depth_height",
            &mut self.depth_height,
            within(64, 4096, "pixels"),
            "480",
            "Height of the depth picture that a RealSense camera is asked for. Without it depth is as high as the colour \
             picture.",
        );
    }
}
