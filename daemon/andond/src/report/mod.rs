//! What people and programs read: verdicts and events as JSON lines and as sentences, recordings as pictures.

mod json;
pub mod plot;
mod words;

pub use json::{EventLine, VerdictLine};
pub use words::{Names, verdict_sentence};
