//! librealsense, loaded when the first source is opened.
//!
//! The trampolines that `build.rs` wrote have the names that `realsense-sys` declares and jump through [`SLOTS`]. They must not be called before
//! [`load`] has succeeded. Everything in this folder that calls the SDK is built from an [`Api`], and only `load` gives one.

use std::ffi::c_int;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use libloading::os::unix::{Library, RTLD_GLOBAL, RTLD_LOCAL, RTLD_NOW};
use realsense_sys::{rs2_device, rs2_error};

use crate::Error;

include!(concat!(env!("OUT_DIR"), "/trampolines.rs"));

/// Where each trampoline jumps to.
// SAFETY: the name is this crate's own, and only the trampolines refer to it.
#[unsafe(export_name = "andon_rs2_slots")]
static SLOTS: [AtomicUsize; NAMES.len()] = [const { AtomicUsize::new(0) }; NAMES.len()];

/// The file that `provision.py` makes of the Python package.
const LIBRARY: &str = "librealsense2.so.2.56";

/// Replaces the Python interpreter for a library that was built for one; other builds come without it.
const STUB: &str = "libpystub.so";

/// Proof that the library has been loaded. Holds its functions for recordings, which `realsense-sys` does not declare.
#[derive(Clone, Copy, Debug)]
pub(super) struct Api {
    /// `rs2_playback_device_set_real_time`.
    pub(super) set_real_time: unsafe extern "C" fn(*const rs2_device, c_int, *mut *mut rs2_error),
    /// `rs2_playback_device_pause`.
    pub(super) pause: unsafe extern "C" fn(*const rs2_device, *mut *mut rs2_error),
    /// `rs2_playback_device_resume`.
    pub(super) resume: unsafe extern "C" fn(*const rs2_device, *mut *mut rs2_error),
    /// `rs2_playback_device_get_current_status`.
    pub(super) status: unsafe extern "C" fn(*const rs2_device, *mut *mut rs2_error) -> c_int,
}

/// Loads the library once per process: a second call returns the same library, whatever its folder.
pub(super) fn load(folder: &Path) -> Result<Api, Error> {
    static LOADED: Mutex<Option<Api>> = Mutex::new(None);
    let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(api) = *loaded {
        return Ok(api);
    }
    let path = folder.join(LIBRARY);
    let failed = |detail: String| Error::Library { library: path.clone(), detail };
    let stub = folder.join(STUB);
    if stub.exists() {
        // SAFETY: the stub has data symbols only and runs nothing when it is loaded.
        let stub = unsafe { Library::open(Some(&stub), RTLD_NOW | RTLD_GLOBAL) };
        // It stays loaded until the end of the process, as does the library that refers to it.
        std::mem::forget(stub.map_err(|error| failed(error.to_string()))?);
    }
    // SAFETY: the constructors of librealsense only set up its own global state.
    let library = unsafe { Library::open(Some(&path), RTLD_NOW | RTLD_LOCAL) };
    let library = library.map_err(|error| failed(error.to_string()))?;
    for (slot, name) in SLOTS.iter().zip(NAMES) {
        // SAFETY: only the address is taken here; realsense-sys declares the type that it is called with.
        let function = unsafe { symbol::<*const ()>(&library, name) }.map_err(failed)?;
        slot.store(function as usize, Ordering::Release);
    }
    // SAFETY: the types are those of librealsense2/h/rs_record_playback.h of 2.56.
    let api = unsafe {
        Api {
            set_real_time: symbol(&library, "rs2_playback_device_set_real_time").map_err(failed)?,
            pause: symbol(&library, "rs2_playback_device_pause").map_err(failed)?,
            resume: symbol(&library, "rs2_playback_device_resume").map_err(failed)?,
            status: symbol(&library, "rs2_playback_device_get_current_status").map_err(failed)?,
        }
    };
    // Its threads and the slots need it until the end of the process.
    std::mem::forget(library);
    *loaded = Some(api);
    Ok(api)
}

/// A function of the library.
///
/// # Safety
/// `T` must be the type of the function's address.
unsafe fn symbol<T: Copy>(library: &Library, name: &str) -> Result<T, String> {
    // SAFETY: by the caller.
    unsafe { library.get::<T>(name.as_bytes()) }
        .map(|found| *found)
        .map_err(|_| format!("it has no {name}, so its version is not 2.56"))
}
