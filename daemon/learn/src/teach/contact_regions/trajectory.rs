//! What a run shows of the ways of hands and objects.

use super::joining::TOUCH_M;
use super::{PUT_BACK_M, SAME_PLACE_M, median};
use crate::statistics::noise_m;
use andon_core::capacity::HANDS;
use andon_core::input::{Frame, Hand, Point, Space};
use andon_core::object::{ObjectShape, REACH_M};
use andon_core::segment::MOVED_M;
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};

/// The time in which a move is looked for, in seconds: the frames in which a change is believed, by default. Halved, 30 of 70 jobs differ: 5 more
/// right runs are accepted, and 1 fault fewer is found. Doubled, 31 do, and 1 more right run is accepted.
const PERSIST_S: f64 = 1.0 / 6.0;

/// An object dwells where it stays within [`PUT_BACK_M`] for this time, in seconds. Halved or doubled, 18 or 17 of 70 jobs differ: 3 right runs or 1
/// fewer are accepted, and 3 or 2 faults fewer are found.
const DWELL_S: f64 = 0.5;

/// What leaves the place where it dwells and comes back this often makes strokes there. One time is that it comes. With two, 9 of 70 jobs differ: 2
/// more right runs are accepted, and 1 fault fewer is found. With four, 7 do, and 1 more fault is found.
const MIN_RETURNS: usize = 3;

/// When it was carried there, in seconds before it began to dwell. Either end halved, none of 70 jobs differs. The first one doubled, 1 does, and the
/// second one 3: 2 more right runs are accepted, and 1 fault fewer is found.
const CARRIED_S: std::ops::Range<f64> = -0.3..0.7;

/// A pause in which an object that is carried does not move, in seconds. Halved, 9 of 70 jobs differ and no verdict. Doubled, 6 do, and one set
/// teaches no job.
const PAUSE_S: f64 = 1.0;

/// Of two hands that move with an object, both hold it if the farther one does so in this share of the time. It must bring nothing of its own.
/// Otherwise it passes by. With half of the time none of 70 jobs differs, and with all of it 1 does. If both held it always, 11 right runs fewer
/// would be accepted, and 5 faults fewer found.
const BOTH_HOLD: (usize, usize) = (3, 4);

/// The nearer one holds it if it is the nearer one in this share of the time. The object is handed over, or both hold it. Halved or doubled, 1 of 70
/// jobs differs; halved, 1 right run fewer is accepted.
const ONE_HOLDS: (usize, usize) = (1, 4);

pub(super) type Tips = [Point3<f32>; 3];

/// The finger tips of the hands that move with an object, in its frame of reference, by the index of the side. At least one does.
type Carriers = [Option<Tips>; HANDS];

/// The frames of a dwelling, and the places in metres.
pub(super) type Dwell = Vec<(usize, Point3<f32>)>;

pub(super) struct Trajectories {
    times_s: Vec<f64>,
    hands: [Vec<Option<Tips>>; HANDS],
    /// In the order of the shapes.
    objects: Vec<Vec<Option<Isometry3<f32>>>>,
    /// For each object, the least way that is one, in metres: where markers are seen less exactly, it is as much as their errors.
    min_ways_m: Vec<f32>,
    /// For each object, the frames in which it is carried.
    carried: Vec<Vec<(usize, Carriers)>>,
}

