//! Bounds of duration and of reversals. DTW stretches time, so by distance alone it forgives a motion that was cut short or never ends.

use crate::rule::BoundsRule;
use andon_core::capacity::IU_FRAMES;
use andon_core::couple::Context;
use andon_core::job::Bounds;

/// A motion with fewer reversals than this is not a repeated one, and may have none.
const MIN_REPEATED_REVERSALS: u32 = 3;

/// Number of reversals that noise may add.
const STRAY_REVERSALS: u32 = 3;

/// The bounds of a release state: it lasts until the hand comes back, at once or never.
const UNBOUNDED: Bounds = Bounds { min: 0, max: u32::MAX };

impl BoundsRule {
    /// Bounds of duration in frames of the grid, from the durations in frames of the demonstrations.
    pub(super) fn frames(&self, context: Context, rate_hz: f32, demonstrations: &[u32]) -> Bounds {
        if !context.is_touch() {
            return UNBOUNDED;
        }
        let (shortest, longest) = range(demonstrations);
        let pause = self.pause_s * f64::from(rate_hz);
        let max = (self.max_duration * f64::from(longest) + pause).ceil() as u32;
        Bounds {
            min: (self.min_duration * f64::from(shortest)).floor() as u32,
            max: max.min(IU_FRAMES as u32),
        }
    }

    /// Bounds of the number of reversals, from the numbers of reversals of the demonstrations.
    pub(super) fn reversals(&self, context: Context, demonstrations: &[u32]) -> Bounds {
        if !context.is_touch() {
            return UNBOUNDED;
        }
        let (fewest, most) = range(demonstrations);
        let is_repeated = fewest >= MIN_REPEATED_REVERSALS;
        let min = if is_repeated { (self.min_reversals * f64::from(fewest)).round() as u32 } else { 0 };
        let max = (self.max_reversals * f64::from(most.max(1))).ceil() as u32;
        Bounds { min, max: max.saturating_add(STRAY_REVERSALS) }
    }
}

/// The smallest and the largest of these values; 0 and 0 if there are none.
fn range(values: &[u32]) -> (u32, u32) {
    (values.iter().copied().min().unwrap_or_default(), values.iter().copied().max().unwrap_or_default())
}
