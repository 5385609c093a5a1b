//! A step that is not part of the job, and the step that was missed for it.
//!
//! While it is done nobody knows what it is for; once the step that was next is missed, what was taken was taken instead.

use andon_core::couple::Context;
use andon_core::verdict::{Note, Outcome, Verdict};

use super::Names;
use super::words::{missing, reason_text};

/// What was done where a step of the job was next.
#[derive(Debug)]
pub(super) struct Instead {
    when: String,
    /// The context of its first IU.
    context: Context,
    /// The step that was next.
    step: u16,
}

impl Instead {
    /// `None` where no hand has taken anything.
    pub(super) fn new(when: &str, verdict: &Verdict, step: u16) -> Option<Self> {
        let context = verdict.context;
        (context.0[0] != 0).then(|| Self { when: when.trim_start().to_owned(), context, step })
    }

    /// What was taken and what is taken for the step that is next, in words; `None` where it is the same part.
    fn parts(&self, names: &Names) -> Option<[String; 2]> {
        let [_, taken, ..] = self.context.0;
        let [_, expected, ..] = names.nominal(self.step, Some(0))?.0;
        (taken != expected).then(|| [names.the(taken), names.the(expected)])
    }

    /// Said at once, when it may still have been right.
    pub(super) fn noted(&self, names: &Names) -> Option<String> {
        let [taken, expected] = self.parts(names)?;
        Some(format!("took {taken}, and {} begins with {expected}; was it right?", names.step(self.step)))
    }

    /// Why a verdict is as it is, where it depends on the step that was missed for this one.
    pub(super) fn missed(&self, verdict: &Verdict, names: &Names) -> Option<String> {
        let is_missed = verdict.outcome != Outcome::Ok && missing(verdict) == Some(self.step);
        let [taken, expected] = self.parts(names).filter(|_| is_missed)?;
        // The question whether it was right is answered.
        let verdict = Verdict { note: verdict.note.filter(|note| *note != Note::Step), ..*verdict };
        let why = reason_text(&verdict, names)?;
        Some(format!("{why}; took {taken} at {}, expected {expected}", self.when))
    }
}
