//! The SDK's player of a file, which `realsense-rust` does not provide.

use std::ffi::{CStr, CString, c_int, c_void};
use std::mem;
use std::os::unix::ffi::OsStrExt as _;
use std::path::Path;
use std::ptr::{self, NonNull};
use std::sync::mpsc::SyncSender;

use realsense_rust::frame::{DepthFrame, FrameEx, ImageFrame};
use realsense_sys::{
    RS2_API_VERSION, rs2_context_add_device, rs2_create_context, rs2_create_sensor, rs2_delete_context,
    rs2_delete_device, rs2_delete_sensor, rs2_delete_sensor_list, rs2_delete_stream_profiles_list,
    rs2_depth_frame_get_units, rs2_device, rs2_error, rs2_frame, rs2_free_error, rs2_get_error_message,
    rs2_get_sensors_count, rs2_get_stream_profile, rs2_get_stream_profiles, rs2_get_stream_profiles_count,
    rs2_open_multiple, rs2_query_sensors, rs2_release_frame, rs2_sensor, rs2_start, rs2_stop,
    rs2_stream_profile,
};

use super::library::Api;

/// What a player is doing, as the `rs2_playback_status` of rs_record_playback.h.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Status {
    Playing,
    Paused,
    /// Every frame has been sent.
    Stopped,
}

/// The player of a file.
#[derive(Debug)]
pub(super) struct Player {
    api: Api,
    device: NonNull<rs2_device>,
}

// SAFETY: the SDK counts the references to a device atomically. The functions below either hand a request to the player's own thread or read and
// write its atomic fields.
unsafe impl Send for Player {}
// SAFETY: as above.
unsafe impl Sync for Player {}

impl Player {
    /// Sends a frame when the one before has been taken, as fast as they are taken: none is lost.
    pub(super) fn open(api: Api, file: &Path) -> Result<Self, String> {
        let file = CString::new(file.as_os_str().as_bytes()).map_err(|error| error.to_string())?;
        // SAFETY: the context is ours and deleted once; the player that was made in it keeps what it needs of it.
        let device = unsafe {
            let context = checked(|error| rs2_create_context(RS2_API_VERSION as c_int, error))?;
            let device = checked(|error| rs2_context_add_device(context, file.as_ptr(), error));
            rs2_delete_context(context);
            device?
        };
        let device = NonNull::new(device).ok_or("it has no player")?;
        let player = Self { api, device };
        // SAFETY: the device is a player and lives as long as `player`.
        unsafe { checked(|error| (api.set_real_time)(device.as_ptr(), 0, error))? };
        Ok(player)
    }

    /// The sensors that were recorded.
    pub(super) fn sensors(&self) -> Result<Vec<Sensor>, String> {
        // SAFETY: the list is ours and deleted once; each sensor holds the device that it belongs to.
        unsafe {
            let list = checked(|error| rs2_query_sensors(self.device.as_ptr(), error))?;
            let sensor = |index| {
                let sensor = checked(|error| rs2_create_sensor(list, index, error))?;
                NonNull::new(sensor).map(Sensor).ok_or_else(|| "a sensor is missing".to_owned())
            };
            let sensors = checked(|error| rs2_get_sensors_count(list, error))
                .and_then(|count| (0..count).map(sensor).collect());
            rs2_delete_sensor_list(list);
            sensors
        }
    }

    /// Lets no frame pass, and returns when all that was asked of the player before has been done.
    pub(super) fn pause(&self) -> Result<(), String> {
        // SAFETY: as in `open`.
        unsafe { checked(|error| (self.api.pause)(self.device.as_ptr(), error)) }
    }

    /// Plays from the first frame on, or from where it was paused. Returns when the player has got round to it, which may be after several frames.
    pub(super) fn resume(&self) -> Result<(), String> {
        // SAFETY: as in `open`.
        unsafe { checked(|error| (self.api.resume)(self.device.as_ptr(), error)) }
    }

    pub(super) fn status(&self) -> Result<Status, String> {
        // SAFETY: as in `open`.
        let status = unsafe { checked(|error| (self.api.status)(self.device.as_ptr(), error))? };
        Ok(match status {
            2 => Status::Paused,
            3 => Status::Stopped,
            _ => Status::Playing,
        })
    }
}

impl Drop for Player {
    fn drop(&mut self) {
        // SAFETY: made by `rs2_context_add_device` and deleted here alone.
        unsafe { rs2_delete_device(self.device.as_ptr()) }
    }
}

/// A sensor of a recording.
#[derive(Debug)]
pub(super) struct Sensor(NonNull<rs2_sensor>);

