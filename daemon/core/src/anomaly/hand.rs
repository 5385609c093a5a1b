//! Algorithm 1 for the activities of one hand.

use super::alignment::Alignment;
use super::progress::{Progress, Set};
use super::trial::{Extent, Memory, Outcome, Trials};
use crate::capacity::ACTIVITIES;
use crate::couple::{Context, Couple, Motion};
use crate::input::Side;
use crate::job::{Job, NominalActivity};
use crate::segment::{Iu, Segmenter};
use crate::verdict::{Kind, Reason, Verdict};
use heapless::Vec;

/// Against what the IUs of an activity are judged.
///
/// ```text
///   Candidates --- no candidate is left, or what was not seen may be skipped ---> Following
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Against {
    /// `J \ L`: nominal activities that all IUs so far agree with, place by place.
    Candidates(Set),
    /// After a fault: the nominal activity that came nearest, aligned by context.
    Following(Option<usize>),
}

/// An activity that goes on.
#[derive(Clone, Debug)]
struct OpenActivity {
    number: u16,
    /// The context of its first IU.
    context: Context,
    began_ns: u64,
    /// When its newest IU that has ended did so, or its release state began.
    ended_ns: u64,
    against: Against,
    /// `i`: IUs that agree with every candidate.
    place: usize,
    /// IUs that have begun.
    ius: u16,
    /// The nominal activity that the newest IU came nearest to.
    nearest: Option<usize>,
    /// Of each nominal activity: the sum of its distances as multiples of the thresholds.
    ratios: [f64; ACTIVITIES],
    alignments: [Alignment; ACTIVITIES],
    /// Why an IU of it was not judged.
    unknown: Option<Reason>,
    /// Its verdict has been given.
    concluded: bool,
}

/// An IU that goes on.
#[derive(Clone, Copy, Debug)]
struct OpenIu {
    number: u16,
    context: Context,
    began_ns: u64,
    extent: Extent,
    /// Its verdict has been given.
    concluded: bool,
}

/// Judges the activities of one hand.
#[derive(Clone, Debug)]
pub(super) struct HandJudge<'a, M> {
    side: Side,
    trials: Trials<'a, M>,
    activity: Option<OpenActivity>,
    iu: Option<OpenIu>,
}

/// What is said of an IU or an activity.
struct Finding {
    kind: Kind,
    reason: Reason,
    nominal: Option<usize>,
    outcome: Option<Outcome>,
    early: bool,
}

