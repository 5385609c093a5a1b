//! What an encoder may say of work of which it has not seen all: four laws. They are tried on scenes of a scripted worker in each of which one of them
//! was broken once, with the gap that broke it, with known gaps and with drawn ones. `encoder_doubt` has the same scenes to the frame: a rule that is
//! taken away may be seen there alone.

use crate::common::bench::{Bench, encode_shapes, gripped_shapes};
use crate::common::gaps::BLIND;
use crate::common::hiding::Hidden::{Frames, Hand, Part, Parts};
use crate::common::hiding::{DOUBTS, Gap, PERSIST, contradicted, delete, gaps, touched};
use crate::common::seed::{hardly_ever, wrong_cases};
use andon_core::couple::{Context, Couples, Unseen, Visibility};
use andon_core::input::Side::{Left, Right};
use andon_core::object::ObjectShape;

const TOOL: u16 = 5;
const BOX: u16 = 7;
const CUP: u16 = 9;

/// To the end of any scene.
const END: usize = 1000;

/// Work that all frames show, and what was hidden of it when a law was broken.
struct Scene {
    name: &'static str,
    parts: Vec<ObjectShape>,
    bench: Bench,
    gaps: Vec<Vec<Gap>>,
    /// Its couples where all is seen.
    whole: Vec<Couples>,
}

impl Scene {
    fn new(name: &'static str, bench: Bench, gaps: &[&[Gap]]) -> Self {
        let gaps = gaps.iter().map(|gaps| gaps.to_vec()).collect();
        let parts = gripped_shapes(&bench.ids());
        let whole = encode_shapes(&parts, &bench.frames);
        Self { name, parts, bench, gaps, whole }
    }

    /// The same, where the first part can also be touched here.
    fn with_point(mut self, at: [f32; 3]) -> Self {
        self.parts[0].interaction_points.push(at).unwrap();
        self.whole = encode_shapes(&self.parts, &self.bench.frames);
        self
    }

    fn less(&self, gaps: &[Gap]) -> Vec<Couples> {
        encode_shapes(&self.parts, &delete(&self.bench.frames, gaps))
    }
}

/// Nothing is seen in these frames.
fn all(from: usize, count: usize) -> [Gap; 3] {
    [(Hand(Right), from, count), (Hand(Left), from, count), (Parts, from, count)]
}

fn bench(parts: &[(u16, [f32; 2])], act: impl FnOnce(&mut Bench)) -> Bench {
    let mut bench = Bench::new(parts);
    act(&mut bench);
    bench
}