impl Sensor {
    /// Its recorded streams, which live as long as the sensor.
    pub(super) fn streams(&self) -> Result<Vec<NonNull<rs2_stream_profile>>, String> {
        // SAFETY: the list is ours and deleted once; what it lists belongs to the sensor.
        unsafe {
            let list = checked(|error| rs2_get_stream_profiles(self.0.as_ptr(), error))?;
            let stream = |index| {
                let stream = checked(|error| rs2_get_stream_profile(list, index, error))?;
                NonNull::new(stream.cast_mut()).ok_or_else(|| "a stream is missing".to_owned())
            };
            let streams = checked(|error| rs2_get_stream_profiles_count(list, error))
                .and_then(|count| (0..count).map(stream).collect());
            rs2_delete_stream_profiles_list(list);
            streams
        }
    }

    /// Chooses the streams that it will send.
    pub(super) fn open(&self, streams: Vec<NonNull<rs2_stream_profile>>) -> Result<(), String> {
        let mut streams: Vec<_> = streams.into_iter().map(|stream| stream.as_ptr().cast_const()).collect();
        // A sensor has a handful of streams.
        let count = streams.len() as c_int;
        // SAFETY: `streams` has `count` streams, and the SDK keeps no pointer to it.
        unsafe { checked(|error| rs2_open_multiple(self.0.as_ptr(), streams.as_mut_ptr(), count, error)) }
    }

    /// Sends every frame to the channel, and waits while that is full.
    ///
    /// # Safety
    /// The channel must stay where it is until the sensor has been stopped.
    pub(super) unsafe fn start(&self, channel: &SyncSender<RawFrame>) -> Result<(), String> {
        let channel = ptr::from_ref(channel).cast_mut().cast::<c_void>();
        // SAFETY: `send` takes what is given here as its second argument, and by the caller it lives until the last call.
        unsafe { checked(|error| rs2_start(self.0.as_ptr(), Some(send), channel, error)) }
    }

    /// Returns when no frame is being sent any more. A frame that waits for room in the channel must have been released from it.
    pub(super) fn stop(&self) {
        // SAFETY: the sensor is ours. Stopping one that has already been stopped does nothing.
        let stopped = unsafe { checked(|error| rs2_stop(self.0.as_ptr(), error)) };
        // It fails only for a null pointer.
        drop(stopped);
    }
}

impl Drop for Sensor {
    fn drop(&mut self) {
        // SAFETY: made by `rs2_create_sensor` and deleted here alone.
        unsafe { rs2_delete_sensor(self.0.as_ptr()) }
    }
}

/// Takes a frame from the SDK. When nobody receives any more, the frame is released.
unsafe extern "C" fn send(frame: *mut rs2_frame, channel: *mut c_void) {
    // SAFETY: `Sensor::start` gives this channel, which lives until the sensor is stopped.
    let channel = unsafe { &*channel.cast::<SyncSender<RawFrame>>() };
    if let Some(frame) = NonNull::new(frame) {
        drop(channel.send(RawFrame(frame)));
    }
}

/// A frame of the SDK that is ours to release.
#[derive(Debug)]
pub(super) struct RawFrame(NonNull<rs2_frame>);

// SAFETY: the SDK counts the references to a frame atomically, and this one is used by one thread at a time.
unsafe impl Send for RawFrame {}

impl RawFrame {
    pub(super) fn of<K>(image: ImageFrame<K>) -> Self
    where
        ImageFrame<K>: FrameEx,
    {
        // SAFETY: what the picture owned is ours now.
        Self(unsafe { image.get_owned_raw() })
    }

    /// Its picture. `K` must be of the kind of the frame before its pixels are used.
    pub(super) fn into_image<K>(self) -> Result<ImageFrame<K>, String> {
        let image = ImageFrame::try_from(self.0).map_err(|error| error.to_string())?;
        // The picture releases it.
        mem::forget(self);
        Ok(image)
    }
}

/// A depth picture and the metres of one of its steps. `realsense-rust` would keep a sensor, and with it the device, for good at every question.
pub(super) fn with_unit(depth: DepthFrame) -> Result<(DepthFrame, f32), String> {
    let raw = RawFrame::of(depth);
    // SAFETY: the frame is ours and a depth frame.
    let unit_m = unsafe { checked(|error| rs2_depth_frame_get_units(raw.0.as_ptr(), error))? };
    Ok((raw.into_image()?, unit_m))
}

impl Drop for RawFrame {
    fn drop(&mut self) {
        // SAFETY: given by the SDK and released here alone.
        unsafe { rs2_release_frame(self.0.as_ptr()) }
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
        let message = CStr::from_ptr(rs2_get_error_message(error)).to_string_lossy().into_owned();
        rs2_free_error(error);
        Err(message)
    }
}
