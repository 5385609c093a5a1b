//! Opening a `.bag` recording.

use std::fs::File;
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
use super::{Kind, Open};
use crate::Error;
use crate::clock::RecordingClock;
use crate::settings::{Pace, Recording};

/// The first frame of a recording is due after its index has been read, 0.2 s here for an hour.
const FIRST_FRAME: Duration = Duration::from_secs(5);

/// `RS2_PLAYBACK_STATUS_STOPPED` of rs_record_playback.h.
const STOPPED: i32 = 3;

pub(super) fn open(api: Api, context: &Context, wanted: &Recording, depth: bool) -> Result<Open, Error> {
    // The SDK notices a missing file late and says so in terms of its own.
    File::open(&wanted.file)
        .map_err(|error| Error::NoRecording { file: wanted.file.clone(), detail: error.to_string() })?;
    let bad = |detail: String| Error::Recording {
        file: wanted.file.clone(),
        wanted: if depth { "colour and depth" } else { "colour" },
        detail,
    };
    let mut config = Config::new();
    config.enable_device_from_file(&wanted.file, wanted.repeat).map_err(|error| bad(error.to_string()))?;
    config.disable_all_streams().map_err(|error| bad(error.to_string()))?;
    let streams = [Rs2StreamKind::Color, Rs2StreamKind::Depth];
    for stream in &streams[..=usize::from(depth)] {
        let any = Rs2Format::Any;
        config.enable_stream(*stream, None, 0, 0, any, 0).map_err(|error| bad(error.to_string()))?;
    }
    let pipeline =
        InactivePipeline::try_from(context).map_err(|error| super::sdk("opening the recording", error))?;
    let mut pipeline = pipeline.start(Some(config)).map_err(|error| bad(error.to_string()))?;
    let optics = Optics::read(pipeline.profile())?;
    let first = pipeline.wait(Some(FIRST_FRAME)).map_err(|error| bad(error.to_string()))?;
    let playback = Playback::of(api, &first).map_err(bad)?;
    playback.set_pace(wanted.pace).map_err(bad)?;
    let name = wanted.file.display().to_string();
    Ok(Open {
        pipeline,
        serial: name.clone(),
        name,
        depth,
        optics,
        kind: Kind::Recording(RecordingClock::default(), playback),
        fetched: [first].into(),
        last_number: None,
    })
}

/// The SDK's control of the file that is being played; `realsense-rust` has no such thing.
#[derive(Debug)]
pub(super) struct Playback {
    api: Api,
    device: NonNull<rs2_device>,
}

// SAFETY: the SDK's devices may be used from any thread.
unsafe impl Send for Playback {}

impl Playback {
    /// The player that a frameset came from: the only way to it that `realsense-rust` leaves open.
    fn of(api: Api, frameset: &CompositeFrame) -> Result<Self, String> {
        let colour = frameset.frames_of_type::<ColorFrame>().pop().ok_or("its first frame has no colour")?;
        // SAFETY: `raw` is a frame that we own now, and release below; `sensor` belongs to it. Both calls report
        // through `error`, which `checked` looks at before the result is used.
        unsafe {
            let raw = colour.get_owned_raw();
            let device = checked(|error| rs2_get_frame_sensor(raw.as_ptr(), error))
                .and_then(|sensor| checked(|error| rs2_create_device_from_sensor(sensor, error)));
            rs2_release_frame(raw.as_ptr());
            let device = NonNull::new(device?).ok_or("it has no player")?;
            Ok(Self { api, device })
        }
    }

    fn set_pace(&self, pace: Pace) -> Result<(), String> {
        let device = self.device.as_ptr();
        match pace {
            // SAFETY: the device is a player and lives as long as self.
            Pace::AsFetched => unsafe { checked(|error| (self.api.set_real_time)(device, 0, error)) },
            // SAFETY: as above.
            Pace::Times(speed) => unsafe { checked(|error| (self.api.set_speed)(device, speed, error)) },
        }
    }

    /// Whether the last frame has been played. The SDK itself only stops sending.
    pub(super) fn has_ended(&self) -> bool {
        // SAFETY: as in `set_pace`.
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
