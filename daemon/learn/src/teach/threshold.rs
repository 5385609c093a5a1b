//! From the demonstrations of an IU to its barycentre and threshold.
//!
//! The threshold is the mean distance and four standard deviations, and as much as the borders of an IU may shift. Three to five runs show
//! their deviation badly, so it is pooled with what it is in general, 0.3 of the mean. Of 327 and 330 right runs of motion capture 7 and 8
//! were accused with their own deviation. With the pooled one 4 and 1 are.
//!
//! The slack at the borders is in seconds, because where a contact begins has to do with time, whatever the rate of the camera.

use super::options::TeachOptions;
use super::people::People;
use super::strength::Strength;
use crate::barycentre::Barycentres;
use crate::rule::ThresholdRule;
use crate::run::Iu;
use crate::statistics::{deviation, mean, variance_of_one_more};
use crate::warp::Warp;
use andon_core::couple::Motion;
use andon_core::dtw::Refused;
use andon_core::job::{LocalCost, slowdown_factor};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::f64::consts::SQRT_2;

/// The root mean square, per frame, of the distance of a correct execution from its reference, used where a single demonstration gives no spread. It
/// was measured on the simulated people of the development seeds 1 to 6, taught by one run. 0.9 finds 11 of 18 correct jobs of other people
/// anomalous. 1.2 finds none of them but 10 of 18 with a hesitation, and 1.5 none at all. Each of the three finds all flawed jobs (`simulate
/// floor-measure`).
const SINGLE_DEMONSTRATION_PER_FRAME: f64 = 1.5;

/// How the distances of the demonstrations of an IU differ in general, as a share of their mean. It was 0.28 on average in jobs that three to
/// five runs of one real person taught, 0.29 to 0.48 with simulated people.
const PRIOR_SPREAD: f64 = 0.3;

/// What was learned from the demonstrations of one IU.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Learned {
    pub(super) reference: Vec<Motion>,
    /// The number of frames of each demonstration, in their order.
    frames: Vec<u32>,
    /// The DTW distance of each demonstration to the barycentre.
    pub(super) own: Vec<f64>,
    /// The DTW distance of each demonstration to the barycentre of the others; empty if there is only one demonstration.
    pub(super) left_out: Vec<f64>,
}

/// Computes the barycentre and the distances.
///
/// # Errors
/// If there is no demonstration, or if one is empty or longer than an IU may be.
pub(super) fn learn(
    warp: &mut Warp,
    tables: &Barycentres,
    demonstrations: &[&[Motion]],
) -> Result<Learned, Refused> {
    let distances = warp.matrix(demonstrations)?;
    let all: Vec<usize> = (0..demonstrations.len()).collect();
    let leave_out = demonstrations.len() > 1;
    let (reference, others) = tables.with_left_out(warp, demonstrations, &distances, &all, leave_out)?;
    let mut distances_to = |references: &[&[Motion]]| -> Result<Vec<f64>, Refused> {
        demonstrations
            .iter()
            .zip(references)
            .map(|(motion, reference)| warp.distance(motion, reference))
            .collect()
    };
    let own = distances_to(&vec![reference.as_slice(); demonstrations.len()])?;
    let left_out = distances_to(&others.iter().map(Vec::as_slice).collect::<Vec<_>>())?;
    let frames = demonstrations.iter().map(|motion| motion.len() as u32).collect();
    Ok(Learned { reference, frames, own, left_out })
}

/// The motion of an IU as it is compared: with free ends, at rest before and after what the hand does. Release states have none.
pub(super) fn compared<'a>(iu: &'a Iu, options: &TeachOptions) -> Cow<'a, [Motion]> {
    if options.has_free_ends && iu.context.is_touch() {
        let rest = [Motion::at_rest(iu.context)];
        Cow::Owned([&rest, iu.motion.as_slice(), &rest].concat())
    } else {
        Cow::Borrowed(&iu.motion)
    }
}

/// What was learned from the same runs under the same local cost, to teach them with other rules.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    /// The local cost, and whether motions have free ends.
    rules: Option<(LocalCost, bool)>,
    /// By the number of the nominal sequence and that of the IU in it.
    learned: BTreeMap<(usize, usize), Learned>,
}

