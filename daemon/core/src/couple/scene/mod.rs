//! The scene graphs of both hands: poses as nodes, contacts as edges, and the couple that is read off them (paper III-A).

mod distance;
mod grip;
mod hold;
mod in_hand;
mod lying;
mod misreading;
mod sides;
mod unseen;
mod waiting;

use super::contact::Edge;
use super::geometry::squared_distance;
use super::interaction::{self, Interaction};
use super::kinematics::{Kinematics, Precision, Sample, kinematics};
use super::noise::{Drift, MOVED_M, has_moved, jitter_bound_m};
use super::poses::{Grip, HandPose, ObjectPose, REMEMBERED, Recent, Source, UPRIGHT};
use super::{Context, Couple, Couples, Motion, Unseen, Visibility, Waiting};
use crate::capacity::{HANDS, OBJECTS};
use crate::config::Method;
use crate::input::{Frame, Point, Side};
use crate::object::ObjectShape;
use crate::set::ObjectSet;
use core::ops::RangeInclusive;
use distance::Shape;
use heapless::Vec;
use hold::Hold;
use in_hand::{InHand, ObjectContact};
use misreading::Misreading;
use sides::Sides;
use unseen::Glimpses;

/// A parabola explains the positions if their noise bound is at least so many residuals: half of the 5.9 of noise alone, by default. Halved or
/// doubled, none or 1 of 975 runs of people is judged otherwise.
const NOISE_PER_RESIDUAL: f32 = 3.0;

/// An object as a node of the graph.
#[derive(Clone, Debug)]
struct Node {
    shape: Shape,
    poses: Recent<ObjectPose>,
    /// For how many frames it has had a pose.
    known_frames: u32,
    misreading: Misreading,
    drift: Drift,
    glimpses: Glimpses,
    /// How it lies in each hand that holds it; it moves by this while it is hidden.
    grips: [Option<Grip>; HANDS],
    /// Where it was when a hand was last seen anywhere.
    attended: Option<Point>,
}

impl Node {
    fn new(shape: Shape) -> Self {
        Self {
            shape,
            poses: Recent::default(),
            known_frames: 0,
            misreading: Misreading::default(),
            drift: Drift::default(),
            glimpses: Glimpses::default(),
            grips: [None; HANDS],
            attended: None,
        }
    }
}

/// Poses and edges of the newest frames of the grid.
#[derive(Clone, Debug, Default)]
pub(super) struct Scene {
    method: Method,
    /// A hand or object that has not been seen for more frames than this is out of sight (`blind_ms`).
    pub(super) blind_frames: u32,
    /// Motion is measured by positions within this time of the frame, in seconds. It is the window, and half of it for jitter; behind a gap is nothing.
    /// With all positions 4 of 3,700 drawn streams differ, and 30 without the jitter.
    window_s: f64,
    precision: Precision,
    times_ns: Recent<u64>,
    /// [`Couples::unseen`] of the newest frames.
    unseen: Recent<Unseen>,
    /// For each hand, bit k: the frame k frames before the newest shows what it acts on.
    clear: [u32; HANDS],
    /// For each hand, [`Couple::hidden_object`] of the newest frames.
    hidden_objects: [Recent<u16>; HANDS],
    /// For how many frames no hand has been seen.
    handless_frames: u32,
    /// For how many frames no hand has acted on anything.
    idle_frames: u32,
    /// [`Couples::twice`] of the newest frame.
    twice: ObjectSet,
    /// The objects that lie where they do at the beginning of the job.
    at_start: ObjectSet,
    /// For each hand, the objects that were moved while they were hidden, and with which it has not been seen to begin since.
    displaced: [ObjectSet; HANDS],
    /// For each hand, the objects that it may have taken since they were last seen. It was at them or not seen, or was given them.
    may_be_taken: [ObjectSet; HANDS],
    /// For each hand, the objects that it may have been near since they were last seen.
    may_be_touched: [ObjectSet; HANDS],
    /// For each hand, the objects on which it may act instead of its `o_j`.
    alternatives: [ObjectSet; HANDS],
    /// For each hand, the objects that its `o_j` may touch instead of its `o_l`.
    alternative_neighbours: [ObjectSet; HANDS],
    /// The objects that no hand has attended for a while: none was seen anywhere since they were where they are known to have been.
    unattended: ObjectSet,
    hands: [Recent<HandPose>; HANDS],
    misreadings: [Misreading; HANDS],
    sides: Sides,
    /// Sorted by id.
    objects: Vec<Node, OBJECTS>,
    /// From each hand to each object.
    touches: [[Edge; OBJECTS]; HANDS],
    /// For each hand, whether it acts on the object.
    in_hand: [[InHand; OBJECTS]; HANDS],
    /// For each hand, the objects that it acts on and may have let go unseen, while the other hand was at them.
    shared_unseen: [ObjectSet; HANDS],
    /// For each hand, the objects that it has led since it has acted on them.
    led: [ObjectSet; HANDS],
    /// Between each two objects, the lower index first.
    adjacent: [[Edge; OBJECTS]; OBJECTS],
    /// Whether the two touch, rather than pass each other.
    object_contacts: [[ObjectContact; OBJECTS]; OBJECTS],
    interactions: [Interaction; HANDS],
    holds: [Option<Hold>; HANDS],
    /// For how many frames each has been what it is.
    lasted: [u32; HANDS],
    /// What was not seen when each began: [`Unseen::CHANGE`], [`Unseen::ARRIVAL`] and [`Unseen::MOVE`]. The first is the end of the one before, or
    /// whether its two objects touch.
    began: [Unseen; HANDS],
}

