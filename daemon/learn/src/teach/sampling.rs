//! How many frames per second the job needs: the lowest rate at which the runs themselves are still judged as they were shown.

use crate::job_file::JobFile;
use crate::run::Run;
use andon_core::couple::Context;
use andon_core::verdict::{Level, Outcome, Verdict};

/// At fewer frames per second than this, nobody runs a line.
const LEAST_HZ: f32 = 1.0;

/// Thins the runs to every second, third, fourth frame and so on, beginning with each possible frame, until one of them is segmented or
/// judged in another way than with all its frames. The last rate before that is what the job needs. Runs that are not right with all
/// their frames say nothing; where none is right, the job needs all frames.
pub(super) fn needed_rate_hz<'a>(runs: impl Iterator<Item = &'a Run>, job: &JobFile) -> f32 {
    let method = &job.method;
    // Nothing is asked of the rate while it is measured.
    let free = JobFile { min_rate_hz: 0.0, ..job.clone() };
    free.with_job(|lent| {
        let shown: Vec<(&Run, Vec<Said>)> = runs
            .filter_map(|run| Some((run, said(&run.judge(lent, method).ok()?))))
            .filter(|(_, said)| is_right(said))
            .collect();
        let is_enough = |part: &u32| {
            let rate_hz = f64::from(method.rate_hz) / f64::from(*part);
            shown.iter().all(|(run, shown)| {
                let thinned = run.judge_at(rate_hz, *part, lent, method);
                thinned.len() == *part as usize && thinned.iter().all(|verdicts| said(verdicts) == *shown)
            })
        };
        let least = (method.rate_hz / LEAST_HZ) as u32;
        let parts = (2..=least).take_while(is_enough).last().filter(|_| !shown.is_empty()).unwrap_or(1);
        method.rate_hz / parts as f32
    })
}

/// What a verdict is about and how it came out.
type Said = (Level, Outcome, u16, Option<u16>, Context);

fn said(verdicts: &[Verdict]) -> Vec<Said> {
    let said =
        |verdict: &Verdict| (verdict.level, verdict.outcome, verdict.activity, verdict.iu, verdict.context);
    verdicts.iter().map(said).collect()
}

fn is_right(said: &[Said]) -> bool {
    said.last().is_some_and(|(level, ..)| *level == Level::Job)
        && said.iter().all(|(_, outcome, ..)| *outcome == Outcome::Ok)
}
