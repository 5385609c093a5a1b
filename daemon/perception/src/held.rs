//! What is in a hand moves with the hand: the pose of an object whose marker is hidden.
//!
//! ```text
//!              both have travelled TRAVEL_M together
//!   ┌───────┐ ──────────────────────────────────────► ┌─────────┐  marker hidden, hand seen
//!   │ loose │                                          │ carried │ ─────────────────────────► the pose follows the hand,
//!   └───────┘ ◄────────────────────────────────────── └─────────┘                            HELD_NS at most
//!              one has travelled TRAVEL_M without the other
//! ```
//!
//! Common motion is asked for, not nearness: a hand that passes over a part at rest hides its marker too, and must not
//! take it along.

use heapless::Vec;

use crate::detections::{HANDS, LANDMARKS, OBJECTS, Side};

/// After this much travel it is decided whether hand and object go together, in metres: twice what landmarks and markers
/// wander while at rest.
const TRAVEL_M: f64 = 0.020;

/// Hand and object go together while the object is within this share of the travel from where the hand would have taken
/// it: halfway between going along and staying behind.
const TOGETHER: f64 = 0.5;

/// A pose follows the hand for this long, in nanoseconds: a reach takes less, and a part that was put down unseen goes
/// astray for no longer.
const HELD_NS: u64 = 1_000_000_000;

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

/// An object in the bench frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedObject {
    /// The marker's id, which is the object's.
    pub id: u16,
    /// Centre of the marker in metres.
    pub position_m: [f32; 3],
    /// Unit quaternion (w, x, y, z), marker frame to bench frame.
    pub orientation: [f32; 4],
}

/// Hand and object at one moment, from which their travel counts.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    hand: PlacedHand,
    object: [f32; 3],
}

/// An object and a hand.
#[derive(Clone, Copy, Debug)]
struct Pair {
    anchor: Anchor,
    carried: bool,
    /// The hand when the object was last seen.
    last_hand: PlacedHand,
}

#[derive(Clone, Copy, Debug)]
struct Known {
    object: PlacedObject,
    seen_ns: u64,
    /// By hand, as in [`Side`].
    pairs: [Option<Pair>; HANDS],
}

/// Follows what the hands carry, frame by frame.
#[derive(Clone, Debug, Default)]
pub struct Held {
    known: Vec<Known, OBJECTS>,
}

impl Held {
    /// Takes in what was seen in a frame, and tells where the carried objects are whose markers were not. Hands without
    /// finite landmarks are taken for unseen.
    pub fn step(
        &mut self,
        now_ns: u64,
        hands: &[PlacedHand],
        seen: &[PlacedObject],
    ) -> Vec<PlacedObject, OBJECTS> {
        let hand = |side: usize| {
            hands.iter().find(|hand| {
                hand.side as usize == side && GRIP.iter().all(|&k| is_finite(&hand.landmarks_m[k]))
            })
        };
        for object in seen {
            let known = match self.known.iter_mut().position(|known| known.object.id == object.id) {
                Some(at) => &mut self.known[at],
                None => {
                    let known = Known { object: *object, seen_ns: now_ns, pairs: [None; HANDS] };
                    // More objects than there is room for are not followed.
                    if self.known.push(known).is_err() {
                        continue;
                    }
                    let last = self.known.len() - 1;
                    &mut self.known[last]
                }
            };
            (known.object, known.seen_ns) = (*object, now_ns);
            for (side, pair) in known.pairs.iter_mut().enumerate() {
                *pair = hand(side).map(|hand| Pair::seen(pair.take(), *hand, object));
            }
        }
        let hidden =
            self.known.iter().filter(|known| known.seen_ns < now_ns && now_ns - known.seen_ns <= HELD_NS);
        hidden
            .filter_map(|known| {
                let (side, pair) = known
                    .pairs
                    .iter()
                    .enumerate()
                    .find_map(|(side, pair)| Some((side, pair.filter(|pair| pair.carried)?)))?;
                Some(Motion::between(&pair.last_hand, hand(side)?).of(&known.object))
            })
            .collect()
    }
}

impl Pair {
    /// The pair after a frame in which both were seen.
    fn seen(before: Option<Self>, hand: PlacedHand, object: &PlacedObject) -> Self {
        let here = Anchor { hand, object: object.position_m };
        let Some(before) = before else { return Self { anchor: here, carried: false, last_hand: hand } };
        let from = before.anchor.object;
        let taken = Motion::between(&before.anchor.hand, &hand).at(from);
        let travel = distance(from, here.object).max(distance(from, taken));
        if travel < TRAVEL_M {
            return Self { last_hand: hand, ..before };
        }
        let carried = distance(taken, here.object) <= TOGETHER * travel;
        Self { anchor: here, carried, last_hand: hand }
    }
}

/// A motion of a hand: a turn about the vertical, which a camera over the bench sees well, and a shift.
struct Motion {
    /// Mean of the landmarks before and after.
    means: [[f64; 3]; 2],
    cos: f64,
    sin: f64,
}

impl Motion {
    /// The one that takes the landmarks of `before` nearest to those of `after` (least squares).
    fn between(before: &PlacedHand, after: &PlacedHand) -> Self {
        let points = [before, after].map(|hand| GRIP.map(|k| hand.landmarks_m[k].map(f64::from)));
        let means = points.map(|points| {
            [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64)
        });
        let (mut dot, mut cross) = (0.0, 0.0);
        for (one, two) in points[0].iter().zip(&points[1]) {
            let [x0, y0] = [0, 1].map(|axis| one[axis] - means[0][axis]);
            let [x1, y1] = [0, 1].map(|axis| two[axis] - means[1][axis]);
            dot += x0 * x1 + y0 * y1;
            cross += x0 * y1 - y0 * x1;
        }
        let (sin, cos) = cross.atan2(dot).sin_cos();
        Self { means, cos, sin }
    }

    fn at(&self, point: [f32; 3]) -> [f32; 3] {
        let [from, to] = self.means;
        let [x, y, z] = [0, 1, 2].map(|axis| f64::from(point[axis]) - from[axis]);
        let turned = [self.cos * x - self.sin * y, self.sin * x + self.cos * y, z];
        [0, 1, 2].map(|axis| (to[axis] + turned[axis]) as f32)
    }

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

fn distance(one: [f32; 3], two: [f32; 3]) -> f64 {
    [0, 1, 2].iter().map(|&axis| f64::from(one[axis] - two[axis]).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests;
