//! Too few frames to learn from.

use super::Doubt;
use crate::run::Run;
use andon_core::config::Method;

/// The least frame rate of a run, as a share of that of the grid. Taught by five simulated people (three seeds) at 30 frames per second and
/// thinned evenly, jobs from every second frame found 12 of 12 `J1` of other people, and jobs from every third frame 3 of 12: the motion is
/// then measured in so few places that any motion is near it. The frames of a real camera come a little late now and then, hence not 0.5.
const MIN_SHARE: f64 = 0.45;

/// The runs with too few frames, if there are any.
pub(in crate::teach) fn too_few_frames(runs: &[Run], method: &Method) -> Option<Doubt> {
    let needed_hz = MIN_SHARE * f64::from(method.rate_hz);
    let slow: Vec<(&Run, f64)> =
        runs.iter().map(|run| (run, run.captured_rate_hz())).filter(|(_, rate)| *rate < needed_hz).collect();
    let least = slow.iter().map(|(_, rate)| *rate).min_by(f64::total_cmp)?;
    let names = slow.iter().map(|(run, _)| run.name.clone()).collect();
    Some(Doubt::TooFewFrames { runs: names, rate_hz: least, needed_hz: 0.5 * f64::from(method.rate_hz) })
}
