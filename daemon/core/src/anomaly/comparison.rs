//! The comparisons of an open IU with nominal IUs.
//!
//! With free ends a rest stands before and after each motion and each reference. Half a second of rest at a part would else differ as much as a
//! motion in the wrong direction. Of 15 runs at half the speed, judged by another person's job, 12 were right without it and 14 are.
//!
//! An IU of two parts may then have ended in one of the five frames before its last: the nearest of these six counts. Of 144 jobs of
//! `learn_two_hands.rs` (`Workshop`) 139 are right without this and 141 with it.

use super::observation::IuObservation;
use crate::capacity::ACTIVITIES;
use crate::couple::{Context, Motion};
use crate::dtw::{LocalCosts, OnlineDtw, Refused};
use crate::job::{Job, NominalIu, slowdown_factor};
use crate::segment::HIDDEN_SLACK;
use crate::verdict::{Measure, Measured, Reason};
use heapless::Vec;

/// Where the other hand ends the contact of two parts, this one may go on while they are still near enough for it. That takes as many frames as a
/// change takes to be believed by default.
const BORDER_FRAMES: usize = 5;

/// The comparison of the open IU with one nominal IU.
#[derive(Clone, Copy, Debug)]
struct Comparison<'a> {
    /// The indices of the nominal activity in the job, and of the IU in it.
    nominal: usize,
    index: usize,
    iu: &'a NominalIu<'a>,
    /// The IU cannot be this one any more, so its distance is not computed further.
    is_lost: bool,
    /// The distances in the newest frame and in those before it, newest first; infinite where there was none.
    newest: [f64; 1 + BORDER_FRAMES],
}

/// The result of a comparison, so far or at the end of the IU.
#[derive(Clone, Copy, Debug)]
pub(super) struct ComparisonResult {
    /// The indices of the nominal activity in the job, and of the IU in it.
    pub(super) nominal: usize,
    pub(super) index: usize,
    /// The rule that is broken, or [`Reason::None`].
    pub(super) reason: Reason,
    /// The DTW distance, or a lower bound of it while the IU is open.
    pub(super) distance: f64,
    pub(super) threshold: f32,
    /// The measure that breaks it, if one does.
    pub(super) measured: Option<Measured>,
    /// The rule may be broken only because something was not seen.
    pub(super) is_doubtful: bool,
}

impl ComparisonResult {
    /// A rule is broken, whatever was not seen.
    pub(super) fn is_certainly_wrong(&self) -> bool {
        self.reason != Reason::None && !self.is_doubtful
    }

    /// The distance as a multiple of the threshold: a measure of how near the IU is.
    pub(super) fn ratio(&self) -> f64 {
        let threshold = f64::from(self.threshold);
        match self.distance {
            0.0 => 0.0,
            distance if threshold > 0.0 => distance / threshold,
            _ => f64::INFINITY,
        }
    }
}

/// The memory for the distances of one hand's comparisons: `heapless::Vec`, or `Vec` where there is a heap.
pub trait Memory<'a>: AsRef<[OnlineDtw<'a>]> + AsMut<[OnlineDtw<'a>]> + FromIterator<OnlineDtw<'a>> {}

impl<'a, M> Memory<'a> for M where
    M: AsRef<[OnlineDtw<'a>]> + AsMut<[OnlineDtw<'a>]> + FromIterator<OnlineDtw<'a>>
{
}

/// The maximum number of comparisons of a hand at once: how many nominal IUs have the same context. Either hand may do what was shown.
pub(super) fn needed(job: &Job<'_>) -> usize {
    let contexts = || job.activities.iter().flat_map(|nominal| nominal.ius).map(|iu| iu.context);
    let touches = contexts().filter(|context| context.is_touch());
    let sharing = |context: Context| contexts().filter(|other| *other == context).count();
    touches.map(sharing).max().unwrap_or(0).min(ACTIVITIES)
}

/// The comparisons of the open IU with all nominal IUs that it can be.
#[derive(Clone, Debug)]
pub(super) struct Comparisons<'a, M> {
    comparisons: Vec<Comparison<'a>, ACTIVITIES>,
    /// One for each comparison in the same order, then unused ones. They are made once, because their rows are long.
    distances: M,
    job: &'a Job<'a>,
    /// The frame rate of the grid.
    rate_hz: f32,
}

