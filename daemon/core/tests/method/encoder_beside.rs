//! The encoder where parts lie beside each other.

use crate::common::bench::{Bench, contexts, encode, errors};
use crate::common::seed::known_and_drawn_seeds;
use andon_core::config::{Contact, Method};
use andon_core::couple::Unseen;
use andon_core::input::Side;

const TOOL: u16 = 5;
const BOX: u16 = 7;

fn just_contexts(bench: &Bench) -> Vec<[u16; 4]> {
    let couples = encode(&bench.ids(), &bench.frames);
    contexts(&couples, Side::Right).into_iter().map(|(context, _)| context).collect()
}

/// The noise of a camera: hands are seen less exactly than markers, and the error of a hand stays for some frames.
fn with_noise(mut bench: Bench, seed: u32) -> Bench {
    let mut noise = errors(seed);
    let mut drift = [0.0; 2];
    for frame in &mut bench.frames {
        drift = drift.map(|drift| 0.8 * drift + noise(0.002));
        for hand in &mut frame.hands {
            let points = hand.tips.iter_mut().chain([&mut hand.wrist, &mut hand.middle_knuckle]);
            points.for_each(|point| (0..2).for_each(|axis| point[axis] += drift[axis] + noise(0.0025)));
        }
        for object in &mut frame.objects {
            (0..2).for_each(|axis| object.position[axis] += noise(0.001));
        }
    }
    bench
}

#[test]
fn a_hand_that_rests_at_two_parts_takes_the_nearer_one_whatever_the_noise() {
    for seed in known_and_drawn_seeds(300) {
        let mut bench = Bench::new(&[(TOOL, [0.015, 0.0]), (BOX, [0.038, 0.0])]);
        bench.hand(Side::Right, [0.0, -0.3]).rest(10).go([0.0, 0.0], 20).rest(12);
        bench.hold(Side::Right, TOOL).go([-0.2, 0.1], 30).rest(10);
        let bench = with_noise(bench, seed);
        assert_eq!(just_contexts(&bench), [[1, TOOL, TOOL, BOX], [1, TOOL, 0, 0]], "seed {seed}");
    }
}

/// A hand takes a tool that has lain at this distance from a box since before it was first seen, and carries it away. Contexts of the hand, and
/// whether any of them was in doubt.
fn first_seen_beside(distance_m: f32) -> (Vec<[u16; 4]>, bool) {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [distance_m, 0.0])]);
    bench.hand(Side::Right, [-0.02, -0.3]).rest(10).go([-0.02, 0.0], 20).rest(12);
    bench.hold(Side::Right, TOOL).go([-0.2, 0.1], 30).rest(10);
    let couples = encode(&bench.ids(), &bench.frames);
    let is_doubtful = couples.iter().any(|couples| couples.hands[0].lacks(Unseen::CHANGE));
    (just_contexts(&bench), is_doubtful)
}

#[test]
fn parts_that_are_first_seen_at_rest_rather_within_the_distances_of_a_contact_than_beyond_touch() {
    let Contact { on_m, off_m } = Method::default().object_contact;
    let touches = vec![[1, TOOL, TOOL, BOX], [1, TOOL, 0, 0]];
    assert_eq!(first_seen_beside(on_m + 0.3 * (off_m - on_m)), (touches, false));
    // That these touch is not known.
    assert_eq!(first_seen_beside(on_m + 0.7 * (off_m - on_m)), (vec![[1, TOOL, 0, 0]], true));
    assert_eq!(first_seen_beside(1.1 * off_m), (vec![[1, TOOL, 0, 0]], false));
}

#[test]
fn parts_that_touch_and_were_hidden_between_the_distances_of_a_contact_are_known_to_touch() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.034, 0.0])]);
    bench.hand(Side::Right, [-0.03, 0.0]).rest(20).hide(BOX).rest(8).show(BOX).rest(20);
    let couples = encode(&bench.ids(), &bench.frames);
    assert!(
        couples[36..].iter().all(
            |couples| !couples.hands[0].lacks(Unseen::CONTEXT) && !couples.hands[0].lacks(Unseen::CHANGE)
        )
    );
    assert_eq!(couples[36].hands[0].context.0, [1, TOOL, TOOL, BOX]);
}
