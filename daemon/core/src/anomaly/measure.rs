//! Which measure of an IU is not right.

use super::comparison::Extent;
use crate::job::{Around, MeasureBounds, NominalIu, Range};
use crate::segment::Measures;
use crate::verdict::Reason;

/// How far a bound gives way, as a multiple of the share of the IU that was not seen: what was hidden may have been twice as fast as
/// the rest.
const GIVES_WAY: f32 = 2.0;

impl Extent {
    /// The rule that the length, the reversals or another measure breaks, or [`Reason::None`]; with `may_be_hidden` only if no motion in
    /// the frames that were not seen could have kept it. A path that was seen is never too long only because something else was not.
    pub(super) fn broken(&self, iu: &NominalIu<'_>, may_be_hidden: bool) -> Reason {
        let hidden = if may_be_hidden { self.hidden() } else { 0.0 };
        let [min_frames, max_frames] = if may_be_hidden { self.possible_frames() } else { [self.frames; 2] };
        let hidden_reversals = if may_be_hidden { self.possible_reversals() } else { 0 };
        let MeasureBounds { path_m, .. } = iu.measures;
        let speed = path_m.max.min(f32::MAX) / iu.frames.min.max(1) as f32;
        let hidden_m = hidden * self.frames as f32 * speed;
        let Measures { reversals, path_m: walked_m, .. } = self.measures;
        if min_frames > iu.frames.max || reversals > iu.reversals.max || walked_m > path_m.max {
            Reason::TooLong
        } else if self.ended
            && (max_frames < iu.frames.min
                || reversals.saturating_add(hidden_reversals) < iu.reversals.min
                || walked_m + hidden_m < path_m.min)
        {
            Reason::TooShort
        } else if self.ended && !self.is_elsewhere_right(&iu.measures, GIVES_WAY * hidden) {
            Reason::Motion
        } else {
            Reason::None
        }
    }

    /// Whether size, direction and place of the motion are right, if they may differ by `slack`, a share.
    fn is_elsewhere_right(&self, bounds: &MeasureBounds, slack: f32) -> bool {
        let measures = &self.measures;
        let is_in = |range: Range, value: f32| {
            value * (1.0 + slack) >= range.min && value <= range.max * (1.0 + slack)
        };
        measures.stroke_m.is_none_or(|stroke_m| is_in(bounds.stroke_m, stroke_m))
            && bounds.axis.has(measures.axis, slack)
            && bounds.place_m.has(measures.place_m, slack * measures.path_m)
    }
}

impl<const N: usize> Around<N> {
    fn has(&self, value: [f32; N], slack: f32) -> bool {
        let square: f32 =
            value.iter().zip(self.centre).map(|(value, centre)| (value - centre) * (value - centre)).sum();
        libm::sqrtf(square) <= self.max + slack
    }
}
