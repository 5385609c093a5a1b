//! Logs: readable text on a terminal, fields in the journal under systemd, and a stable code on every message.
//!
//! INFO is a transition that a technician cares about, DEBUG an IU, TRACE a frame. An error is handled once: logged
//! or returned. What is logged at INFO and above has a [`code`]; its message ends with what to do, which is the remedy of
//! the code:
//!
//! ```
//! use andon_host::log::{code, log};
//! let device = "/dev/video0";
//! log!(code::CAMERA_GONE, { device }, "{device} does not answer: No such device");
//! assert_eq!(andon_host::log::last_error(), code::CAMERA_GONE.number);
//! ```

pub mod code;
mod output;

pub use crate::__log as log;
pub use code::index;
pub use output::{Level, start};

use std::fmt;
use std::sync::atomic::{AtomicU32, Ordering};

static LAST_ERROR: AtomicU32 = AtomicU32::new(0);

/// Number of the newest code of level WARN or ERROR in this process, for the role's health; 0 is none.
pub fn last_error() -> u32 {
    LAST_ERROR.load(Ordering::Relaxed)
}

/// A kind of message. All of them are in [`code`].
#[derive(Debug)]
pub struct Code {
    /// Its number: the index page and the PLC's registers know it by this.
    pub number: u32,
    /// The number as it is written: `AND-104`.
    pub name: &'static str,
    /// How serious it is.
    pub level: tracing::Level,
    /// What it means, in one line.
    pub meaning: &'static str,
    /// What to do; empty where there is nothing to do.
    pub remedy: &'static str,
}

/// Where an error says what to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remedy {
    /// The remedy of its code follows its message.
    OfCode,
    /// Its message ends with a remedy of its own.
    InMessage,
}

impl Code {
    /// Logs a message whose code is found at run time. All others are logged with [`log!`].
    pub fn log_found(&'static self, what: &dyn fmt::Display, remedy: Remedy) {
        let remedy = if remedy == Remedy::OfCode { self.remedy } else { "" };
        self.note();
        let message = format_args!("{what}");
        let text = self.text(message, remedy);
        match self.level {
            tracing::Level::ERROR => tracing::error!(code = self.name, "{text}"),
            tracing::Level::WARN => tracing::warn!(code = self.name, "{text}"),
            _ => tracing::info!(code = self.name, "{text}"),
        }
    }

    /// The text of a message with this code. For [`log!`], which formats it only where the level is on.
    #[doc(hidden)]
    pub fn text<'a>(
        &'static self,
        message: fmt::Arguments<'a>,
        remedy: &'static str,
    ) -> impl fmt::Display + 'a {
        Text { code: self, message, remedy }
    }

    /// Keeps the code for [`last_error`].
    #[doc(hidden)]
    pub fn note(&self) {
        if self.level <= tracing::Level::WARN {
            LAST_ERROR.store(self.number, Ordering::Relaxed);
        }
    }
}

struct Text<'a> {
    code: &'static Code,
    message: fmt::Arguments<'a>,
    remedy: &'static str,
}

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.code.name, self.message)?;
        if !self.remedy.is_empty() {
            write!(f, ". {}", self.remedy)?;
        }
        Ok(())
    }
}

/// Logs a message with a code: `log!(code::CAMERA_GONE, { device = %path }, "{path} does not answer")`; the fields
/// may be left out. The message has no full stop at its end: the remedy of the code follows. An error whose own text says
/// what to do is logged as `log!(code::DISK_FULL, remedied: "{error}")`, and no remedy follows.
#[doc(hidden)]
#[macro_export]
macro_rules! __log {
    (@event $code:path, $remedy:expr, { $($fields:tt)* }, $($message:tt)+) => {{
        const LEVEL: ::tracing::Level = $code.level;
        $code.note();
        ::tracing::event!(
            LEVEL,
            { code = $code.name, $($fields)* },
            "{}",
            $code.text(::std::format_args!($($message)+), $remedy)
        );
    }};
    ($code:path, remedied: $($message:tt)+) => { $crate::log::log!(@event $code, "", {}, $($message)+) };
    ($code:path, { $($fields:tt)* }, $($message:tt)+) => {
        $crate::log::log!(@event $code, $code.remedy, { $($fields)* }, $($message)+)
    };
    ($code:path, $($message:tt)+) => { $crate::log::log!($code, {}, $($message)+) };
}