/// One hand, with one part or beside another.
fn scenes_of_one_hand() -> Vec<Scene> {
    let past = bench(&[(TOOL, [0.0, 0.025]), (BOX, [0.3, 0.045])], |bench| {
        bench.hand(Right, [-0.3, -0.3]).rest(20).go([0.0, 0.0], 20);
        bench.hold(Right, TOOL).go([0.6, 0.0], 120).rest(20);
    });
    let there_and_back = bench(&[(TOOL, [0.0, 0.0]), (BOX, [0.2, 0.0])], |bench| {
        bench.hand(Right, [0.0, 0.0]).rest(20).hold(Right, TOOL).go([0.2, 0.0], 30).rest(20);
        bench.go([0.0, 0.0], 20).rest(20);
    });
    let slows_down = bench(&[(TOOL, [0.0, 0.0]), (BOX, [0.2, 0.0])], |bench| {
        bench.hand(Right, [0.0, 0.0]).rest(20).hold(Right, TOOL).go([0.28, 0.0], 24).rest(20);
    });
    let takes_away = bench(&[(TOOL, [0.0, 0.0]), (BOX, [0.0, 0.02])], |bench| {
        bench.hand(Right, [0.0, 0.0]).rest(20).hold(Right, TOOL).rest(20);
        bench.go([0.3, 0.0], 15).let_go(Right).go([0.3, -0.3], 15).rest(20);
    });
    let carries = bench(&[(TOOL, [0.0, 0.0])], |bench| {
        bench.hand(Right, [0.0, 0.0]).rest(20).hold(Right, TOOL).go([0.4, 0.0], 30).rest(20);
    });
    let between = bench(&[(TOOL, [0.0, 0.0]), (BOX, [0.038, 0.0]), (CUP, [-0.02, 0.0])], |bench| {
        bench.hand(Right, [-0.3, 0.0]).rest(20).go([-0.02, 0.0], 20).rest(60);
    });
    let takes = bench(&[(TOOL, [0.0, 0.0]), (BOX, [0.29, 0.0])], |bench| {
        bench.hand(Right, [-0.3, 0.0]).rest(40).go([0.0, 0.0], 20).rest(30);
    });
    let leaves = bench(&[(TOOL, [0.0, 0.0])], |bench| {
        bench.hand(Right, [0.0, 0.0]).rest(40).go([0.3, 0.0], 20).rest(30);
    });
    let steps_back = bench(&[(TOOL, [0.0, 0.0])], |bench| {
        bench.hand(Right, [0.0, 0.0]).rest(40).go([0.0405, 0.0], 6).go([0.03, 0.0], 5).rest(30);
    });
    let beside_a_cup = bench(&[(TOOL, [0.0, 0.0]), (CUP, [0.0, 0.02])], |bench| {
        bench.hand(Right, [0.0, -0.3]).rest(20).go([0.0, 0.0], 20).hold(Right, TOOL).rest(10);
        bench.go([0.3, 0.01], 30).rest(20).let_go(Right).go([0.3, -0.3], 30).rest(30);
    });
    let to_the_box = bench(&[(TOOL, [0.0, 0.0]), (BOX, [0.3, 0.0])], |bench| {
        bench.hand(Right, [0.0, 0.0]).rest(40).go([0.3, 0.0], 20).rest(30);
    });
    let moves_and_uses = bench(&[(TOOL, [0.0, 0.0]), (BOX, [0.5, 0.3])], |bench| {
        bench.hand(Right, [-0.3, 0.0]).rest(20).go([0.0, 0.0], 15).hold(Right, TOOL).go([0.2, 0.0], 20);
        bench.let_go(Right).go([0.2, -0.3], 20).rest(30).go([0.2, 0.0], 20).rest(30);
    });
    vec![
        Scene::new("a part is carried past another one", past, &[&all(20, 77)]),
        Scene::new("a part is brought and taken back", there_and_back, &[&all(48, END), &all(74, END)]),
        Scene::new("a part slows down behind another one", slows_down, &[&all(36, 3), &all(38, 4)]),
        Scene::new("a part is taken away from another one", takes_away, &[&[(Part(BOX), 40, 15)]]),
        Scene::new(
            "a part is carried",
            carries,
            &[&[(Hand(Right), 30, 6), (Parts, 34, 12)], &[(Parts, 25, END)]],
        ),
        Scene::new("parts neither touch nor are apart", between, &[]),
        Scene::new("a part is long", takes, &[&[(Part(BOX), 20, END)]]).with_point([0.25, 0.0, 0.0]),
        Scene::new("a hand moves away", leaves, &[&all(44, 16)]),
        Scene::new("a hand steps back", steps_back, &[&[(Frames, 40, 1)]]),
        Scene::new(
            "a part is taken from beside a cup",
            beside_a_cup,
            &[&[(Part(CUP), 40, 10)], &[(Part(CUP), 0, 50)]],
        ),
        Scene::new(
            "a part is first seen in the hand",
            to_the_box,
            &[&[(Part(TOOL), 0, 20)], &[(Part(BOX), 0, 70)]],
        ),
        Scene::new(
            "a part is moved and used",
            moves_and_uses,
            &[&[(Part(TOOL), 10, 55), (Hand(Right), 22, 45)]],
        ),
    ]
}

