//! What can go wrong, each in one sentence that says what to do.

use std::path::PathBuf;

/// Why there are no frames, and what to do about it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// librealsense could not be loaded.
    #[error("cannot load {}: {detail}; run `python3 daemon/realsense/provision.py`, or set the folder that has it", .library.display())]
    Library {
        /// The file that was tried.
        library: PathBuf,
        /// What the loader said.
        detail: String,
    },
    /// Nothing is attached.
    #[error("no RealSense camera is attached; plug it into a USB 3 port (blue, or marked SS)")]
    NoCamera,
    /// A camera is attached that this user may not open.
    #[error(
        "the RealSense camera may not be opened, {} is closed to this user; install 60-andon-realsense.rules in /etc/udev/rules.d, run `udevadm control --reload`, and plug the camera in again",
        .node.display()
    )]
    Permission {
        /// The device file.
        node: PathBuf,
    },
    /// A camera is attached, but the SDK does not see it.
    #[error(
        "a RealSense camera is on the USB bus but does not answer; plug it out and in again, and try another cable if that does not help"
    )]
    Unresponsive,
    /// The link is too slow for the mode.
    #[error(
        "camera {serial} runs over USB {usb}, which is too slow for {mode}; plug it into a USB 3 port (blue, or marked SS) with the cable that came with it"
    )]
    UsbSpeed {
        /// The camera.
        serial: String,
        /// The version of its link.
        usb: String,
        /// What was asked for.
        mode: String,
    },
    /// Not the camera that was asked for.
    #[error(
        "camera {serial} is not attached, only {attached}; correct the serial number, or plug that camera in"
    )]
    SerialNotFound {
        /// Which was asked for.
        serial: String,
        /// Which are there.
        attached: String,
    },
    /// More than one camera and none chosen.
    #[error("several RealSense cameras are attached ({attached}); choose one by its serial number")]
    Ambiguous {
        /// Which are there.
        attached: String,
    },
    /// The camera has no such mode.
    #[error("camera {serial} has no mode {mode}; it has {offered}")]
    Mode {
        /// The camera.
        serial: String,
        /// What was asked for.
        mode: String,
        /// What it has for that stream at that size or rate.
        offered: String,
    },
    /// A value that the camera does not take.
    #[error("camera {serial} does not take {value} for {option}; {allowed}")]
    Option {
        /// The camera.
        serial: String,
        /// The option.
        option: &'static str,
        /// The value.
        value: f32,
        /// What it takes.
        allowed: String,
    },
    /// Another process has the camera.
    #[error(
        "camera {serial} is in use by another program; stop that one (realsense-viewer, another andond) first"
    )]
    Busy {
        /// The camera.
        serial: String,
    },
    /// The camera is there but silent.
    #[error(
        "camera {serial} has sent no picture for {seconds} s and is started again; if this repeats, try another cable and port"
    )]
    Silent {
        /// The camera.
        serial: String,
        /// For how long.
        seconds: u64,
    },
    /// The camera went away.
    #[error("camera {serial} has been unplugged; it is opened again as soon as it is back")]
    Unplugged {
        /// The camera.
        serial: String,
    },
    /// No such file.
    #[error("cannot read the recording {}: {detail}", .file.display())]
    NoRecording {
        /// The file.
        file: PathBuf,
        /// What the system said.
        detail: String,
    },
    /// Not a recording, or one without what is wanted.
    #[error("{} is not a recording with {wanted}: {detail}; record it again with these streams on", .file.display())]
    Recording {
        /// The file.
        file: PathBuf,
        /// Which streams.
        wanted: &'static str,
        /// What the SDK said.
        detail: String,
    },
    /// A picture in a format that is not understood.
    #[error("the colour stream has the format {format}; choose rgb8, bgr8 or yuyv")]
    Format {
        /// The SDK's name of it.
        format: String,
    },
    /// The memory for a frame is too small.
    #[error(
        "a frame of {needed} bytes does not fit into {given} bytes; lower the resolution or enlarge the channel"
    )]
    Room {
        /// Bytes of the frame.
        needed: usize,
        /// Bytes of the memory.
        given: usize,
    },
    /// The SDK failed in a way that has no remedy of its own.
    #[error("librealsense failed at {step}: {detail}; if it repeats, plug the camera out and in again")]
    Sdk {
        /// What was being done.
        step: &'static str,
        /// What it said.
        detail: String,
    },
}
