//! What the job would say of the runs that it was taught with, if each had not been shown.

use super::options::TeachOptions;
use super::teach;
use crate::run::Run;
use andon_core::verdict::Outcome;

/// The names of the runs that a job taught with the others accuses, in the order of the runs; those that nothing can be taught without too.
pub(super) fn rejected(runs: &[&Run], options: &TeachOptions) -> Vec<String> {
    let options = TeachOptions { try_runs: false, ..options.clone() };
    let is_rejected = |index: &usize| {
        let others: Vec<Run> = runs
            .iter()
            .enumerate()
            .filter(|(other, _)| other != index)
            .map(|(_, run)| (*run).clone())
            .collect();
        let Ok((job, _)) = teach(&others, &options) else { return true };
        let verdicts = job.with_job(|lent| runs[*index].judge(lent, &job.method));
        verdicts.map_or(true, |verdicts| verdicts.iter().any(|verdict| verdict.outcome == Outcome::Anomaly))
    };
    (0..runs.len()).filter(is_rejected).map(|index| runs[index].name.clone()).collect()
}
