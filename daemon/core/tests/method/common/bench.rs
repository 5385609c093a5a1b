//! Frames of a scripted worker: plane mode, in metres, at 30 Hz.

use andon_core::config::Method;
use andon_core::couple::{Couples, Encoder};
use andon_core::input::{Frame, Hand, Object, Side};
use andon_core::object::ObjectShape;
use std::collections::{BTreeMap, BTreeSet};

pub(crate) const PERIOD_NS: u64 = 33_333_333;

/// Objects with one interaction point, in their origin.
pub(crate) fn shapes(ids: &[u16]) -> Vec<ObjectShape> {
    ids.iter()
        .map(|id| ObjectShape {
            id: *id,
            interaction_points: heapless::Vec::from_slice(&[[0.0; 3]]).unwrap(),
            ..ObjectShape::default()
        })
        .collect()
}

/// Objects whose grip is known. One of which only the middle is known is in the hand that leads it, wherever that is.
pub(crate) fn gripped_shapes(ids: &[u16]) -> Vec<ObjectShape> {
    let mut shapes = shapes(ids);
    let points = [[-0.005, 0.0, 0.0], [0.005, 0.0, 0.0]];
    shapes.iter_mut().for_each(|shape| shape.interaction_points = points.into_iter().collect());
    shapes
}

/// The current positions, and the frames so far.
pub(crate) struct Bench {
    pub(crate) frames: Vec<Frame>,
    hands: [Option<[f32; 2]>; 2],
    held: [Option<u16>; 2],
    objects: BTreeMap<u16, [f32; 2]>,
    hidden: BTreeSet<u16>,
}

impl Bench {
    pub(crate) fn new(objects: &[(u16, [f32; 2])]) -> Self {
        Self {
            frames: Vec::new(),
            hands: [None; 2],
            held: [None; 2],
            objects: objects.iter().copied().collect(),
            hidden: BTreeSet::new(),
        }
    }

    pub(crate) fn hand(&mut self, side: Side, at: [f32; 2]) -> &mut Self {
        self.hands[side.index()] = Some(at);
        self
    }

    /// The hand leaves the picture. An object in it remains visible where it is.
    pub(crate) fn leave(&mut self, side: Side) -> &mut Self {
        self.hands[side.index()] = None;
        self
    }

    pub(crate) fn hold(&mut self, side: Side, id: u16) -> &mut Self {
        self.held[side.index()] = Some(id);
        self
    }

    pub(crate) fn let_go(&mut self, side: Side) -> &mut Self {
        self.held[side.index()] = None;
        self
    }

    pub(crate) fn hide(&mut self, id: u16) -> &mut Self {
        self.hidden.insert(id);
        self
    }

    pub(crate) fn show(&mut self, id: u16) -> &mut Self {
        self.hidden.remove(&id);
        self
    }

    pub(crate) fn rest(&mut self, frames: usize) -> &mut Self {
        for _ in 0..frames {
            self.record();
        }
        self
    }

    /// Moves both hands smoothly to these positions within `frames` frames, with the objects that they hold.
    pub(crate) fn carry(&mut self, to: [Option<[f32; 2]>; 2], frames: usize) -> &mut Self {
        let from = self.hands;
        for frame in 1..=frames {
            let part = frame as f32 / frames as f32;
            let eased = part * part * (3.0 - 2.0 * part);
            for hand in 0..2 {
                let (Some(a), Some(b)) = (from[hand], to[hand]) else { continue };
                let at = [0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * eased);
                let before = self.hands[hand].unwrap();
                self.hands[hand] = Some(at);
                if let Some(object) = self.held[hand].and_then(|id| self.objects.get_mut(&id)) {
                    *object = [0, 1].map(|axis| object[axis] + at[axis] - before[axis]);
                }
            }
            self.record();
        }
        self
    }

    /// Moves the right hand.
    pub(crate) fn go(&mut self, to: [f32; 2], frames: usize) -> &mut Self {
        self.carry([Some(to), None], frames)
    }

    fn record(&mut self) {
        let mut frame = Frame { captured_ns: self.frames.len() as u64 * PERIOD_NS, ..Frame::default() };
        for side in Side::ALL {
            if let Some([x, y]) = self.hands[side.index()] {
                let tips = [[x - 0.01, y, 0.0], [x, y, 0.0], [x + 0.01, y, 0.0]];
                let hand = Hand {
                    side,
                    score: 1.0,
                    wrist: [x, y - 0.17, 0.0],
                    middle_knuckle: [x, y - 0.08, 0.0],
                    tips,
                };
                frame.hands.push(hand).unwrap();
            }
        }
        for (id, [x, y]) in self.objects.iter().filter(|(id, _)| !self.hidden.contains(id)) {
            let object = Object { id: *id, position: [*x, *y, 0.0], orientation: [1.0, 0.0, 0.0, 0.0] };
            frame.objects.push(object).unwrap();
        }
        self.frames.push(frame);
    }

    pub(crate) fn ids(&self) -> Vec<u16> {
        self.objects.keys().copied().collect()
    }
}

/// The couples of frames.
pub(crate) fn encode(ids: &[u16], frames: &[Frame]) -> Vec<Couples> {
    encode_shapes(&shapes(ids), frames)
}

/// The couples of frames with objects that are known like this.
pub(crate) fn encode_shapes(shapes: &[ObjectShape], frames: &[Frame]) -> Vec<Couples> {
    let mut encoder = Encoder::new(Method::default(), shapes).unwrap();
    let mut couples = Vec::new();
    for frame in frames {
        encoder.step(frame, &mut |each| couples.push(each)).unwrap();
    }
    encoder.flush(&mut |each| couples.push(each));
    couples
}

/// The contexts of one hand in order, each with its number of frames, without idle time.
pub(crate) fn contexts(couples: &[Couples], side: Side) -> Vec<([u16; 4], usize)> {
    let mut runs: Vec<([u16; 4], usize)> = Vec::new();
    for couple in couples.iter().map(|couples| &couples.hands[side.index()]) {
        match runs.last_mut() {
            Some((context, frames)) if *context == couple.context.0 => *frames += 1,
            _ => runs.push((couple.context.0, 1)),
        }
    }
    runs.retain(|(context, _)| *context != [0; 4]);
    runs
}

/// Errors up to a maximum, of which all are equally likely; the seed chooses them.
pub(crate) fn errors(seed: u32) -> impl FnMut(f32) -> f32 {
    let mut state = seed;
    move |max_m| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        ((state >> 8) as f32 / (1 << 23) as f32 - 1.0) * max_m
    }
}
