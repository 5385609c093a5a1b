//! The couples of an encoder that does not see a hand in some frames.
//!
//! A context is believed once it was seen in three of the five frames from its beginning on. Meanwhile, and while nothing is seen, the one before
//! goes on.

use super::hiding::PERSIST;
use andon_core::couple::{Context, Couple, Couples, Unseen, Visibility};
use proptest::prelude::*;

/// How many of the frames in which a change is believed must be known for that, and for how many what is not seen is assumed to go on (`blind_ms`).
const KNOWN: usize = 3;
pub(crate) const BLIND: usize = 21;

/// A stretch in which a hand is not seen.
pub(crate) type Gap = (usize, usize, usize);

/// One to three of them, of any length.
pub(crate) fn gaps() -> impl Strategy<Value = Vec<Gap>> {
    let frames = prop_oneof![2 => 1..8usize, 2 => 1..40usize, 1 => 1..200usize];
    prop::collection::vec((0..2usize, 0..900usize, frames), 1..4)
}

/// The couples of an encoder that does not see the hands in these gaps.
pub(crate) fn hidden(couples: &[Couples], gaps: &[Gap]) -> Vec<Couples> {
    let mut left = couples.to_vec();
    for hand in 0..2 {
        let raw: Vec<Couple> = couples.iter().map(|couples| couples.hands[hand]).collect();
        let hides =
            |frame: usize, (of, from, frames): &Gap| *of == hand && (*from..from + frames).contains(&frame);
        let known: Vec<bool> =
            (0..raw.len()).map(|frame| !gaps.iter().any(|gap| hides(frame, gap))).collect();
        let (mut believed, mut unseen) = (raw[0].context, 0);
        for (frame, couples) in left.iter_mut().enumerate() {
            let is_doubtful = believe(&mut believed, &raw, &known, frame);
            unseen = if known[frame] { 0 } else { unseen + 1 };
            couples.hands[hand] = assumed(&raw[frame], believed, unseen, is_doubtful);
            // The part is seen to move without a hand.
            couples.unseen |= Unseen::CARRIER.when(unseen > 0 && raw[frame].context.is_touch());
        }
    }
    left
}

/// Goes on with the context that is believed in this frame. Whether it is in doubt.
fn believe(believed: &mut Context, raw: &[Couple], known: &[bool], frame: usize) -> bool {
    let window = frame..(frame + PERSIST).min(raw.len());
    let seen: Vec<usize> = window.clone().filter(|frame| known[*frame]).collect();
    let context = raw[frame].context;
    let is_new = known[frame]
        && context != *believed
        && (*believed != Context::IDLE || !context.is_release())
        && seen.iter().all(|other| raw[*other].context == context);
    let is_believed = is_new && seen.len() >= KNOWN;
    if is_believed {
        // A part was let go only by a hand that was seen to hold it.
        let is_of_held = !context.is_release() || believed.0[1] == context.0[2];
        *believed = if is_of_held { context } else { Context::IDLE };
    }
    2 * seen.len() + 1 < window.len() || is_new && !is_believed
}

/// The couple of a frame in which this context is believed, and in which the hand has not been seen for so many frames.
fn assumed(raw: &Couple, context: Context, unseen: usize, is_doubtful: bool) -> Couple {
    let is_measured = unseen == 0 && raw.context == context;
    Couple {
        context,
        motion: raw.motion.filter(|_| is_measured),
        position: raw.position.filter(|_| is_measured),
        tips: raw.tips.filter(|_| is_measured),
        visibility: match unseen {
            0 => raw.visibility,
            1..=BLIND => [Visibility::Assumed, Visibility::Seen, Visibility::Seen],
            _ => [Visibility::Unseen, Visibility::Seen, Visibility::Seen],
        },
        unseen: Unseen::CONTEXT.when(unseen > 0) | Unseen::CHANGE.when(is_doubtful || unseen > BLIND),
        ..*raw
    }
}
