//! Where a part or hand is drawn that is not seen. That is where it was last seen or, if a hand that is seen holds it, moved with that hand.

use crate::report::Names;
use andon_core::couple::Couple;
use shm_schemas::{Detections, HandCode, HandDetection, LANDMARKS, ObjectDetection};

type Corners = [[f32; 2]; 4];
type Landmarks = [[f32; 2]; LANDMARKS];

/// A part as it was last seen, with the hands of that picture.
#[derive(Clone)]
struct SeenPart {
    object: ObjectDetection,
    hands: Vec<HandDetection>,
    at_ns: u64,
}

/// Remembers where everything was last seen.
#[derive(Clone)]
pub(crate) struct LastSeen {
    blind_ns: u64,
    objects: Vec<SeenPart>,
    hands: Vec<(HandDetection, u64)>,
}

impl LastSeen {
    pub(crate) fn new(blind_ms: u32) -> Self {
        Self { blind_ns: u64::from(blind_ms) * 1_000_000, objects: Vec::new(), hands: Vec::new() }
    }

    /// Takes what was seen in the next picture.
    pub(crate) fn take(&mut self, seen: &Detections) {
        let at_ns = seen.source_ns;
        for object in seen.seen_objects() {
            self.objects.retain(|known| known.object.id != object.id);
            self.objects.push(SeenPart { object: *object, hands: seen.hands().to_vec(), at_ns });
        }
        for hand in seen.hands() {
            self.hands.retain(|(known, _)| known.hand != hand.hand);
            self.hands.push((*hand, at_ns));
        }
    }

    /// The objects that are not seen in this picture, and where they are assumed to be. That is in the hand that holds them by the newest couples, or
    /// where they were last seen.
    pub(crate) fn objects(&self, seen: &Detections, couples: &[Couple]) -> Vec<(u16, Corners)> {
        let place = |known: &SeenPart| {
            let id = known.object.id;
            if is_seen(seen, id) {
                return None;
            }
            let in_hand = known.in_hand(seen, couples);
            let corners =
                in_hand.or_else(|| self.is_recent(known.at_ns, seen).then_some(known.object.corners_px));
            corners.map(|corners| (id, corners))
        };
        self.objects.iter().filter_map(place).collect()
    }

    /// The hands that are not seen in this picture, by their codes, and where they are assumed to be.
    pub(crate) fn hands(&self, seen: &Detections) -> Vec<(u8, Landmarks)> {
        let is_hidden = |known: &HandDetection| seen.hands().iter().all(|hand| hand.hand != known.hand);
        let hidden =
            self.hands.iter().filter(|(known, seen_ns)| is_hidden(known) && self.is_recent(*seen_ns, seen));
        hidden.map(|(known, _)| (known.hand, known.landmarks_px)).collect()
    }

