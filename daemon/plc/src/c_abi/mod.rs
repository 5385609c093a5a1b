//! `libandon_plc`: the verdict channel for a soft PLC in C or C++ on the same machine. The header is `include/andon.h`.
//!
//! The only unsafe code of this crate. Every function checks its pointers for null, lets no panic out, and returns an
//! [`AndonResult`]. A verdict is read when it is sent, before the journal has it on disk. A program that must not act before
//! that reads the registers over Modbus.
#![allow(unsafe_code)]

mod line;
mod reader;
mod types;

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

pub use reader::AndonReader;
pub use types::{
    ANDON_NO_INDEX, ANDON_PART_BYTES, ANDON_STATION_BYTES, AndonResult, AndonStatus, AndonVerdict,
    VERDICT_SOURCE,
};

use reader::{Next, code};

thread_local! {
    static LAST_ERROR: RefCell<CString> = RefCell::default();
}

/// Runs `call`. A fault or a panic becomes a number, and its text is kept for [`andon_last_error`].
fn guarded(call: impl FnOnce() -> Result<AndonResult, (AndonResult, String)>) -> AndonResult {
    let fault = match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(result)) => return result,
        Ok(Err(fault)) => fault,
        Err(_) => (AndonResult::Internal, "a fault in libandon_plc: close this reader and report it".into()),
    };
    // A text that contains a zero would be dropped; ours contain none.
    let text = CString::new(fault.1).unwrap_or_default();
    // This fails only while the thread ends, when nobody can ask for the text any more.
    let _ = LAST_ERROR.try_with(|last| *last.borrow_mut() = text);
    fault.0
}

fn argument(what: &str) -> (AndonResult, String) {
    (AndonResult::Argument, format!("{what} is null or not UTF-8"))
}

fn transport(error: &andon_ipc::Error) -> (AndonResult, String) {
    (code(error), error.to_string())
}

/// # Safety
/// `text` is null or points to a zero-terminated string that lives as long as `'a`.
unsafe fn text<'a>(text: *const c_char) -> Option<&'a str> {
    if text.is_null() {
        return None;
    }
    // SAFETY: not null, and the caller promises the rest.
    unsafe { CStr::from_ptr(text) }.to_str().ok()
}

/// Opens the verdict channel of `station`. `root` is the station's directory, null for `/run/andon/STATION`. Waits for at most
/// `timeout_ms` for a station that is still starting. Returns ANDON_RESULT_NOTHING and writes the reader to `*out`, or returns a
/// fault and writes null.
///
/// A reader may be handed from one thread to another, as from the one that starts a program to its cyclic task. It is called by one
/// thread at a time: the caller lets one call return before the next begins. The newest 256 verdicts come first, as they were sent
/// before.
///
/// # Safety
/// `root` (or null) and `station` are zero-terminated; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn andon_open(
    root: *const c_char,
    station: *const c_char,
    timeout_ms: u32,
    out: *mut *mut AndonReader,
) -> AndonResult {
    guarded(|| {
        if out.is_null() {
            return Err(argument("out"));
        }
        // SAFETY: not null, and the caller promises that it can be written.
        unsafe { out.write(std::ptr::null_mut()) };
        // SAFETY: the caller promises zero-terminated strings, and they are not kept.
        let (root_text, station) = unsafe { (text(root), text(station)) };
        if root_text.is_none() && !root.is_null() {
            return Err(argument("root"));
        }
        let station = station.ok_or_else(|| argument("station"))?;
        let patience = Duration::from_millis(timeout_ms.into());
        let reader = AndonReader::open(root_text, station, patience).map_err(|e| transport(&e))?;
        // SAFETY: as above. The box is given back in `andon_close`.
        unsafe { out.write(Box::into_raw(Box::new(reader))) };
        Ok(AndonResult::Nothing)
    })
}

/// Writes the next verdict to `*out` and returns ANDON_RESULT_VERDICT. When none is there, waits for at most `timeout_us` and returns
/// ANDON_RESULT_NOTHING. A judge that goes away ends the wait with ANDON_RESULT_WRITER_GONE. With `timeout_us` 0, or when a verdict is there, the
/// call does not block. A judge that has gone away is reported all the same.
///
/// # Safety
/// `reader` is from `andon_open`, not closed, and no other call with it is running; `out` can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn andon_next(
    reader: *mut AndonReader,
    timeout_us: u64,
    out: *mut AndonVerdict,
) -> AndonResult {
    guarded(|| {
        // SAFETY: null is None; otherwise the caller promises that it is ours and used by nobody else.
        let reader = unsafe { reader.as_mut() }.ok_or_else(|| argument("reader"))?;
        if out.is_null() {
            return Err(argument("out"));
        }
        // Longer than a day is the same as for ever, and could overflow the clock.
        let timeout = Duration::from_micros(timeout_us).min(Duration::from_secs(86_400));
        match reader.next(timeout).map_err(|e| transport(&e))? {
            Next::Verdict(verdict) => {
                // SAFETY: not null, and the caller promises that it can be written.
                unsafe { out.write(AndonVerdict::from(&verdict)) };
                Ok(AndonResult::Verdict)
            }
            Next::WriterGone => Ok(AndonResult::WriterGone),
            Next::Nothing => Ok(AndonResult::Nothing),
        }
    })
}

/// Writes what the reader has received so far, and whether the station is ready, to `*out` and returns ANDON_RESULT_NOTHING. It does
/// not block: call it in every cycle.
///
/// # Safety
/// As `andon_next`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn andon_status(reader: *mut AndonReader, out: *mut AndonStatus) -> AndonResult {
    guarded(|| {
        // SAFETY: null is None; otherwise the caller promises that it is ours and used by nobody else.
        let reader = unsafe { reader.as_mut() }.ok_or_else(|| argument("reader"))?;
        if out.is_null() {
            return Err(argument("out"));
        }
        let status = reader.status().map_err(|e| transport(&e))?;
        // SAFETY: not null, and the caller promises that it can be written.
        unsafe { out.write(status) };
        Ok(AndonResult::Nothing)
    })
}

/// Closes a reader. Null is allowed and does nothing.
///
/// # Safety
/// `reader` is null or from `andon_open`, and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn andon_close(reader: *mut AndonReader) {
    if reader.is_null() {
        return;
    }
    guarded(|| {
        // SAFETY: from `Box::into_raw` in `andon_open`, and the caller promises that it is closed once.
        drop(unsafe { Box::from_raw(reader) });
        Ok(AndonResult::Nothing)
    });
}

/// What was wrong in the last call of this thread that failed, with the remedy; empty if none has failed. The text is valid until
/// the next call of this thread that fails.
#[unsafe(no_mangle)]
pub extern "C" fn andon_last_error() -> *const c_char {
    LAST_ERROR.try_with(|last| last.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;

    #[test]
    fn a_panic_becomes_a_number_and_a_text() {
        assert_eq!(guarded(|| panic!("on purpose")), AndonResult::Internal);
        // SAFETY: the text lives until the next failing call of this thread, and there is none.
        let text = unsafe { CStr::from_ptr(andon_last_error()) };
        assert!(text.to_str().unwrap().contains("close this reader"));
    }
}
