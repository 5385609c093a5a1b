//! One IU against the nominal IUs that it can be, while it goes on.

use crate::capacity::ACTIVITIES;
use crate::couple::{Context, Motion};
use crate::dtw::{LocalCosts, OnlineDtw, Refused};
use crate::input::Side;
use crate::job::{Job, NominalActivity, NominalIu, allowance};
use crate::verdict::Reason;
use heapless::Vec;

/// One nominal IU that this one can be.
#[derive(Clone, Copy, Debug)]
struct Trial<'a> {
    /// The nominal activity, as its place in the job.
    nominal: usize,
    iu: &'a NominalIu<'a>,
    /// It cannot be this one any more; its distance is not followed further.
    lost: bool,
}

/// How one trial came out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outcome {
    /// The nominal activity, as its place in the job.
    pub(super) nominal: usize,
    /// The rule that is broken, or `None`.
    pub(super) reason: Reason,
    /// The DTW distance, or while the IU goes on a bound that it cannot fall under any more.
    pub(super) distance: f64,
    pub(super) threshold: f32,
}

impl Outcome {
    /// The distance as a multiple of the threshold: how near it is.
    pub(super) fn ratio(&self) -> f64 {
        let threshold = f64::from(self.threshold);
        match self.distance {
            0.0 => 0.0,
            distance if threshold > 0.0 => distance / threshold,
            _ => f64::INFINITY,
        }
    }
}

/// How long the IU is, and how often it turned back.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Extent {
    pub(super) frames: u32,
    pub(super) reversals: u32,
    /// The IU has ended.
    pub(super) ended: bool,
}

/// Where the distances of one hand's trials are kept: `heapless::Vec`, or where there is a heap `Vec`.
pub trait Memory<'a>: AsRef<[OnlineDtw<'a>]> + AsMut<[OnlineDtw<'a>]> + FromIterator<OnlineDtw<'a>> {}

impl<'a, M> Memory<'a> for M where
    M: AsRef<[OnlineDtw<'a>]> + AsMut<[OnlineDtw<'a>]> + FromIterator<OnlineDtw<'a>>
{
}

/// How many nominal activities of the job have an IU in the same context of this hand: the most trials it can have at once.
pub(super) fn needed(job: &Job<'_>, side: Side) -> usize {
    let contexts = job.activities.iter().flat_map(|nominal| nominal.ius).map(|iu| iu.context);
    let of_hand = contexts.filter(|context| context.0[0] == side as u16);
    let sharing = |context: Context| {
        let has = |nominal: &&NominalActivity<'_>| nominal.ius.iter().any(|iu| iu.context == context);
        job.activities.iter().filter(has).count()
    };
    of_hand.map(sharing).max().unwrap_or(0)
}

/// All nominal IUs that one IU can be.
#[derive(Clone, Debug)]
pub(super) struct Trials<'a, M> {
    trials: Vec<Trial<'a>, ACTIVITIES>,
    /// One for each trial, in their order, and spare ones. Made once: their rows are long.
    distances: M,
    /// [`Job::slowness`]
    slowness: f32,
}

impl<'a, M: Memory<'a>> Trials<'a, M> {
    /// Room for as many trials as this hand can have at once. The references have been checked.
    pub(super) fn new(job: &'a Job<'a>, side: Side) -> Self {
        let costs = LocalCosts::new(job.cost);
        let touch = job.activities.iter().flat_map(|nominal| nominal.ius).find(|iu| iu.context.is_touch());
        let spare = touch.and_then(|iu| OnlineDtw::new(&costs, iu.reference).ok());
        let distances = spare.iter().cycle().take(needed(job, side)).cloned().collect();
        Self { trials: Vec::new(), distances, slowness: job.slowness }
    }

    pub(super) fn clear(&mut self) {
        self.trials.clear();
    }

    /// Adds a nominal IU in the context of this one: there is room for one of each nominal activity that has it.
    pub(super) fn add(&mut self, nominal: usize, iu: &'a NominalIu<'a>) {
        if let Some(distance) = self.distances.as_mut().get_mut(self.trials.len()) {
            // Lengths were checked when the judge was made.
            if distance.begin(iu.reference).is_ok() {
                let _ = self.trials.push(Trial { nominal, iu, lost: false });
            }
        }
    }

    /// Takes the next motion.
    ///
    /// # Errors
    /// If the IU is longer than can be compared.
    pub(super) fn append(&mut self, motion: &Motion) -> Result<(), Refused> {
        let going_on = self.trials.iter().zip(self.distances.as_mut()).filter(|(trial, _)| !trial.lost);
        going_on.map(|(_, distance)| distance).try_for_each(|distance| distance.append(motion))
    }

    /// Gives up the trials that cannot come out right any more, and says whether all are.
    pub(super) fn all_lost(&mut self, extent: Extent) -> bool {
        let slowness = self.slowness;
        for (trial, distance) in self.trials.iter_mut().zip(self.distances.as_ref()) {
            trial.lost |= outcome(trial, distance, extent, slowness).reason != Reason::None;
        }
        self.trials.iter().all(|trial| trial.lost)
    }

    /// How each trial came out.
    pub(super) fn outcomes(&self, extent: Extent) -> impl Iterator<Item = Outcome> {
        self.trials
            .iter()
            .zip(self.distances.as_ref())
            .map(move |(trial, distance)| outcome(trial, distance, extent, self.slowness))
    }

    /// The nearest trial of those that came out right, or of all where none did.
    pub(super) fn nearest(&self, extent: Extent) -> Option<Outcome> {
        let key = |outcome: &Outcome| (outcome.reason != Reason::None, outcome.ratio());
        self.outcomes(extent).min_by(|one, other| {
            let ((wrong, ratio), (other_wrong, other_ratio)) = (key(one), key(other));
            wrong.cmp(&other_wrong).then(ratio.total_cmp(&other_ratio))
        })
    }
}

/// Bounds come before the distance: a motion that was cut short explains the distance, not the other way round.
fn outcome(trial: &Trial<'_>, dtw: &OnlineDtw<'_>, extent: Extent, slowness: f32) -> Outcome {
    let NominalIu { frames, reversals, reference, .. } = *trial.iu;
    let whole = dtw.distance().filter(|_| extent.ended && !trial.lost);
    let distance = whole.unwrap_or_else(|| dtw.lower_bound());
    // While the IU goes on it can still become the slowest that is right.
    let length = if extent.ended { extent.frames } else { frames.most };
    let threshold = trial.iu.threshold * allowance(length, reference.len(), slowness);
    let reason = if extent.frames > frames.most || extent.reversals > reversals.most {
        Reason::TooLong
    } else if extent.ended && (extent.frames < frames.least || extent.reversals < reversals.least) {
        Reason::TooShort
    } else if distance > f64::from(threshold) {
        Reason::Motion
    } else {
        Reason::None
    };
    Outcome { nominal: trial.nominal, reason, distance, threshold }
}
