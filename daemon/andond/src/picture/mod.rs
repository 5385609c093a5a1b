//! Pictures for people: the film with what was seen and judged drawn on it.

mod annotator;
mod assumed;
mod canvas;

pub use annotator::{AnnotateError, Annotator, END_S};
