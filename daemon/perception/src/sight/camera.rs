//! Whether the camera was moved. Markers that lay still then all lie elsewhere in the picture, as if it had been shifted, turned or scaled as one.
//!
//! Parts are moved, too, and sometimes several at once. So the markers must have moved at one time, and at least one of them lay where no hand was.
//! Nothing that is seen may have stayed from where the picture's movement would have taken it. A tray that carries all parts away looks the same from
//! above.
//!
//! The fault clears when the markers lie where they lay before. Without a calibration it also clears after ten seconds, because every scale
//! then comes from the picture itself. With one, nothing in the picture says that the calibration is right again.

use super::observation::{Corners, Observation, SeenMarker, centre, distance, side};
use std::vec::Vec;

/// Nanoseconds of a second.
const S: f32 = 1e9;

/// A marker lies still while its corners stay within this, in sides of the marker: far above the noise of a corner.
const STILL: f32 = 0.1;
/// It lies where it is when it has done so for this long, in seconds. Longer than a part is held still in a hand on its way.
const REST_S: f32 = 1.0;
/// A marker that came to lie further away than this has moved, in sides of the marker. A camera that sags by less disturbs nobody.
const MOVED: f32 = 0.2;
/// Markers are moved as one if no centre is further than this from where the picture's movement takes it, in sides...
const AS_ONE: f32 = 0.03;
/// ... and as a share of its way: a camera that is tilted shows a little perspective, and parts differ in height.
const AS_ONE_OF_WAY: f32 = 0.1;
/// Each marker is turned and scaled as the whole: none of its corners is off by more than this, in sides. Two parts that were moved
/// apart from each other may lie as if the picture had been turned, but are hardly turned alike.
const ALIKE: f32 = 0.02;
/// The camera is back if nothing is further than this from where it would be seen, in sides.
const BACK: f32 = 0.25;
/// Where a hand is nearer than this to a marker, it may have moved it, in sides.
const REACH: f32 = 2.5;
/// Markers are first seen in another place at slightly different times, in seconds.
const AT_ONCE_S: f32 = 0.4;
/// What moved longer ago than this does not belong together, in seconds.
const FORGET_S: f32 = 5.0;
/// Without a calibration every scale comes from the markers in the picture. A new view is as good as the old one when it has lasted for
/// so long, in seconds.
const SETTLED_S: f32 = 10.0;

/// A marker, and where it lay.
struct Place {
    id: u16,
    /// Where it is seen now, since when, and until when.
    at: Corners,
    since_ns: u64,
    /// Where it lay at last, since when, and when it was last seen there.
    lay: Option<(Corners, u64, u64)>,
    /// When a hand was last near it.
    handled_ns: u64,
}

impl Place {
    /// Whether a hand moved it when it left at this time. One that has just let go of the part, or was there when it left.
    fn is_handled(&self, left_ns: u64) -> bool {
        self.handled_ns > 0 && self.handled_ns + (AT_ONCE_S * S) as u64 >= left_ns
    }
}

/// A marker that came to lie elsewhere.
#[derive(Clone, Copy)]
struct Move {
    id: u16,
    from: Corners,
    to: Corners,
    /// When it was last seen where it lay, and first seen where it lies now.
    left_ns: u64,
    arrived_ns: u64,
    is_handled: bool,
}

/// Follows where the camera looks.
pub(super) struct Camera {
    is_calibrated: bool,
    places: Vec<Place>,
    moves: Vec<Move>,
    /// The camera looks elsewhere.
    moved: Option<Moved>,
    /// It may have been moved just now.
    may_be_moved: bool,
}

/// A camera that has been moved.
struct Moved {
    since_ns: u64,
    /// From the view that is known to the one now.
    view: Shift,
    /// Where markers lay in the view that is known.
    known: Vec<(u16, Corners)>,
}

impl Camera {
    pub(super) fn new(is_calibrated: bool) -> Self {
        Self { is_calibrated, places: Vec::new(), moves: Vec::new(), moved: None, may_be_moved: false }
    }

    /// Since when the camera has been moved.
    pub(super) fn moved_since_ns(&self) -> Option<u64> {
        self.moved.as_ref().map(|moved| moved.since_ns)
    }

    /// Whether the newest picture looks as if the camera was moved, whether it turns out so or not.
    pub(super) fn may_be_moved(&self) -> bool {
        self.may_be_moved
    }

    pub(super) fn step(&mut self, observation: &Observation) {
        let now_ns = observation.at_ns;
        let age_s = |from_ns: u64| now_ns.saturating_sub(from_ns) as f32 / S;
        self.moves.retain(|moved| age_s(moved.arrived_ns) <= FORGET_S);
        self.note_hands(observation);
        for marker in &observation.markers {
            let moved = self.see(marker, now_ns);
            if let Some(moved) = moved {
                self.moves.retain(|other| other.id != moved.id);
                self.moves.push(moved);
            }
        }
        if let Some(shifted) = self.shift(&self.moves, |moved| moved.arrived_ns) {
            self.moves.clear();
            self.take(shifted);
        }
        let under_way: Vec<Move> =
            observation.markers.iter().filter_map(|marker| self.under_way(marker)).collect();
        self.may_be_moved = self.shift(&under_way, |moved| moved.left_ns).is_some();
        let has_settled =
            |moved: &Moved| !self.is_calibrated && age_s(moved.since_ns) > SETTLED_S || self.is_back(moved);
        if self.moved.as_ref().is_some_and(has_settled) {
            self.moved = None;
        }
    }

