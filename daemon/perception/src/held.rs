//! What is in a hand moves with the hand: the pose of an object whose marker is hidden.
//!
//! ```text
//!              both have travelled TRAVEL_M together
//!   ┌───────┐ ──────────────────────────────────────► ┌─────────┐  marker hidden, hand seen
//!   │ loose │                                          │ carried │ ─────────────────────────► the pose follows the hand,
//!   └───────┘ ◄────────────────────────────────────── └─────────┘                            HELD_NS at most
//!              one has travelled TRAVEL_M without the other,
//!              or the hand has opened by OPENED_M within OPENING_NS
//!              and the marker has not moved by MOVED_M since
//! ```
//!
//! Common motion is asked for, not nearness: a hand that passes over a part at rest hides its marker too, and must not
//! take it along.

use heapless::{Deque, Vec};

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

/// A grip that has widened by this much has let go, in metres: landmarks wander by 5 mm, and fingers clear a part on both
/// sides, which takes twice that at least.
const OPENED_M: f64 = 0.010;

/// Letting go takes no longer than this, in nanoseconds; the slow changes of a grip are the turns of a wrist.
const OPENING_NS: u64 = 300_000_000;

/// What has moved by this much since the hand opened is held all the same, in metres: markers at rest wander by a tenth of
/// a millimetre, and a part that is put down settles by 2.
const MOVED_M: f64 = 0.005;

/// Grips that are remembered: OPENING_NS at 60 frames a second.
const GRIPS: usize = 18;

/// Neighbouring frames of which the middle grip counts: a tip that leaps in one frame opens no hand.
const SETTLED: usize = 3;

/// The tips that a part is held between: the thumb's, and those against it.
const THUMB: usize = 4;
const AGAINST: [usize; 2] = [8, 12];

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
    /// Where the object was when the hand seemed to let it go, until it moves again.
    left_at: Option<[f32; 3]>,
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
    /// When and how wide each hand gripped in the last frames, by hand as in [`Side`].
    grips: [Deque<(u64, f64), GRIPS>; HANDS],
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
        for side in 0..HANDS {
            if hand(side).is_some_and(|hand| self.lets_go(side, now_ns, grip_m(hand))) {
                for Known { object, pairs, .. } in &mut self.known {
                    if let Some(pair) = &mut pairs[side] {
                        pair.left_at.get_or_insert(object.position_m);
                    }
                }
            }
        }
        let is_hidden = |known: &&Known| known.seen_ns < now_ns && now_ns - known.seen_ns <= HELD_NS;
        self.known
            .iter()
            .filter(is_hidden)
            .filter_map(|Known { object, pairs, .. }| {
                let (side, pair) = pairs
                    .iter()
                    .enumerate()
                    .find_map(|(side, pair)| Some((side, pair.filter(Pair::holds)?)))?;
                Some(Motion::between(&pair.last_hand, hand(side)?).of(object))
            })
            .collect()
    }

    /// Takes in how wide a hand grips, and tells whether it has just opened.
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
        // The oldest and the newest must be different frames: under 20 frames a second nothing is told.
        if grips.len() < 2 * SETTLED {
            return false;
        }
        let widths = || grips.iter().map(|&(_, width_m)| width_m);
        middle(widths().rev()) - middle(widths()) > OPENED_M
    }
}

/// The middle one of the first SETTLED numbers.
fn middle(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut first: Vec<f64, SETTLED> = numbers.take(SETTLED).collect();
    first.sort_unstable_by(f64::total_cmp);
    first[SETTLED / 2]
}

/// How wide the grip is, in metres of the bench plane: what a camera over the bench sees well.
fn grip_m(hand: &PlacedHand) -> f64 {
    let away = |k: usize| {
        let [x, y] = [0, 1].map(|axis| f64::from(hand.landmarks_m[k][axis] - hand.landmarks_m[THUMB][axis]));
        x.hypot(y)
    };
    AGAINST.iter().map(|&k| away(k)).sum::<f64>() / AGAINST.len() as f64
}

impl Pair {
    fn holds(&self) -> bool {
        self.carried && self.left_at.is_none()
    }

    /// The pair after a frame in which both were seen.
    fn seen(before: Option<Self>, hand: PlacedHand, object: &PlacedObject) -> Self {
        let here = Anchor { hand, object: object.position_m };
        let Some(before) = before else {
            return Self { anchor: here, carried: false, left_at: None, last_hand: hand };
        };
        let left_at = before.left_at.filter(|&at| distance(at, here.object) <= MOVED_M);
        let from = before.anchor.object;
        let taken = Motion::between(&before.anchor.hand, &hand).at(from);
        let travel = distance(from, here.object).max(distance(from, taken));
        if travel < TRAVEL_M {
            return Self { left_at, last_hand: hand, ..before };
        }
        let carried = distance(taken, here.object) <= TOGETHER * travel;
        Self { anchor: here, carried, left_at, last_hand: hand }
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
