//! At how many frames per second the job can be judged, and at how many its own runs are still judged as they were shown.
//!
//! The runs are thinned to every n-th frame, from every first frame, and must be segmented and judged as with all frames. This measures the
//! verdicts themselves. It says when correct work is recognised; a fault may need more frames. Two rates follow. From the lower one on nothing that
//! was shown is accused, and most of it is judged: a step with fewer frames is not judged. From the higher one on all but a few thinned runs are
//! right. With one rate for both, every second frame of right jobs was not judged in one of fifteen drawn sets of people.

use crate::job_file::JobFile;
use crate::run::Run;
use andon_core::verdict::{Level, Outcome, Verdict};

/// Shares of the frames that are tried before every second, third, fourth frame and so on: numerator and denominator.
const FRACTIONS: [[u32; 2]; 3] = [[5, 6], [3, 4], [2, 3]];

/// One in this number of thinned runs may fail to be judged where the runs count as recognised. What a run itself hides may lie where a frame is left
/// out. Halved or doubled, 10 or 2 of 41 jobs ask for another rate, and no verdict on 521 runs changes.
const RUNS_PER_FAILURE: usize = 10;

/// In frames per second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rates {
    /// With fewer, an IU is not judged.
    pub(super) min_hz: f32,
    /// From here on the runs are recognised.
    pub(super) recognised_hz: f32,
}

/// Thins the runs to fewer and fewer frames, beginning with each possible frame. It ends when one of them is segmented in another way or accused, or
/// fewer than half are judged. Runs that are not right with all their frames say nothing; where none is right, the job needs all frames.
pub(super) fn rates(runs: &[&Run], job: &JobFile) -> Rates {
    let rate_hz = job.method.rate_hz;
    // Nothing is asked of the rate while it is measured.
    let free = JobFile { min_rate_hz: 0.0, ..job.clone() };
    let judged = runs.iter().filter_map(|run| Some((*run, run.judge(&free).ok()?)));
    let shown: Vec<(&Run, Vec<Verdict>)> = judged.filter(|(_, verdicts)| are_right(verdicts)).collect();
    let rate_of = |[kept, of]: [u32; 2]| rate_hz * kept as f32 / of as f32;
    let tried = |share: [u32; 2]| {
        let thinned = |(run, shown): &(&Run, Vec<Verdict>)| -> Vec<Option<Outcome>> {
            let thinned = run.judge_at(rate_of(share).into(), share[1], &free);
            thinned.iter().map(|verdicts| outcome(verdicts, shown)).collect()
        };
        let outcomes: Vec<Option<Outcome>> = shown.iter().flat_map(thinned).collect();
        let unjudged = outcomes.iter().filter(|outcome| **outcome == Some(Outcome::NotJudged)).count();
        let is_as_shown =
            |outcome: &Option<Outcome>| outcome.is_some_and(|outcome| outcome != Outcome::Anomaly);
        let is_enough = outcomes.len() == shown.len() * share[1] as usize && outcomes.iter().all(is_as_shown);
        let has_few_failures = |per_failure: usize| per_failure * unjudged <= outcomes.len();
        (is_enough && has_few_failures(2) && !shown.is_empty())
            .then(|| (rate_of(share), has_few_failures(RUNS_PER_FAILURE)))
    };
    // Nobody runs a line at less than one frame per second.
    let every = (2..=rate_hz as u32).map(|every| [1, every]);
    let enough: Vec<(f32, bool)> = FRACTIONS.into_iter().chain(every).map_while(tried).collect();
    let recognised = enough.iter().take_while(|(_, is_recognised)| *is_recognised).last().copied();
    // No camera delivers every frame, and a job that needed each would not be judged for the loss of one.
    let recognised = recognised.or_else(|| tried([19, 20]).filter(|(_, is_recognised)| *is_recognised));
    let recognised_hz = recognised.map_or(rate_hz, |(rate_hz, _)| rate_hz);
    Rates { min_hz: enough.last().map_or(recognised_hz, |(min_hz, _)| *min_hz), recognised_hz }
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