impl<'a, M: Memory<'a>> HandJudge<'a, M> {
    pub(super) fn new(side: Side, job: &'a Job<'a>) -> Self {
        Self { side, trials: Trials::new(job, side), activity: None, iu: None }
    }

    pub(super) fn begin_activity(&mut self, context: Context, began_ns: u64, progress: &mut Progress<'a>) {
        let all = progress.job.activities.len().min(ACTIVITIES) as u32;
        self.activity = Some(OpenActivity {
            number: progress.next_activity(),
            context,
            began_ns,
            ended_ns: began_ns,
            // `C`, `L` and `i` start anew at every activity.
            against: Against::Candidates(Set::MAX.checked_shr(Set::BITS - all).unwrap_or(0)),
            place: 0,
            ius: 0,
            nearest: None,
            ratios: [0.0; ACTIVITIES],
            alignments: [Alignment::new(); ACTIVITIES],
            unknown: None,
            concluded: false,
        });
    }

    /// An IU begins with `couple`: what its context alone decides is decided at once.
    pub(super) fn begin_iu(
        &mut self,
        couple: &Couple,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(activity) = &mut self.activity else { return };
        let context = couple.context;
        self.iu = Some(OpenIu {
            number: activity.ius,
            context,
            began_ns: couple.captured_ns,
            extent: Extent::default(),
            concluded: false,
        });
        activity.ius = activity.ius.saturating_add(1);
        self.trials.clear();
        let job = progress.job;
        let mut matches = [None; ACTIVITIES];
        for ((matched, alignment), nominal) in
            matches.iter_mut().zip(&mut activity.alignments).zip(job.activities)
        {
            *matched = alignment.step(nominal.ius, context);
        }
        match activity.against {
            Against::Candidates(candidates) => {
                let agrees = |nominal: &NominalActivity<'_>| {
                    nominal.ius.get(activity.place).is_some_and(|iu| iu.context == context)
                };
                let left = members(candidates).filter(|nominal| agrees(&job.activities[*nominal]));
                let left = left.fold(0, |set, nominal| set | 1 << nominal);
                if left == 0 {
                    self.context_fault(candidates, couple.sighted, progress, emit);
                    return;
                }
                activity.against = Against::Candidates(left);
                for nominal in members(left).filter(|_| context.is_touch()) {
                    self.trials.add(nominal, &job.activities[nominal].ius[activity.place]);
                }
                self.check_place(progress, emit);
            }
            Against::Following(nominal) => {
                let nominal = activity.nearest_by_context(job, nominal, &matches);
                activity.against = Against::Following(nominal);
                activity.nearest = nominal.or(activity.nearest);
                match nominal.and_then(|nominal| Some((nominal, matches[nominal]?))) {
                    Some((nominal, place)) if context.is_touch() => {
                        self.trials.add(nominal, &job.activities[nominal].ius[place]);
                    }
                    Some(_) => {}
                    None => {
                        let among = nominal.map_or(Set::MAX, |nominal| 1 << nominal);
                        let reason = context_reason(job, among, context);
                        self.conclude_context(couple.sighted, reason, nominal, progress, emit);
                    }
                }
            }
        }
    }

    /// No candidate has this context at this place.
    fn context_fault(
        &mut self,
        candidates: Set,
        sighted: bool,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let (Some(activity), Some(iu)) = (&mut self.activity, &self.iu) else { return };
        let job = progress.job;
        let places = |nominal: &usize| {
            let ius = job.activities[*nominal].ius.iter();
            ius.enumerate().filter(|(_, other)| other.context == iu.context).map(|(place, _)| place)
        };
        let from = activity.place;
        let later = members(candidates)
            .filter_map(|nominal| Some((places(&nominal).find(|place| *place > from)?, nominal)))
            .min();
        let earlier = || members(candidates).find(|nominal| places(nominal).next().is_some());
        let nominal = later.map(|(_, nominal)| nominal).or_else(earlier).or(activity.nearest);
        let reason = context_reason(job, candidates, iu.context);
        activity.against = Against::Following(nominal);
        activity.nearest = nominal;
        // What lies between may have happened while nothing could be seen.
        let skipped_unseen = activity.unknown.is_some() && later.is_some();
        self.conclude_context(sighted && !skipped_unseen, reason, nominal, progress, emit);
    }

    /// Gives the verdict on an IU whose context is wrong, or not `certain`.
    fn conclude_context(
        &mut self,
        certain: bool,
        reason: Reason,
        nominal: Option<usize>,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        if certain {
            self.conclude_iu(
                Finding { kind: Kind::IuAnomaly, reason, nominal, outcome: None, early: true },
                progress,
                emit,
            );
        } else {
            self.give_up(Reason::Blind, progress, emit);
        }
    }

    /// The next filtered motion of the IU.
    pub(super) fn frame(
        &mut self,
        motion: &Motion,
        reversals: u32,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(iu) = self.iu.as_mut().filter(|iu| !iu.concluded) else { return };
        iu.extent.reversals = reversals;
        if self.trials.append(motion).is_err() {
            self.give_up(Reason::Overload, progress, emit);
        }
    }

    /// The IU goes on with `couple`: decides what can be decided before its end.
    pub(super) fn go_on(
        &mut self,
        couple: &Couple,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(iu) = self.iu.as_mut().filter(|iu| !iu.concluded) else { return };
        iu.extent.frames = iu.extent.frames.saturating_add(1);
        let extent = iu.extent;
        if !couple.sighted {
            self.give_up(Reason::Blind, progress, emit);
        } else if iu.context.is_release() {
            // It has no motion of a hand and may last for ever: its context is all there is to it.
            let candidates = self.activity.as_ref().map_or(0, OpenActivity::candidates);
            self.pass(candidates, None, true, progress, emit);
        } else if self.trials.all_lost(extent) {
            self.decide(extent, progress, emit);
        }
    }

    /// The IU has ended.
    pub(super) fn end_iu(&mut self, iu: &Iu, progress: &mut Progress<'a>, emit: &mut impl FnMut(Verdict)) {
        if let Some(activity) = &mut self.activity
            && iu.context.is_touch()
        {
            activity.ended_ns = iu.ended_ns;
        }
        if self.iu.is_some_and(|open| !open.concluded) {
            self.decide(Extent { frames: iu.frames, reversals: iu.reversals, ended: true }, progress, emit);
        }
        self.iu = None;
    }

    /// Decides by motion and bounds.
    fn decide(&mut self, extent: Extent, progress: &mut Progress<'a>, emit: &mut impl FnMut(Verdict)) {
        let Some(nearest) = self.trials.nearest(extent) else {
            self.give_up(Reason::Unknown, progress, emit);
            return;
        };
        let early = !extent.ended;
        if nearest.reason == Reason::None {
            let right = self.trials.outcomes(extent).filter(|outcome| outcome.reason == Reason::None);
            let mut survivors = 0;
            for outcome in right {
                survivors |= 1 << outcome.nominal;
                if let Some(activity) = &mut self.activity {
                    activity.ratios[outcome.nominal] += outcome.ratio();
                }
            }
            self.pass(survivors, Some(nearest), early, progress, emit);
        } else {
            let nominal = Some(nearest.nominal);
            if let Some(activity) = &mut self.activity {
                activity.against = Against::Following(nominal);
                activity.nearest = nominal;
            }
            let finding = Finding {
                kind: Kind::IuAnomaly,
                reason: nearest.reason,
                nominal,
                outcome: Some(nearest),
                early,
            };
            self.conclude_iu(finding, progress, emit);
        }
    }

    /// The IU is right; `survivors` are the nominal activities that agree with it.
    fn pass(
        &mut self,
        survivors: Set,
        outcome: Option<Outcome>,
        early: bool,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let nominal = outcome.map(|outcome| outcome.nominal).or_else(|| members(survivors).next());
        let Some(activity) = &mut self.activity else { return };
        let nominal = nominal.or(activity.nearest);
        activity.agree(survivors);
        activity.nearest = nominal;
        self.conclude_iu(
            Finding { kind: Kind::IuOk, reason: Reason::None, nominal, outcome, early },
            progress,
            emit,
        );
        self.check_place(progress, emit);
    }

    /// The IU cannot be judged. Its context is taken as it is, its motion as right.
    fn give_up(&mut self, reason: Reason, progress: &mut Progress<'a>, emit: &mut impl FnMut(Verdict)) {
        let Some(activity) = &mut self.activity else { return };
        let agreeing = activity.candidates();
        activity.agree(agreeing);
        activity.unknown = activity.unknown.or(Some(reason));
        let nominal = members(agreeing).next().or(activity.nearest);
        self.conclude_iu(
            Finding { kind: Kind::NotJudged, reason, nominal, outcome: None, early: true },
            progress,
            emit,
        );
    }

    /// Says that the activity comes at the wrong time as soon as that holds for every candidate.
    fn check_place(&mut self, progress: &mut Progress<'a>, emit: &mut impl FnMut(Verdict)) {
        let Some(OpenActivity { against: Against::Candidates(candidates), .. }) = self.activity else {
            return;
        };
        if members(candidates).all(|nominal| progress.is_out_of_place(nominal)) {
            let nominal = members(candidates).next();
            self.conclude_activity(Kind::ActivityAnomaly, Reason::WrongOrder, nominal, true, progress, emit);
        }
    }

    /// What is to be said after all that one frame brought: whether the activity is right, if nothing can follow any more.
    pub(super) fn settle(
        &mut self,
        segmenter: &mut Segmenter,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        progress.set_waiting(self.side, None);
        if !self.is_resting() {
            return;
        }
        let Some(activity) = &self.activity else { return };
        let Some(nominal) = activity.matched(progress) else { return };
        let job = progress.job;
        let goes_on: Vec<Context, ACTIVITIES> = members(activity.candidates())
            .filter_map(|nominal| job.activities[nominal].ius.get(activity.place))
            .map(|iu| iu.context)
            .collect();
        segmenter.activity_matched(&goes_on);
        if goes_on.is_empty() {
            self.conclude_matched(nominal, true, progress, emit);
        } else if !activity.concluded {
            progress.set_waiting(self.side, Some(nominal));
        }
    }

    /// The activity has ended.
    pub(super) fn end_activity(&mut self, progress: &mut Progress<'a>, emit: &mut impl FnMut(Verdict)) {
        let Some(activity) = &self.activity else { return };
        let (nearest, unknown) = (activity.nearest, activity.unknown);
        match activity.matched(progress) {
            Some(nominal) => self.conclude_matched(nominal, false, progress, emit),
            // What is missing may have happened while nothing could be seen.
            None => match unknown {
                Some(reason) => {
                    self.conclude_activity(Kind::NotJudged, reason, nearest, false, progress, emit);
                }
                None => {
                    let (kind, reason) = (Kind::ActivityAnomaly, Reason::NotCompleted);
                    self.conclude_activity(kind, reason, nearest, false, progress, emit);
                }
            },
        }
        self.activity = None;
        progress.set_waiting(self.side, None);
    }

    /// No IU goes on in which the hand acts.
    pub(super) fn is_resting(&self) -> bool {
        self.iu.is_none_or(|iu| iu.concluded && iu.context.is_release())
    }

    /// Nothing is left to be said of what goes on.
    pub(super) fn is_concluded(&self) -> bool {
        self.is_resting() && self.activity.as_ref().is_none_or(|activity| activity.concluded)
    }

    /// The activity equals a nominal one.
    fn conclude_matched(
        &mut self,
        nominal: usize,
        early: bool,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(activity) = &self.activity else { return };
        let unknown = activity.unknown;
        if progress.is_out_of_place(nominal) {
            // Said before, or now: then it was not certain, because a longer candidate would have been in place.
            let (kind, reason) = (Kind::ActivityAnomaly, Reason::WrongOrder);
            self.conclude_activity(kind, reason, Some(nominal), false, progress, emit);
        }
        match unknown {
            Some(reason) => {
                self.conclude_activity(Kind::NotJudged, reason, Some(nominal), early, progress, emit);
            }
            None => {
                let (kind, reason) = (Kind::ActivityOk, Reason::None);
                self.conclude_activity(kind, reason, Some(nominal), early, progress, emit);
                progress.set_done(nominal);
            }
        }
    }

    /// Gives the verdict on the IU, and on the activity where it is wrong.
    fn conclude_iu(&mut self, finding: Finding, progress: &mut Progress<'a>, emit: &mut impl FnMut(Verdict)) {
        let (Some(iu), Some(activity)) = (&mut self.iu, &self.activity) else { return };
        if iu.concluded {
            return;
        }
        iu.concluded = true;
        let Finding { kind, reason, nominal, outcome, early } = finding;
        emit(Verdict {
            kind,
            reason,
            side: Some(self.side),
            nearest: nominal.and_then(|nominal| progress.number(nominal)),
            activity: activity.number,
            iu: Some(iu.number),
            context: iu.context,
            distance: outcome.map(|outcome| outcome.distance as f32),
            threshold: outcome.map(|outcome| outcome.threshold),
            early,
            began_ns: iu.began_ns,
            ended_ns: progress.now_ns,
            decided_ns: progress.known_ns,
        });
        if kind == Kind::IuAnomaly {
            self.conclude_activity(Kind::ActivityAnomaly, reason, nominal, true, progress, emit);
        }
    }

    /// Gives the verdict on the activity, once.
    fn conclude_activity(
        &mut self,
        kind: Kind,
        reason: Reason,
        nominal: Option<usize>,
        early: bool,
        progress: &mut Progress<'a>,
        emit: &mut impl FnMut(Verdict),
    ) {
        let Some(activity) = self.activity.as_mut().filter(|activity| !activity.concluded) else { return };
        activity.concluded = true;
        match kind {
            Kind::ActivityAnomaly => progress.set_wrong(nominal, reason),
            Kind::NotJudged => progress.set_unjudged(nominal, reason),
            _ => {}
        }
        let wrong_early = early && kind == Kind::ActivityAnomaly;
        emit(Verdict {
            kind,
            reason,
            side: Some(self.side),
            nearest: nominal.and_then(|nominal| progress.number(nominal)),
            activity: activity.number,
            iu: None,
            context: activity.context,
            distance: None,
            threshold: None,
            early,
            began_ns: activity.began_ns,
            ended_ns: if wrong_early { progress.now_ns } else { activity.ended_ns },
            decided_ns: progress.known_ns,
        });
    }
}

