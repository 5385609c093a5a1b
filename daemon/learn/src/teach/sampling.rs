//! How many frames per second the job needs: the lowest rate at which the runs themselves are still judged as they were shown.
//!
//! The runs are thinned to every n-th frame, from every first frame, and must be segmented and judged as with all frames. This measures the
//! verdicts themselves. It says when correct work is recognised; a fault may need more frames.

use crate::job_file::JobFile;
use crate::run::Run;
use andon_core::verdict::{Level, Outcome, Verdict};

/// Shares of the frames that are tried before every second, third, fourth frame and so on: numerator and denominator.
const FRACTIONS: [[u32; 2]; 3] = [[5, 6], [3, 4], [2, 3]];

/// One in this number of thinned runs may fail to be judged. What a run itself hides may lie where a frame is left out. Halved or doubled, 10 or 2 of
/// 41 jobs ask for another rate, and no verdict on 521 runs changes.
const RUNS_PER_FAILURE: usize = 10;

/// Thins the runs to fewer and fewer frames, beginning with each possible frame. It ends when one of them is segmented in another way or accused, or
/// several are not judged. The last rate before that is what the job needs. Runs that are not right with all their frames say nothing; where none is
/// right, the job needs all frames.
pub(super) fn needed_rate_hz(runs: &[&Run], job: &JobFile) -> f32 {
    let rate_hz = job.method.rate_hz;
    // Nothing is asked of the rate while it is measured.
    let free = JobFile { min_rate_hz: 0.0, ..job.clone() };
    let judged = runs.iter().filter_map(|run| Some((*run, run.judge(&free).ok()?)));
    let shown: Vec<(&Run, Vec<Verdict>)> = judged.filter(|(_, verdicts)| are_right(verdicts)).collect();
    let rate_of = |[kept, of]: [u32; 2]| rate_hz * kept as f32 / of as f32;
    let is_enough = |share: &[u32; 2]| {
        let thinned = |(run, shown): &(&Run, Vec<Verdict>)| -> Vec<Option<Outcome>> {
            let thinned = run.judge_at(rate_of(*share).into(), share[1], &free);
            thinned.iter().map(|verdicts| outcome(verdicts, shown)).collect()
        };
        let outcomes: Vec<Option<Outcome>> = shown.iter().flat_map(thinned).collect();
        let unjudged = outcomes.iter().filter(|outcome| **outcome == Some(Outcome::NotJudged)).count();
        outcomes.len() == shown.len() * share[1] as usize
            && outcomes.iter().all(|outcome| outcome.is_some_and(|outcome| outcome != Outcome::Anomaly))
            && unjudged <= outcomes.len() / RUNS_PER_FAILURE
    };
    // Nobody runs a line at less than one frame per second.
    let every = (2..=rate_hz as u32).map(|every| [1, every]);
    let least = FRACTIONS.into_iter().chain(every).take_while(is_enough).last();
    // No camera delivers every frame, and a job that needed each would not be judged for the loss of one.
    let least = least.or_else(|| Some([19, 20]).filter(is_enough));
    least.filter(|_| !shown.is_empty()).map_or(rate_hz, rate_of)
}

/// How a thinned run came out: as it was shown, not judged, or an anomaly; `None` if it was segmented in another way.
fn outcome(verdicts: &[Verdict], shown: &[Verdict]) -> Option<Outcome> {
    let has = |wanted: &Outcome| verdicts.iter().any(|verdict| verdict.outcome == *wanted);
    let about = |of: &Verdict| (of.level, of.activity, of.iu, of.context);
    let is_alike = || verdicts.iter().map(about).eq(shown.iter().map(about));
    let worse = [Outcome::Anomaly, Outcome::NotJudged].into_iter().find(has);
    worse.or_else(|| is_alike().then_some(Outcome::Ok))
}

fn are_right(verdicts: &[Verdict]) -> bool {
    verdicts.last().is_some_and(|verdict| verdict.level == Level::Job)
        && verdicts.iter().all(|verdict| verdict.outcome == Outcome::Ok)
}
