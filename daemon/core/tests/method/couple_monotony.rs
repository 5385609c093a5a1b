//! Whoever sees less of a bench and says that nothing is unseen has the context of who sees all of it.

use crate::common::bench::{Bench, encode_shapes, shapes};
use crate::common::cases;
use crate::common::seed::{drawn, wrong_cases};
use andon_core::couple::{Context, Couples, Unseen};
use andon_core::input::{Frame, Side};
use andon_core::object::ObjectShape;
use andon_rate::Rate;
use proptest::prelude::*;

/// How many frames a change takes to be believed.
const PERSIST: usize = 5;

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

/// What is not seen in a stretch of frames.
#[derive(Clone, Copy, Debug)]
enum Hidden {
    Hand(Side),
    Part(u16),
    Parts,
    Frames,
}

fn gap() -> impl Strategy<Value = (Hidden, usize, usize)> {
    let hidden = prop_oneof![
        prop::sample::select(Side::ALL.to_vec()).prop_map(Hidden::Hand),
        prop::sample::select(vec![5, 7, 9]).prop_map(Hidden::Part),
        Just(Hidden::Parts),
        Just(Hidden::Frames),
    ];
    (hidden, 1..400usize, prop_oneof![1..8usize, 1..60usize])
}

fn delete(frames: &[Frame], gaps: &[(Hidden, usize, usize)]) -> Vec<Frame> {
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

/// For each frame, what the hand touches, if it is seen and nothing is unseen, nor was in the `persist_frames` before it. A hand that touches nothing
/// is idle, whatever it has let go: that is what it did before.
fn certainly_touched(couples: &[Couples], hand: usize) -> Vec<Option<Context>> {
    let doubts = Unseen::CONTEXT | Unseen::CHANGE | Unseen::TAKING | Unseen::ARRIVAL | Unseen::MOVE;
    let mut clear = 0;
    let touched = |couples: &Couples| {
        let couple = &couples.hands[hand];
        clear = if couple.lacks(doubts) || !couple.is_hand_seen() { 0 } else { clear + 1 };
        let context = if couple.context.is_touch() { couple.context } else { Context::IDLE };
        (clear > PERSIST).then_some(context)
    };
    couples.iter().map(touched).collect()
}

/// The first hand and frame in which whoever sees less is certain of what the hand touches, and whoever sees all of something else. It is so for as
/// long around it as a contact takes to be known again and to be believed.
fn contradicted(whole: &[Couples], less: &[Couples]) -> Option<(usize, usize)> {
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

/// Parts whose grip is known. One of which only the middle is known is in the hand that leads it, wherever that is.
fn parts() -> Vec<ObjectShape> {
    let mut shapes = shapes(&PARTS.map(|(id, _)| id));
    let points = [[-0.005, 0.0, 0.0], [0.005, 0.0, 0.0]];
    shapes.iter_mut().for_each(|shape| shape.interaction_points = points.into_iter().collect());
    shapes
}

/// The scenes of a seed in which whoever sees less contradicts who sees all, and of how many.
fn contradicted_scenes(seed: u64) -> (Vec<String>, usize) {
    let parts = parts();
    let scene = (prop::collection::vec([act(), act()], 2..8), prop::collection::vec(gap(), 1..4));
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
    let (wrong, _) = contradicted_scenes(cases::KNOWN);
    assert!(wrong.is_empty(), "{wrong:#?}");
    let (wrong, scenes) = contradicted_scenes(drawn());
    println!("{wrong:#?}");
    // It was 7 of 19,000, such as a hand that let go unseen while the other one carried the part the same way.
    Rate::new(wrong.len(), scenes).expect_at_most(0.001, "contradicted");
}