impl<'a, M: Memory<'a>> Comparisons<'a, M> {
    /// Makes room for as many comparisons as a hand can have at the same time. The references have been checked.
    pub(super) fn new(job: &'a Job<'a>, rate_hz: f32) -> Self {
        let costs = LocalCosts::new(job.cost);
        let touch = job.activities.iter().flat_map(|nominal| nominal.ius).find(|iu| iu.context.is_touch());
        let spare = touch.and_then(|iu| OnlineDtw::new(&costs, iu.reference).ok());
        let distances = spare.iter().cycle().take(needed(job)).cloned().collect();
        Self { comparisons: Vec::new(), distances, job, rate_hz }
    }

    pub(super) fn clear(&mut self) {
        self.comparisons.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.comparisons.is_empty()
    }

    /// Whether the two parts of the open IU were shown to be at rest beside each other.
    pub(super) fn were_shown_at_rest(&self) -> bool {
        let rests = |comparison: &Comparison<'_>| {
            let (reference, ends) = (comparison.iu.reference, usize::from(self.job.has_free_ends));
            let shown = reference.get(ends..reference.len().saturating_sub(ends));
            shown.is_some_and(|shown| shown.iter().any(Motion::is_pair_at_rest))
        };
        !self.comparisons.is_empty() && self.comparisons.iter().all(rests)
    }

    /// Whether the open IU is not seen to have moved what every first IU that it can be was shown to move.
    pub(super) fn has_moved_nothing(&self, observation: IuObservation) -> bool {
        let moves = |comparison: &Comparison<'_>| comparison.iu.measures.path_m.min > 0.0;
        let mut first = self.comparisons.iter().filter(|comparison| comparison.index == 0).peekable();
        observation.measures.path_m == 0.0 && first.peek().is_some() && first.all(moves)
    }

    /// Adds a nominal IU that has the context of the open one. There is room for all.
    pub(super) fn add(&mut self, nominal: usize, index: usize) {
        let iu = &self.job.activities[nominal].ius[index];
        if let Some(distance) = self.distances.as_mut().get_mut(self.comparisons.len()) {
            // The lengths were checked when the judge was made, so this does not fail.
            if distance.begin(iu.reference).is_ok() {
                // There is room for a first frame.
                if self.job.has_free_ends {
                    let _ = distance.append(&Motion::at_rest(iu.context));
                }
                let newest = [f64::INFINITY; 1 + BORDER_FRAMES];
                let _ = self.comparisons.push(Comparison { nominal, index, iu, is_lost: false, newest });
            }
        }
    }

    /// Takes the next motion, unless the IU is too long to be compared.
    pub(super) fn append(&mut self, motion: &Motion) -> Result<(), Refused> {
        let has_free_ends = self.job.has_free_ends;
        for (comparison, distance) in self.open() {
            distance.append(motion)?;
            if has_free_ends && comparison.iu.context.is_pair() {
                comparison.newest.rotate_right(1);
                comparison.newest[0] = distance.distance().unwrap_or(f64::INFINITY);
            }
        }
        Ok(())
    }

    /// The IU has ended; else as [`append`](Self::append).
    pub(super) fn end(&mut self) -> Result<(), Refused> {
        let Some(one) = self.comparisons.first().filter(|_| self.job.has_free_ends) else { return Ok(()) };
        let rest = Motion::at_rest(one.iu.context);
        self.open().try_for_each(|(_, distance)| distance.append(&rest))
    }

    /// Takes any number of frames of which nothing is known.
    pub(super) fn append_unknown(&mut self) {
        for (comparison, distance) in self.open() {
            comparison.newest = [f64::INFINITY; 1 + BORDER_FRAMES];
            distance.append_unknown();
        }
    }

    /// Those that are not lost.
    fn open(&mut self) -> impl Iterator<Item = (&mut Comparison<'a>, &mut OnlineDtw<'a>)> {
        let all = self.comparisons.iter_mut().zip(self.distances.as_mut());
        all.filter(|(comparison, _)| !comparison.is_lost)
    }

    /// Marks the comparisons that cannot come out right any more as lost. Returns whether all are.
    pub(super) fn all_lost(&mut self, observation: IuObservation) -> bool {
        for number in 0..self.comparisons.len() {
            self.comparisons[number].is_lost |= self.result(number, observation).reason != Reason::None;
        }
        self.comparisons.iter().all(|comparison| comparison.is_lost)
    }

    pub(super) fn results(&self, observation: IuObservation) -> impl Iterator<Item = ComparisonResult> {
        (0..self.comparisons.len()).map(move |number| self.result(number, observation))
    }

    /// The nearest result of those that are right, or of all if none is.
    pub(super) fn nearest(&self, observation: IuObservation) -> Option<ComparisonResult> {
        self.results(observation).min_by(|one, other| {
            let is_wrong = |result: &ComparisonResult| result.reason != Reason::None;
            is_wrong(one).cmp(&is_wrong(other)).then(one.ratio().total_cmp(&other.ratio()))
        })
    }

    /// Bounds come before the distance: that a motion was cut short explains its distance, not the other way round.
    fn result(&self, number: usize, observation: IuObservation) -> ComparisonResult {
        let (comparison, dtw, job) = (&self.comparisons[number], &self.distances.as_ref()[number], self.job);
        let NominalIu { frames, reference, threshold, .. } = *comparison.iu;
        let whole = dtw.distance().filter(|_| observation.ended && !comparison.is_lost);
        let distance = whole.unwrap_or_else(|| dtw.lower_bound());
        let distance = comparison.newest.into_iter().skip(1).fold(distance, f64::min);
        // An open IU may still become as slow as the bounds allow.
        let length = if observation.ended { observation.worked_frames() } else { frames.max };
        let length = length.saturating_add(2 * u32::from(job.has_free_ends));
        let threshold = threshold * slowdown_factor(length, reference.len(), job.max_slowdown);
        let reason_of = |broken: Option<(Reason, Measure)>, threshold: f32| match broken {
            Some((reason, _)) => reason,
            None if distance > f64::from(threshold) => Reason::Motion,
            None => Reason::None,
        };
        // In frames that were not seen, and beside them, motion is measured worse.
        let assumed = observation.assumed as f32 / observation.frames.max(1) as f32;
        let max = threshold * (1.0 + HIDDEN_SLACK * assumed);
        let possible = observation.broken(comparison.iu, true);
        // What is right only if something happened unseen is neither right nor wrong.
        let is_certain = reason_of(possible, max) != Reason::None;
        let (broken, max) =
            if is_certain { (possible, max) } else { (observation.broken(comparison.iu, false), threshold) };
        let reason = reason_of(broken, max);
        let Comparison { nominal, index, iu, .. } = *comparison;
        let ius = job.activities[nominal].ius;
        // An activity of one IU may come again behind it.
        let is_unique = ius.len() > 1 && ius.iter().filter(|other| other.context == iu.context).count() == 1;
        let is_doubtful = !is_certain && reason != Reason::None || observation.explains(reason, is_unique);
        let measured = broken.and_then(|broken| observation.measured(iu, broken, self.rate_hz));
        ComparisonResult { nominal, index, reason, distance, threshold, measured, is_doubtful }
    }
}
