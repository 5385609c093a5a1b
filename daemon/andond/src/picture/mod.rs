//! Pictures for people: the film with what was seen and judged drawn on it.

mod annotator;
mod assumed;
mod canvas;
mod panel;
mod steps;

pub use annotator::{AnnotateError, Annotator, END_S};
