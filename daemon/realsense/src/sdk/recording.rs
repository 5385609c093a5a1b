//! Opens a `.bag` recording.

use std::fs::File;
use std::path::Path;
use std::ptr::{self, NonNull};
use std::time::Duration;

use realsense_rust::config::Config;
use realsense_rust::context::Context;
use realsense_rust::frame::{ColorFrame, CompositeFrame, FrameEx};
use realsense_rust::kind::{Rs2Format, Rs2StreamKind};
use realsense_rust::pipeline::InactivePipeline;
use realsense_sys::{
    rs2_create_device_from_sensor, rs2_delete_device, rs2_device, rs2_error, rs2_free_error,
    rs2_get_error_message, rs2_get_frame_sensor, rs2_release_frame,
};

use super::library::Api;
use super::picture::Optics;
use super::{Kind, Source};
use crate::Error;
use crate::clock::RecordingClock;

/// The first frame of a recording comes when its index has been read, which took 0.2 s for an hour.
const FIRST_FRAME: Duration = Duration::from_secs(5);

/// `RS2_PLAYBACK_STATUS_STOPPED` of rs_record_playback.h.
const STOPPED: i32 = 3;

pub(super) fn open(api: Api, context: Context, file: &Path, depth: bool) -> Result<Source, Error> {
    // The SDK notices a missing file late and reports it in terms of its own.
    File::open(file).map_err(|error| Error::NoRecording { file: file.into(), detail: error.to_string() })?;
    let bad = |detail: String| Error::Recording {
        file: file.into(),
        wanted: if depth { "colour and depth" } else { "colour" },
        detail,
    };
    let mut config = Config::new();
    config.enable_device_from_file(file, false).map_err(|error| bad(error.to_string()))?;
    config.disable_all_streams().map_err(|error| bad(error.to_string()))?;
    let streams = [Rs2StreamKind::Color, Rs2StreamKind::Depth];
    for stream in &streams[..=usize::from(depth)] {
        let any = Rs2Format::Any;
        config.enable_stream(*stream, None, 0, 0, any, 0).map_err(|error| bad(error.to_string()))?;
    }
    let pipeline =
        InactivePipeline::try_from(&context).map_err(|error| super::sdk("opening the recording", error))?;
    let mut pipeline = pipeline.start(Some(config)).map_err(|error| bad(error.to_string()))?;
    let optics = Optics::read(pipeline.profile())?;
    let first = pipeline.wait(Some(FIRST_FRAME)).map_err(|error| bad(error.to_string()))?;
    let playback = Playback::of(api, &first).map_err(bad)?;
    playback.send_as_fetched().map_err(bad)?;
    Ok(Source {
        pipeline,
        depth,
        optics,
        kind: Kind::Recording { playback, clock: RecordingClock::default() },
        fetched: Some(first),
        last_number: None,
        _context: context,
    })
}

/// The SDK's player of the file, which `realsense-rust` does not provide.
#[derive(Debug)]
pub(super) struct Playback {
    api: Api,
    device: NonNull<rs2_device>,
}

impl Playback {
    /// The player that a frameset came from, which is the only access to it that `realsense-rust` leaves.
    fn of(api: Api, frameset: &CompositeFrame) -> Result<Self, String> {
        let colour = frameset.frames_of_type::<ColorFrame>().pop().ok_or("its first frame has no colour")?;
        // SAFETY: `raw` is a frame that we own and release below; `sensor` belongs to it. Both calls report errors through `error`, which
        // `checked` reads before the result is used.
        unsafe {
            let raw = colour.get_owned_raw();
            let device = checked(|error| rs2_get_frame_sensor(raw.as_ptr(), error))
                .and_then(|sensor| checked(|error| rs2_create_device_from_sensor(sensor, error)));
            rs2_release_frame(raw.as_ptr());
            let device = NonNull::new(device?).ok_or("it has no player")?;
            Ok(Self { api, device })
        }
    }

    /// Sends the next frame when the one before has been fetched, so that none is lost.
    fn send_as_fetched(&self) -> Result<(), String> {
        // SAFETY: the device is a player and lives as long as self.
        unsafe { checked(|error| (self.api.set_real_time)(self.device.as_ptr(), 0, error)) }
    }

    /// Whether the last frame has been played. At the end the SDK just stops sending.
    pub(super) fn has_ended(&self) -> bool {
        // SAFETY: as in `send_as_fetched`.
        let status = unsafe { checked(|error| (self.api.status)(self.device.as_ptr(), error)) };
        status.is_ok_and(|status| status == STOPPED)
    }
}

impl Drop for Playback {
    fn drop(&mut self) {
        // SAFETY: made by `rs2_create_device_from_sensor` and deleted here alone.
        unsafe { rs2_delete_device(self.device.as_ptr()) }
    }
}

/// Calls a function of the SDK and gives its error as text.
///
/// # Safety
/// `call` must be sound for the pointer it is given, as every function of the SDK is.
unsafe fn checked<T>(call: impl FnOnce(*mut *mut rs2_error) -> T) -> Result<T, String> {
    let mut error = ptr::null_mut();
    let result = call(&raw mut error);
    if error.is_null() {
        return Ok(result);
    }
    // SAFETY: the SDK has set `error` to an object of its own, whose message is a C string until it is freed.
    unsafe {
        let message = std::ffi::CStr::from_ptr(rs2_get_error_message(error)).to_string_lossy().into_owned();
        rs2_free_error(error);
        Err(message)
    }
}