/// Both hands, of which one may carry what the other one was at.
fn scenes_of_two_hands() -> Vec<Scene> {
    let takes_from = bench(&[(TOOL, [0.0, 0.0])], |bench| {
        bench.hand(Left, [-0.01, 0.0]).hand(Right, [0.01, 0.0]).rest(20).hold(Right, TOOL);
        bench.carry([Some([0.4, 0.0]), Some([-0.01, 0.0])], 30).rest(20);
    });
    let both_carry = bench(&[(BOX, [0.0, 0.0])], |bench| {
        bench.hand(Right, [0.02, 0.0]).hand(Left, [-0.02, 0.0]).rest(20);
        bench.hold(Left, BOX).carry([Some([0.02, 0.15]), Some([-0.02, 0.15])], 15);
        bench.carry([None, Some([-0.02, 0.3])], 15).rest(20);
    });
    let comes = |holds: bool| {
        bench(&[(TOOL, [0.0, 0.0])], |bench| {
            bench.hand(Right, [0.0, if holds { 0.0 } else { -0.3 }]).hand(Left, [0.0, 0.3]).rest(30);
            bench.carry([None, Some([0.0, 0.02])], 15).rest(30);
        })
    };
    let two_parts = bench(&[(TOOL, [0.3, 0.0]), (BOX, [-0.3, 0.0])], |bench| {
        bench.hand(Right, [0.3, 0.0]).hand(Left, [-0.3, 0.0]).rest(20).hold(Right, TOOL).hold(Left, BOX);
        bench.carry([Some([0.3, 0.1]), Some([-0.3, 0.1])], 20);
        bench.carry([Some([0.3, 0.2]), Some([0.14, 0.2])], 20).rest(20);
    });
    let gives = bench(&[(TOOL, [0.0, 0.0])], |bench| {
        bench.hand(Left, [0.0, 0.0]).hand(Right, [0.5, 0.0]).rest(20).hold(Left, TOOL);
        bench.carry([Some([0.1, 0.0]), Some([0.1, 0.0])], 40).rest(20).let_go(Left).hold(Right, TOOL);
        bench.carry([Some([0.5, 0.0]), Some([-0.2, 0.0])], 30).rest(20);
    });
    let meet = bench(&[(TOOL, [0.0, 0.0]), (BOX, [0.5, 0.0])], |bench| {
        bench.hand(Right, [0.0, 0.0]).hand(Left, [0.5, 0.0]).rest(30).hold(Right, TOOL).hold(Left, BOX);
        bench.carry([Some([0.49, 0.0]), None], 20).rest(40);
    });
    let unseen_bringing = [(Part(TOOL), 5, 65), (Hand(Right), 5, 65)];
    vec![
        Scene::new("a hand takes away what the other one is at", takes_from, &[]),
        Scene::new(
            "one of two hands goes on",
            both_carry,
            &[&[(Part(BOX), 30, END), (Hand(Right), 35, END)]],
        ),
        Scene::new("a hand comes to what is held", comes(true), &[&[(Parts, 45, END)], &[(Parts, 48, END)]]),
        Scene::new("a hand comes to what lies", comes(false), &[&[(Parts, 45, END)], &[(Parts, 48, END)]]),
        Scene::new("two parts are carried", two_parts, &[&[(Part(BOX), 40, END)], &[(Parts, 40, END)]]),
        Scene::new(
            "a part is handed over",
            gives,
            &[&[(Hand(Left), 20, END), (Parts, 60, END)], &all(78, 8)],
        ),
        Scene::new("both hands are at two parts that meet", meet, &[&unseen_bringing]),
    ]
}

fn scenes() -> Vec<Scene> {
    scenes_of_one_hand().into_iter().chain(scenes_of_two_hands()).collect()
}

/// It holds in the scenes with their own gaps and with known ones, and hardly ever fails with drawn ones.
fn holds(wrong: impl Fn(&Scene, &[Gap]) -> Option<String>) {
    let scenes = scenes();
    let cases = scenes.iter().flat_map(|scene| scene.gaps.iter().map(move |gaps| (scene, gaps)));
    let before: Vec<String> = cases.filter_map(|(scene, gaps)| wrong(scene, gaps)).collect();
    assert!(before.is_empty(), "{before:#?}");
    let case = (0..scenes.len(), gaps(&[TOOL, BOX, CUP], 120));
    hardly_ever(0.002, "broken", |seed| {
        wrong_cases(1_000, seed, &case, |(scene, gaps)| wrong(&scenes[scene], &gaps))
    });
}

/// What is not seen of a bench that is seen whole: nothing.
const OF_BENCH: [Unseen; 4] = [Unseen::MOVER, Unseen::CARRIER, Unseen::BENCH, Unseen::FRAME];

