//! Bounds of duration. DTW stretches time, so by distance alone it forgives a motion that was cut short or never ends.

use crate::rule::BoundsRule;
use andon_core::bounds::Bounds;
use andon_core::capacity::IU_FRAMES;
use andon_core::couple::Context;

/// The bounds of a release state: it lasts until the hand comes back, at once or never.
pub(super) const UNBOUNDED: Bounds = Bounds { min: 0, max: u32::MAX };

impl BoundsRule {
    /// Bounds of duration in frames of the grid, from the durations in frames of the demonstrations.
    pub(super) fn frames(&self, context: Context, rate_hz: f32, demonstrations: &[u32]) -> Bounds {
        if !context.is_touch() {
            return UNBOUNDED;
        }
        let shortest = demonstrations.iter().copied().min().unwrap_or_default();
        let longest = demonstrations.iter().copied().max().unwrap_or_default();
        let pause = self.pause_s * f64::from(rate_hz);
        let max = (self.max_duration * f64::from(longest) + pause).ceil() as u32;
        Bounds {
            min: (self.min_duration * f64::from(shortest)).floor() as u32,
            max: max.min(IU_FRAMES as u32),
        }
    }
}