impl Scene {
    /// The ids of `shapes` differ; a shape without interaction points or beyond the capacity is left out.
    pub(super) fn new(method: Method, shapes: &[ObjectShape]) -> Self {
        let nodes = shapes.iter().filter_map(|shape| Some(Node::new(Shape::new(shape, &method)?)));
        let mut objects: Vec<Node, OBJECTS> = nodes.take(OBJECTS).collect();
        objects.sort_unstable_by_key(|node| node.shape.id);
        Self {
            method,
            // At most a minute of 240 Hz, see `Method::check`.
            blind_frames: libm::ceil(f64::from(method.blind_ms) * f64::from(method.rate_hz) / 1000.0) as u32,
            precision: Precision::new(&method),
            window_s: 1.5 * f64::from(method.persist_frames) / f64::from(method.rate_hz),
            objects,
            lasted: [u32::MAX; HANDS],
            ..Self::default()
        }
    }

    pub(super) fn clear(&mut self) {
        let objects = self.objects.iter().map(|node| Node::new(node.shape.clone())).collect();
        *self = Self { objects, ..Self::new(self.method, &[]) };
    }

    /// The time of the newest frame, in nanoseconds.
    pub(super) fn newest_ns(&self) -> u64 {
        *self.times_ns.ago(0)
    }

    /// Takes the next frame of the grid, or `None` where it is missing.
    pub(super) fn push(&mut self, captured_ns: u64, frame: Option<&Frame>) {
        self.times_ns.push(captured_ns);
        self.twice =
            frame.iter().flat_map(|frame| &frame.twice).filter_map(|id| self.index_of(*id)).collect();
        self.push_hands(frame);
        self.push_objects(frame);
        self.move_holding_hands();
        self.push_edges();
        let gripped = core::array::from_fn(|hand| self.gripped(hand));
        self.update_grips(gripped);
        self.place_hands(gripped);
        let unseen = Unseen::FRAME.when(frame.is_none())
            | Unseen::MOVER.when(self.have_moved_unseen())
            | Unseen::CARRIER.when(self.are_carried_unseen())
            | Unseen::BENCH.when(self.is_bench_hidden());
        self.unseen.push(unseen);
        self.push_clear();
        self.push_alternatives();
    }

    /// Whether the newest frame calls each hand by the name of the other one.
    pub(super) fn are_hands_swapped(&self) -> bool {
        self.sides.is_swapped
    }

    fn push_hands(&mut self, frame: Option<&Frame>) {
        let mut seen = [None; HANDS];
        for hand in frame.iter().flat_map(|frame| &frame.hands) {
            let index = hand.side.index();
            seen[index] = seen[index].or_else(|| HandPose::seen(hand, self.method.space));
        }
        let seen = self.sides.settle(&self.hands, seen, self.blind_frames, &self.method);
        for ((poses, misreading), seen) in self.hands.iter_mut().zip(&mut self.misreadings).zip(seen) {
            let seen = seen.filter(|seen| {
                misreading.believes(poses.newest_two().map(HandPose::fix), seen.middle_knuckle, &self.method)
            });
            let before = *poses.ago(0);
            let is_elsewhere = |seen: HandPose| {
                let max_m = self.method.hand_contact.on_m;
                squared_distance(seen.grip(), before.grip()) > max_m * max_m
            };
            // It had let go of what it moved with, or holds it otherwise.
            if before.source == Source::Carried && seen.is_some_and(is_elsewhere) {
                poses.revise(before.unseen, |pose| pose.source = Source::Kept);
            }
            poses.push(seen.unwrap_or(before.kept()));
        }
    }

