//! Frames of which less is seen, and whether whoever sees less is certain of something else than whoever sees all.

use andon_core::couple::{Context, Couples, Unseen};
use andon_core::input::{Frame, Side};
use proptest::prelude::*;

/// How many frames a change takes to be believed.
pub(crate) const PERSIST: usize = 5;

/// What must be known of a frame so that what a hand touches in it is certain.
pub(crate) const DOUBTS: [Unseen; 5] =
    [Unseen::CONTEXT, Unseen::CHANGE, Unseen::ARRIVAL, Unseen::MOVE, Unseen::TAKING];

/// What is not seen in a stretch of frames.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Hidden {
    Hand(Side),
    Part(u16),
    Parts,
    /// Nobody watches.
    Frames,
}

/// What is hidden, from which frame on, and for how many frames.
pub(crate) type Gap = (Hidden, usize, usize);

/// One to three gaps, of any length, in so many frames with these parts.
pub(crate) fn gaps(parts: &[u16], frames: usize) -> impl Strategy<Value = Vec<Gap>> {
    let hidden = prop_oneof![
        prop::sample::select(Side::ALL.to_vec()).prop_map(Hidden::Hand),
        prop::sample::select(parts.to_vec()).prop_map(Hidden::Part),
        Just(Hidden::Parts),
        Just(Hidden::Frames),
    ];
    let gap = (hidden, 1..frames, prop_oneof![1..8usize, 1..60usize]);
    prop::collection::vec(gap, 1..4)
}

/// The frames without what is hidden.
pub(crate) fn delete(frames: &[Frame], gaps: &[Gap]) -> Vec<Frame> {
    let mut frames = frames.to_vec();
    for (hidden, from, count) in gaps {
        for frame in frames.iter_mut().skip(*from).take(*count) {
            match hidden {
                Hidden::Hand(side) => frame.hands.retain(|hand| hand.side != *side),
                Hidden::Part(id) => frame.objects.retain(|object| object.id != *id),
                Hidden::Parts => frame.objects.clear(),
                Hidden::Frames => frame.is_unseen = true,
            }
        }
    }
    frames
}

/// What a hand touches in a frame. One that touches nothing is idle, whatever it has let go: that is what it did before.
pub(crate) fn touched(couples: &Couples, hand: usize) -> Context {
    let context = couples.hands[hand].context;
    if context.is_touch() { context } else { Context::IDLE }
}

/// For each frame, what the hand touches, if it is seen and nothing is unseen, nor was in the `persist_frames` before it.
fn certainly_touched(couples: &[Couples], hand: usize) -> Vec<Option<Context>> {
    let mut clear = 0;
    let certainly = |couples: &Couples| {
        let couple = &couples.hands[hand];
        let is_doubtful = DOUBTS.iter().any(|doubt| couple.lacks(*doubt));
        clear = if is_doubtful || !couple.is_hand_seen() { 0 } else { clear + 1 };
        (clear > PERSIST).then_some(touched(couples, hand))
    };
    couples.iter().map(certainly).collect()
}

/// The first hand and frame in which whoever sees less is certain of what the hand touches, and whoever sees all of something else. It is so for as
/// long around it as a contact takes to be known again and to be believed.
pub(crate) fn contradicted(whole: &[Couples], less: &[Couples]) -> Option<(usize, usize)> {
    (0..2).find_map(|hand| {
        let [whole, less] = [whole, less].map(|couples| certainly_touched(couples, hand));
        // In the last frames nothing new is believed.
        let frames = PERSIST..less.len().saturating_sub(3 * PERSIST);
        let is_wrong = |frame: &usize| {
            let mut around = whole[frame.saturating_sub(2 * PERSIST)..=frame + 2 * PERSIST].iter();
            less[*frame].is_some() && around.all(|other| other.is_some() && *other != less[*frame])
        };
        frames.into_iter().find(is_wrong).map(|frame| (hand, frame))
    })
}
