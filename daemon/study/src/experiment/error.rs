//! Why an experiment could not be carried out.

use andon_learn::run::RunError;
use andon_learn::teach::TeachError;

/// Why an experiment could not be carried out.
#[derive(Debug, thiserror::Error)]
pub enum ExperimentError {
    /// There are not enough recordings.
    #[error(
        "the second experiment needs at least 3 correct executions (p<person>_none_r<repetition>; the paper has 21) and some flawed ones \
         (p<person>_J1_r1, p<person>_J2_r1); there are {correct} and {flawed}"
    )]
    TooFew {
        /// Number of correct executions.
        correct: usize,
        /// Number of flawed executions.
        flawed: usize,
    },
    /// No job could be taught.
    #[error(transparent)]
    Teach(#[from] TeachError),
    /// An execution cannot be encoded without the filter.
    #[error(transparent)]
    Run(#[from] RunError),
}
