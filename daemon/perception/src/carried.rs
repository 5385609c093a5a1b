//! An object whose marker is hidden moves with the hand that carries it.
//!
//! ```text
//!              both have travelled TRAVEL_M together
//!   ┌───────┐ ──────────────────────────────────────► ┌─────────┐  marker hidden, hand seen
//!   │ loose │                                         │ carried │ ─────────────────────────► the pose follows the hand
//!   └───────┘ ◄────────────────────────────────────── └─────────┘                            for up to MAX_HIDDEN_NS
//!              one has travelled TRAVEL_M without the other,
//!              or the hand has opened by OPENED_M within OPENING_NS
//!              and the marker has not moved by MOVED_M since
//! ```
//!
//! The criterion is common motion, not nearness. A hand that passes over a part at rest hides its marker, too, and must not take it along.
//!
//! The pose of a carried object goes on the channel with the flag `HELD`, for people and recorders. The method counts it as not seen, and
//! carries hidden objects by contact itself. So a replay has the same information as the running line.
//!
//! On two clips a part that a hand holds is 2 to 4 mm off in the median for up to a second. It would be 13 to 74 mm off if it stayed. A part at rest
//! is taken along in 1 of 915 cases.

use heapless::{Deque, Vec};

use crate::detections::{HANDS, HandDetection, LANDMARKS, OBJECTS, PlacedObject, Side};

/// After this much travel it is decided whether hand and object move together, in metres: twice what landmarks and markers
/// jitter at rest.
const TRAVEL_M: f64 = 0.020;

/// Hand and object move together while the object is within this share of the travel from where the hand would have taken it. It is halfway between
/// moving along and staying behind.
const TOGETHER_SHARE: f64 = 0.5;

/// How long a pose follows the hand, in nanoseconds. A reach takes less, and a part that was put down unseen is misplaced for no longer.
const MAX_HIDDEN_NS: u64 = 1_000_000_000;

/// A grip that has widened by this much has let go, in metres. Landmarks drift by 5 mm, and fingers clear a part on both sides, which takes at least
/// twice that.
const OPENED_M: f64 = 0.010;

/// Letting go takes no longer than this, in nanoseconds; slower changes of a grip are the turns of a wrist.
const OPENING_NS: u64 = 300_000_000;

/// An object that has moved by this much since the hand opened is still carried, in metres. Markers at rest jitter by a tenth of a millimetre, and a
/// part that is put down settles by 2 mm.
const MOVED_M: f64 = 0.005;

/// Number of grips that are remembered: `OPENING_NS` at 60 frames per second.
const GRIPS: usize = 18;

/// Number of neighbouring frames whose median grip counts, so that a tip that leaps in one frame opens no hand.
const MEDIAN_FRAMES: usize = 3;

/// The tips that hold a part: the thumb's, and those opposite to it.
const THUMB: usize = 4;
const OPPOSITE: [usize; 2] = [8, 12];

/// Landmarks that move with what the hand holds: wrist, knuckles, and the tips that grip.
const GRIP: [usize; 8] = [0, 5, 9, 13, 17, 4, 8, 12];

/// A hand in the bench frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedHand {
    /// Which hand.
    pub side: Side,
    /// Landmarks in metres; z is 0 in plane mode.
    pub landmarks_m: [[f32; 3]; LANDMARKS],
}

impl From<&HandDetection> for PlacedHand {
    fn from(hand: &HandDetection) -> Self {
        Self { side: hand.side, landmarks_m: hand.landmarks_m.map(|[x, y]| [x, y, 0.0]) }
    }
}

/// Hand and object at one moment. Their travel is counted from there.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    hand: PlacedHand,
    object_m: [f32; 3],
}

/// What is known of an object and a hand together.
#[derive(Clone, Copy, Debug)]
struct Pair {
    anchor: Anchor,
    moves_together: bool,
    /// Where the object was when the hand seemed to let it go, until it moves again.
    left_at_m: Option<[f32; 3]>,
    /// The hand when the object was last seen.
    last_hand: PlacedHand,
}

#[derive(Clone, Copy, Debug)]
struct Known {
    object: PlacedObject,
    seen_ns: u64,
    /// Per hand, indexed by [`Side`].
    pairs: [Option<Pair>; HANDS],
}

