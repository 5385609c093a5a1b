//! What people and programs read: verdicts and events as JSON lines and as sentences, recordings as pictures.

mod json;
mod names;
pub mod plot;
mod teller;
#[cfg(test)]
mod tests;
mod words;

pub use json::{EventLine, VerdictLine};
pub use names::{Names, Step};
pub use teller::{Line, Teller, reason_words};
pub use words::{acts, outcome_word, verdict_sentence};

/// The time of a verdict on a recording, in a column.
pub fn on_recording(ns: u64) -> String {
    format!("{:7.2} s", ns as f64 / 1e9)
}
