//! One IU against the nominal IUs that it can be, while it goes on.

use crate::capacity::ACTIVITIES;
use crate::couple::Motion;
use crate::dtw::{LocalCosts, OnlineDtw, Refused};
use crate::job::{Job, NominalIu};
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

/// All nominal IUs that one IU can be.
#[derive(Clone, Debug)]
pub(super) struct Trials<'a> {
    trials: Vec<Trial<'a>, ACTIVITIES>,
    /// One for each trial, in their order, and spare ones. Made once: their rows are long.
    distances: Vec<OnlineDtw<'a>, ACTIVITIES>,
}

impl<'a> Trials<'a> {
    /// Room for as many trials as the job has nominal activities.
    ///
    /// # Errors
    /// If a reference cannot be compared.
    pub(super) fn new(job: &'a Job<'a>) -> Result<Self, Refused> {
        let costs = LocalCosts::new(job.cost);
        let mut distances = Vec::new();
        for iu in job.activities.iter().take(ACTIVITIES).filter_map(|activity| activity.ius.first()) {
            // As many as fit were taken.
            let _ = distances.push(OnlineDtw::new(&costs, iu.reference)?);
        }
        Ok(Self { trials: Vec::new(), distances })
    }

    pub(super) fn clear(&mut self) {
        self.trials.clear();
    }

    /// Adds a nominal IU. There is room for one of each nominal activity.
    pub(super) fn add(&mut self, nominal: usize, iu: &'a NominalIu<'a>) {
        if let Some(distance) = self.distances.get_mut(self.trials.len()) {
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
        let going_on = self.trials.iter().zip(&mut self.distances).filter(|(trial, _)| !trial.lost);
        going_on.map(|(_, distance)| distance).try_for_each(|distance| distance.append(motion))
    }

    /// Gives up the trials that cannot come out right any more, and says whether all are.
    pub(super) fn all_lost(&mut self, extent: Extent) -> bool {
        for (trial, distance) in self.trials.iter_mut().zip(&self.distances) {
            trial.lost |= outcome(trial, distance, extent).reason != Reason::None;
        }
        self.trials.iter().all(|trial| trial.lost)
    }

    /// How each trial came out.
    pub(super) fn outcomes(&self, extent: Extent) -> impl Iterator<Item = Outcome> {
        self.trials.iter().zip(&self.distances).map(move |(trial, distance)| outcome(trial, distance, extent))
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
fn outcome(trial: &Trial<'_>, dtw: &OnlineDtw<'_>, extent: Extent) -> Outcome {
    let NominalIu { threshold, frames, reversals, .. } = *trial.iu;
    let whole = dtw.distance().filter(|_| extent.ended && !trial.lost);
    let distance = whole.unwrap_or_else(|| dtw.lower_bound());
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
