//! What is known of an IU so far, and what of it may have happened unseen.

use crate::segment::{FRAMES_PER_REVERSAL, Measures};
use crate::verdict::Reason;

/// How far a bound gives way, as a multiple of the share of the IU that was not seen: what was hidden may have been twice as fast as
/// the rest.
pub(super) const HIDDEN_SLACK: f32 = 2.0;

/// How long the IU is, what it measures, and what was not seen of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct IuObservation {
    pub(super) frames: u32,
    /// In how many of them the hand waited for the other one.
    pub(super) waited: u32,
    /// In how many it may have, because either hand was not seen.
    pub(super) may_have_waited: u32,
    /// In how many frames its motion was measured.
    pub(super) measured: u32,
    /// In how many frames a part of it was not seen, even where it was assumed.
    pub(super) assumed: u32,
    pub(super) measures: Measures,
    /// Whether the IU has ended.
    pub(super) ended: bool,
    /// It may have begun as many frames earlier.
    pub(super) gap_before: u32,
    /// It may have ended as many frames earlier.
    pub(super) gap_after: u32,
    /// Its beginning or its end may be that of another stretch: the IU may be a part of one.
    pub(super) may_be_part: bool,
    /// What was not seen of it may have been something else.
    pub(super) is_doubtful: bool,
}

/// A stroke goes to and fro.
pub(super) const PER_STROKE: u32 = 2;

/// The ends of an IU, and of what leads to a reversal and away from it: its beginning and its end.
pub(super) const ENDS: u32 = 2;

/// The share of an IU up to which what was hidden in it is assumed to have gone on like the rest. Short gaps hide no reversal, so beyond it
/// half of the strokes could seem to be all of them.
const MAX_ASSUMED: f32 = 0.25;

impl IuObservation {
    /// How many frames the IU lasts without those in which the hand waited for the other one. A hand may wait for any time.
    pub(super) fn worked_frames(&self) -> u32 {
        self.frames.saturating_sub(self.waited)
    }

    /// The minimum number of frames that the hand may have worked, and the maximum that the IU may have. A frame that was not seen may shift
    /// either end by one.
    pub(super) fn possible_frames(&self) -> [u32; 2] {
        let shift = self.assumed.min(ENDS);
        let not_work = self.gap_after.saturating_add(shift).saturating_add(self.may_have_waited);
        [
            self.worked_frames().saturating_sub(not_work),
            self.frames.saturating_add(self.gap_before).saturating_add(shift),
        ]
    }

    /// How often the motion may have reversed in addition, in frames that were not seen, in a row or one by one.
    pub(super) fn possible_reversals(&self) -> u32 {
        let Measures { hidden, hidden_reversals, cut_reversals, .. } = self.measures;
        let scattered = (hidden * self.frames as f32) as u32 / FRAMES_PER_REVERSAL;
        // Where the motion was not seen to turn, it may not be seen to turn back either.
        let unseen = if self.hidden() > 0.0 { PER_STROKE } else { 0 };
        let before = self.gap_before / FRAMES_PER_REVERSAL + unseen;
        hidden_reversals.max(scattered).saturating_add(cut_reversals).saturating_add(before)
    }

    /// How many reversals were hidden within the IU if the hand went on at the pace at which it was seen; none where so much was hidden that
    /// this is not known. What happened before it or after it is not known.
    pub(super) fn assumed_reversals(&self) -> u32 {
        if self.measures.hidden > MAX_ASSUMED { 0 } else { self.measures.hidden_reversals_at_pace() }
    }

    /// In how much of the IU something may have happened that was not seen, as a share of its frames; more than 1 if most of it lies in
    /// a gap.
    pub(super) fn hidden(&self) -> f32 {
        let gaps = self.gap_before.saturating_add(self.gap_after);
        self.measures.hidden + gaps as f32 / self.frames.max(1) as f32
    }

    /// Whether so much of the IU was measured that it can be right.
    pub(super) fn is_known(&self) -> bool {
        2 * self.measured.saturating_sub(self.waited) >= self.worked_frames()
    }