    fn push_objects(&mut self, frame: Option<&Frame>) {
        let mut seen = [None; OBJECTS];
        for object in frame.iter().flat_map(|frame| &frame.objects) {
            if let Some(index) = self.index_of(object.id) {
                seen[index] = seen[index].or_else(|| ObjectPose::seen(object, self.method.space));
            }
        }
        for (node, seen) in self.objects.iter_mut().zip(&mut seen) {
            *seen = seen.filter(|seen| {
                node.misreading.believes(
                    node.poses.newest_two().map(ObjectPose::fix),
                    seen.position,
                    &self.method,
                )
            });
        }
        let persist = u32::from(self.method.persist_frames);
        for (index, seen) in seen.iter().enumerate() {
            if let Some(seen) = seen {
                self.correct_assumed(index, seen);
            }
        }
        for (index, (node, seen)) in self.objects.iter_mut().zip(seen).enumerate() {
            let before = node.poses.ago(0);
            let was_hidden = before.source == Source::Kept && before.unseen > persist;
            if was_hidden && seen.is_some_and(|seen| has_moved(seen.position, before.position)) {
                self.displaced.iter_mut().for_each(|displaced| displaced.set(index, true));
            }
            let grips = node.grips.iter().zip(&self.hands);
            let mut carriers = grips.filter_map(|(grip, hand)| Some(((*grip)?, hand.ago(0))));
            let carrier = carriers.find(|(_, hand)| hand.source == Source::Seen);
            let covers = |hand: &Recent<HandPose>| hand.ago(0).covers(before.position);
            let mut pose = match (seen, carrier) {
                (Some(pose), _) => pose,
                (None, Some((grip, hand))) => grip.carried(hand, before),
                _ => before.kept(self.hands.iter().any(covers)),
            };
            if node.shape.is_position_only {
                pose.orientation = UPRIGHT;
            }
            node.known_frames = node.known_frames.saturating_add((pose.source != Source::Never).into());
            node.poses.push(pose);
        }
    }

    fn index_of(&self, id: u16) -> Option<usize> {
        self.objects.binary_search_by_key(&id, |node| node.shape.id).ok()
    }

    /// The couples of the frame `age` frames before the newest. Call it once for each frame, in order.
    pub(super) fn couples(&mut self, age: usize, known_ns: u64) -> Couples {
        let persist = self.method.persist_frames;
        let count = self.objects.len();
        let touches = self.touches.iter_mut().flat_map(|edges| &mut edges[..count]);
        let adjacent = self.adjacent[..count].iter_mut().enumerate();
        for edge in touches.chain(adjacent.flat_map(|(i, edges)| &mut edges[i + 1..count])) {
            edge.believe(age, persist);
        }
        self.update_in_hand(age);
        self.update_object_contacts(age);
        let mut hands: [Couple; HANDS] = core::array::from_fn(|hand| {
            let touched = self.touched(hand, age);
            let next = self.interactions[hand].next(touched, |j| self.neighbours(j, age));
            // What has just begun goes on for as long as a change takes to be believed.
            let is_settled = self.lasted[hand] >= u32::from(persist);
            let interaction = if is_settled { next } else { self.interactions[hand] };
            let is_same = interaction == self.interactions[hand];
            self.lasted[hand] = if is_same { self.lasted[hand].saturating_add(1) } else { 1 };
            let before = core::mem::replace(&mut self.interactions[hand], interaction);
            if !is_same {
                let involved: ObjectSet = (0..count).filter(|object| interaction.involves(*object)).collect();
                let is_hidden = self.was_hidden(hand, before, age) || self.may_not_touch(interaction);
                // What was moved while it was hidden does not matter for what this hand does after it.
                let displaced = &mut self.displaced[hand];
                let is_displaced = displaced.intersects(involved);
                *displaced = displaced.without(involved);
                self.began[hand] = Unseen::CHANGE.when(is_hidden)
                    | Unseen::ARRIVAL.when(involved.iter().any(|object| self.is_new(object, age)))
                    | Unseen::MOVE.when(is_displaced);
            }
            self.update_alternatives(hand, before, age);
            self.alternative_neighbours[hand] = self.alternative_neighbours(hand, before, age);
            let mut couple = self.couple(hand, interaction, age);
            // Nobody saw when the hand ended what it did before, so it may be doing already what comes after this.
            let is_assumed =
                interaction != next || couple.context.is_release() && couple.lacks(Unseen::CONTEXT);
            let began = self.began[hand];
            couple.unseen |= if is_assumed { began } else { began.without(Unseen::CHANGE) };
            couple
        });
        let waiting = [0, 1].map(|hand| self.waiting(&hands[hand], &hands[1 - hand], age));
        hands.iter_mut().zip(waiting).for_each(|(couple, waiting)| couple.waiting = waiting);
        self.push_drift(age);
        self.push_at_start(age);
        Couples {
            captured_ns: *self.times_ns.ago(age),
            known_ns,
            unseen: *self.unseen.ago(age),
            objects: core::array::from_fn(|index| self.objects.get(index).map_or(0, |node| node.shape.id)),
            at_start: self.at_start,
            out_of_sight: self.out_of_sight(age),
            twice: self.twice,
            hands,
        }
    }

