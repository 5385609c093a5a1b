//! Bytes as a worker: frames for the encoder, or couples that bypass it, and a job to judge them by.

use super::Input;
use super::ledger::Ledger;
use andon_core::anomaly::Judge;
use andon_core::bounds::{Around, Bounds, Range};
use andon_core::capacity::OBJECTS;
use andon_core::config::Method;
use andon_core::couple::{Context, Couple, Couples, Encoder, Motion, Visibility, Waiting};
use andon_core::dtw::OnlineDtw;
use andon_core::input::{Frame, Hand, Object, Side, Space};
use andon_core::job::{Job, JobObject, Law, LocalCost, MeasureBounds, NominalActivity, NominalIu, Shown};
use andon_core::object::ObjectShape;
use andon_core::set::{ActivitySet, ObjectSet};

/// Number of objects that the bytes can refer to.
const KNOWN: u8 = 6;

/// Contexts that the bytes can refer to: idle, and grasp, contact and release by either hand.
const CONTEXTS: [[u16; 4]; 8] = [
    [0, 0, 0, 0],
    [1, 1, 0, 0],
    [1, 1, 1, 2],
    [0, 0, 1, 2],
    [2, 3, 0, 0],
    [2, 3, 3, 4],
    [1, 5, 0, 0],
    [1, 5, 5, 1],
];

/// Runs the whole core on a worker that is made of `bytes`.
pub fn couple_stream(bytes: &[u8]) {
    let mut input = Input(bytes);
    let method = method(&mut input);
    let taught: Vec<Vec<Taught>> = (0..1 + input.below(4)).map(|_| activity(&mut input)).collect();
    let lent: Vec<Vec<NominalIu<'_>>> =
        taught.iter().map(|ius| ius.iter().map(Taught::lend).collect()).collect();
    // Each activity is fulfilled by two sequences.
    let activities: Vec<NominalActivity<'_>> =
        (0u16..).zip(&lent).map(|(index, ius)| NominalActivity { activity: index / 2, ius }).collect();
    let cost = match input.below(4) {
        0 => LocalCost::Ordinal,
        _ => LocalCost::Circular { bins: method.bins },
    };
    let laws: Vec<Law> = (0..input.below(4)).map(|_| law(&mut input)).collect();
    let max_slowdown = 1.0 + input.below(3) as f32;
    let min_captured = input.below(3) as f32 / 2.0;
    let has_free_ends = input.below(2) == 0;
    let (activities, laws) = (&activities, &laws);
    let job_object = |id: u16| JobObject {
        id,
        used_by: ActivitySet::first((id != 5).into()),
        moved_by: ActivitySet::first(if id == 1 { 2 } else { 0 }),
    };
    let objects: Vec<JobObject> = (1..=u16::from(KNOWN)).map(job_object).collect();
    let objects = &objects;
    let job = Job {
        activities,
        laws,
        objects,
        passive_contacts: &[6],
        cost,
        max_slowdown,
        has_free_ends,
        min_captured,
    };
    let Ok(judge) = Judge::with_memory(&job, method) else { return };
    let mut line = Line { judge, ledger: Ledger::default() };
    if input.below(3) == 0 {
        line.take_couples(&mut input);
    } else {
        line.take_frames(&mut input, method);
    }
    line.judge.finish(&mut |event| line.ledger.record(event));
    line.ledger.check();
}

fn method(input: &mut Input<'_>) -> Method {
    let default = Method::default();
    Method {
        space: if input.below(2) == 0 { Space::Plane } else { Space::Metric },
        rate_hz: [1.0, 15.0, 30.0, 60.0][usize::from(input.below(4))],
        // Mostly the default: most other numbers have no scale that is exact enough, and finding the best one takes longer than everything else.
        bins: [4, 7, 12].get(usize::from(input.below(32))).copied().unwrap_or(default.bins),
        persist_frames: 1 + input.below(15),
        filter_frames: 1 + 2 * input.below(16),
        blind_ms: 4 * u32::from(input.byte()),
        // With 0, a job ends in the first frame without a hand.
        idle_end_ms: 20 * u32::from(input.byte()),
        ..default
    }
}

/// A law, which may be one that cannot be kept.
fn law(input: &mut Input<'_>) -> Law {
    let set = |bits: u8| (0..4).filter(|activity| bits >> activity & 1 == 1).collect();
    Law {
        after_begin: set(input.below(4)),
        after_end: set(input.below(4)),
        usually_after: set(input.below(4)),
        is_required: input.below(4) > 0,
        completes: set(input.below(4)),
        is_once: input.below(2) == 0,
        allows_insertions: input.below(4) == 0,
        runs: input.byte().into(),
    }
}

/// One nominal IU with its own memory.
struct Taught {
    context: Context,
    reference: Vec<Motion>,
    threshold: f32,
    frames: Bounds,
    reversals: Bounds,
    measures: MeasureBounds,
}

