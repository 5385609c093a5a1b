//! What the job would say of the runs that it was taught with, if each had not been shown.

use super::options::TeachOptions;
use super::teach;
use crate::job_file::JobFile;
use crate::run::Run;
use andon_core::verdict::Outcome;

/// The names of the runs that a job taught with the others accuses, in the order of the runs; those that nothing can be taught without too.
/// `whole` is the job that all of them teach: the frame rate that the work needs is measured once, there, and the runs are known to differ.
pub(super) fn rejected(runs: &[&Run], options: &TeachOptions, whole: &JobFile) -> Vec<String> {
    let options = TeachOptions {
        try_runs: false,
        measure_rate: false,
        examine_runs: false,
        find_meetings: false,
        ..options.clone()
    };
    let is_rejected = |index: &usize| {
        let others: Vec<Run> = runs
            .iter()
            .enumerate()
            .filter(|(other, _)| other != index)
            .map(|(_, run)| (*run).clone())
            .collect();
        let Ok((job, _)) = teach(&others, &options) else { return true };
        let job = JobFile { min_rate_hz: whole.min_rate_hz, ..job };
        let verdicts = runs[*index].judge(&job);
        verdicts.map_or(true, |verdicts| verdicts.iter().any(|verdict| verdict.outcome == Outcome::Anomaly))
    };
    (0..runs.len()).filter(is_rejected).map(|index| runs[index].name.clone()).collect()
}