impl Trajectories {
    pub(super) fn new(frames: &[Frame], shapes: &[ObjectShape], space: Space) -> Self {
        let flat = |point: Point| Point3::from(space.flat(point));
        let tips = |hand: &Hand| hand.tips.map(flat);
        let of_hand = |index| {
            let seen = |frame: &Frame| frame.hands.iter().find(|hand| hand.side.index() == index).map(tips);
            frames.iter().map(seen).collect()
        };
        let of_object = |shape: &ObjectShape| {
            let seen = |frame: &Frame| {
                let object = frame.objects.iter().find(|object| object.id == shape.id)?;
                let [w, x, y, z] = object.orientation;
                let whole = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
                let orientation = match space {
                    Space::Plane => UnitQuaternion::from_euler_angles(0.0, 0.0, whole.euler_angles().2),
                    Space::Metric => whole,
                };
                let position = Translation3::from(flat(object.position).coords);
                Some(Isometry3::from_parts(position, orientation))
            };
            frames.iter().map(seen).collect()
        };
        let objects: Vec<Vec<Option<Isometry3<f32>>>> = shapes.iter().map(of_object).collect();
        let place = |pose: &Option<Isometry3<f32>>| pose.map(|pose| pose.translation.vector.into());
        let noise_m = |poses: &Vec<_>| noise_m(&poses.iter().map(place).collect::<Vec<_>>());
        let mut ways = Self {
            times_s: frames.iter().map(|frame| frame.captured_ns as f64 * 1e-9).collect(),
            hands: [0, 1].map(of_hand),
            min_ways_m: objects.iter().map(|poses| noise_m(poses).max(MOVED_M)).collect(),
            objects,
            carried: Vec::new(),
        };
        ways.carried = (0..shapes.len()).map(|object| ways.find_carried(object)).collect();
        ways
    }

    /// The orientation of this object counts as that of the bench.
    pub(super) fn forget_orientation(&mut self, object: usize) {
        for pose in self.objects[object].iter_mut().flatten() {
            pose.rotation = UnitQuaternion::identity();
        }
        self.carried[object] = self.find_carried(object);
    }

    fn find_carried(&self, object: usize) -> Vec<(usize, Carriers)> {
        let carriers = |frame: usize| Some((frame, self.carriers(object, frame)?));
        (0..self.times_s.len()).filter_map(carriers).collect()
    }

    pub(super) fn carried_frames(&self, object: usize) -> usize {
        self.carried[object].len()
    }

    /// The finger tips of each hand that holds the object, in its frame of reference, each time that it is carried.
    pub(super) fn holds(&self, object: usize) -> Vec<Vec<Tips>> {
        let holds = self.carried[object].chunk_by(|one, next| self.is_within(PAUSE_S, one, next));
        holds
            .flat_map(|hold| [0, 1].map(|hand| self.held_by(hand, object, hold)))
            .filter(|tips| !tips.is_empty())
            .collect()
    }

    /// The finger tips of one hand while it holds an object, if it does.
    fn held_by(&self, hand: usize, object: usize, hold: &[(usize, Carriers)]) -> Vec<Tips> {
        let (mut nearer, mut all) = (Vec::new(), Vec::new());
        for (frame, carriers) in hold {
            let Some(tips) = carriers[hand] else { continue };
            if carriers[1 - hand].is_none_or(|other| from_middle_m(&tips) <= from_middle_m(&other)) {
                nearer.push(tips);
                all.push(tips);
            } else if !self.carries_nearer(hand, object, *frame, from_middle_m(&tips)) {
                all.push(tips);
            }
        }
        let is_share = |part: &[Tips], (share, of): (usize, usize)| of * part.len() >= share * hold.len();
        if is_share(&all, BOTH_HOLD) {
            all
        } else if is_share(&nearer, ONE_HOLDS) {
            nearer
        } else {
            Vec::new()
        }
    }

    /// Whether a hand moves with another object in this frame that is nearer to it than this one. Beside a hand that brings one part, the other one
    /// may bring another.
    fn carries_nearer(&self, hand: usize, object: usize, frame: usize, than_m: f32) -> bool {
        let tips = |carried: &Vec<(usize, Carriers)>| {
            let index = carried.binary_search_by_key(&frame, |(frame, _)| *frame).ok()?;
            carried[index].1[hand]
        };
        let others = self.carried.iter().enumerate().filter(|(other, _)| *other != object);
        others.filter_map(|(_, carried)| tips(carried)).any(|tips| from_middle_m(&tips) < than_m)
    }