    fn note_hands(&mut self, observation: &Observation) {
        for place in &mut self.places {
            let (centre, side) = (centre(&place.at), side(&place.at));
            let is_near = |point: &[f32; 2]| distance(*point, centre) < REACH * side;
            if observation.hands_px.iter().flatten().any(is_near) {
                place.handled_ns = observation.at_ns;
            }
        }
    }

    /// Takes where a marker is seen. Gives its move, if it has come to lie elsewhere.
    fn see(&mut self, marker: &SeenMarker, now_ns: u64) -> Option<Move> {
        let SeenMarker { id, corners } = *marker;
        let Some(place) = self.places.iter_mut().find(|place| place.id == id) else {
            self.places.push(Place { id, at: corners, since_ns: now_ns, lay: None, handled_ns: 0 });
            return None;
        };
        if !is_within(STILL, &place.at, &corners) {
            (place.at, place.since_ns) = (corners, now_ns);
        }
        if let Some((lay, _, seen_ns)) = &mut place.lay
            && is_within(MOVED, lay, &corners)
        {
            *seen_ns = now_ns;
            return None;
        }
        if (now_ns.saturating_sub(place.since_ns) as f32) < REST_S * S {
            return None;
        }
        // By now it has settled.
        let (from, _, left_ns) = place.lay.replace((corners, place.since_ns, now_ns))?;
        let (to, arrived_ns) = (corners, place.since_ns);
        let is_handled = place.is_handled(left_ns);
        Some(Move { id, from, to, left_ns, arrived_ns, is_handled })
    }

    /// The move of a marker that is not where it lay, before it is known where it comes to lie.
    fn under_way(&self, marker: &SeenMarker) -> Option<Move> {
        let place = self.places.iter().find(|place| place.id == marker.id)?;
        let (from, _, left_ns) = place.lay.filter(|(lay, ..)| !is_within(MOVED, lay, &marker.corners))?;
        let is_handled = place.is_handled(left_ns);
        Some(Move { id: marker.id, from, to: marker.corners, left_ns, arrived_ns: left_ns, is_handled })
    }

    /// How the picture was shifted and when, if that is what the newest of these moves say. `over_ns` tells when a move is over: what lies where it
    /// lay after that has stayed.
    fn shift(&self, moves: &[Move], over_ns: impl Fn(&Move) -> u64) -> Option<Moved> {
        let newest = moves.last()?;
        let at_once_ns = (AT_ONCE_S * S) as u64;
        let is_at_once = |moved: &&Move| {
            moved.left_ns <= newest.arrived_ns + at_once_ns && newest.left_ns <= moved.arrived_ns + at_once_ns
        };
        let together: Vec<Move> = moves.iter().filter(is_at_once).copied().collect();
        let since_ns = together.iter().map(|moved| moved.left_ns).max()?;
        let arrived_ns = together.iter().map(|moved| moved.arrived_ns).min()?;
        let last_ns = together.iter().map(over_ns).max()?;
        let alone = together.iter().filter(|moved| !moved.is_handled);
        let pushed_ns = alone.map(|moved| moved.left_ns).max()?;
        // A part that was in a hand before the camera was pushed has gone a way of its own as well. So has one that is in a hand for longer.
        let must_fit = |moved: &&Move| {
            let is_carried =
                moved.left_ns + at_once_ns < pushed_ns || moved.arrived_ns > arrived_ns + at_once_ns;
            !moved.is_handled || !is_carried
        };
        // One marker alone does not say to within a pixel where the other end of the picture was turned to.
        let fitting: Vec<Move> = together.iter().filter(must_fit).copied().collect();
        let shift = Shift::of(&fitting)?;
        // What lies in the middle of a turn hardly moves. What is on its way may pass by where it lay.
        let has_stayed = self.places.iter().any(|place| {
            place.lay.is_some_and(|(lay, lay_since_ns, seen_ns)| {
                let is_there =
                    lay_since_ns < since_ns && seen_ns > last_ns && is_within(MOVED, &lay, &place.at);
                is_there && !is_within(MOVED, &lay, &shift.takes(&lay))
            })
        });
        if has_stayed || !fitting.iter().all(|moved| shift.moves(moved)) {
            return None;
        }
        let as_one: Vec<Move> = together.iter().filter(|moved| shift.moves(moved)).copied().collect();
        let view = Shift::of(&as_one).filter(|_| as_one.len() > 1)?;
        Some(Moved { since_ns, view, known: as_one.iter().map(|moved| (moved.id, moved.from)).collect() })
    }