impl OpenActivity {
    /// `J \ L`; empty after a fault.
    fn candidates(&self) -> Set {
        match self.against {
            Against::Candidates(candidates) => candidates,
            Against::Following(_) => 0,
        }
    }

    /// An IU agrees with these nominal activities.
    fn agree(&mut self, nominal: Set) {
        if let Against::Candidates(_) = self.against {
            self.against = Against::Candidates(nominal);
            self.place += 1;
        }
    }

    /// The candidate whose end has been reached: one that is in its place before one that is not, then the nearest.
    fn matched(&self, progress: &Progress<'_>) -> Option<usize> {
        let ended = |nominal: &usize| progress.job.activities[*nominal].ius.len() == self.place;
        members(self.candidates()).filter(ended).min_by(|one, other| {
            let out = |nominal: &usize| progress.is_out_of_place(*nominal);
            out(one).cmp(&out(other)).then(self.ratios[*one].total_cmp(&self.ratios[*other]))
        })
    }

    /// The nominal activity with the fewest edits; `before` unless another has fewer, and none before a context of one is met.
    fn nearest_by_context(
        &self,
        job: &Job<'_>,
        before: Option<usize>,
        matches: &[Option<usize>; ACTIVITIES],
    ) -> Option<usize> {
        let edits = |nominal: usize| self.alignments[nominal].least(job.activities[nominal].ius);
        let least = (0..job.activities.len().min(ACTIVITIES))
            .filter(|nominal| matches[*nominal].is_some())
            .min_by_key(|nominal| edits(*nominal));
        match (before, least) {
            (Some(before), Some(least)) if edits(least) < edits(before) => Some(least),
            (None, least) => least,
            (before, _) => before,
        }
    }
}

/// The members of a set, from the lowest on.
fn members(set: Set) -> impl Iterator<Item = usize> {
    (0..ACTIVITIES).filter(move |member| set >> member & 1 == 1)
}

/// Why a context is wrong here: whether it is known to any of the nominal activities.
fn context_reason(job: &Job<'_>, among: Set, context: Context) -> Reason {
    let known = job.activities.iter().enumerate().any(|(nominal, activity)| {
        among >> nominal & 1 == 1 && activity.ius.iter().any(|iu| iu.context == context)
    });
    if known { Reason::WrongOrder } else { Reason::WrongObject }
}
