//! Whose hand is seen. A tracker may confuse the two hands for some frames. A hand that is where one of them has just been, and the other has not, is
//! that one. One that may be either is not seen.
//!
//! A name that lasts longer than `blind_ms` is believed: where two hands meet, a part may be handed over. A rule that kept the old name would call
//! that the work of one hand. The other hand has verdicts of its own, with a question where its work was not shown. The hand that has lost its name is
//! not seen.

use super::misreading::{is_reached, off_course_m};
use crate::capacity::HANDS;
use crate::config::Method;
use crate::couple::noise::MOVED_M;
use crate::couple::poses::{HandPose, Recent, Source};

/// A frame now and then is missing between two that show the same hand. With one 20 of 3,700 drawn streams differ, and 12 with three.
const MAX_UNSEEN: u32 = 2;

/// For how long each hand has been called what it is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sides {
    /// In how many frames it was, at most `blind_frames`, less those in which it was called the other one. Another name that lasts is believed.
    known: [u32; HANDS],
    /// Whether the newest frame calls each hand by the name of the other one.
    pub(super) is_swapped: bool,
}

impl Sides {
    /// The hands as they are, from the hands as they are called.
    pub(super) fn settle(
        &mut self,
        hands: &[Recent<HandPose>; HANDS],
        called: [Option<HandPose>; HANDS],
        blind_frames: u32,
        method: &Method,
    ) -> [Option<HandPose>; HANDS] {
        // Whether a hand that was seen before may be here, if it has been pushed for as many frames.
        let reaches = |of: usize, seen: &HandPose, pushed: u32| {
            hands[of].ago(0).source != Source::Never
                && is_reached(hands[of].newest_two().map(HandPose::fix), seen.middle_knuckle, pushed, method)
        };
        let is_there =
            |of: usize, seen: &HandPose| hands[of].ago(0).unseen <= MAX_UNSEEN && reaches(of, seen, 1);
        // A hand that has been seen before may have come to where the other one was.
        let may_have_come =
            |name: usize, seen: &HandPose| reaches(name, seen, hands[name].ago(0).unseen.saturating_add(1));
        let may_be_other = |name: usize| {
            let (seen, other) = (called[name].as_ref(), 1 - name);
            seen.filter(|seen| self.known[other] > 0 && is_there(other, seen) && !is_there(name, seen))
        };
        let is_other = |name: usize| {
            may_be_other(name).is_some_and(|seen| {
                off_course_m(hands[1 - name].newest_two().map(HandPose::fix), seen.middle_knuckle) <= MOVED_M
                    && !may_have_come(name, seen)
            })
        };
        let is_swapped = match called {
            [Some(_), Some(_)] => is_other(0) && is_other(1),
            _ => is_other(0) || is_other(1),
        };
        let is_either =
            |name: usize| !is_swapped && called[1 - name].is_none() && may_be_other(name).is_some();
        let called = [0, 1].map(|name| called[name].filter(|_| !is_either(name)));
        self.is_swapped = is_swapped;
        let seen = if is_swapped { [called[1], called[0]] } else { called };
        for (hand, known) in self.known.iter_mut().enumerate() {
            *known = match seen[hand] {
                Some(_) if is_swapped => *known - u32::from(*known > 0),
                Some(_) => known.saturating_add(1).min(blind_frames),
                None if hands[hand].ago(0).unseen < MAX_UNSEEN => *known,
                None => 0,
            };
        }
        seen
    }
}