    /// The finger tips of a hand in the frame of reference of an object. They are those of each time that it comes, rests near it with nothing in the
    /// hand, and leaves again. Where the hand is in the beginning or at the end it waits.
    pub(super) fn rests(&self, hand: usize, object: usize) -> Vec<Vec<Tips>> {
        let seen = self.seen_at(hand, object);
        let ends = [seen.first(), seen.last()];
        let waits = |tips: &Tips| ends.iter().flatten().any(|(_, end)| apart_m(end, tips) < PUT_BACK_M);
        let holds_anything = |frame: usize| {
            (0..self.objects.len()).any(|object| self.are_at(object, frame)[hand] == Some(true))
        };
        let is_at = |rest: &&[(usize, Tips)]| {
            let (frame, tips) = &rest[rest.len() / 2];
            from_middle_m(tips) < TOUCH_M
                && !waits(tips)
                && self.is_nearest(hand, object, *frame)
                && !holds_anything(*frame)
        };
        let tips = |rest: &[(usize, Tips)]| rest.iter().map(|(_, tips)| *tips).collect();
        self.still(&seen).into_iter().filter(is_at).map(tips).collect()
    }

    /// The frames that show a hand and an object, with the finger tips in the frame of reference of the object.
    fn seen_at(&self, hand: usize, object: usize) -> Vec<(usize, Tips)> {
        let seen = |(frame, tips): (usize, &Option<Tips>)| {
            let pose = self.objects[object][frame]?;
            Some((frame, (*tips)?.map(|tip| pose.inverse_transform_point(&tip))))
        };
        self.hands[hand].iter().enumerate().filter_map(seen).collect()
    }

