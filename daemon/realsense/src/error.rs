//! What can go wrong, each with one sentence that says what to do.

use std::path::PathBuf;

/// Why no frames come, and what to do about it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// librealsense could not be loaded.
    #[error("cannot load {}: {detail}; run `python3 daemon/realsense/provision.py`, or set the folder that has it", .library.display())]
    Library {
        /// The file that was tried.
        library: PathBuf,
        /// The cause that the loader gives.
        detail: String,
    },
    /// Nothing is attached.
    #[error("no RealSense camera is attached; plug it into a USB 3 port (blue, or marked SS)")]
    NoCamera,
    /// This user may not open the attached camera.
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
        "a RealSense camera is on the USB bus but does not answer; unplug it and plug it in again, or try another cable"
    )]
    Unresponsive,
    /// The link is too slow for the mode.
    #[error(
        "camera {serial} runs over USB {usb}, which is too slow for {mode}; use a USB 3 port (blue, or marked SS) and its own cable"
    )]
    UsbSpeed {
        /// The camera.
        serial: String,
        /// The version of USB that its link has.
        usb: String,
        /// The requested mode.
        mode: String,
    },
    /// The requested camera is not attached.
    #[error(
        "camera {serial} is not attached, only {attached}; correct the serial number, or plug that camera in"
    )]
    SerialNotFound {
        /// The requested serial number.
        serial: String,
        /// The serial numbers of the attached cameras.
        attached: String,
    },
    /// More than one camera is attached and none has been chosen.
    #[error("several RealSense cameras are attached ({attached}); choose one by its serial number")]
    Ambiguous {
        /// The serial numbers of the attached cameras.
        attached: String,
    },
    /// The camera does not offer the mode.
    #[error("camera {serial} has no mode {mode}; it has {offered}")]
    Mode {
        /// The camera.
        serial: String,
        /// The requested mode.
        mode: String,
        /// The modes that it offers for this stream.
        offered: String,
    },
    /// The camera does not accept a value.
    #[error("camera {serial} does not accept {value} for {option}; {allowed}")]
    Option {
        /// The camera.
        serial: String,
        /// The option.
        option: &'static str,
        /// The value.
        value: f32,
        /// What it accepts.
        allowed: String,
    },
    /// Another process is using the camera.
    #[error(
        "camera {serial} is in use by another program; stop that one (realsense-viewer, another andond) first"
    )]
    Busy {
        /// The camera.
        serial: String,
    },
    /// The camera is attached but sends nothing, or no depth with its colour pictures.
    #[error(
        "camera {serial} has sent no whole frame for 2 s and is started again; if this repeats, try another cable and port"
    )]
    Silent {
        /// The camera.
        serial: String,
    },
    /// The camera went away.
    #[error("camera {serial} has been unplugged; it is opened again as soon as it is back")]
    Unplugged {
        /// The camera.
        serial: String,
    },
    /// The recording cannot be read.
    #[error("cannot read the recording {}: {detail}", .file.display())]
    NoRecording {
        /// The file.
        file: PathBuf,
        /// The cause that the system gives.
        detail: String,
    },
    /// The file is no recording, or lacks a stream.
    #[error("{} is not a recording with {wanted}: {detail}; record it again with these streams", .file.display())]
    Recording {
        /// The file.
        file: PathBuf,
        /// The streams that are needed.
        wanted: &'static str,
        /// The cause that the SDK gives.
        detail: String,
    },
    /// The format of the colour pictures is not supported.
    #[error("the colour stream has the format {format}; choose rgb8, bgr8 or yuyv")]
    Format {
        /// The name that the SDK gives it.
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
    /// The SDK failed for a reason without a remedy of its own.
    #[error(
        "librealsense failed at {step}: {detail}; if this repeats, unplug the camera and plug it in again"
    )]
    Sdk {
        /// What was being done.
        step: &'static str,
        /// The cause that it gives.
        detail: String,
    },
}

#[cfg(feature = "realsense")]
impl Error {
    /// What speaks against playing a file with the streams that are wanted.
    pub(crate) fn recording(file: &std::path::Path, wants_depth: bool, detail: String) -> Self {
        let wanted = if wants_depth { "colour and depth" } else { "colour" };
        Self::Recording { file: file.into(), wanted, detail }
    }
}
