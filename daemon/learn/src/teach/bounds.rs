//! The maximum of the duration. DTW stretches time, so by distance alone it forgives a motion that never ends.
//!
//! At another part without strokes the duration has a prediction interval, and 3 s above it for a pause. With strokes it has a minimum that
//! only three times the speed falls short of. On the way it has no minimum: what was taken was taken. Of 15 runs in which a real person
//! stops for 8 s none was found without the maximum, and all are with it.

use super::sequence::ShownIu;
use crate::rule::BoundsRule;
use andon_core::bounds::Bounds;
use andon_core::capacity::IU_FRAMES;

/// The bounds of a release state: it lasts until the hand comes back, at once or never.
pub(super) const UNBOUNDED: Bounds = Bounds { min: 0, max: u32::MAX };

impl BoundsRule {
    /// The maximum duration of an IU in frames of the grid, from `likely_max`, or else from the durations of the demonstrations. Who
    /// differs `variety` times as much from others as people in general does so in the logarithm of the duration.
    pub(super) fn max_frames(
        &self,
        iu: &ShownIu,
        rate_hz: f32,
        variety: f64,
        likely_max: Option<f64>,
    ) -> u32 {
        if !iu.context.is_touch() {
            return UNBOUNDED.max;
        }
        let longest = iu.frames.iter().copied().max().unwrap_or_default();
        let pause = self.pause_s * f64::from(rate_hz);
        let max = self.max_duration.powf(variety) * f64::from(longest);
        let max = likely_max.filter(|_| max.is_finite()).unwrap_or(max);
        ((max + pause).ceil() as u32).min(IU_FRAMES as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_core::couple::Context;

    #[test]
    fn people_who_differ_more_may_be_slower() {
        let rule = BoundsRule { max_duration: 2.0, pause_s: 1.0, ..BoundsRule::NONE };
        let iu = ShownIu::measuring(Context([1, 5, 0, 0]), &[], &[40, 48]);
        let frames = |variety| rule.max_frames(&iu, 30.0, variety, None);
        assert_eq!([frames(1.0), frames(2.0)], [126, 222]);
    }
}
