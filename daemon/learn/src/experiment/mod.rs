//! The paper's two experiments (IV), on recordings.

mod confusion;
mod one;
mod score;
mod table;
mod two;
mod variation;

pub use confusion::{Confusion, Rounds};
pub use one::{Drilling, One, Segmentation, run as experiment_1};
pub use score::{Score, score};
pub use table::Table;
pub use two::{Outcome, Split, run as experiment_2};
pub use variation::Variation;

use crate::teach::TeachError;
use andon_core::anomaly::Unusable;

/// Why an experiment was not done.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// There are not enough recordings.
    #[error(
        "the second experiment needs more than 14 correct executions (p<person>_none_r<repetition>) and some flawed ones \
         (p<person>_J1_r1, p<person>_J2_r1); there are {correct} and {flawed}"
    )]
    TooFew {
        /// Correct ones.
        correct: usize,
        /// Flawed ones.
        flawed: usize,
    },
    /// No job could be taught.
    #[error(transparent)]
    Teach(#[from] TeachError),
    /// A taught job could not be judged by.
    #[error("the taught job cannot be judged by: {0:?}")]
    Unusable(Unusable),
}

impl From<Unusable> for ExperimentError {
    fn from(unusable: Unusable) -> Self {
        Self::Unusable(unusable)
    }
}
