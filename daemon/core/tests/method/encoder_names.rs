//! Who is seen, and when: frames in which nobody watched, and hands that are called by the name of the other one.

use crate::common::bench::{Bench, encode};
use andon_core::couple::{Couple, Unseen, Visibility};
use andon_core::input::{Frame, Side};

const TOOL: u16 = 5;
const BOX: u16 = 7;

/// The couples of one hand.
fn couples_of(bench: &Bench, side: Side) -> Vec<Couple> {
    couples_in(bench, &bench.frames, side)
}

/// The couples of one hand in other frames of this bench.
fn couples_in(bench: &Bench, frames: &[Frame], side: Side) -> Vec<Couple> {
    encode(&bench.ids(), frames).iter().map(|couples| couples.hands[side.index()]).collect()
}

/// A hand takes a tool and moves it to and fro.
fn strokes() -> Bench {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.025]), (BOX, [0.3, 0.2])]);
    bench.hand(Side::Right, [-0.3, -0.3]).rest(20).go([0.0, 0.0], 20).hold(Side::Right, TOOL);
    for _ in 0..4 {
        bench.go([0.1, 0.0], 10).go([0.0, 0.0], 10);
    }
    bench.let_go(Side::Right).go([-0.3, -0.3], 20).rest(20);
    bench
}

#[test]
fn a_frame_in_which_nobody_watched_is_one_that_never_came() {
    let bench = strokes();
    let seen = |couples: &Couple| {
        (couples.context, couples.visibility, couples.motion, couples.lacks(Unseen::CHANGE))
    };
    let mut unseen = bench.frames.clone();
    unseen[50..70].iter_mut().for_each(|frame| frame.is_unseen = true);
    let missing = [&bench.frames[..50], &bench.frames[70..]].concat();
    let [unseen, missing] = [unseen, missing].map(|frames| couples_in(&bench, &frames, Side::Right));
    assert_eq!(unseen.iter().map(seen).collect::<Vec<_>>(), missing.iter().map(seen).collect::<Vec<_>>());
    assert!(unseen.iter().any(|couple| couple.visibility[0] == Visibility::Assumed));
}

#[test]
fn a_hand_that_is_called_the_other_one_for_some_frames_is_the_same_hand() {
    let bench = strokes();
    for called_left in [1, 5, 12] {
        let mut frames = bench.frames.clone();
        let hands = frames[60..60 + called_left].iter_mut().flat_map(|frame| &mut frame.hands);
        hands.for_each(|hand| hand.side = Side::Left);
        assert_eq!(
            encode(&bench.ids(), &frames),
            encode(&bench.ids(), &bench.frames),
            "{called_left} frames"
        );
    }
}

#[test]
fn two_hands_whose_names_are_exchanged_for_some_frames_are_the_same_hands() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.025]), (BOX, [0.3, 0.2])]);
    bench.hand(Side::Right, [-0.3, -0.3]).hand(Side::Left, [0.3, 0.2]).rest(40);
    bench.go([0.0, 0.0], 20).hold(Side::Right, TOOL).go([0.1, 0.0], 20).go([0.0, 0.0], 20).rest(20);
    let mut frames = bench.frames.clone();
    let hands = frames[70..82].iter_mut().flat_map(|frame| &mut frame.hands);
    hands.for_each(|hand| hand.side = hand.side.other());
    assert_eq!(encode(&bench.ids(), &frames), encode(&bench.ids(), &bench.frames));
}

#[test]
fn another_hand_at_another_place_is_the_other_hand_and_a_name_that_lasts_is_believed() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.025])]);
    bench.hand(Side::Right, [0.0, 0.0]).rest(40).leave(Side::Right).hand(Side::Left, [0.3, 0.0]).rest(40);
    let left = couples_of(&bench, Side::Left);
    assert!(left[45..].iter().all(Couple::is_hand_seen));
    let mut frames = bench.frames[..40].to_vec();
    let renamed = bench.frames[39].clone();
    frames.extend((40..100).map(|index| {
        let mut frame = Frame { captured_ns: index * crate::common::bench::PERIOD_NS, ..renamed.clone() };
        frame.hands.iter_mut().for_each(|hand| hand.side = Side::Left);
        frame
    }));
    let left = couples_in(&bench, &frames, Side::Left);
    assert!(!left[50].is_hand_seen() && left[70].is_hand_seen());
}
