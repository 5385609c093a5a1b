//! The comparisons of an open IU with nominal IUs.

use super::measure::GIVES_WAY;
use crate::capacity::ACTIVITIES;
use crate::couple::{Context, Motion};
use crate::dtw::{LocalCosts, OnlineDtw, Refused};
use crate::job::{Job, NominalActivity, NominalIu, slowdown_factor};
use crate::segment::{FRAMES_PER_REVERSAL, Measures};
use crate::verdict::{Measure, Measured, Reason};
use heapless::Vec;

/// The comparison of the open IU with one nominal IU.
#[derive(Clone, Copy, Debug)]
struct Comparison<'a> {
    /// Index of the nominal activity in the job.
    nominal: usize,
    iu: &'a NominalIu<'a>,
    /// No other IU of the nominal activity has the same context.
    is_unique: bool,
    /// The IU cannot be this one any more, so its distance is not computed further.
    is_lost: bool,
}

/// The result of a comparison, so far or at the end of the IU.
#[derive(Clone, Copy, Debug)]
pub(super) struct ComparisonResult {
    /// Index of the nominal activity in the job.
    pub(super) nominal: usize,
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

/// How long the IU is, what it measures, and what was not seen of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Extent {
    pub(super) frames: u32,
    /// In how many frames its motion was measured.
    pub(super) measured: u32,
    /// In how many frames a part of it was not seen, even where it was assumed.
    pub(super) assumed: u32,
    pub(super) measures: Measures,
    /// Whether the IU has ended.
    pub(super) ended: bool,
    /// It may have begun as many frames earlier.
    pub(super) gap_before: u32,
    /// It may have ended as many frames earlier.
    pub(super) gap_after: u32,
    /// Its beginning or its end may be that of another stretch: the IU may be a part of one.
    pub(super) may_be_part: bool,
    /// What was not seen of it may have been something else.
    pub(super) is_doubtful: bool,
}

/// The ends of an IU: its beginning and its end.
const ENDS: u32 = 2;

/// The share of an IU up to which what was hidden in it is assumed to have gone on like the rest. Short gaps hide no reversal, so beyond it
/// half of the strokes could seem to be all of them.
const MAX_ASSUMED: f32 = 0.25;

impl Extent {
    /// The minimum and the maximum number of frames that the IU may have. A frame that was not seen may shift either end by one.
    pub(super) fn possible_frames(&self) -> [u32; 2] {
        let shift = self.assumed.min(ENDS);
        [
            self.frames.saturating_sub(self.gap_after.saturating_add(shift)),
            self.frames.saturating_add(self.gap_before).saturating_add(shift),
        ]
    }

    /// How often the motion may have reversed in addition, in frames that were not seen, in a row or one by one.
    pub(super) fn possible_reversals(&self) -> u32 {
        let scattered = (self.measures.hidden * self.frames as f32) as u32 / FRAMES_PER_REVERSAL;
        let hidden = self.measures.hidden_reversals.max(scattered);
        hidden.max(self.measures.cut_reversals).saturating_add(self.gap_before / FRAMES_PER_REVERSAL)
    }

    /// How many reversals were hidden within the IU if the hand went on at the pace at which it was seen; none where so much was hidden that
    /// this is not known. What happened before it or after it is not known.
    pub(super) fn assumed_reversals(&self) -> u32 {
        let hidden = self.measures.hidden;
        if hidden > MAX_ASSUMED {
            return 0;
        }
        let assumed = self.measures.reversals as f32 * hidden / (1.0 - hidden);
        (libm::roundf(assumed) as u32).min(self.measures.hidden_reversals)
    }

    /// In how much of the IU something may have happened that was not seen, as a share of its frames; more than 1 if most of it lies in
    /// a gap.
    pub(super) fn hidden(&self) -> f32 {
        let gaps = self.gap_before.saturating_add(self.gap_after);
        self.measures.hidden + gaps as f32 / self.frames.max(1) as f32
    }

    /// Whether so much of the IU was measured that it can be right.
    pub(super) fn is_known(&self) -> bool {
        2 * self.measured >= self.frames
    }

    /// Whether what was not seen may explain this reason. A part of an IU may be too short, or another motion. What was hidden in the
    /// middle was counted as if it were right; but two IUs in the same context may seem to be one if the one between them was hidden.
    fn explains(&self, reason: Reason, is_unique: bool) -> bool {
        match reason {
            Reason::None => false,
            Reason::TooShort => self.may_be_part,
            _ => self.may_be_part || self.is_doubtful && !is_unique,
        }
    }
}