/// The first frame in which a hand of a scene, or its bench, is in doubt though all of it is seen. What a hand was at from the first frame on may have
/// come to it before. Of two parts that lie side by side nobody sees which one it took ([`Unseen::TAKING`]).
fn doubtful(scene: &Scene) -> Option<usize> {
    let whole = &scene.whole;
    let is_there = |hand: usize| scene.bench.frames[0].hands.iter().any(|seen| seen.side.index() == hand);
    let begins = |hand: usize| {
        let mut frames = PERSIST..whole.len();
        frames.find(|frame| !touched(&whole[*frame], hand).is_touch()).unwrap_or(whole.len())
    };
    let is_doubtful = |frame: usize, hand: usize| {
        let couple = &whole[frame].hands[hand];
        let doubts = if frame < begins(hand) { &DOUBTS[..2] } else { &DOUBTS[..4] };
        couple.visibility != [Visibility::Seen; 3] || doubts.iter().any(|doubt| couple.lacks(*doubt))
    };
    // In the first frames nothing is known of what was before, in the last ones of what comes.
    (PERSIST..whole.len() - PERSIST).find(|frame| {
        OF_BENCH.iter().any(|doubt| whole[*frame].lacks(*doubt))
            || (0..2).any(|hand| is_there(hand) && is_doubtful(*frame, hand))
    })
}

#[test]
fn who_sees_all_is_in_no_doubt() {
    for scene in scenes() {
        let doubtful = doubtful(&scene);
        assert!(
            doubtful.is_none(),
            "{}: {doubtful:?} {:?}",
            scene.name,
            doubtful.map(|frame| scene.whole[frame].hands)
        );
    }
}

#[test]
fn who_sees_less_is_certain_of_no_other_touch() {
    holds(|scene, gaps| {
        let at = contradicted(&scene.whole, &scene.less(gaps))?;
        Some(format!("{}: {at:?} {gaps:?}", scene.name))
    });
}

/// The hands and objects that touch each other in a row of frames: the first, and the one behind the last.
fn touches(couples: &[Couples], hand: usize) -> Vec<(Context, usize, usize)> {
    let mut touches: Vec<(Context, usize, usize)> = Vec::new();
    for (frame, couples) in couples.iter().enumerate() {
        let context = touched(couples, hand);
        match touches.last_mut() {
            Some((before, _, end)) if *before == context => *end = frame + 1,
            _ => touches.push((context, frame, frame + 1)),
        }
    }
    touches.retain(|(context, begin, end)| context.is_touch() && end - begin > 2 * PERSIST);
    touches
}

/// Whether this frame says that something was not seen of a hand or the bench.
fn says_so(couples: &Couples, hand: usize) -> bool {
    let is_hidden = couples.hands[hand].visibility.iter().any(|visibility| *visibility != Visibility::Seen);
    is_hidden
        || DOUBTS.iter().any(|doubt| couples.hands[hand].lacks(*doubt))
        || OF_BENCH.iter().any(|doubt| couples.lacks(*doubt))
}

#[test]
fn no_touch_is_lost_without_a_word() {
    holds(|scene, gaps| {
        let (whole, less) = (&scene.whole, scene.less(gaps));
        (0..2).find_map(|hand| {
            let is_lost = |(context, begin, end): &(Context, usize, usize)| {
                let is_there = less[*begin..*end].iter().any(|couples| touched(couples, hand) == *context);
                let from = begin.saturating_sub(PERSIST);
                !is_there && !less[from..].iter().any(|couples| says_so(couples, hand))
            };
            let lost = touches(whole, hand).into_iter().find(is_lost)?;
            Some(format!("{}: {lost:?} of hand {hand} {gaps:?}", scene.name))
        })
    });
}

/// Whether both hands touch what they do for all of these frames.
fn goes_on(couples: &[Couples]) -> bool {
    let is_same = |hand: usize| {
        let mut contexts = couples.iter().map(|couples| touched(couples, hand));
        contexts.next().is_none_or(|first| contexts.all(|context| context == first))
    };
    is_same(0) && is_same(1)
}

/// A hand or a part that is hidden for no longer than its pose is assumed.
fn short((hidden, from, count): Gap) -> Option<Gap> {
    matches!(hidden, Hand(_) | Part(_)).then_some((hidden, from, 1 + count % BLIND))
}

#[test]
fn what_goes_on_behind_a_short_gap_is_the_same() {
    holds(|scene, gaps| {
        let gap = short(gaps[0])?;
        let (_, from, count) = gap;
        let whole = &scene.whole;
        let around = from.saturating_sub(2 * PERSIST)..(from + count + 2 * PERSIST).min(whole.len());
        if from >= whole.len() || !goes_on(&whole[around.clone()]) {
            return None;
        }
        let less = scene.less(&[gap]);
        let differs =
            |frame: &usize| (0..2).any(|hand| touched(&less[*frame], hand) != touched(&whole[*frame], hand));
        let frame = around.clone().find(differs)?;
        Some(format!("{}: frame {frame} {gap:?}", scene.name))
    });
}
