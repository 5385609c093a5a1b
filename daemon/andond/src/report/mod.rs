//! What people and programs read: verdicts and events as JSON lines and as sentences, recordings as pictures.

mod code;
mod instead;
mod json;
mod names;
mod not_watching;
mod pair;
pub mod plot;
#[cfg(test)]
pub(crate) mod sample;
mod teller;
#[cfg(test)]
mod tests;
mod words;

pub(crate) use code::code_of;
pub use json::{EventLine, VerdictLine};
pub use names::{Names, Step};
pub(crate) use not_watching::NotWatchingLine;
pub use teller::{Cause, Teller, TextLine};
pub use words::{has_contact, is_instead, outcome_word, verdict_sentence};

/// The time of a verdict on a recording, in a column.
pub fn on_recording(ns: u64) -> String {
    format!("{:7.2} s", ns as f64 / 1e9)
}