    /// The edges from a hand to the objects that are in it: the one that it acts on, and others at which it rests. One that lets go of it leaves those
    /// beside it at nearly the same time.
    fn touched(&self, hand: usize, age: usize) -> impl Iterator<Item = interaction::Edge> + Clone {
        let former = self.interactions[hand].held();
        let is_touched = move |j: &usize| {
            self.in_hand[hand][*j] == InHand::Yes
                && (former == Some(*j) || self.rests(hand, *j, age) == Some(true))
        };
        (0..self.objects.len()).filter(is_touched).map(move |j| (j, self.distance_from_hand(hand, j, age)))
    }

    /// The edges from an object to the objects that it touches.
    fn neighbours(&self, j: usize, age: usize) -> impl Iterator<Item = interaction::Edge> {
        let touches = move |l: &usize| self.object_contacts[j.min(*l)][j.max(*l)].touches();
        (0..self.objects.len()).filter(touches).map(move |l| (l, self.distance_of_objects(j, l, age)))
    }

    fn couple(&self, hand: usize, interaction: Interaction, age: usize) -> Couple {
        let pose = self.hands[hand].ago(age);
        let (j, l) = (interaction.held(), interaction.pair().map(|(_, l)| l));
        let visibility = |object: usize| match self.objects[object].poses.ago(age) {
            // What a seen hand carries goes with it for longer: how it is seen again shows whether it did.
            pose if self.is_carried(pose) => Visibility::Assumed,
            pose => self.visibility(pose.unseen),
        };
        let [of_j, of_l] = [j, l].map(|object| object.map_or(Visibility::Seen, visibility));
        let from_hand = j.filter(|j| interaction.acts_on(*j));
        let (h, id) = (Side::ALL[hand] as u16, |object: usize| self.objects[object].shape.id);
        let tips = from_hand.and_then(|_| self.tips(hand, age));
        // What the two do before it is known that they touch may be the way to where they do.
        let is_known = !self.may_not_touch(interaction);
        let mut couple = Couple {
            side: Side::ALL[hand],
            captured_ns: *self.times_ns.ago(age),
            motion: self.motion(hand, interaction, age).filter(|_| is_known),
            context: match interaction {
                Interaction::Idle => Context::IDLE,
                Interaction::Acts { j, l: None } => Context([h, id(j), 0, 0]),
                Interaction::Acts { j, l: Some(l) } => Context([h, id(j), id(j), id(l)]),
                Interaction::Released { j, l } => Context([0, 0, id(j), id(l)]),
            },
            position: from_hand
                .filter(|_| is_known)
                .and_then(|j| l.map_or(tips, |l| self.position(j, l, age))),
            tips,
            drift_m: from_hand
                .map_or(0.0, |j| libm::hypotf(self.drift_m(j), l.map_or(0.0, |l| self.drift_m(l)))),
            distances: [
                from_hand.map_or(f32::INFINITY, |j| self.distance_from_hand(hand, j, age)),
                interaction.pair().map_or(f32::INFINITY, |(j, l)| self.distance_of_objects(j, l, age)),
            ],
            visibility: [self.visibility(pose.unseen), of_j, of_l],
            waiting: Waiting::No,
            unseen: (*self.unseen.ago(age) & Unseen::FRAME)
                | Unseen::TAKING.when(!self.alternatives[hand].is_empty()),
            hidden_object: *self.hidden_objects[hand].ago(age),
        };
        // Only now it is known which objects the context depends on.
        let is_clear = self.clear[hand] >> age & 1 == 1 && couple.visibility[1..] == [Visibility::Seen; 2];
        let is_doubtful = self.is_doubtful(hand, age)
            || self.in_hand[hand].contains(&InHand::Unknown)
            || j.is_some_and(|j| self.shared_unseen[hand].contains(j))
            || !self.alternative_neighbours[hand].is_empty()
            || !is_known
            || self.may_have_left(hand, interaction, age)
            || self.may_have_met_or_parted(interaction, age);
        couple.unseen |= Unseen::CONTEXT.when(!is_clear) | Unseen::CHANGE.when(is_doubtful);
        couple
    }

