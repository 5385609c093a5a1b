//! What people and programs read: verdicts and events as JSON lines, as sentences, as pictures.

mod json;
pub mod plot;
mod words;

pub(crate) use json::side_name;
pub use json::{EventLine, VerdictLine};
pub use words::{Names, is_anomaly, verdict_sentence};