/// The memory for the distances of one hand's comparisons: `heapless::Vec`, or `Vec` where there is a heap.
pub trait Memory<'a>: AsRef<[OnlineDtw<'a>]> + AsMut<[OnlineDtw<'a>]> + FromIterator<OnlineDtw<'a>> {}

impl<'a, M> Memory<'a> for M where
    M: AsRef<[OnlineDtw<'a>]> + AsMut<[OnlineDtw<'a>]> + FromIterator<OnlineDtw<'a>>
{
}

/// The maximum number of comparisons of a hand at the same time: how many nominal activities of the job have an IU in the same
/// context. Either hand may do what the other one was shown to do.
pub(super) fn needed(job: &Job<'_>) -> usize {
    let contexts = job.activities.iter().flat_map(|nominal| nominal.ius).map(|iu| iu.context);
    let touches = contexts.filter(|context| context.is_touch());
    let sharing = |context: Context| {
        let has = |nominal: &&NominalActivity<'_>| nominal.ius.iter().any(|iu| iu.context == context);
        job.activities.iter().filter(has).count()
    };
    touches.map(sharing).max().unwrap_or(0)
}

/// The comparisons of the open IU with all nominal IUs that it can be.
#[derive(Clone, Debug)]
pub(super) struct Comparisons<'a, M> {
    comparisons: Vec<Comparison<'a>, ACTIVITIES>,
    /// One for each comparison in the same order, then unused ones. They are made once, because their rows are long.
    distances: M,
    /// [`Job::max_slowdown`].
    max_slowdown: f32,
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
        Self { comparisons: Vec::new(), distances, max_slowdown: job.max_slowdown, rate_hz }
    }

    pub(super) fn clear(&mut self) {
        self.comparisons.clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.comparisons.is_empty()
    }

    /// Whether the two parts of the open IU were shown to be at rest beside each other.
    pub(super) fn were_shown_at_rest(&self) -> bool {
        let rests = |comparison: &Comparison<'_>| comparison.iu.reference.iter().any(Motion::is_pair_at_rest);
        !self.comparisons.is_empty() && self.comparisons.iter().all(rests)
    }

    /// Adds a nominal IU that has the context of the open one. There is room for one of each nominal activity.
    pub(super) fn add(&mut self, job: &'a Job<'a>, nominal: usize, index: usize) {
        let ius = job.activities[nominal].ius;
        let iu = &ius[index];
        let is_unique = ius.iter().filter(|other| other.context == iu.context).count() == 1;
        if let Some(distance) = self.distances.as_mut().get_mut(self.comparisons.len()) {
            // The lengths were checked when the judge was made, so this does not fail.
            if distance.begin(iu.reference).is_ok() {
                let _ = self.comparisons.push(Comparison { nominal, iu, is_unique, is_lost: false });
            }
        }
    }

    /// Takes the next motion.
    ///
    /// # Errors
    /// If the IU is too long to be compared.
    pub(super) fn append(&mut self, motion: &Motion) -> Result<(), Refused> {
        let open = self
            .comparisons
            .iter()
            .zip(self.distances.as_mut())
            .filter(|(comparison, _)| !comparison.is_lost);
        open.map(|(_, distance)| distance).try_for_each(|distance| distance.append(motion))
    }

    /// Takes any number of frames of which nothing is known.
    pub(super) fn append_unknown(&mut self) {
        let open = self.comparisons.iter().zip(self.distances.as_mut());
        open.filter(|(comparison, _)| !comparison.is_lost)
            .for_each(|(_, distance)| distance.append_unknown());
    }

    /// Marks the comparisons that cannot come out right any more as lost. Returns whether all are.
    pub(super) fn all_lost(&mut self, extent: Extent) -> bool {
        let scale = (self.max_slowdown, self.rate_hz);
        for (comparison, distance) in self.comparisons.iter_mut().zip(self.distances.as_ref()) {
            comparison.is_lost |= result(comparison, distance, extent, scale).reason != Reason::None;
        }
        self.comparisons.iter().all(|comparison| comparison.is_lost)
    }

    /// The results of all comparisons.
    pub(super) fn results(&self, extent: Extent) -> impl Iterator<Item = ComparisonResult> {
        let scale = (self.max_slowdown, self.rate_hz);
        self.comparisons
            .iter()
            .zip(self.distances.as_ref())
            .map(move |(comparison, distance)| result(comparison, distance, extent, scale))
    }

    /// The nearest result of those that are right, or of all if none is.
    pub(super) fn nearest(&self, extent: Extent) -> Option<ComparisonResult> {
        self.results(extent).min_by(|one, other| {
            let is_wrong = |result: &ComparisonResult| result.reason != Reason::None;
            is_wrong(one).cmp(&is_wrong(other)).then(one.ratio().total_cmp(&other.ratio()))
        })
    }
}

/// Bounds come before the distance: that a motion was cut short explains its distance, not the other way round.
fn result(
    comparison: &Comparison<'_>,
    dtw: &OnlineDtw<'_>,
    extent: Extent,
    (max_slowdown, rate_hz): (f32, f32),
) -> ComparisonResult {
    let NominalIu { frames, reference, threshold, .. } = *comparison.iu;
    let whole = dtw.distance().filter(|_| extent.ended && !comparison.is_lost);
    let distance = whole.unwrap_or_else(|| dtw.lower_bound());
    // An open IU may still become as slow as the bounds allow.
    let length = if extent.ended { extent.frames } else { frames.max };
    let threshold = threshold * slowdown_factor(length, reference.len(), max_slowdown);
    let reason_of = |broken: Option<(Reason, Measure)>, threshold: f32| match broken {
        Some((reason, _)) => reason,
        None if distance > f64::from(threshold) => Reason::Motion,
        None => Reason::None,
    };
    // In frames that were not seen, and beside them, motion is measured worse.
    let assumed = extent.assumed as f32 / extent.frames.max(1) as f32;
    let max = threshold * (1.0 + GIVES_WAY * assumed);
    let possible = extent.broken(comparison.iu, true);
    // What is right only if something happened unseen is neither right nor wrong.
    let is_certain = reason_of(possible, max) != Reason::None;
    let (broken, max) =
        if is_certain { (possible, max) } else { (extent.broken(comparison.iu, false), threshold) };
    let reason = reason_of(broken, max);
    let is_doubtful = !is_certain && reason != Reason::None || extent.explains(reason, comparison.is_unique);
    let measured = broken.and_then(|(_, measure)| extent.measured(comparison.iu, measure, rate_hz));
    ComparisonResult { nominal: comparison.nominal, reason, distance, threshold, measured, is_doubtful }
}
