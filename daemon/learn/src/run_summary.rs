//! What was seen in one run, for the person who has just shown it.

use crate::job_file::sequence_words;
use crate::recording::object_name;
use crate::run::Run;
use crate::teach::{TeachOptions, with_learned_contacts};
use andon_core::config::Method;
use std::fmt;

/// What was seen in one run. `Display` says it in one line.
#[derive(Clone, Debug, PartialEq)]
pub struct RunSummary {
    /// From the first frame to the last, in seconds.
    pub duration_s: f64,
    /// Frames per second, from the median time between two of them.
    pub rate_hz: f64,
    /// Which hand did what with which parts, and for how many seconds, in the order in which it began.
    pub steps: Vec<(String, f64)>,
    /// The parts that were in no frame.
    pub unseen: Vec<String>,
    /// Whether a hand was in any frame.
    pub has_hands: bool,
}

impl RunSummary {
    /// Looks at a run that was read with this method.
    pub fn of(run: &Run, method: &Method) -> Self {
        // Where the station does not say where parts are touched, the run shows it.
        let options = TeachOptions::new(&run.name, "", *method);
        let met = with_learned_contacts(std::slice::from_ref(run), &options)
            .ok()
            .and_then(|met| met.into_iter().next());
        let activities = met.as_ref().map_or(&run.activities, |met| &met.activities);
        let [first_ns, last_ns] = [run.frames().first(), run.frames().last()]
            .map(|frame| frame.map_or(0, |frame| frame.captured_ns));
        let unseen = run.objects.iter().filter(|object| !run.shows(object.shape.id));
        let steps = activities.iter().map(|activity| {
            let began_ns = activity.ius.first().map_or(0, |iu| iu.began_ns);
            let name = sequence_words(&activity.contexts(), |id| object_name(&run.objects, id));
            (name, seconds(began_ns, activity.ended_ns()))
        });
        Self {
            duration_s: seconds(first_ns, last_ns),
            rate_hz: run.captured_rate_hz(),
            steps: steps.collect(),
            unseen: unseen.map(|object| object.name.clone()).collect(),
            has_hands: run.shows_hands(),
        }
    }
}

fn seconds(from_ns: u64, to_ns: u64) -> f64 {
    to_ns.saturating_sub(from_ns) as f64 * 1e-9
}

impl fmt::Display for RunSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} s at {:.0} frames a second: ", self.duration_s, self.rate_hz)?;
        let steps: Vec<String> =
            self.steps.iter().map(|(name, seconds)| format!("{name} ({seconds:.1} s)")).collect();
        match (steps.is_empty(), self.has_hands) {
            (false, _) => write!(f, "{}", steps.join(", "))?,
            (true, true) => write!(f, "no hand touched a part")?,
            (true, false) => write!(f, "no hand was seen")?,
        }
        if !self.unseen.is_empty() {
            write!(f, "; never seen: {}", self.unseen.join(", "))?;
        }
        Ok(())
    }
}
