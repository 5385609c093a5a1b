//! Whoever sees less of a bench and says that nothing is unseen has the context of who sees all of it.

use crate::common::bench::{Bench, encode_shapes, gripped_shapes};
use crate::common::hiding::{contradicted, delete, gaps};
use crate::common::seed::{hardly_ever, wrong_cases};
use andon_core::input::{Frame, Side};
use proptest::prelude::*;

const PARTS: [(u16, [f32; 2]); 3] = [(5, [0.0, 0.0]), (7, [0.3, 0.1]), (9, [-0.25, 0.15])];

/// What a hand does next.
#[derive(Clone, Copy, Debug)]
enum Act {
    /// It goes to a part, and takes it if it holds none.
    Take(usize),
    /// It goes to the side of a part, with what it holds.
    Meet(usize),
    /// It goes to this place, in centimetres.
    Go([i8; 2]),
    /// It lets go and withdraws.
    LetGo,
    Rest,
}

fn act() -> impl Strategy<Value = Act> {
    prop_oneof![
        4 => (0..3usize).prop_map(Act::Take),
        3 => (0..3usize).prop_map(Act::Meet),
        2 => [-45..45i8, -30..30i8].prop_map(Act::Go),
        3 => Just(Act::LetGo),
        2 => Just(Act::Rest),
    ]
}

/// One that works with these acts, one pair after the other, as fast as people do.
struct Worker {
    bench: Bench,
    at: [[f32; 2]; 2],
    held: [Option<usize>; 2],
    parts: [[f32; 2]; 3],
}

impl Worker {
    fn frames(acts: &[[Act; 2]]) -> Vec<Frame> {
        let at = [[0.1, -0.3], [-0.1, -0.3]];
        let mut bench = Bench::new(&PARTS);
        bench.hand(Side::Right, at[0]).hand(Side::Left, at[1]).rest(20);
        let mut worker = Self { bench, at, held: [None; 2], parts: PARTS.map(|(_, at)| at) };
        acts.iter().for_each(|acts| worker.act(*acts));
        worker.bench.rest(15);
        worker.bench.frames
    }

    fn act(&mut self, acts: [Act; 2]) {
        let mut to = self.at;
        for hand in 0..2 {
            let is_free = |part: usize| !self.held.contains(&Some(part));
            to[hand] = match acts[hand] {
                Act::Take(part) if self.held[hand].is_none() && is_free(part) => self.parts[part],
                Act::Meet(part) if is_free(part) => [self.parts[part][0] + 0.02, self.parts[part][1]],
                Act::Go(to) => to.map(|cm| f32::from(cm) / 100.0),
                Act::LetGo => {
                    self.bench.let_go(Side::ALL[hand]);
                    self.held[hand] = None;
                    [self.at[hand][0] + 0.05, self.at[hand][1] - 0.15]
                }
                _ => continue,
            };
        }
        let way = |hand: usize| (to[hand][0] - self.at[hand][0]).hypot(to[hand][1] - self.at[hand][1]);
        let frames = (way(0).max(way(1)) / 0.013) as usize + 6;
        self.bench.carry(to.map(Some), frames).rest(10);
        for hand in 0..2 {
            if let Some(part) = self.held[hand] {
                self.parts[part] =
                    [0, 1].map(|axis| self.parts[part][axis] + to[hand][axis] - self.at[hand][axis]);
            }
            if let Act::Take(part) = acts[hand]
                && self.held[hand].is_none()
                && !self.held.contains(&Some(part))
                && to[hand] == self.parts[part]
            {
                self.held[hand] = Some(part);
                self.bench.hold(Side::ALL[hand], PARTS[part].0);
            }
        }
        self.at = to;
    }
}

/// The scenes of a seed in which whoever sees less contradicts who sees all, and of how many.
fn contradicted_scenes(seed: u64) -> (Vec<String>, usize) {
    let ids = PARTS.map(|(id, _)| id);
    let parts = gripped_shapes(&ids);
    let scene = (prop::collection::vec([act(), act()], 2..8), gaps(&ids, 400));
    wrong_cases(1_000, seed, &scene, |(acts, gaps)| {
        let frames = Worker::frames(&acts);
        let whole = encode_shapes(&parts, &frames);
        let less = encode_shapes(&parts, &delete(&frames, &gaps));
        contradicted(&whole, &less).map(|at| format!("{at:?} {acts:?} {gaps:?}"))
    })
}

/// Less observed is hardly ever certain of another touch than all observed, and never in the scenes that have always been tried.
#[test]
fn whoever_sees_less_and_is_certain_of_a_touch_agrees_with_who_sees_all() {
    // It was 1 of 16,000: which of two parts that touch was let go last, say, is not asked.
    hardly_ever(0.0005, "contradicted", contradicted_scenes);
}