impl Taught {
    fn lend(&self) -> NominalIu<'_> {
        let Self { context, threshold, frames, reversals, measures, .. } = *self;
        NominalIu { context, reference: &self.reference, threshold, frames, reversals, measures }
    }
}

fn activity(input: &mut Input<'_>) -> Vec<Taught> {
    (0..1 + input.below(4)).map(|_| taught(input)).collect()
}

fn taught(input: &mut Input<'_>) -> Taught {
    let bounds =
        |input: &mut Input<'_>| Bounds { min: u32::from(input.below(8)), max: 4 * u32::from(input.byte()) };
    Taught {
        context: Context(CONTEXTS[usize::from(input.below(8))]),
        reference: vec![motion(input); usize::from(input.byte())],
        threshold: f32::from(input.byte()),
        frames: bounds(input),
        reversals: bounds(input),
        measures: measures(input),
    }
}

fn measures(input: &mut Input<'_>) -> MeasureBounds {
    let metres = |input: &mut Input<'_>| f32::from(input.byte()) / 100.0;
    let range = |input: &mut Input<'_>| Range { min: metres(input) / 10.0, max: 0.1 + metres(input) };
    MeasureBounds {
        stroke_m: range(input),
        path_m: range(input),
        max_detour_m: if input.below(2) == 0 { metres(input) } else { f32::INFINITY },
        max_lateral_m: if input.below(2) == 0 { metres(input) } else { f32::INFINITY },
        axis: Around { centre: [metres(input), 0.0], max: metres(input) },
        place_m: Around { centre: [0.0, metres(input), 0.0], max: metres(input) },
        shown: (input.below(4) > 0).then(|| shown(input)),
    }
}

/// What was shown, which need not fit the bounds.
fn shown(input: &mut Input<'_>) -> Shown {
    let counts = Bounds { min: u32::from(input.below(8)), max: u32::from(input.byte()) };
    let metres = Range { min: 0.0, max: f32::from(input.byte()) / 100.0 };
    let (stroke_m, path_m, detour_m, lateral_m) = (metres, metres, metres.max, metres.max);
    Shown {
        frames: counts,
        reversals: counts,
        stroke_m,
        path_m,
        detour_m,
        lateral_m,
        axis: 0.5,
        place_m: 0.1,
    }
}

/// A motion whose features may be out of range.
fn motion(input: &mut Input<'_>) -> Motion {
    let directions = [input.below(10) as i8 - 1, input.below(10) as i8];
    match input.below(4) {
        0 => Motion(std::array::from_fn(|_| input.byte() as i8)),
        _ => Motion([0, 0, directions[0], 1, 0, directions[1], 1]),
    }
}

/// The judge, and a ledger of its verdicts.
struct Line<'a> {
    judge: Judge<'a, Vec<OnlineDtw<'a>>>,
    ledger: Ledger,
}

impl Line<'_> {
    fn step(&mut self, couples: &Couples) {
        self.ledger.observe(couples);
        self.judge.step(couples, &mut |event| self.ledger.record(event));
    }

    fn command(&mut self) {
        self.ledger.command();
        self.judge.start(&mut |event| self.ledger.record(event));
    }

    /// Feeds the judge couples that no encoder has checked: any sequence of contexts, each for any number of frames.
    fn take_couples(&mut self, input: &mut Input<'_>) {
        self.ledger.expect_anything();
        let mut captured_ns = 0;
        while !input.is_empty() {
            if input.byte() == 0 {
                self.command();
            }
            let contexts = Side::ALL.map(|_| Context(CONTEXTS[usize::from(input.below(8))]));
            let visibility = [(); 3].map(|()| {
                [Visibility::Seen, Visibility::Assumed, Visibility::Unseen][usize::from(input.below(24) / 11)]
            });
            // Each of the observations is missing now and then.
            let unseen = (0..9).filter(|_| input.below(8) == 0).collect();
            let drift_m = [0.0, 0.02, f32::MAX][usize::from(input.below(3))];
            let waiting = [Waiting::No, Waiting::Unknown, Waiting::Yes][usize::from(input.below(3))];
            // Now and then, an IU is longer than can be compared.
            let frames = match input.byte() {
                255 => 2100,
                frames => usize::from(frames % 64),
            };
            for _ in 0..frames {
                captured_ns += 1 + u64::from(input.byte()) * 1_000_000;
                let position = (input.below(4) != 0).then(|| [f32::from(input.byte()) / 100.0; 3]);
                let hand = |side: Side| Couple {
                    context: contexts[side.index()],
                    position,
                    tips: position,
                    drift_m,
                    visibility,
                    unseen,
                    waiting,
                    ..Couple::idle(side, captured_ns)
                };
                let mut hands = Side::ALL.map(hand);
                for hand in &mut hands {
                    hand.motion = (input.below(8) != 0).then(|| motion(input));
                }
                self.step(&Couples {
                    captured_ns,
                    known_ns: captured_ns,
                    unseen,
                    objects: core::array::from_fn(|index| index as u16 + 1),
                    at_start: ObjectSet::from_bits(u32::from(input.byte())),
                    out_of_sight: ObjectSet::from_bits(u32::from(input.byte())),
                    twice: ObjectSet::from_bits(u32::from(input.byte())),
                    hands,
                });
            }
        }
    }

    fn take_frames(&mut self, input: &mut Input<'_>, method: Method) {
        let shapes: Vec<ObjectShape> = (1..=u16::from(KNOWN)).map(shape).collect();
        let Ok(mut encoder) = Encoder::new(method, &shapes) else { return };
        // The encoder promises at most this number of couples per step.
        let max = (f64::from(method.blind_ms) * f64::from(method.rate_hz) / 1000.0).ceil() as usize
            + usize::from(method.persist_frames)
            + 2;
        let mut worker = Worker { captured_ns: input.word() >> input.below(64), ..Worker::default() };
        let mut made = Vec::new();
        while !input.is_empty() {
            if input.byte() == 0 {
                self.command();
            }
            let frame = worker.frame(input);
            if encoder.step(&frame, &mut |couples| made.push(couples)).is_err() {
                assert!(made.is_empty(), "a refused frame changes nothing");
            }
            assert!(made.len() <= max, "{} couples in one step, at most {max} are promised", made.len());
            made.drain(..).for_each(|couples| self.step(&couples));
        }
        encoder.flush(&mut |couples| made.push(couples));
        made.drain(..).for_each(|couples| self.step(&couples));
    }
}

