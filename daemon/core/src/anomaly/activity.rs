//! An activity that goes on, and against what its IUs are judged.

use super::alignment::Alignment;
use super::progress::{Progress, Set};
use crate::capacity::ACTIVITIES;
use crate::couple::Context;
use crate::input::Side;
use crate::job::Job;
use crate::verdict::Reason;

/// Against what the IUs of an activity are judged.
///
/// ```text
///   Candidates --- no candidate is left, or what was not seen may be skipped ---> Following
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Against {
    /// `J \ L`: nominal activities that all IUs so far agree with, place by place.
    Candidates(Set),
    /// After a fault: the nominal activity that came nearest, aligned by context.
    Following(Option<usize>),
}

/// An activity that goes on.
#[derive(Clone, Debug)]
pub(super) struct OpenActivity {
    pub(super) number: u16,
    /// The context of its first IU.
    pub(super) context: Context,
    pub(super) began_ns: u64,
    /// When its newest IU that has ended did so, or its release state began.
    pub(super) ended_ns: u64,
    pub(super) against: Against,
    /// `i`: IUs that agree with every candidate.
    pub(super) place: usize,
    /// IUs that have begun.
    pub(super) ius: u16,
    /// The nominal activity that the newest IU came nearest to.
    pub(super) nearest: Option<usize>,
    /// Of each nominal activity: the sum of its distances as multiples of the thresholds.
    pub(super) ratios: [f64; ACTIVITIES],
    alignments: [Alignment; ACTIVITIES],
    /// Of each nominal activity: the place of the IU that the newest one is, by its context.
    pub(super) aligned: [Option<usize>; ACTIVITIES],
    /// Why an IU of it was not judged.
    pub(super) unknown: Option<Reason>,
    /// Its verdict has been given.
    pub(super) concluded: bool,
}

impl OpenActivity {
    /// Before its first IU: `C`, `L` and `i` start anew at every activity.
    pub(super) fn new(number: u16, context: Context, began_ns: u64, job: &Job<'_>) -> Self {
        let all = job.activities.len().min(ACTIVITIES) as u32;
        Self {
            number,
            context,
            began_ns,
            ended_ns: began_ns,
            against: Against::Candidates(Set::MAX.checked_shr(Set::BITS - all).unwrap_or(0)),
            place: 0,
            ius: 0,
            nearest: None,
            ratios: [0.0; ACTIVITIES],
            alignments: [Alignment::new(); ACTIVITIES],
            aligned: [None; ACTIVITIES],
            unknown: None,
            concluded: false,
        }
    }

    /// Takes the context of the next IU and gives the IU's number.
    pub(super) fn next_iu(&mut self, job: &Job<'_>, context: Context) -> u16 {
        for ((aligned, alignment), nominal) in
            self.aligned.iter_mut().zip(&mut self.alignments).zip(job.activities)
        {
            *aligned = alignment.step(nominal.ius, context);
        }
        let number = self.ius;
        self.ius = number.saturating_add(1);
        number
    }

    /// `J \ L`; empty after a fault.
    pub(super) fn candidates(&self) -> Set {
        match self.against {
            Against::Candidates(candidates) => candidates,
            Against::Following(_) => 0,
        }
    }

    /// An IU agrees with these nominal activities.
    pub(super) fn agree(&mut self, nominal: Set) {
        if let Against::Candidates(_) = self.against {
            self.against = Against::Candidates(nominal);
            self.place += 1;
        }
    }

    /// It is followed on against this nominal activity, if any is near.
    pub(super) fn follow(&mut self, nominal: Option<usize>) {
        self.against = Against::Following(nominal);
        self.nearest = nominal.or(self.nearest);
    }

    /// The candidate whose end has been reached: one that is in its place before one that is not, then the nearest.
    pub(super) fn matched(&self, side: Side, progress: &Progress<'_>) -> Option<usize> {
        let ended = |nominal: &usize| progress.job.activities[*nominal].ius.len() == self.place;
        members(self.candidates()).filter(ended).min_by(|one, other| {
            let out = |nominal: &usize| progress.is_out_of_place(side, *nominal);
            out(one).cmp(&out(other)).then(self.ratios[*one].total_cmp(&self.ratios[*other]))
        })
    }

    /// Candidates that have `context` at this place.
    pub(super) fn agreeing(&self, job: &Job<'_>, context: Context) -> Set {
        members(self.candidates())
            .filter(|nominal| {
                job.activities[*nominal].ius.get(self.place).is_some_and(|iu| iu.context == context)
            })
            .fold(0, |set, nominal| set | 1 << nominal)
    }

    /// After a fault: the newest IU is the last one of the nominal activity that is followed.
    pub(super) fn is_followed_to_its_end(&self, job: &Job<'_>) -> bool {
        match self.against {
            Against::Following(Some(nominal)) => {
                self.aligned[nominal].is_some_and(|place| place + 1 == job.activities[nominal].ius.len())
            }
            _ => false,
        }
    }

    /// Where no candidate has `context` at this place: the candidate that has it soonest after, or else before, or else the nearest so
    /// far; and whether it comes after, so that IUs may have been skipped.
    pub(super) fn nearest_elsewhere(&self, job: &Job<'_>, context: Context) -> (Option<usize>, bool) {
        let places = |nominal: usize| {
            let ius = job.activities[nominal].ius.iter().enumerate();
            ius.filter(|(_, iu)| iu.context == context).map(|(place, _)| place)
        };
        let candidates = self.candidates();
        let after = |nominal| Some((places(nominal).find(|place| *place > self.place)?, nominal));
        match members(candidates).filter_map(after).min() {
            Some((_, nominal)) => (Some(nominal), true),
            None => {
                let before = members(candidates).find(|nominal| places(*nominal).next().is_some());
                (before.or(self.nearest), false)
            }
        }
    }

    /// The nominal activity with the fewest edits; `before` unless another has fewer, and none before a context of one is met.
    pub(super) fn nearest_by_context(&self, job: &Job<'_>, before: Option<usize>) -> Option<usize> {
        let edits = |nominal: usize| self.alignments[nominal].least(job.activities[nominal].ius);
        let least = (0..job.activities.len().min(ACTIVITIES))
            .filter(|nominal| self.aligned[*nominal].is_some())
            .min_by_key(|nominal| edits(*nominal));
        match (before, least) {
            (Some(before), Some(least)) if edits(least) < edits(before) => Some(least),
            (None, least) => least,
            (before, _) => before,
        }
    }
}

/// The members of a set, from the lowest on.
pub(super) fn members(set: Set) -> impl Iterator<Item = usize> {
    (0..ACTIVITIES).filter(move |member| set >> member & 1 == 1)
}

/// Why a context is wrong here: whether it is known to any of the nominal activities.
pub(super) fn context_reason(job: &Job<'_>, among: Set, context: Context) -> Reason {
    let known = job.activities.iter().enumerate().any(|(nominal, activity)| {
        among >> nominal & 1 == 1 && activity.ius.iter().any(|iu| iu.context == context)
    });
    if known { Reason::WrongOrder } else { Reason::WrongObject }
}
