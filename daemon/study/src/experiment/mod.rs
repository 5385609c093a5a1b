//! The paper's two experiments (IV), repeated on recordings.

mod confusion;
mod error;
mod first;
mod ladder;
mod score;
mod second;
mod table;
mod training;
mod variation;

pub use confusion::{Confusion, Rounds};
pub use error::ExperimentError;
pub use first::{FirstExperiment, Segmentation, run as experiment_1};
pub use ladder::Ladder;
pub use second::{Outcome, Split, run as experiment_2};
pub use table::Table;
pub use variation::Variation;