    /// The stretches in which finger tips stay where they are for long enough.
    fn still<'a>(&self, seen: &'a [(usize, Tips)]) -> Vec<&'a [(usize, Tips)]> {
        let mut still = Vec::new();
        let mut begin = 0;
        while begin < seen.len() {
            let has_left = |(_, tips): &(usize, Tips)| apart_m(tips, &seen[begin].1) >= SAME_PLACE_M;
            let end = seen[begin..].iter().position(has_left).map_or(seen.len(), |left| begin + left);
            let is_still = self.times_s[seen[end - 1].0] - self.times_s[seen[begin].0] >= DWELL_S;
            still.extend(is_still.then(|| &seen[begin..end]));
            begin = if is_still { end } else { begin + 1 };
        }
        still
    }

    /// Whether no other object that lies is nearer to a hand.
    fn is_nearest(&self, hand: usize, object: usize, frame: usize) -> bool {
        let Some(tips) = self.hands[hand][frame] else { return false };
        let apart_m = |object: usize| {
            let pose = self.objects[object][frame];
            pose.map_or(f32::INFINITY, |pose| (centre(&tips).coords - pose.translation.vector).norm())
        };
        let mut lying = (0..self.objects.len()).filter(|other| !self.is_held(*other, frame));
        lying.all(|other| apart_m(other) >= apart_m(object))
    }

    /// The direction in which the object is carried first, until it stops, on the bench and in its own frame of reference before.
    pub(super) fn first_way(&self, object: usize) -> Option<[Vector3<f32>; 2]> {
        let hold = self.carried[object].chunk_by(|one, next| self.is_within(PERSIST_S, one, next)).next()?;
        let pose = |frame: usize| self.objects[object][frame];
        let (began, ended) = pose(hold.first()?.0).zip(pose(hold.last()?.0))?;
        let way = (ended.translation.vector - began.translation.vector).try_normalize(MOVED_M)?;
        Some([way, began.rotation.inverse_transform_vector(&way)])
    }

    /// How far the object lies at the end from where it lay first, in metres.
    pub(super) fn moved_m(&self, object: usize) -> f32 {
        let seen = || self.objects[object].iter().flatten();
        let (Some(first), Some(last)) = (seen().next(), seen().next_back()) else { return 0.0 };
        (last.translation.vector - first.translation.vector).norm()
    }

    fn is_within(&self, seconds: f64, one: &(usize, Carriers), next: &(usize, Carriers)) -> bool {
        self.times_s[next.0] - self.times_s[one.0] <= seconds
    }

    /// The first object in the frame of reference of the second.
    pub(super) fn relative_pose(&self, with: usize, at: usize, frame: usize) -> Option<Isometry3<f32>> {
        let (with, at) = self.objects[with][frame].zip(self.objects[at][frame])?;
        Some(at.inv_mul(&with))
    }

    /// Where the first object lies at the second when both are seen first.
    pub(super) fn first_place(&self, with: usize, at: usize) -> Option<Point3<f32>> {
        let pose = (0..self.times_s.len()).find_map(|frame| self.relative_pose(with, at, frame))?;
        Some(Point3::from(pose.translation.vector))
    }

    /// Where the first object is at the second in each frame that shows both.
    fn places(&self, with: usize, at: usize) -> Vec<(usize, Point3<f32>)> {
        let place = |frame: usize| {
            let pose = self.relative_pose(with, at, frame)?;
            Some((frame, Point3::from(pose.translation.vector)))
        };
        (0..self.times_s.len()).filter_map(place).collect()
    }

    /// Where the first object dwells at the second after one of them was carried there, each time.
    pub(super) fn dwells(&self, with: usize, at: usize) -> Vec<Dwell> {
        let places = self.places(with, at);
        let mut dwells: Vec<Dwell> = Vec::new();
        let mut end = 0;
        for (index, (frame, place)) in places.iter().enumerate() {
            let Some(last) = self.after(*frame, DWELL_S) else { break };
            let until = places.partition_point(|(frame, _)| *frame <= last);
            if places[index..until].iter().any(|(_, other)| (other - place).norm() > PUT_BACK_M) {
                continue;
            }
            let next = &places[end.max(index).min(until)..until];
            match dwells.last_mut().filter(|_| index < end) {
                Some(dwell) => dwell.extend(next),
                None => dwells.push(next.to_vec()),
            }
            end = until;
        }
        dwells.retain(|dwell| [with, at].iter().any(|object| self.was_carried(*object, dwell[0].0)));
        dwells
    }

    /// Where the first object dwells at the second, or the middle of the strokes that it makes around there.
    pub(super) fn place(&self, with: usize, at: usize, dwell: &Dwell) -> Point3<f32> {
        let middle = median(dwell.iter().map(|(_, place)| *place));
        let places = self.places(with, at);
        let is_away = |(_, place): &(usize, Point3<f32>)| nalgebra::distance(place, &middle) > TOUCH_M;
        let [first, last] = [dwell.first(), dwell.last()]
            .map(|end| places.partition_point(|place| end.is_some_and(|end| place.0 < end.0)));
        let begin = places[..first].iter().rposition(is_away).map_or(0, |away| away + 1);
        let end = places[last..].iter().position(is_away).map_or(places.len(), |away| last + away);
        strokes(&places[begin..end], &middle)
            .map_or(middle, |strokes| median(strokes.iter().map(|(_, place)| *place)))
    }

    /// Whether a hand holds the object: one has carried it, and is still where it did so.
    pub(super) fn is_held(&self, object: usize, frame: usize) -> bool {
        self.are_at(object, frame).contains(&Some(true))
    }

    /// Whether no hand holds the object, and each that carried it last is seen elsewhere.
    pub(super) fn is_let_go(&self, object: usize, frame: usize) -> bool {
        self.are_at(object, frame) == [Some(false); HANDS]
    }

    /// For each hand, whether it is where it carried the object last. Not if it did not carry it, and `None` where that is not seen.
    fn are_at(&self, object: usize, frame: usize) -> [Option<bool>; HANDS] {
        let carried = &self.carried[object];
        let last = carried.partition_point(|(carried, _)| *carried <= frame).checked_sub(1);
        let carriers = last.map_or([None; HANDS], |last| carried[last].1);
        core::array::from_fn(|hand| {
            let Some(carrier) = carriers[hand] else { return Some(false) };
            let (pose, tips) = self.objects[object][frame].zip(self.hands[hand][frame])?;
            let own = tips.map(|tip| pose.inverse_transform_point(&tip));
            Some(nalgebra::distance(&centre(&own), &centre(&carrier)) < SAME_PLACE_M)
        })
    }

    /// Whether one of two objects was carried to where they dwell, and is nearer there to a third one that lies.
    pub(super) fn is_brought_to_another(&self, objects: [usize; 2], dwell: &Dwell) -> bool {
        let others = (0..self.objects.len()).filter(|object| !objects.contains(object));
        let brought = objects.into_iter().filter(|object| self.was_carried(*object, dwell[0].0));
        brought.flat_map(|object| others.clone().map(move |third| (object, third))).any(|(object, third)| {
            let is_nearer = |(frame, place): &(usize, Point3<f32>)| {
                let pose = self.relative_pose(object, third, *frame);
                pose.is_some_and(|pose| pose.translation.vector.norm() < place.coords.norm())
                    && !self.is_held(third, *frame)
            };
            dwell.iter().any(is_nearer)
        })
    }

    fn was_carried(&self, object: usize, began: usize) -> bool {
        let ago_s = |frame: usize| self.times_s[began] - self.times_s[frame];
        self.carried[object].iter().any(|(frame, _)| CARRIED_S.contains(&ago_s(*frame)))
    }

    /// The hands that move with the object, where it moves and one does.
    fn carriers(&self, object: usize, frame: usize) -> Option<Carriers> {
        let later = self.after(frame, PERSIST_S)?;
        let (pose, moved) = self.objects[object][frame].zip(self.objects[object][later])?;
        let way = moved.translation.vector - pose.translation.vector;
        let held = |hand: &Vec<Option<Tips>>| {
            let (tips, moved_tips) = hand[frame].zip(hand[later])?;
            let own = tips.map(|tip| pose.inverse_transform_point(&tip));
            let moved_own = moved_tips.map(|tip| moved.inverse_transform_point(&tip));
            let slipped = (centre(&moved_tips) - centre(&tips) - way).norm();
            let slipped_m = slipped.min((centre(&moved_own) - centre(&own)).norm());
            let is_carried = slipped_m < way.norm() / 2.0 && from_middle_m(&own) < REACH_M;
            is_carried.then_some(own)
        };
        let carriers = self.hands.each_ref().map(held);
        (way.norm() > self.min_ways_m[object] && carriers.iter().any(Option::is_some)).then_some(carriers)
    }

    /// The first frame that is at least this many seconds later.
    fn after(&self, frame: usize, seconds: f64) -> Option<usize> {
        // A millionth of a second clears the rounding of times.
        let at = self.times_s[frame] + seconds - 1e-6;
        let index = self.times_s.partition_point(|time| *time < at);
        (index < self.times_s.len()).then_some(index)
    }
}

