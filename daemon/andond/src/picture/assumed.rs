//! Where a part or hand is drawn that is not seen. That is where it was last seen or, if a hand that is seen holds it, moved with that hand.

use crate::report::Names;
use shm_schemas::{Detections, HandCode, HandDetection, LANDMARKS, ObjectDetection, flag};

type Corners = [[f32; 2]; 4];
type Landmarks = [[f32; 2]; LANDMARKS];

/// Remembers where everything was last seen.
pub(super) struct LastSeen {
    blind_ns: u64,
    /// Object, corners in pixels, position in metres, time.
    objects: Vec<(ObjectDetection, u64)>,
    hands: Vec<(HandDetection, u64)>,
}

impl LastSeen {
    pub(super) fn new(blind_ms: u32) -> Self {
        Self { blind_ns: u64::from(blind_ms) * 1_000_000, objects: Vec::new(), hands: Vec::new() }
    }

    /// Takes what was seen in the next picture.
    pub(super) fn take(&mut self, seen: &Detections) {
        let now_ns = seen.source_ns;
        for object in seen.objects().iter().filter(|object| object.flags & flag::SEEN != 0) {
            self.objects.retain(|(known, _)| known.id != object.id);
            self.objects.push((*object, now_ns));
        }
        for hand in seen.hands() {
            self.hands.retain(|(known, _)| known.hand != hand.hand);
            self.hands.push((*hand, now_ns));
        }
    }

    /// The objects that are not seen in this picture, and where they are assumed to be.
    pub(super) fn objects(&self, seen: &Detections) -> Vec<(u16, Corners)> {
        let place = |(known, seen_ns): &(ObjectDetection, u64)| {
            let now = seen.objects().iter().find(|object| object.id == known.id);
            match now {
                Some(object) if object.flags & flag::SEEN != 0 => None,
                Some(held) if held.flags & flag::HELD != 0 => moved(known, held, seen.hands()),
                _ => self.is_recent(*seen_ns, seen).then_some(known.corners_px),
            }
            .map(|corners| (known.id, corners))
        };
        self.objects.iter().filter_map(place).collect()
    }

    /// The hands that are not seen in this picture, and where they are assumed to be.
    pub(super) fn hands(&self, seen: &Detections) -> Vec<Landmarks> {
        let is_hidden = |known: &HandDetection| seen.hands().iter().all(|hand| hand.hand != known.hand);
        let hidden =
            self.hands.iter().filter(|(known, seen_ns)| is_hidden(known) && self.is_recent(*seen_ns, seen));
        hidden.map(|(known, _)| known.landmarks_px).collect()
    }

    /// The names of the parts and hands that have been out of sight for so long that they are assumed to be nowhere.
    pub(super) fn lost(&self, seen: &Detections, names: &Names) -> Vec<String> {
        let assumed = self.objects(seen);
        let is_seen =
            |id: u16| seen.objects().iter().any(|object| object.id == id && object.flags & flag::SEEN != 0);
        let ids = self.objects.iter().map(|(known, _)| known.id);
        let parts = ids.filter(|id| !is_seen(*id) && assumed.iter().all(|(other, _)| other != id));
        let parts = parts.map(|id| names.object(id));
        let is_gone = |(known, seen_ns): &&(HandDetection, u64)| {
            seen.hands().iter().all(|hand| hand.hand != known.hand) && !self.is_recent(*seen_ns, seen)
        };
        let side = |hand: &HandDetection| HandCode::try_from(hand.hand).map_or("", |side| side.name());
        let hands = self.hands.iter().filter(is_gone).map(|(known, _)| format!("{} hand", side(known)));
        let none_so_far = self.hands.is_empty().then(|| "hand".to_owned());
        hands.chain(none_so_far).chain(parts).collect()
    }

    fn is_recent(&self, seen_ns: u64, seen: &Detections) -> bool {
        seen.source_ns.saturating_sub(seen_ns) <= self.blind_ns
    }
}

