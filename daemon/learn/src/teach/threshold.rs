//! From the demonstrations of an IU to its barycentre and threshold.

use super::people::People;
use crate::barycentre::Barycentres;
use crate::rule::ThresholdRule;
use crate::statistics::{deviation, mean};
use crate::warp::Warp;
use andon_core::couple::Motion;
use andon_core::dtw::Refused;
use andon_core::job::slowdown_factor;

/// The root mean square, per frame, of the distance of a correct execution from its reference, used where a single demonstration gives no
/// spread. On the simulated people of the development seeds 1 to 6, taught by one run, 0.9 finds 11 of 18 correct jobs of other people
/// anomalous, 1.2 none of them but 10 of 18 with a hesitation, 1.5 none at all; each of the three finds all flawed jobs
/// (`simulate floor-measure`).
const SINGLE_DEMONSTRATION_PER_FRAME: f64 = 1.5;

/// Minimum spread, as a share of the mean: the deviation of a few demonstrations can be small by chance.
const MIN_SPREAD: f64 = 0.2;

/// Another person's distance is greater than that of whom the reference is from: the variance between people is about that between the runs
/// of one of them.
const OTHER_PEOPLE: f64 = std::f64::consts::SQRT_2;

/// Squared local cost of a frame in the opposite direction, under both costs: the square of the diameter of the unit circle.
const OPPOSITE: f64 = 4.0;

/// What was learned from the demonstrations of one IU.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Learned {
    /// The DBA barycentre of all demonstrations.
    pub(super) reference: Vec<Motion>,
    /// Distance of each demonstration to it, in their order, each divided by its [`slowdown_factor`].
    pub(super) own: Vec<f64>,
    /// The same distance of each demonstration to the barycentre of the others; empty if there is only one demonstration or if these
    /// distances were not asked for.
    pub(super) left_out: Vec<f64>,
}

/// Computes the barycentre and the distances. `leave_out` asks for the distances to the barycentres of the others; `max_slowdown` is the
/// job's.
///
/// # Errors
/// If there is no demonstration, or if one is empty or longer than an IU may be.
pub(super) fn learn(
    warp: &mut Warp,
    tables: &Barycentres,
    demonstrations: &[&[Motion]],
    leave_out: bool,
    max_slowdown: f32,
) -> Result<Learned, Refused> {
    let distances = warp.matrix(demonstrations)?;
    let all: Vec<usize> = (0..demonstrations.len()).collect();
    let leave_out = leave_out && demonstrations.len() > 1;
    let (reference, others) = tables.with_left_out(warp, demonstrations, &distances, &all, leave_out)?;
    let mut distances_to = |references: &[&[Motion]]| -> Result<Vec<f64>, Refused> {
        let distance = |(motion, reference): (&&[Motion], &&[Motion])| {
            let slowdown_factor = slowdown_factor(motion.len() as u32, reference.len(), max_slowdown);
            Ok(warp.distance(motion, reference)? / f64::from(slowdown_factor))
        };
        demonstrations.iter().zip(references).map(distance).collect()
    };
    let own = distances_to(&vec![reference.as_slice(); demonstrations.len()])?;
    let left_out = distances_to(&others.iter().map(Vec::as_slice).collect::<Vec<_>>())?;
    Ok(Learned { reference, own, left_out })
}

impl Learned {
    /// The threshold by a rule, as a DTW distance. `rate_hz` is the frame rate of the grid, `people` what the runs tell of those
    /// who showed them.
    pub(super) fn threshold(&self, rule: ThresholdRule, rate_hz: f64, people: &People) -> f64 {
        if self.own.len() == 1 {
            return SINGLE_DEMONSTRATION_PER_FRAME * (self.reference.len() as f64).sqrt();
        }
        match rule {
            ThresholdRule::Paper { sigmas } => mean(&self.own) + sigmas * deviation(&self.own, 0),
            ThresholdRule::LeaveOneOut { sigmas, border_s } => {
                let centre = mean(&self.left_out);
                let spread = deviation(&self.left_out, 1).max(MIN_SPREAD * centre);
                // Costs add up under the root.
                let of_others = people.variety * (1.0 + people.one_person * (OTHER_PEOPLE - 1.0));
                (of_others * (centre + sigmas * spread)).hypot((border_s * rate_hz * OPPOSITE).sqrt())
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

/// The smallest share of false alarms that this number of demonstrations can promise by rank.
pub(super) fn min_false_alarms(demonstrations: usize) -> f64 {
    1.0 / (demonstrations + 1) as f64
}
