//! From the demonstrations of an IU to its barycentre and threshold.

use super::rule::ThresholdRule;
use super::statistics::{deviation, mean};
use crate::barycentre::Barycentres;
use crate::warp::Warp;
use andon_core::couple::Motion;
use andon_core::dtw::Refused;
use andon_core::job::allowance;

/// The distance a frame of a correct execution has from its reference, root of the mean square, where only one demonstration
/// is there to tell. On the simulated people of the development seeds 1 to 6 taught by one run, 0.9 accuses 11 of 18 correct
/// jobs of others, 1.2 none but 10 of 18 with a hesitation, 1.5 none; all flawed jobs are found by each (`simulate floor-measure`).
const ALONE_PER_FRAME: f64 = 1.5;

/// Least spread that is believed, as a share of the mean: the deviation of few demonstrations can be small by chance.
const LEAST_SPREAD: f64 = 0.2;

/// Squared local cost of a frame in the opposite direction, in both costs' own units: the diameter of the unit circle.
const OPPOSITE: f64 = 4.0;

/// What the demonstrations of one IU give.
#[derive(Clone, Debug, PartialEq)]
pub struct Learned {
    /// The DBA barycentre of all demonstrations.
    pub reference: Vec<Motion>,
    /// Distances of the demonstrations to it, in their order, each divided by its [`allowance`].
    pub own: Vec<f64>,
    /// Distances of each demonstration to the barycentre of the others; empty where there is but one.
    pub left_out: Vec<f64>,
}

/// Computes barycentre and distances. `slowness` is the job's.
///
/// # Errors
/// If there is no demonstration, or one is empty or longer than an IU may be.
pub fn learn(
    warp: &mut Warp,
    tables: &Barycentres,
    demonstrations: &[&[Motion]],
    leave_out: bool,
    slowness: f32,
) -> Result<Learned, Refused> {
    let distances = warp.matrix(demonstrations)?;
    let all: Vec<usize> = (0..demonstrations.len()).collect();
    let leave_out = leave_out && demonstrations.len() > 1;
    let (reference, others) = tables.with_left_out(warp, demonstrations, &distances, &all, leave_out)?;
    let mut to = |references: &[&[Motion]]| -> Result<Vec<f64>, Refused> {
        let one = |(motion, other): (&&[Motion], &&[Motion])| {
            let allowance = allowance(motion.len() as u32, other.len(), slowness);
            Ok(warp.distance(motion, other)? / f64::from(allowance))
        };
        demonstrations.iter().zip(references).map(one).collect()
    };
    let own = to(&vec![reference.as_slice(); demonstrations.len()])?;
    let left_out = to(&others.iter().map(Vec::as_slice).collect::<Vec<_>>())?;
    Ok(Learned { reference, own, left_out })
}

impl Learned {
    /// The threshold by a rule, for so many frames a second.
    pub fn threshold(&self, rule: ThresholdRule, rate_hz: f64) -> f64 {
        if self.own.len() == 1 {
            return ALONE_PER_FRAME * (self.reference.len() as f64).sqrt();
        }
        match rule {
            ThresholdRule::Paper { sigmas } => mean(&self.own) + sigmas * deviation(&self.own, 0),
            ThresholdRule::LeaveOneOut { sigmas, border_s } => {
                let centre = mean(&self.left_out);
                let spread = deviation(&self.left_out, 1).max(LEAST_SPREAD * centre);
                // Costs add up under the root.
                (centre + sigmas * spread).hypot((border_s * rate_hz * OPPOSITE).sqrt())
            }
            ThresholdRule::Conformal { false_alarms } => {
                let mut sorted = self.left_out.clone();
                sorted.sort_by(f64::total_cmp);
                let rank = ((sorted.len() + 1) as f64 * (1.0 - false_alarms)).ceil() as usize;
                sorted[rank.clamp(1, sorted.len()) - 1]
            }
        }
    }
}

/// The least share of false alarms that this many demonstrations can promise by rank.
pub fn least_promise(demonstrations: usize) -> f64 {
    1.0 / (demonstrations + 1) as f64
}