/// The corners of a marker that is hidden in a hand. The landmarks of the hand say how metres become pixels there.
fn moved(known: &ObjectDetection, held: &ObjectDetection, hands: &[HandDetection]) -> Option<Corners> {
    let distance_m = |hand: &HandDetection| {
        let tip_m = hand.landmarks_m[12];
        (tip_m[0] - held.position_m[0]).hypot(tip_m[1] - held.position_m[1])
    };
    let nearest = hands.iter().min_by(|one, other| distance_m(one).total_cmp(&distance_m(other)))?;
    let [tip_m, wrist_m] = [12, 0].map(|landmark: usize| nearest.landmarks_m[landmark]);
    let [tip_px, wrist_px] = [12, 0].map(|landmark: usize| nearest.landmarks_px[landmark]);
    let metres = (tip_m[0] - wrist_m[0]).hypot(tip_m[1] - wrist_m[1]);
    let pixels = (tip_px[0] - wrist_px[0]).hypot(tip_px[1] - wrist_px[1]);
    let px_per_m = pixels / metres;
    // Also false for NaN, which stands for what has no position.
    if !(px_per_m > 0.0 && px_per_m.is_finite()) {
        return None;
    }
    // The direction from wrist to tip on the bench, whose y axis points up, and in the picture, whose y axis points down.
    let on_bench = (tip_m[1] - wrist_m[1]).atan2(tip_m[0] - wrist_m[0]);
    let in_picture = (-(tip_px[1] - wrist_px[1])).atan2(tip_px[0] - wrist_px[0]);
    let turned = |vector: [f32; 2], angle: f32| {
        let (sin, cos) = angle.sin_cos();
        [cos * vector[0] - sin * vector[1], sin * vector[0] + cos * vector[1]]
    };
    let from_tip_m = [held.position_m[0] - tip_m[0], held.position_m[1] - tip_m[1]];
    let from_tip = turned(from_tip_m, in_picture - on_bench).map(|metres| metres * px_per_m);
    let centre = [tip_px[0] + from_tip[0], tip_px[1] - from_tip[1]];
    let turn = yaw(held) - yaw(known);
    let sum = known.corners_px.iter().fold([0.0; 2], |sum, corner| [sum[0] + corner[0], sum[1] + corner[1]]);
    let before = sum.map(|coordinate| coordinate / 4.0);
    Some(known.corners_px.map(|corner| {
        let arm = turned([corner[0] - before[0], -(corner[1] - before[1])], turn);
        [centre[0] + arm[0], centre[1] - arm[1]]
    }))
}

fn yaw(object: &ObjectDetection) -> f32 {
    let [w, x, y, z] = object.orientation;
    (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z))
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: u64 = 1_000_000_000;

    /// A picture of 1,000 pixels per metre with a hand from (0.1, 0.1) upwards and an object of 40 pixels at this place.
    fn picture(at_ns: u64, flags: u16, position_m: [f32; 2], turn: f32) -> Detections {
        let mut seen = Detections { source_ns: at_ns, hands_len: 1, objects_len: 1, ..Detections::default() };
        seen.hands[0].hand = 1;
        for (landmark, y) in [(0, 0.1), (12, 0.3)] {
            seen.hands[0].landmarks_m[landmark] = [0.1, y, 0.0];
            seen.hands[0].landmarks_px[landmark] = [100.0, 500.0 - 1000.0 * y];
        }
        let [x, y] = [1000.0 * position_m[0], 500.0 - 1000.0 * position_m[1]];
        seen.objects[0] = ObjectDetection {
            id: 5,
            flags,
            position_m: [position_m[0], position_m[1], 0.0],
            orientation: [(turn / 2.0).cos(), 0.0, 0.0, (turn / 2.0).sin()],
            corners_px: [
                [x - 20.0, y - 20.0],
                [x + 20.0, y - 20.0],
                [x + 20.0, y + 20.0],
                [x - 20.0, y + 20.0],
            ],
            ..ObjectDetection::default()
        };
        seen
    }

    #[test]
    fn a_part_that_a_hand_hides_is_assumed_where_the_hand_has_it() {
        let mut last_seen = LastSeen::new(700);
        last_seen.take(&picture(0, flag::SEEN, [0.1, 0.3], 0.0));
        assert!(last_seen.objects(&picture(0, flag::SEEN, [0.1, 0.3], 0.0)).is_empty());
        // It is a quarter turned to the left and 5 cm to the right.
        let assumed = last_seen.objects(&picture(S, flag::HELD, [0.15, 0.3], std::f32::consts::FRAC_PI_2));
        let corners = assumed.first().map(|(_, corners)| corners.map(|corner| corner.map(f32::round)));
        assert_eq!(corners, Some([[130.0, 220.0], [130.0, 180.0], [170.0, 180.0], [170.0, 220.0]]));
    }

    #[test]
    fn what_is_not_seen_is_assumed_where_it_was_for_a_while_and_then_nowhere() {
        let names = Names::new([(5, "polisher".to_owned())]);
        let nothing_at = |at_ns| Detections { source_ns: at_ns, ..Detections::default() };
        let mut last_seen = LastSeen::new(700);
        assert_eq!(last_seen.lost(&nothing_at(0), &names), ["hand"]);
        last_seen.take(&picture(0, flag::SEEN, [0.1, 0.3], 0.0));
        assert_eq!(last_seen.objects(&nothing_at(S / 2)).len(), 1);
        assert_eq!(last_seen.hands(&nothing_at(S / 2)).len(), 1);
        assert!(last_seen.lost(&nothing_at(S / 2), &names).is_empty());
        assert!(last_seen.objects(&nothing_at(S)).is_empty());
        assert!(last_seen.hands(&nothing_at(S)).is_empty());
        assert_eq!(last_seen.lost(&nothing_at(S), &names), ["right hand", "polisher"]);
        assert!(last_seen.lost(&picture(S, flag::SEEN, [0.1, 0.3], 0.0), &names).is_empty());
    }
}