    /// Where `o_j` is in the frame of reference of `o_l`.
    fn position(&self, j: usize, l: usize, age: usize) -> Option<Point> {
        self.steady(age, |age| {
            let [of_j, of_l] = [j, l].map(|object| self.objects[object].poses.ago(age));
            self.are_seen(j, l, age).then(|| of_l.own(of_j.position))
        })
    }

    /// Where the finger tips of a hand are on the bench; `None` where they were neither seen nor assumed.
    fn tips(&self, hand: usize, age: usize) -> Option<Point> {
        self.steady(age, |age| {
            let hand = self.hands[hand].ago(age);
            hand.source.is_known().then(|| hand.acts_at())
        })
    }

    /// A position in the frame of this age. Where one frame alone is too inexact, it is that of the parabola through the frames around it. If these are
    /// farther off it than their errors, the motion is too quick for one.
    fn steady(&self, age: usize, known: impl Fn(usize) -> Option<Point> + Copy) -> Option<Point> {
        let seen = known(age)?;
        let jitter_m = jitter_bound_m(self.around(age).map(known));
        if jitter_m <= MOVED_M {
            return Some(seen);
        }
        let steady =
            self.kinematics(age, known).filter(|motion| NOISE_PER_RESIDUAL * motion.residual_m <= jitter_m);
        Some(steady.map_or(seen, |motion| motion.position))
    }

    /// `x_m` of a hand that acts on an object and of a pair of objects that touch each other. `None` where any of it was not measured.
    fn motion(&self, hand: usize, interaction: Interaction, age: usize) -> Option<Motion> {
        let mut motion = Motion::default();
        let axes = |object: usize| self.objects[object].poses.ago(age).orientation;
        if let Interaction::Acts { j, .. } = interaction {
            let [of_hand, of_j] = [self.hand_kinematics(hand, age)?, self.object_kinematics(j, age)?];
            let [elevation, azimuth] = self.method.direction(&of_hand, axes(j));
            motion.0[0] = self.method.sign(&of_hand);
            motion.0[1..4].copy_from_slice(&[elevation, azimuth, self.method.joint_motion(&of_hand, &of_j)]);
        }
        if let Some((j, l)) = interaction.pair() {
            let [of_j, of_l] = [self.object_kinematics(j, age)?, self.object_kinematics(l, age)?];
            let [elevation, azimuth] = self.method.direction(&of_j, axes(l));
            motion.0[4..7].copy_from_slice(&[elevation, azimuth, self.method.joint_motion(&of_j, &of_l)]);
        }
        Some(motion)
    }

    fn hand_kinematics(&self, hand: usize, age: usize) -> Option<Kinematics> {
        self.kinematics(age, |age| {
            let pose = self.hands[hand].ago(age);
            pose.source.is_known().then_some(pose.middle_knuckle)
        })
    }

    fn object_kinematics(&self, object: usize, age: usize) -> Option<Kinematics> {
        self.kinematics(age, |age| {
            let pose = self.objects[object].poses.ago(age);
            pose.source.is_known().then_some(pose.position)
        })
    }

    /// Where an object is seen in the frame of this age.
    fn seen_object(&self, object: usize, age: usize) -> Option<Point> {
        let pose = self.objects[object].poses.ago(age);
        (pose.source == Source::Seen).then_some(pose.position)
    }

    /// As [`jitter_bound_m`] of all remembered frames, or of those around `age` if it is larger there, as where fingers pass before a marker.
    fn jitter_bound_m(&self, age: usize, known: impl Fn(usize) -> Option<Point> + Copy) -> f32 {
        f32::max(jitter_bound_m((0..REMEMBERED).map(known)), jitter_bound_m(self.around(age).map(known)))
    }

    /// The ages of a frame and of the `persist_frames` before and after it.
    fn around(&self, age: usize) -> RangeInclusive<usize> {
        let half = usize::from(self.method.persist_frames);
        age.saturating_sub(half)..=age + half
    }

    fn kinematics(&self, age: usize, known: impl Fn(usize) -> Option<Point> + Clone) -> Option<Kinematics> {
        let now = *self.times_ns.ago(age);
        let sample = |age: usize| -> Option<Sample> {
            let position = known(age)?;
            let time = *self.times_ns.ago(age);
            let apart = time.abs_diff(now) as f64 * 1e-9;
            (apart < self.window_s).then_some((if time < now { -apart } else { apart }, position))
        };
        kinematics(self.around(age).filter_map(sample), &self.precision)
    }
}
