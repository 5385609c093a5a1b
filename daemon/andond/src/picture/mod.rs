//! Pictures for people: the film with what was seen and judged drawn on it.

mod annotator;
mod assumed;
mod canvas;
mod panel;
mod seen;
mod steps;
mod still;
mod veil;

pub use annotator::{AnnotateError, Annotator, END_S};
pub(crate) use assumed::LastSeen;
pub(crate) use seen::BONES;
pub use still::{Marked, with_residuals, with_seen, with_verdict};
pub use veil::Veil;