impl Memory {
    /// Forgets what was learned under another local cost, or with other ends of motions.
    pub(super) fn prepare(&mut self, cost: LocalCost, has_free_ends: bool) {
        let rules = (cost, has_free_ends);
        if self.rules.replace(rules) != Some(rules) {
            self.learned.clear();
        }
    }

    /// What was learned of this IU, or what is learned now.
    ///
    /// # Errors
    /// What `learn` fails with.
    pub(super) fn recall(
        &mut self,
        iu: (usize, usize),
        learn: impl FnOnce() -> Result<Learned, Refused>,
    ) -> Result<&Learned, Refused> {
        Ok(match self.learned.entry(iu) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(unknown) => unknown.insert(learn()?),
        })
    }
}

impl Learned {
    /// With each distance divided by its [`slowdown_factor`]. `max_slowdown` is the job's. Without `leave_out`, the distances to the barycentres
    /// of the others are not used.
    pub(super) fn slowed(&self, max_slowdown: f32, leave_out: bool) -> Self {
        let slow = |distances: &[f64]| {
            let slow = |(distance, frames): (&f64, &u32)| {
                distance / f64::from(slowdown_factor(*frames, self.reference.len(), max_slowdown))
            };
            distances.iter().zip(&self.frames).map(slow).collect()
        };
        let left_out = if leave_out { slow(&self.left_out) } else { Vec::new() };
        Self { own: slow(&self.own), left_out, ..self.clone() }
    }

    pub(super) fn distances(&self) -> &[f64] {
        if self.left_out.is_empty() { &self.own } else { &self.left_out }
    }

    /// The threshold by a rule, as a DTW distance. `rate_hz` is the frame rate of the grid, `people` what the runs tell of those
    /// who showed them.
    pub(super) fn threshold(
        &self,
        rule: ThresholdRule,
        rate_hz: f64,
        people: &People,
        strength: Strength,
    ) -> f64 {
        if strength == Strength::NONE {
            return f64::from(f32::MAX);
        }
        if self.own.len() == 1 {
            return SINGLE_DEMONSTRATION_PER_FRAME * (self.reference.len() as f64).sqrt();
        }
        match rule {
            ThresholdRule::Paper { sigmas } => mean(&self.own) + sigmas * deviation(&self.own, 0),
            ThresholdRule::LeaveOneOut { sigmas, border_s } => {
                let centre = mean(&self.left_out);
                let spread = variance_of_one_more(&self.left_out, (PRIOR_SPREAD * centre).powi(2)).sqrt();
                let apart = strength.wider() * sigmas * spread;
                // The variance between people is about that between the runs of the one whom the reference is from.
                let of_others = people.variety * (1.0 + people.one_person * (SQRT_2 - 1.0));
                // Costs add up under the root, and that of a frame in the opposite direction is 2.
                (of_others * (centre + apart)).hypot((border_s * rate_hz * 4.0).sqrt())
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
pub(super) fn min_false_alarms(demonstrations: u32) -> f64 {
    1.0 / f64::from(demonstrations + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_demonstrations_that_are_alike_by_chance_leave_others_as_much_room_as_people_need() {
        let learned = |left_out: &[f64]| Learned {
            reference: Vec::new(),
            frames: Vec::new(),
            own: left_out.to_vec(),
            left_out: left_out.to_vec(),
        };
        let rule = ThresholdRule::LeaveOneOut { sigmas: 4.0, border_s: 0.0 };
        let of = |left_out: &[f64]| {
            learned(left_out).threshold(rule, 30.0, &People::IN_GENERAL, Strength::GENERAL)
        };
        // The root of 16 / 18 of 0.3 squared, and a third more for the mean of three.
        let spread = 0.3 * (16.0_f64 / 18.0 * 4.0 / 3.0).sqrt();
        assert!((of(&[2.0; 3]) - 2.0 * (1.0 + 4.0 * spread)).abs() < 1e-9);
        // Many show that they are alike, or that they are not.
        assert!(of(&[2.0; 40]) < of(&[2.0; 3]));
        assert!(of(&[1.0, 3.0].repeat(20)) > of(&[2.0; 3]));
    }
}