    /// Takes a shift of the picture. One that leads back to the view that is known ends the trouble.
    fn take(&mut self, shifted: Moved) {
        let moved = match self.moved.take() {
            Some(before) => Moved { view: before.view.then(&shifted.view), ..before },
            None => shifted,
        };
        let lie = self.places.iter().filter_map(|place| place.lay);
        let mut corners = lie.map(|(corners, ..)| corners);
        let is_back = corners.all(|corners| is_within(BACK, &corners, &moved.view.back(&corners)));
        self.moved = (!is_back).then_some(moved);
    }

    /// Whether a marker lies where it lay in the view that is known. In another view it would take a great chance.
    fn is_back(&self, moved: &Moved) -> bool {
        self.places.iter().any(|place| {
            let known = moved.known.iter().find(|(id, _)| *id == place.id);
            place.lay.zip(known).is_some_and(|((lay, ..), (_, known))| is_within(STILL, &lay, known))
        })
    }
}

/// Whether no corner is further from the other than this many sides.
fn is_within(sides: f32, one: &Corners, other: &Corners) -> bool {
    let reach = sides * side(other);
    one.iter().zip(other).all(|(one, other)| distance(*one, *other) <= reach)
}

/// A point of the picture, as a complex number.
type Point = [f64; 2];

/// A shift, turn and scale of the picture: `z` becomes `factor * z + offset`, as complex numbers.
#[derive(Clone, Copy)]
struct Shift {
    factor: Point,
    offset: Point,
}

impl Shift {
    /// The one that comes nearest to these moves (least squares); `None` without a move.
    fn of(moves: &[Move]) -> Option<Self> {
        let points = |corners: fn(&Move) -> Corners| -> Vec<Point> {
            moves.iter().flat_map(corners).map(|corner| corner.map(f64::from)).collect()
        };
        let (from, to) = (points(|moved| moved.from), points(|moved| moved.to));
        let (from_mean, to_mean) = (mean(&from), mean(&to));
        let (mut sum, mut square) = ([0.0; 2], 0.0);
        for (from, to) in from.iter().zip(&to) {
            let from = [from[0] - from_mean[0], from[1] - from_mean[1]];
            let to = [to[0] - to_mean[0], to[1] - to_mean[1]];
            sum[0] += from[0] * to[0] + from[1] * to[1];
            sum[1] += from[0] * to[1] - from[1] * to[0];
            square += from[0] * from[0] + from[1] * from[1];
        }
        // Also false where there is no move.
        if square > 0.0 {
            let factor = sum.map(|sum| sum / square);
            let turned = times(factor, from_mean);
            Some(Self { factor, offset: [to_mean[0] - turned[0], to_mean[1] - turned[1]] })
        } else {
            None
        }
    }

    fn at(&self, point: Point) -> Point {
        let turned = times(self.factor, point);
        [turned[0] + self.offset[0], turned[1] + self.offset[1]]
    }

    fn takes(&self, corners: &Corners) -> Corners {
        corners.map(|corner| self.at(corner.map(f64::from)).map(|value| value as f32))
    }

    /// Whether it takes a marker from where it lay to where it lies.
    fn moves(&self, moved: &Move) -> bool {
        let taken = self.takes(&moved.from);
        let ([from, to, taken_to], side) = ([&moved.from, &moved.to, &taken].map(centre), side(&moved.to));
        let about_centre = |corners: &Corners, centre: [f32; 2]| {
            corners.map(|corner| [corner[0] - centre[0], corner[1] - centre[1]])
        };
        let shapes = [about_centre(&moved.to, to), about_centre(&taken, taken_to)];
        distance(taken_to, to) <= AS_ONE * side + AS_ONE_OF_WAY * distance(from, to)
            && is_within(ALIKE, &shapes[1], &shapes[0])
    }

    /// This one, and then another.
    fn then(&self, next: &Self) -> Self {
        Self { factor: times(next.factor, self.factor), offset: next.at(self.offset) }
    }

    /// Where these corners were before.
    fn back(&self, corners: &Corners) -> Corners {
        let [a, b] = self.factor;
        let square = (a * a + b * b).max(f64::MIN_POSITIVE);
        let inverse = [a / square, -b / square];
        corners.map(|corner| {
            let shifted = [0, 1].map(|axis| f64::from(corner[axis]) - self.offset[axis]);
            times(inverse, shifted).map(|value| value as f32)
        })
    }
}

fn mean(points: &[Point]) -> Point {
    let sum = points.iter().fold([0.0; 2], |sum, point| [sum[0] + point[0], sum[1] + point[1]]);
    sum.map(|sum| sum / points.len() as f64)
}

fn times(one: Point, other: Point) -> Point {
    [one[0] * other[0] - one[1] * other[1], one[0] * other[1] + one[1] * other[0]]
}
