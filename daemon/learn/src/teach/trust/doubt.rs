//! What speaks against learning from the runs, in words.

use super::outlier::Outlier;
use crate::distribution::{Distribution, Right};
use andon_core::couple::Context;
use andon_core::verdict::Measure;

/// What speaks against learning from the runs. Each is a sentence, and says what to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Doubt {
    /// Recordings were given more than once.
    Twice {
        /// The names of the copies.
        copies: Vec<String>,
        /// Number of different runs.
        runs: usize,
    },
    /// Runs have so few frames that their motion is not known.
    TooFewFrames {
        /// The names of the runs.
        runs: Vec<String>,
        /// The lowest frame rate among them, per second.
        rate_hz: f64,
        /// The frame rate that is enough, per second.
        needed_hz: f64,
    },
    /// One run has the activities in another order than all others.
    OtherOrder {
        /// The run's name.
        run: String,
        /// Number of the other runs.
        others: usize,
        /// Index of the first activity that differs, among those of the hand, from 0.
        place: usize,
        /// The context with which it begins in the run.
        had: Context,
        /// The context with which it begins in the others.
        usual: Context,
    },
    /// A demonstration is not like the others.
    Outlier(Outlier),
    /// So few runs agree that the job would be one that most of them do not show.
    FewAgree {
        /// Number of the runs that agree.
        used: usize,
        /// Number of all runs.
        runs: usize,
    },
}

impl Doubt {
    /// The doubt as a sentence without its full stop. `words` puts a context into words.
    pub fn sentence(&self, words: &dyn Fn(Context) -> String) -> String {
        match self {
            Self::Twice { copies, runs } => {
                format!("{} shown before: there {} only", was(copies), count(*runs, "different run"))
            }
            Self::TooFewFrames { runs, rate_hz, needed_hz } => format!(
                "{} too few frames ({rate_hz:.0} per second, {needed_hz:.0} are enough) to tell one motion from another",
                has(runs)
            ),
            Self::OtherOrder { run, others, place, had, usual } => format!(
                "{run} has another order than the {others} others: its step {} begins with {}, theirs with {}",
                place + 1,
                words(*had),
                words(*usual)
            ),
            Self::Outlier(outlier) => {
                format!("{} is not like the others: {}", outlier.run, outlier.figures(words))
            }
            Self::FewAgree { used, runs } => {
                format!(
                    "only {used} of {runs} runs agree{} in their steps",
                    if *used == 1 { "s" } else { "" }
                )
            }
        }
    }

    /// What to do about it, as a sentence without its full stop.
    pub fn remedy(&self) -> String {
        match self {
            Self::Twice { .. } => "give each recording once, and record more runs: 5 should be enough".to_owned(),
            Self::TooFewFrames { needed_hz, .. } => format!(
                "record at {needed_hz:.0} frames per second or more: more light for a shorter exposure, a faster camera or machine"
            ),
            Self::OtherOrder { run, .. } => format!(
                "leave {run} out if it is not correct; if both orders are, say so with --order false or show more runs in that order"
            ),
            Self::Outlier(outlier) => format!(
                "look at {}: leave it out if it is not correct; if it is, show more runs like it",
                outlier.run
            ),
            Self::FewAgree { .. } => {
                "look at the runs that were left out, below, and show at least as many again of the right kind".to_owned()
            }
        }
    }
}

impl Outlier {
    /// Where it lies among the others, beside what the job that was taught says is right of the IU.
    pub(in crate::teach) fn distribution(&self, right: Option<Right<'_>>) -> Distribution {
        // Two reversals are a stroke.
        let per = if self.measure == Some(Measure::Strokes) { 2.0 } else { 1.0 };
        Distribution::among(
            self.measure,
            self.others.iter().map(|other| other / per),
            self.value / per,
            right,
        )
    }

    /// Where and how far it stands out, for a sentence about its run.
    pub(in crate::teach) fn figures(&self, words: &dyn Fn(Context) -> String) -> String {
        let [least, most] =
            [self.others.first(), self.others.last()].map(|end| end.copied().unwrap_or_default());
        let figures = match self.measure {
            Some(Measure::Duration) => {
                format!("takes {:.1} s, the others {least:.1} to {most:.1} s", self.value)
            }
            Some(Measure::Strokes) => {
                format!("reverses its motion {} times, the others {least} to {most} times", self.value)
            }
            Some(_) => {
                let [way, least, most] = [self.value, least, most].map(|metres| 100.0 * metres);
                format!("has a way of {way:.0} cm, the others of {least:.0} to {most:.0} cm")
            }
            None => format!(
                "has distance {:.1} to the others, which have {least:.1} to {most:.1} to each other",
                self.value
            ),
        };
        let place = format!("step {}, IU {}", self.activity + 1, self.iu + 1);
        format!("in {place} ({}) it {figures}", words(self.context))
    }
}

/// The names with "has" or "have".
fn has(names: &[String]) -> String {
    format!("{} {}", names.join(", "), if names.len() == 1 { "has" } else { "have" })
}

/// The names with "was" or "were".
fn was(names: &[String]) -> String {
    format!("{} {}", names.join(", "), if names.len() == 1 { "was" } else { "were" })
}

fn count(count: usize, what: &str) -> String {
    if count == 1 { format!("is one {what}") } else { format!("are {count} {what}s") }
}
