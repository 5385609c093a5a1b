//! Pictures as SVG for light and dark screens. Each of them works within a page or alone.

mod elbow;
mod heat;
mod order;
mod selection;
mod warping;

pub(super) use elbow::elbow;
pub(super) use heat::{LEGEND, heat};
pub use order::draw_order;
pub(super) use selection::selection;
pub(super) use warping::{Execution, Shown, warping};