fn shape(id: u16) -> ObjectShape {
    let points = [[0.0; 3], [0.04, 0.0, 0.01]];
    ObjectShape {
        id,
        interaction_points: points.into_iter().take(1 + usize::from(id) % 2).collect(),
        start: (id == 1).then_some(Around { centre: [0.0; 3], max: 0.1 }),
        ..ObjectShape::default()
    }
}

/// The positions of hands and objects, in centimetres.
#[derive(Default)]
struct Worker {
    captured_ns: u64,
    hands: [[i8; 3]; 2],
    objects: [[i8; 3]; KNOWN as usize],
}

impl Worker {
    /// Moves hands and objects as the bytes say, and lets as much time pass as they say.
    fn frame(&mut self, input: &mut Input<'_>) -> Frame {
        const PERIOD_NS: u64 = 33_333_333;
        self.captured_ns = match input.byte() {
            0 => input.word(),
            1 => self.captured_ns.saturating_sub(1),
            2 => self.captured_ns,
            3 => self.captured_ns.saturating_add(PERIOD_NS << input.below(12)),
            jitter => self.captured_ns.saturating_add(PERIOD_NS + u64::from(jitter) * 20_000),
        };
        let step = |input: &mut Input<'_>| [0; 3].map(|_: i8| input.below(9) as i8 - 4);
        let what = input.byte();
        for hand in &mut self.hands {
            let step = step(input);
            *hand = std::array::from_fn(|axis| hand[axis].wrapping_add(step[axis]));
        }
        // An object comes to the right hand, which is how contacts begin.
        let object = usize::from(input.below(KNOWN));
        if what & 4 != 0 {
            self.objects[object] = self.hands[0];
        }
        let mut frame = Frame { captured_ns: self.captured_ns, ..Frame::default() };
        self.add_hands(&mut frame, what);
        self.add_objects(&mut frame, what, object);
        frame
    }

    /// Adds the hands that the bits of `what` do not hide.
    fn add_hands(&self, frame: &mut Frame, what: u8) {
        for (side, at) in Side::ALL.into_iter().zip(self.hands) {
            if what >> side.index() & 1 == 0 {
                // A hand that finds no room, or whose position is not a number, is part of the test.
                let at = metres(at, what == 255);
                let hand = Hand {
                    side,
                    score: 1.0,
                    wrist: [at[0], at[1] - 0.17, at[2]],
                    middle_knuckle: [at[0], at[1] - 0.08, at[2]],
                    tips: [at; 3],
                };
                let _ = frame.hands.push(hand);
            }
        }
    }

    /// Adds the objects, except for `moved` if a bit of `what` hides it. Some values of `what` give ids, poses or numbers that are wrong.
    fn add_objects(&self, frame: &mut Frame, what: u8, moved: usize) {
        for (index, at) in self.objects.into_iter().enumerate() {
            if what & 8 == 0 || index != moved {
                let orientation = [f32::from(what), 1.0, 0.0, f32::from(what >> 4)];
                let position = metres(at, what == 254);
                let id = index as u16 + u16::from(what != 253);
                let _ = frame.objects.push(Object { id, position, orientation });
            }
        }
        while what == 252 && frame.objects.len() < OBJECTS {
            let _ = frame.objects.push(Object { id: 9, position: [0.0; 3], orientation: [0.0; 4] });
        }
    }
}

fn metres(centimetres: [i8; 3], nonsense: bool) -> [f32; 3] {
    if nonsense { [f32::NAN, f32::INFINITY, f32::MAX] } else { centimetres.map(|at| f32::from(at) / 100.0) }
}
