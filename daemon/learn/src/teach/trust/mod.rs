//! Whether the runs can be trusted: nobody checks a job again once it is taught, so a demonstration that is not what it is taken for must
//! be noticed here.
//!
//! A [`Doubt`] speaks against learning from the runs. It accuses nobody: it is a sentence with the figure and with what to do, and whoever
//! knows better teaches all the same. What was not seen of a run ([`Blind`]) is not learnt, and the rest of the run is.

mod blind;
mod doubt;
mod order;
mod outlier;
mod rate;
mod summary;
mod twice;

pub use blind::Blind;
pub use doubt::Doubt;
pub use outlier::{Measure, Outlier};
pub(super) use rate::too_few_frames;
pub(super) use summary::summary;
pub(super) use twice::without_copies;

use super::options::TeachOptions;
use super::sequence::Agreement;
use crate::run::Run;
use andon_core::dtw::Refused;

/// Fewer runs than this cannot tell which of them is the odd one.
const MIN_RUNS: usize = 4;

/// What stands out among the runs.
#[derive(Debug, Default)]
pub(super) struct Odd {
    /// What speaks against learning from them.
    pub(super) doubts: Vec<Doubt>,
    /// Demonstrations that stand out where that changes nothing that the others prove: was it right?
    pub(super) questions: Vec<Outlier>,
    /// Demonstrations in which there is only a pause.
    pub(super) pauses: Vec<Outlier>,
}

/// What stands out among these runs, once it is known what they have in common.
///
/// # Errors
/// If an IU is too long to be compared.
pub(super) fn odd_runs(runs: &[Run], agreement: &Agreement, options: &TeachOptions) -> Result<Odd, Refused> {
    let kept = agreement.used_runs(runs);
    let used = kept.len();
    let few = (2 * used < runs.len() || used == 1 && runs.len() > 1)
        .then_some(Doubt::FewAgree { used, runs: runs.len() });
    // Whoever says that the order does not matter has seen that it differs.
    let order = if options.order_matters == Some(false) { None } else { order::odd_one(&kept, agreement) };
    let (pauses, odd): (Vec<_>, Vec<_>) =
        outlier::of_runs(runs, agreement, options)?.into_iter().partition(|outlier| outlier.is_pause);
    let (odd, questions): (Vec<_>, Vec<_>) = odd.into_iter().partition(|outlier| outlier.is_law_of_others);
    let doubts = few.into_iter().chain(order).chain(odd.into_iter().map(Doubt::Outlier)).collect();
    Ok(Odd { doubts, questions, pauses })
}