/// Those of these places that lie between the first and the last return to the middle, if there are enough of them for strokes.
fn strokes<'a>(
    places: &'a [(usize, Point3<f32>)],
    middle: &Point3<f32>,
) -> Option<&'a [(usize, Point3<f32>)]> {
    let (mut is_out, mut back) = (false, Vec::new());
    for (index, (_, place)) in places.iter().enumerate() {
        // Errors neither leave nor come back.
        let was_out = is_out;
        is_out = nalgebra::distance(place, middle) > if was_out { PUT_BACK_M / 2.0 } else { PUT_BACK_M };
        back.extend((was_out && !is_out).then_some(index));
    }
    let (first, last) = back.first().zip(back.last())?;
    (back.len() >= MIN_RETURNS).then(|| &places[*first..=*last])
}

/// How far finger tips are from the middle of the object in whose frame of reference they are, in metres.
fn from_middle_m(tips: &Tips) -> f32 {
    centre(tips).coords.norm()
}

fn apart_m(one: &Tips, other: &Tips) -> f32 {
    nalgebra::distance(&centre(one), &centre(other))
}

pub(super) fn centre(points: &Tips) -> Point3<f32> {
    Point3::from((points[0].coords + points[1].coords + points[2].coords) / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_core::input::{Object, Side};

    /// Two hands and some objects at these places beside each other, in metres. All go the same way at 0.6 m/s for half a second.
    fn side_by_side(hands: [f32; 2], objects: &[f32]) -> Trajectories {
        let frame = |index: u16| {
            let at = |x: f32| [x, 0.02 * f32::from(index), 0.0];
            let hand = |(side, x): (Side, f32)| Hand {
                side,
                score: 1.0,
                wrist: at(x),
                middle_knuckle: at(x),
                tips: [at(x); 3],
            };
            let object =
                |(id, x): (u16, &f32)| Object { id, position: at(*x), orientation: [1.0, 0.0, 0.0, 0.0] };
            Frame {
                captured_ns: u64::from(index) * 33_333_333,
                hands: Side::ALL.into_iter().zip(hands).map(hand).collect(),
                objects: (1..).zip(objects).map(object).collect(),
                ..Frame::default()
            }
        };
        let frames: Vec<Frame> = (0..15).map(frame).collect();
        let shape = |id: u16| ObjectShape { id, ..ObjectShape::default() };
        let shapes: Vec<ObjectShape> = (1..).map(shape).take(objects.len()).collect();
        Trajectories::new(&frames, &shapes, Space::Plane)
    }

    #[test]
    fn a_part_is_held_while_the_hand_that_carried_it_stays_at_it() {
        // Whoever carries the first one is at it all the time.
        let run = side_by_side([0.0, 5.0], &[0.0, 2.0]);
        assert_eq!([0, 1].map(|object| run.is_held(object, 9)), [true, false]);
        let mut left = side_by_side([0.0, 5.0], &[0.0, 2.0]);
        left.hands[0][9] = left.hands[0][9].map(|tips| tips.map(|tip| tip + Vector3::x() * 0.1));
        assert!(!left.is_held(0, 9) && left.is_held(0, 8));
        assert_eq!([8, 9].map(|frame| left.is_let_go(0, frame)), [false, true]);
        left.hands[0][9] = None;
        assert!(!left.is_held(0, 9) && !left.is_let_go(0, 9), "it is not seen");
    }

    #[test]
    fn a_part_is_brought_to_what_lies_nearer_and_not_to_what_is_held_beside_it() {
        let mut run = side_by_side([0.0, 0.12], &[0.0, 0.25, 0.12]);
        let dwell = vec![(9, Point3::new(0.25, 0.0, 0.0))];
        let is_to_another = |run: &Trajectories| run.is_brought_to_another([0, 1], &dwell);
        assert!(!is_to_another(&run), "the other hand holds that");
        run.carried[2].clear();
        assert!(is_to_another(&run), "it lies there");
        assert!(
            !run.is_brought_to_another([0, 1], &vec![(9, Point3::new(0.1, 0.0, 0.0))]),
            "it is farther away"
        );
    }

    /// Where an object is held, to the right of its middle, in centimetres.
    fn held_cm(run: &Trajectories, object: usize) -> Vec<i32> {
        run.holds(object).iter().map(|tips| (100.0 * tips[0][0].x).round() as i32).collect()
    }

    #[test]
    fn a_tool_that_makes_strokes_works_in_their_middle_wherever_it_came_to_rest_first() {
        let place_of = |strokes: i32| {
            let mut run = side_by_side([0.0, 5.0], &[0.0, 0.0]);
            // It rests at one end of its strokes of 12 cm, one each half second.
            let stroke = |frame: i32| 0.06 * (f64::from(frame) * std::f64::consts::TAU / 15.0).cos() as f32;
            let moves = (0..15 * strokes).map(stroke);
            let ways = [0.6; 3].into_iter().chain([0.06; 15]).chain(moves).chain([0.6; 3]);
            let pose = |x: f32| Some(Isometry3::translation(x, 0.0, 0.0));
            run.objects = vec![ways.clone().map(pose).collect(), ways.clone().map(|_| pose(0.0)).collect()];
            run.times_s = (0..ways.count()).map(|frame| frame as f64 / 30.0).collect();
            let dwell: Dwell = (3..18).map(|frame| (frame, Point3::new(0.06, 0.0, 0.0))).collect();
            (100.0 * run.place(0, 1, &dwell).x).round() as i32
        };
        assert_eq!(place_of(0), 6);
        assert!((-2..=2).contains(&place_of(6)), "{}", place_of(6));
    }

    #[test]
    fn a_part_that_moves_with_two_hands_is_held_by_both() {
        assert_eq!(held_cm(&side_by_side([0.15, -0.1], &[0.0]), 0), [15, -10]);
    }

    #[test]
    fn of_two_hands_that_bring_two_parts_side_by_side_each_holds_its_own() {
        let run = side_by_side([0.1, -0.1], &[0.1, -0.1]);
        assert_eq!([0, 1].map(|object| held_cm(&run, object)), [[0], [0]]);
    }
}
