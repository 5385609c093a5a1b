//! Frames that did not show what a hand acts on, because they never came or it was hidden, and how a verdict names them. Couples that never come, as
//! where `encode` starts again, count as well: an IU would seem too short without them.

use crate::couple::{Couple, Unseen, Visibility};
use crate::input::Side;
use crate::verdict::{Missing, Reason};

/// Objects that are counted: the two of a context, and two that the hand may have taken instead. Of others it is not said for how long.
const COUNTED_OBJECTS: usize = 4;

/// Why something is not judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cause {
    pub(super) reason: Reason,
    pub(super) missing: Missing,
}

impl Cause {
    /// These objects are not seen: that with this id, or one that is not known.
    pub(super) fn object_not_seen(id: u16) -> Self {
        let object = Some(id).filter(|id| *id != 0);
        let reason = object.map_or(Reason::Blind, |_| Reason::ObjectNotSeen);
        Self { reason, missing: Missing { object, ..Missing::default() } }
    }
}

impl From<Reason> for Cause {
    fn from(reason: Reason) -> Self {
        Self { reason, missing: Missing::default() }
    }
}

/// A share of frames in percent, rounded down.
pub(super) fn percent(frames: u32, of: u32) -> Option<u8> {
    let percent = (100 * u64::from(frames)).checked_div(of.into())?;
    Some(percent.min(100) as u8)
}

/// How many frames did not show what a hand acts on.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OcclusionLog {
    side: Option<Side>,
    period_ns: u64,
    /// All frames, and the newest of them that never came one after the other.
    frames: u32,
    newest_gap: u32,
    /// The most that never came one after the other.
    longest_gap: u32,
    /// In how many of those that came the hand or an object was hidden, and how many never came.
    captured: u32,
    uncaptured: u32,
    /// In how many the hand was hidden, and objects with these ids.
    hand: u32,
    objects: [(u16, u32); COUNTED_OBJECTS],
}

impl OcclusionLog {
    pub(super) fn new(side: Side, period_ns: u64) -> Self {
        Self { side: Some(side), period_ns, ..Self::default() }
    }

    /// Neither the newest couple nor anything before it matters.
    pub(super) fn forget(&mut self) {
        *self = Self { side: self.side, period_ns: self.period_ns, ..Self::default() };
    }

    /// The next couple comes as many frames after the one before. Of a long gap, not all frames of the grid have a couple.
    pub(super) fn skip(&mut self, frames: u32, couple: &Couple) {
        let (missing, is_missing) = (frames - 1, couple.lacks(Unseen::FRAME));
        self.uncaptured = self.uncaptured.saturating_add(missing);
        self.frames = self.frames.saturating_add(frames);
        self.newest_gap = self.newest_gap.saturating_add(missing).saturating_add(is_missing.into());
        self.longest_gap = self.longest_gap.max(self.newest_gap);
        if !is_missing {
            self.newest_gap = 0;
        }
    }

    /// Takes that couple.
    pub(super) fn count(&mut self, couple: &Couple) {
        // What is seen and not clear behind frames that never came is so because of them.
        let is_hidden = couple.visibility != [Visibility::Seen; 3] || self.uncaptured == 0;
        if couple.lacks(Unseen::FRAME) {
            self.uncaptured = self.uncaptured.saturating_add(1);
        } else if couple.lacks(Unseen::CONTEXT) && is_hidden {
            self.captured = self.captured.saturating_add(1);
            self.count_hidden(couple);
        }
    }

    /// One object is named for each frame: one of the context, or else one that the hand may have taken.
    fn count_hidden(&mut self, couple: &Couple) {
        let [hand, o_j, o_l] = couple.visibility.map(|visibility| visibility != Visibility::Seen);
        self.hand = self.hand.saturating_add(hand.into());
        let object = match (o_j, o_l) {
            (true, _) => couple.context.o_j(),
            (_, true) => couple.context.0[3],
            _ => couple.hidden_object,
        };
        let place = self.objects.iter_mut().find(|(id, _)| [object, 0].contains(id));
        if let Some(place) = place.filter(|_| object != 0) {
            *place = (object, place.1.saturating_add(1));
        }
    }

