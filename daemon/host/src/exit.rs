//! How a process ends: one exit code per kind of end, on which the units and the callers of a tool can rely.

use crate::log::{code, log};
use std::error::Error;
use std::io::{self, ErrorKind, Write as _};
use std::process::ExitCode;

/// Why a role or a tool has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Code {
    /// It was asked to stop, or its work is done.
    Stopped = 0,
    /// A tool has found what speaks against doing what it was asked for, and has not done it. It says what, and what to do.
    Declined = 1,
    /// The command line is wrong (`EX_USAGE`). A restart would not help: the units do not try.
    Usage = 64,
    /// Something that it needs has failed (`EX_SOFTWARE`): the log says what. The unit starts it again.
    Fault = 70,
    /// It made no progress and ended itself before the watchdog would have. The unit starts it again.
    NoProgress = 71,
    /// It panicked, which is an error in Andon. The unit starts it again.
    Panic = 72,
    /// The configuration is wrong (`EX_CONFIG`), or a file that it names is missing or damaged. A restart would
    /// not help: the units do not try.
    Configuration = 78,
    /// Nobody reads what a tool prints any more: what a shell says of a program that SIGPIPE has ended. With 0, `replay | head` would call a
    /// recording right that nobody has judged to its end.
    Unread = 141,
}

impl From<Code> for ExitCode {
    fn from(code: Code) -> Self {
        Self::from(code as u8)
    }
}

/// Whether a tool has failed because its output pipe was closed.
pub fn is_reader_gone(failure: &(dyn Error + 'static)) -> bool {
    let mut cause = Some(failure);
    while let Some(error) = cause {
        if error.downcast_ref::<io::Error>().is_some_and(|error| error.kind() == ErrorKind::BrokenPipe) {
            return true;
        }
        cause = error.source();
    }
    false
}

/// Makes a panic in any thread end the process with [`Code::Panic`] and one line in the log. A role that went on with one thread less would look
/// healthy and judge nothing.
pub fn exit_on_panic() {
    std::panic::set_hook(Box::new(|panic| {
        let location = panic.location().map(ToString::to_string).unwrap_or_default();
        let message = panic.payload_as_str().unwrap_or("no message");
        // `println!` panics where the reader has seen enough, as `head` does. That is no defect, and there is nobody to tell.
        if message.starts_with("failed printing to std") && message.contains("Broken pipe") {
            std::process::exit(i32::from(Code::Unread as u8));
        }
        if let Some(error) = message.strip_prefix("failed printing to stdout: ") {
            // Nor is a full disk.
            let _ = writeln!(
                io::stderr(),
                "standard output cannot be written: {error}; make room on this disk, or write elsewhere"
            );
            std::process::exit(i32::from(Code::Fault as u8));
        }
        if message.starts_with("failed printing to stderr") {
            // There is nowhere to say it.
            std::process::exit(i32::from(Code::Fault as u8));
        }
        log!(code::PANIC, "{message}, at {location}");
        // A tool has no log.
        if !tracing::dispatcher::has_been_set() {
            eprintln!("{} {message}, at {location}", code::PANIC.name);
        }
        std::process::exit(i32::from(Code::Panic as u8));
    }));
}