    /// Whether what was not seen may explain this reason. A part of an IU may be too short, or another motion. What was hidden in the
    /// middle was counted as if it were right; but two IUs in the same context may seem to be one if the one between them was hidden.
    pub(super) fn explains(&self, reason: Reason, is_unique: bool) -> bool {
        match reason {
            Reason::None => false,
            Reason::TooShort => self.may_be_part,
            _ => self.may_be_part || self.is_doubtful && !is_unique,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::{Around, Bounds, Range};
    use crate::cases::many_cases;
    use crate::config::Method;
    use crate::couple::geometry::{norm, subtract};
    use crate::couple::{Context, Couple, Motion, Unseen};
    use crate::input::{Point, Side};
    use crate::job::{MeasureBounds, NominalIu};
    use crate::segment::Segmenter;
    use core::f32::consts::TAU;
    use proptest::prelude::*;
    use std::vec::Vec;

    const CONTEXT: Context = Context([1, 5, 5, 6]);

    /// Where the hand goes in millimetres, and in how many frames; or strokes in this direction, in hundredths of a radian.
    #[derive(Clone, Copy, Debug)]
    enum Leg {
        To { at: [i16; 2], frames: usize },
        Strokes { half_mm: i16, angle: i16, count: usize, frames: usize },
    }

    fn leg() -> impl Strategy<Value = Leg> {
        let to = ([-200..200i16, -200..200i16], 4..40usize).prop_map(|(at, frames)| Leg::To { at, frames });
        let strokes = (20..80i16, 0..628i16, 1..6usize, 8..30usize)
            .prop_map(|(half_mm, angle, count, frames)| Leg::Strokes { half_mm, angle, count, frames });
        let rest = (4..40usize).prop_map(|frames| Leg::Strokes { half_mm: 0, angle: 0, count: 1, frames });
        prop_oneof![3 => to, 3 => strokes, 1 => rest]
    }

    /// Where the part is in each frame.
    fn positions(legs: &[Leg]) -> Vec<Point> {
        let mut positions = std::vec![[0.0; 3]];
        for leg in legs {
            let [x, y, _] = positions[positions.len() - 1];
            match *leg {
                Leg::To { at, frames } => {
                    let to = at.map(|mm| f32::from(mm) / 1000.0);
                    positions.extend((1..=frames).map(|frame| {
                        let part = frame as f32 / frames as f32;
                        let eased = part * part * (3.0 - 2.0 * part);
                        [x + (to[0] - x) * eased, y + (to[1] - y) * eased, 0.0]
                    }));
                }
                Leg::Strokes { half_mm, angle, count, frames } => {
                    let (angle, half) = (f32::from(angle) / 100.0, f32::from(half_mm) / 1000.0);
                    positions.extend((1..=count * frames).map(|frame| {
                        let off = half * libm::sinf(frame as f32 * TAU / frames as f32);
                        [x + off * libm::cosf(angle), y + off * libm::sinf(angle), 0.0]
                    }));
                }
            }
        }
        positions
    }

    /// What an IU shows that lasts from frame `from` on, where these frames are known: so far after each frame, and in the end.
    fn observed(
        positions: &[Point],
        known: &[bool],
        from: usize,
        (waits, waited): (usize, usize),
    ) -> Vec<IuObservation> {
        let Ok(mut segmenter) = Segmenter::new(Side::Right, &Method::default()) else { return Vec::new() };
        let (mut observation, mut all) =
            (IuObservation { gap_before: from as u32, ..IuObservation::default() }, Vec::new());
        for (frame, position) in positions.iter().enumerate() {
            let seen = Some(*position).filter(|_| known[frame]);
            let couple = Couple {
                context: if frame < from { Context::IDLE } else { CONTEXT },
                motion: seen.map(|_| Motion::default()),
                position: seen,
                tips: seen,
                unseen: (Unseen::CONTEXT | Unseen::CHANGE).when(!known[frame]),
                ..Couple::idle(Side::Right, frame as u64)
            };
            segmenter.step(&couple, &mut |_| {});
            if frame < from {
                continue;
            }
            observation.frames += 1;
            observation.measured += u32::from(known[frame]);
            observation.assumed += u32::from(!known[frame]);
            let waits = (waits..waits + waited).contains(&frame);
            observation.waited += u32::from(waits && known[frame]);
            observation.may_have_waited += u32::from(!known[frame]);
            observation.gap_after = if known[frame] { 0 } else { observation.gap_after + 1 };
            observation.measures = segmenter.measures();
            all.push(observation);
        }
        all.push(IuObservation { ended: true, ..observation });
        all
    }

    /// Bounds that are as near to what was measured as that is known, or a share of it farther.
    fn bounds(whole: &IuObservation, slack: f32) -> NominalIu<'static> {
        let IuObservation { frames, measures, .. } = *whole;
        let around = |value: f32| Range { min: value * (1.0 - slack), max: value * (1.0 + slack) };
        let exactly = |count: u32| Bounds {
            min: count - (count as f32 * slack) as u32,
            max: count + (count as f32 * slack) as u32,
        };
        NominalIu {
            context: CONTEXT,
            reference: &[],
            threshold: 0.0,
            frames: Bounds { max: exactly(whole.worked_frames()).max, ..exactly(frames) },
            reversals: exactly(measures.reversals),
            measures: MeasureBounds {
                stroke_m: measures.stroke_m.map_or(MeasureBounds::ANY.stroke_m, around),
                path_m: around(measures.path_m),
                max_detour_m: measures.detour_m * (1.0 + slack) + 1e-4,
                max_lateral_m: measures.lateral_m * (1.0 + slack) + 1e-4,
                axis: Around { centre: measures.axis, max: slack },
                place_m: Around { centre: measures.place_m, max: slack * measures.path_m + 1e-4 },
                shown: None,
            },
        }
    }

    /// Whether the part moves farther while it is not known than is assumed.
    fn is_fast(positions: &[Point], known: &[bool]) -> bool {
        let steps = || positions.windows(2).map(|pair| norm(subtract(pair[1], pair[0]))).zip(&known[1..]);
        let (way_m, hidden_m): (f32, f32) = (
            steps().map(|(step_m, _)| step_m).sum(),
            steps().filter(|(_, known)| !**known).map(|(step_m, _)| step_m).sum(),
        );
        let hidden = known.iter().filter(|known| !**known).count() as f32 / known.len() as f32;
        hidden_m > HIDDEN_SLACK * hidden * way_m
    }

    /// Stretches of frames that are not known, by their first one and their length, and every how many frames one is.
    fn hidden() -> impl Strategy<Value = (Vec<(usize, usize)>, usize)> {
        let frames = prop_oneof![1..8usize, 1..40usize];
        (prop::collection::vec((0..200usize, frames), 0..4), prop_oneof![4 => Just(1), 1 => 2..5usize])
    }

    proptest! {
        #![proptest_config(many_cases())]

        /// An IU that is right with every frame is not certainly wrong with fewer, at any time: not too long so far, and nothing else in the end.
        /// Frames are hidden anywhere in it, from before it on, or to behind its end.
        ///
        /// Three things are assumed. What is hidden is no faster than [`HIDDEN_SLACK`] times the rest; strokes are so long that each of their halves
        /// is a movement, since shorter ones count or not by where they are first seen; and each takes eight frames, or more.
        #[test]
        fn whoever_sees_less_of_an_iu_that_is_right_is_not_certain_that_it_is_wrong(
            legs in prop::collection::vec(leg(), 1..6),
            (gaps, every) in hidden(),
            slack in prop::sample::select(std::vec![0.02, 0.1, 0.25]),
            waits in (0..100usize, 0..30usize),
            frames_after in 0..12usize,
            is_begun_late: bool,
        ) {
            let mut positions = positions(&legs);
            let count = positions.len();
            let whole = observed(&positions, &std::vec![true; count], 0, waits)[count];
            let iu = bounds(&whole, slack);
            prop_assert_eq!(whole.broken(&iu, false), None);
            let is_hidden = |frame: usize| gaps.iter().any(|(from, frames)| (*from..from + frames).contains(&frame));
            let mut known: Vec<bool> = (0..count).map(|frame| frame % every == 0 && !is_hidden(frame)).collect();
            let Some(first) = known.iter().position(|known| *known) else { return Ok(()) };
            if is_fast(&positions, &known) {
                return Ok(());
            }
            if !known[count - 1] {
                positions.resize(count + frames_after, positions[count - 1]);
                known.resize(count + frames_after, false);
            }
            for less in observed(&positions, &known, if is_begun_late { first } else { 0 }, waits) {
                prop_assert_eq!(less.broken(&iu, true), None, "{:?} of {:?}", less, whole);
            }
        }
    }
}