/// Follows the objects that the hands carry, frame by frame.
#[derive(Clone, Debug, Default)]
pub struct CarriedObjects {
    known: Vec<Known, OBJECTS>,
    /// Times and widths of the grips in the last frames, per hand, indexed by [`Side`].
    grips: [Deque<(u64, f64), GRIPS>; HANDS],
}

impl CarriedObjects {
    /// Takes in the detections of a frame, and returns the poses of carried objects whose markers were not detected. Hands
    /// without finite landmarks count as unseen.
    pub fn step(
        &mut self,
        now_ns: u64,
        hands: &[PlacedHand],
        seen: &[PlacedObject],
    ) -> Vec<PlacedObject, OBJECTS> {
        let mut by_side = [None; HANDS];
        for hand in hands.iter().filter(|hand| GRIP.iter().all(|&index| is_finite(&hand.landmarks_m[index])))
        {
            by_side[hand.side as usize] = Some(*hand);
        }
        for object in seen {
            self.take_in(now_ns, &by_side, object);
        }
        for (side, hand) in by_side.iter().enumerate() {
            if hand.is_some_and(|hand| self.lets_go(side, now_ns, grip_m(&hand))) {
                self.leave_objects(side);
            }
        }
        let is_hidden = |known: &&Known| known.seen_ns < now_ns && now_ns - known.seen_ns <= MAX_HIDDEN_NS;
        self.known.iter().filter(is_hidden).filter_map(|known| known.carried_by(&by_side)).collect()
    }

    /// Takes in an object that was seen. More objects than there is room for are not followed.
    fn take_in(&mut self, now_ns: u64, hands: &[Option<PlacedHand>; HANDS], object: &PlacedObject) {
        if !self.known.iter().any(|known| known.object.id == object.id) {
            let _ = self.known.push(Known { object: *object, seen_ns: now_ns, pairs: [None; HANDS] });
        }
        let Some(known) = self.known.iter_mut().find(|known| known.object.id == object.id) else { return };
        (known.object, known.seen_ns) = (*object, now_ns);
        for (pair, hand) in known.pairs.iter_mut().zip(hands) {
            *pair = hand.map(|hand| Pair::after(pair.take(), hand, object));
        }
    }

    /// Takes in the width of a hand's grip, and returns whether the hand has just opened.
    fn lets_go(&mut self, side: usize, now_ns: u64, grip_m: f64) -> bool {
        let grips = &mut self.grips[side];
        while grips.front().is_some_and(|(then_ns, _)| now_ns.saturating_sub(*then_ns) > OPENING_NS) {
            grips.pop_front();
        }
        if grips.is_full() {
            grips.pop_front();
        }
        // There is room now.
        let _ = grips.push_back((now_ns, grip_m));
        // The oldest and the newest frames must be different ones: under 20 frames per second no opening is found.
        if grips.len() < 2 * MEDIAN_FRAMES {
            return false;
        }
        let widths = || grips.iter().map(|&(_, width_m)| width_m);
        median_of_first(widths().rev()) - median_of_first(widths()) > OPENED_M
    }

    /// The hand of this side leaves its objects where they are.
    fn leave_objects(&mut self, side: usize) {
        for Known { object, pairs, .. } in &mut self.known {
            if let Some(pair) = &mut pairs[side] {
                pair.left_at_m.get_or_insert(object.position_m);
            }
        }
    }
}

impl Known {
    /// The object's pose, moved by the hand that carries it; `None` where no hand does, or where that hand is unseen.
    fn carried_by(&self, hands: &[Option<PlacedHand>; HANDS]) -> Option<PlacedObject> {
        let mut pairs = self.pairs.iter().zip(hands);
        let (pair, hand) =
            pairs.find_map(|(pair, hand)| Some((pair.as_ref().filter(|pair| pair.is_carried())?, hand)))?;
        Some(Motion::between(&pair.last_hand, hand.as_ref()?).of(&self.object))
    }
}

/// The median of the first `MEDIAN_FRAMES` numbers.
fn median_of_first(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut first: Vec<f64, MEDIAN_FRAMES> = numbers.take(MEDIAN_FRAMES).collect();
    first.sort_unstable_by(f64::total_cmp);
    first[MEDIAN_FRAMES / 2]
}