    /// The names of the parts and hands that have been out of sight for so long that they are assumed to be nowhere.
    pub(super) fn lost(&self, seen: &Detections, couples: &[Couple], names: &Names) -> Vec<String> {
        let assumed = self.objects(seen, couples);
        let ids = self.objects.iter().map(|known| known.object.id);
        let parts = ids.filter(|id| !is_seen(seen, *id) && assumed.iter().all(|(other, _)| other != id));
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

fn is_seen(seen: &Detections, id: u16) -> bool {
    seen.seen_objects().any(|object| object.id == id)
}

impl SeenPart {
    /// The corners of its marker as the hand that holds it has moved them since. `None` where no hand does that was seen then and is seen now.
    fn in_hand(&self, seen: &Detections, couples: &[Couple]) -> Option<Corners> {
        let holds = |couple: &&Couple| couple.context.0[0] != 0 && couple.context.0[1] == self.object.id;
        let [hand, ..] = couples.iter().find(holds)?.context.0;
        let of = |hands: &[HandDetection]| hands.iter().find(|seen| u16::from(seen.hand) == hand).copied();
        let [then, now] = [of(&self.hands)?, of(seen.hands())?]
            .map(|hand| [0, 12].map(|landmark| hand.landmarks_px[landmark]));
        Some(self.object.corners_px.map(|corner| moved(corner, then, now)))
    }
}

/// A point that moves with the tip of a finger and turns with the hand; from wrist and tip `then` and `now`, in pixels.
fn moved(point: [f32; 2], then: [[f32; 2]; 2], now: [[f32; 2]; 2]) -> [f32; 2] {
    let angle = |[wrist, tip]: [[f32; 2]; 2]| (tip[1] - wrist[1]).atan2(tip[0] - wrist[0]);
    let (sin, cos) = (angle(now) - angle(then)).sin_cos();
    let arm = [point[0] - then[1][0], point[1] - then[1][1]];
    [now[1][0] + cos * arm[0] - sin * arm[1], now[1][1] + sin * arm[0] + cos * arm[1]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_core::couple::Context;
    use andon_core::input::Side;
    use shm_schemas::flag;

    const S: u64 = 1_000_000_000;

    /// A hand of 100 pixels from its wrist to its tip, which points up or, `turned`, to the right. Beside it is an object of 40 pixels around this
    /// place.
    fn picture(at_ns: u64, is_seen: bool, tip: [f32; 2], turned: bool, [x, y]: [f32; 2]) -> Detections {
        let mut seen = Detections {
            source_ns: at_ns,
            hands_len: 1,
            objects_len: is_seen.into(),
            ..Detections::default()
        };
        seen.hands[0].hand = 1;
        seen.hands[0].landmarks_px[12] = tip;
        seen.hands[0].landmarks_px[0] =
            if turned { [tip[0] - 100.0, tip[1]] } else { [tip[0], tip[1] + 100.0] };
        seen.objects[0] = ObjectDetection {
            id: 5,
            flags: flag::SEEN,
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
    fn a_part_that_a_hand_hides_is_assumed_where_the_hand_that_holds_it_has_it() {
        let mut last_seen = LastSeen::new(700);
        let shown = picture(0, true, [200.0, 100.0], false, [200.0, 60.0]);
        last_seen.take(&shown);
        let held = Couple { context: Context([1, 5, 0, 0]), ..Couple::idle(Side::Right, 0) };
        assert!(last_seen.objects(&shown, &[held]).is_empty());
        // A second later the hand is elsewhere and points to the right, where the part is then.
        let hidden = picture(S, false, [300.0, 150.0], true, [0.0; 2]);
        let assumed = last_seen.objects(&hidden, &[held]);
        let corners = assumed.first().map(|(_, corners)| corners.map(|corner| corner.map(f32::round)));
        assert_eq!(corners, Some([[360.0, 130.0], [360.0, 170.0], [320.0, 170.0], [320.0, 130.0]]));
        let loose = Couple { context: Context([0, 0, 5, 6]), ..held };
        assert!(last_seen.objects(&hidden, &[loose]).is_empty());
    }

    #[test]
    fn what_is_not_seen_is_assumed_where_it_was_for_a_while_and_then_nowhere() {
        let names = Names::new([(5, "polisher".to_owned())]);
        let nothing_at = |at_ns| Detections { source_ns: at_ns, ..Detections::default() };
        let mut last_seen = LastSeen::new(700);
        let shown = picture(0, true, [200.0, 100.0], false, [200.0, 60.0]);
        assert_eq!(last_seen.lost(&nothing_at(0), &[], &names), ["hand"]);
        last_seen.take(&shown);
        assert_eq!(last_seen.objects(&nothing_at(S / 2), &[]).len(), 1);
        assert_eq!(last_seen.hands(&nothing_at(S / 2)).len(), 1);
        assert!(last_seen.lost(&nothing_at(S / 2), &[], &names).is_empty());
        assert!(last_seen.objects(&nothing_at(S), &[]).is_empty());
        assert!(last_seen.hands(&nothing_at(S)).is_empty());
        assert_eq!(last_seen.lost(&nothing_at(S), &[], &names), ["right hand", "polisher"]);
        assert!(last_seen.lost(&Detections { source_ns: S, ..shown }, &[], &names).is_empty());
    }
}
