//! Whether the runs can be trusted: nobody checks a job again once it is taught, so a demonstration that is not what it is taken for must
//! be noticed here.
//!
//! A [`Doubt`] speaks against learning from the runs. It accuses nobody: it is a sentence with the figure and with what to do, and whoever
//! knows better teaches all the same. What was not seen of a run ([`Blind`]) is not learnt, and the rest of the run is.

mod doubt;
mod order;
mod outlier;
mod rate;
mod sight;
mod summary;
mod twice;

pub use doubt::Doubt;
pub use outlier::{Measure, Outlier};
pub(super) use rate::too_few_frames;
pub use sight::Blind;
pub(super) use summary::summary;
pub(super) use twice::without_copies;

use super::options::TeachOptions;
use super::sequence::Agreement;
use crate::run::Run;
use andon_core::dtw::Refused;

/// Fewer runs than this cannot tell which of them is the odd one.
const MIN_RUNS: usize = 4;

/// What speaks against learning from these runs, once it is known what they have in common, and the demonstrations in which there is only
/// a pause.
///
/// # Errors
/// If an IU is too long to be compared.
pub(super) fn doubts_of(
    runs: &[Run],
    agreement: &Agreement,
    options: &TeachOptions,
) -> Result<(Vec<Doubt>, Vec<Outlier>), Refused> {
    let kept = agreement.used_runs(runs);
    let used = kept.len();
    let few = (2 * used < runs.len() || used == 1 && runs.len() > 1)
        .then_some(Doubt::FewAgree { used, runs: runs.len() });
    // Whoever says that the order does not matter has seen that it differs.
    let order = if options.order_matters == Some(false) { None } else { order::odd_one(&kept) };
    let (pauses, odd): (Vec<_>, Vec<_>) =
        outlier::of_runs(runs, agreement, options)?.into_iter().partition(|outlier| outlier.is_pause);
    Ok((few.into_iter().chain(order).chain(odd.into_iter().map(Doubt::Outlier)).collect(), pauses))
}
