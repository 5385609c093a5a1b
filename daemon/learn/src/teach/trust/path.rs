//! The way of a hand during an IU.

use crate::run::{Iu, Run};
use andon_core::input::{Hand, Point};

/// Frames whose positions are averaged before their distances are added up: the noise of a tracker would otherwise walk metres by itself.
const AVERAGED: usize = 5;

/// The length of the way of the middle knuckle during an IU with a hand, in metres.
pub(super) fn length_m(run: &Run, iu: &Iu) -> f64 {
    let is_of_hand = |hand: &&Hand| hand.side as u16 == iu.context.0[0];
    let frames = run.frames_between(iu.began_ns, iu.ended_ns);
    let hands = frames.iter().filter_map(|frame| frame.hands.iter().find(is_of_hand));
    let knuckles: Vec<Point> = hands.map(|hand| hand.middle_knuckle).collect();
    let means: Vec<[f64; 3]> = knuckles.chunks(AVERAGED).map(mean).collect();
    means.windows(2).map(|pair| distance(pair[0], pair[1])).sum()
}

fn mean(points: &[Point]) -> [f64; 3] {
    [0, 1, 2].map(|axis| points.iter().map(|point| f64::from(point[axis])).sum::<f64>() / points.len() as f64)
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}