    /// Why too little is known of these hands: frames that never came, or did not show it, whichever are more; `None` without any.
    pub(super) fn cause(logs: &[Self], min_captured: f32) -> Option<Cause> {
        let uncaptured = logs.iter().max_by_key(|log| log.uncaptured)?;
        let captured = logs.iter().max_by_key(|log| log.captured)?;
        if uncaptured.uncaptured > captured.captured {
            Some(uncaptured.frames_missing(min_captured))
        } else {
            (captured.captured > 0).then(|| captured.not_seen())
        }
    }

    /// The same cause, with the time that has passed by now: what was missing when it was found may have gone on to be.
    pub(super) fn until_now(&self, cause: Cause) -> Cause {
        let is_missing = |(object, _): &&(u16, u32)| cause.missing.object == Some(*object);
        let frames = match cause.reason {
            Reason::FramesMissing => self.longest_gap,
            Reason::HandNotSeen => self.hand,
            Reason::ObjectNotSeen => self.objects.iter().find(is_missing).map_or(0, |(_, frames)| *frames),
            _ => 0,
        };
        let seconds = cause.missing.seconds.map(|before| before.max(self.seconds(frames)));
        Cause { missing: Missing { seconds, ..cause.missing }, ..cause }
    }

    /// The same, where so many frames are missing as a change takes to be believed (`persist_frames`): fewer seldom are the reason.
    pub(super) fn main_cause(logs: &[Self], min_captured: f32, persist_frames: u32) -> Option<Cause> {
        let is_any = logs.iter().any(|log| !log.is_within(persist_frames.saturating_sub(1)));
        Self::cause(logs, min_captured).filter(|_| is_any)
    }

    /// No more frames than this did not show what the hand acts on.
    pub(super) fn is_within(&self, frames: u32) -> bool {
        self.captured.max(self.uncaptured) <= frames
    }

    /// Frames never came: most of them one after the other, or one now and then.
    pub(super) fn frames_missing(&self, min_captured: f32) -> Cause {
        if 2 * u64::from(self.longest_gap) > u64::from(self.uncaptured) && self.longest_gap > 1 {
            let missing = Missing { seconds: Some(self.seconds(self.longest_gap)), ..Missing::default() };
            return Cause { reason: Reason::FramesMissing, missing };
        }
        too_few_frames(self.frames.saturating_sub(self.uncaptured), self.frames, min_captured)
    }

    /// Frames came and did not show the hand, or an object: whichever was hidden for longer.
    fn not_seen(&self) -> Cause {
        let (object, frames) =
            self.objects.iter().copied().max_by_key(|(_, frames)| *frames).unwrap_or_default();
        if self.hand >= frames && self.hand > 0 {
            let seconds = Some(self.seconds(self.hand));
            let missing = Missing { hand: self.side, seconds, ..Missing::default() };
            return Cause { reason: Reason::HandNotSeen, missing };
        }
        let seconds = Some(self.seconds(frames)).filter(|_| object != 0);
        let cause = Cause::object_not_seen(object);
        Cause { missing: Missing { seconds, ..cause.missing }, ..cause }
    }

    fn seconds(&self, frames: u32) -> f32 {
        (f64::from(frames) * self.period_ns as f64 * 1e-9) as f32
    }
}

/// So many of these frames came.
pub(super) fn too_few_frames(captured: u32, frames: u32, min_captured: f32) -> Cause {
    // Rounded up, so that what came is always less; a share that has no exact number counts as the next whole percentage.
    let needed_percent = Some(libm::ceilf(100.0 * min_captured - 0.01) as u8).filter(|percent| *percent > 0);
    let captured_percent = percent(captured, frames);
    let missing = Missing { captured_percent, needed_percent, ..Missing::default() };
    Cause { reason: Reason::TooFewFrames, missing }
}