/// Width of the grip in the bench plane, which a camera over the bench sees well, in metres.
fn grip_m(hand: &PlacedHand) -> f64 {
    let to_thumb = |tip: usize| {
        let [x, y] =
            [0, 1].map(|axis| f64::from(hand.landmarks_m[tip][axis] - hand.landmarks_m[THUMB][axis]));
        x.hypot(y)
    };
    OPPOSITE.iter().map(|&tip| to_thumb(tip)).sum::<f64>() / OPPOSITE.len() as f64
}

impl Pair {
    fn is_carried(&self) -> bool {
        self.moves_together && self.left_at_m.is_none()
    }

    /// The pair after a frame in which both were seen.
    fn after(before: Option<Self>, hand: PlacedHand, object: &PlacedObject) -> Self {
        let here = Anchor { hand, object_m: object.position_m };
        let Some(before) = before else {
            return Self { anchor: here, moves_together: false, left_at_m: None, last_hand: hand };
        };
        let left_at_m = before.left_at_m.filter(|&at_m| distance_m(at_m, here.object_m) <= MOVED_M);
        let from_m = before.anchor.object_m;
        let with_hand_m = Motion::between(&before.anchor.hand, &hand).at(from_m);
        let travel_m = distance_m(from_m, here.object_m).max(distance_m(from_m, with_hand_m));
        if travel_m < TRAVEL_M {
            return Self { left_at_m, last_hand: hand, ..before };
        }
        let moves_together = distance_m(with_hand_m, here.object_m) <= TOGETHER_SHARE * travel_m;
        Self { anchor: here, moves_together, left_at_m, last_hand: hand }
    }
}

/// A motion of a hand: a turn about the vertical, which a camera over the bench sees well, and a shift.
struct Motion {
    /// Mean of the landmarks before and after, in metres.
    means_m: [[f64; 3]; 2],
    cos: f64,
    sin: f64,
}

impl Motion {
    /// The motion that takes the landmarks of `before` nearest to those of `after` (least squares).
    fn between(before: &PlacedHand, after: &PlacedHand) -> Self {
        let points = [before, after].map(|hand| GRIP.map(|index| hand.landmarks_m[index].map(f64::from)));
        let means_m = points.map(|points| {
            [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64)
        });
        let (mut dot, mut cross) = (0.0, 0.0);
        for (one, two) in points[0].iter().zip(&points[1]) {
            let [x0, y0] = [0, 1].map(|axis| one[axis] - means_m[0][axis]);
            let [x1, y1] = [0, 1].map(|axis| two[axis] - means_m[1][axis]);
            dot += x0 * x1 + y0 * y1;
            cross += x0 * y1 - y0 * x1;
        }
        let (sin, cos) = cross.atan2(dot).sin_cos();
        Self { means_m, cos, sin }
    }

    /// Where a point is after the motion, in metres.
    fn at(&self, point_m: [f32; 3]) -> [f32; 3] {
        let [from, to] = self.means_m;
        let [x, y, z] = [0, 1, 2].map(|axis| f64::from(point_m[axis]) - from[axis]);
        let turned = [self.cos * x - self.sin * y, self.sin * x + self.cos * y, z];
        [0, 1, 2].map(|axis| (to[axis] + turned[axis]) as f32)
    }

    /// An object after the motion.
    fn of(&self, object: &PlacedObject) -> PlacedObject {
        let half = 0.5 * self.sin.atan2(self.cos);
        let (s, c) = half.sin_cos();
        let [w, x, y, z] = object.orientation.map(f64::from);
        // The turn about z times the orientation.
        let orientation =
            [c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w].map(|value| value as f32);
        PlacedObject { id: object.id, position_m: self.at(object.position_m), orientation }
    }
}

fn is_finite(point: &[f32; 3]) -> bool {
    point.iter().all(|value| value.is_finite())
}

fn distance_m(one: [f32; 3], two: [f32; 3]) -> f64 {
    [0, 1, 2].iter().map(|&axis| f64::from(one[axis] - two[axis]).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests;
