//! Bounds of duration and of reversals: what DTW forgives (DESIGN 4, "Unfinished and overdue").

use super::rule::BoundsRule;
use andon_core::capacity::IU_FRAMES;
use andon_core::couple::Context;
use andon_core::job::Bounds;

/// Under this many reversals a motion is not a repeated one, and may have none.
const REPEATED: u32 = 3;

/// Reversals that noise may add.
const STRAY_REVERSALS: u32 = 3;

impl Default for BoundsRule {
    fn default() -> Self {
        Self {
            // Half of a step is missing at 0.5; a person in a hurry takes 0.7 of the usual time.
            shortest: 0.55,
            // Half speed takes 2.
            longest: 2.5,
            pause_s: 3.0,
            // Half of the strokes are missing at 0.5; a stroke more or less is 0.83.
            fewest: 0.7,
            most: 1.5,
        }
    }
}

impl BoundsRule {
    /// Bounds nothing, as in the paper.
    pub const NONE: Self =
        Self { shortest: 0.0, longest: f64::MAX, pause_s: 0.0, fewest: 0.0, most: f64::MAX };

    /// Bounds of duration, in frames, from those of the demonstrations.
    pub fn frames(&self, context: Context, rate_hz: f32, demonstrations: &[u32]) -> Bounds {
        let (least, most) = ends(demonstrations);
        if context.0[0] == 0 {
            // No hand: it lasts until the hand comes back, at once or never.
            return Bounds { least: 0, most: u32::MAX };
        }
        let pause = self.pause_s * f64::from(rate_hz);
        let longest = (self.longest * f64::from(most) + pause).ceil() as u32;
        Bounds {
            least: (self.shortest * f64::from(least)).floor() as u32,
            most: longest.min(IU_FRAMES as u32),
        }
    }

    /// Bounds of reversals from those of the demonstrations.
    pub fn reversals(&self, context: Context, demonstrations: &[u32]) -> Bounds {
        let (least, most) = ends(demonstrations);
        if context.0[0] == 0 {
            return Bounds { least: 0, most: u32::MAX };
        }
        let fewest = if least < REPEATED { 0 } else { (self.fewest * f64::from(least)).round() as u32 };
        let most = (self.most * f64::from(most.max(1))).ceil() as u32;
        Bounds { least: fewest, most: most.saturating_add(STRAY_REVERSALS) }
    }
}

fn ends(values: &[u32]) -> (u32, u32) {
    (values.iter().copied().min().unwrap_or_default(), values.iter().copied().max().unwrap_or_default())
}
