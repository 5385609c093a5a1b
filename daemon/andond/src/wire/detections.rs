//! Detections, from perception or a track file to shared memory, and from there to the method.

use super::verdict::side;
use andon_core::input::{Frame, Hand, Object, Side};
use andon_perception::detections::{self as seen, Detections as Seen};
use andon_perception::metric::MetricScene;
use shm_schemas::{Detections, HANDS, HandCode, OBJECTS, ObjectDetection, flag};

/// The factor on the confidence of a pose where another pose fits as well.
const AMBIGUOUS: f32 = 0.5;

/// Writes what was seen, placed in the plane of the bench, into the loaned message.
pub fn write(seen: &Seen, message: &mut Detections) {
    write_hands(seen, |hand| seen.hands[hand].landmarks_m.map(|[x, y]| [x, y, 0.0]), message);
    let pose = |object: &seen::ObjectDetection| Some((object.position_m, object.orientation, object.quality));
    write_objects(seen, pose, message);
}

/// Writes what was seen, placed in three dimensions, into the loaned message. What the scene does not have has no position.
pub fn write_metric(seen: &Seen, scene: &MetricScene, message: &mut Detections) {
    let unplaced = [[f32::NAN; 3]; seen::LANDMARKS];
    write_hands(seen, |hand| scene.hands.get(hand).map_or(unplaced, |hand| hand.landmarks_m), message);
    let pose = |object: &seen::ObjectDetection| {
        let placed = scene.objects.iter().find(|placed| placed.id == object.id)?;
        let certainty = if placed.unambiguous { 1.0 } else { AMBIGUOUS };
        Some((placed.position_m, placed.orientation, certainty * object.quality))
    };
    write_objects(seen, pose, message);
}

fn write_hands(
    seen: &Seen,
    landmarks_m: impl Fn(usize) -> [[f32; 3]; seen::LANDMARKS],
    message: &mut Detections,
) {
    for (index, (hand, slot)) in seen.hands.iter().zip(message.hands.iter_mut()).enumerate() {
        slot.hand = match hand.side {
            seen::Side::Right => HandCode::Right.code(),
            seen::Side::Left => HandCode::Left.code(),
        };
        slot.score = hand.score;
        slot.landmarks_px = hand.landmarks_px;
        slot.landmarks_m = landmarks_m(index);
    }
    message.hands_len = seen.hands.len().min(HANDS) as u32;
}

/// Writes the objects that were seen and have a pose, with its confidence. Then those whose marker is in view twice.
fn write_objects(
    seen: &Seen,
    pose: impl Fn(&seen::ObjectDetection) -> Option<([f32; 3], [f32; 4], f32)>,
    message: &mut Detections,
) {
    let ambiguous = seen.twice.iter();
    let ambiguous =
        ambiguous.map(|&id| ObjectDetection { id, flags: flag::TWICE, ..ObjectDetection::default() });
    let seen = seen.objects.iter().filter_map(|object| {
        let (position_m, orientation, quality) = pose(object)?;
        let (id, corners_px) = (object.id, object.corners_px);
        Some(ObjectDetection { id, flags: flag::SEEN, quality, position_m, orientation, corners_px })
    });
    let mut written = 0;
    for (object, slot) in seen.chain(ambiguous).zip(message.objects.iter_mut()) {
        *slot = object;
        written += 1;
    }
    message.objects_len = written;
}

/// Writes a frame of a track file, which has no picture and only the landmarks that the method uses.
pub fn write_frame(frame: &Frame, message: &mut Detections) {
    if frame.is_unseen {
        message.flags |= flag::UNSEEN;
    }
    for (hand, slot) in frame.hands.iter().zip(message.hands.iter_mut()) {
        slot.hand = hand.side as u8;
        slot.score = hand.score;
        slot.landmarks_px = [[f32::NAN; 2]; shm_schemas::LANDMARKS];
        slot.landmarks_m = [[f32::NAN; 3]; shm_schemas::LANDMARKS];
        for (landmark, point) in
            USED.into_iter().zip([hand.wrist, hand.tips[0], hand.middle_knuckle, hand.tips[1], hand.tips[2]])
        {
            slot.landmarks_m[landmark] = point;
        }
    }
    message.hands_len = frame.hands.len().min(HANDS) as u32;
    for (object, slot) in frame.objects.iter().zip(message.objects.iter_mut()) {
        slot.id = object.id;
        slot.flags = flag::SEEN;
        slot.quality = 1.0;
        slot.position_m = object.position;
        slot.orientation = object.orientation;
    }
    message.objects_len = frame.objects.len().min(OBJECTS) as u32;
}

/// The landmarks that the method uses: wrist, index tip, middle knuckle, middle tip, ring tip.
const USED: [usize; 5] = [0, 8, 9, 12, 16];

fn hand(side: Side, score: f32, landmarks: &[[f32; 3]; seen::LANDMARKS]) -> Option<Hand> {
    let [wrist, index, knuckle, middle, ring] = USED.map(|landmark| landmarks[landmark]);
    let placed =
        [wrist, index, knuckle, middle, ring].iter().flatten().all(|coordinate| coordinate.is_finite());
    placed.then_some(Hand { side, score, wrist, middle_knuckle: knuckle, tips: [index, middle, ring] })
}

/// The objects of a message whose marker is in view twice.
pub fn twice(message: &Detections) -> impl Iterator<Item = u16> {
    message.objects().iter().filter(|object| object.flags & flag::TWICE != 0).map(|object| object.id)
}

/// Reads from a message what the method uses. A hand without a position on the bench counts as not seen, and so does an object whose pose is held.
/// The method itself carries hidden objects by contact, and counts how long it was blind.
pub fn to_core(message: &Detections) -> Frame {
    let is_unseen = message.flags & flag::UNSEEN != 0;
    let mut frame = Frame {
        captured_ns: message.source_ns,
        is_unseen,
        twice: twice(message).collect(),
        ..Frame::default()
    };
    if is_unseen {
        return frame;
    }
    for detected in message.hands() {
        let Some(side) = HandCode::try_from(detected.hand).ok().and_then(side) else { continue };
        if let Some(hand) = hand(side, detected.score, &detected.landmarks_m) {
            // The capacities are equal: what fits the message fits the frame.
            let _ = frame.hands.push(hand);
        }
    }
    for object in message.seen_objects() {
        let _ = frame.objects.push(Object {
            id: object.id,
            position: object.position_m,
            orientation: object.orientation,
        });
    }
    frame
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use andon_perception::metric::{MetricHand, MetricObject};

    fn track_frame() -> Frame {
        let mut frame = Frame { captured_ns: 5, ..Frame::default() };
        let tips = [[0.1, 0.2, 0.0], [0.3, 0.4, 0.0], [0.5, 0.6, 0.0]];
        let hand = Hand { side: Side::Left, score: 0.5, wrist: [1.0; 3], middle_knuckle: [2.0; 3], tips };
        frame.hands.push(hand).unwrap();
        frame.objects.push(Object { id: 7, position: [0.1; 3], orientation: [1.0, 0.0, 0.0, 0.0] }).unwrap();
        frame
    }

    #[test]
    fn a_frame_comes_out_of_shared_memory_as_it_went_in() {
        let mut message = Detections { source_ns: 5, ..Detections::default() };
        write_frame(&track_frame(), &mut message);
        assert_eq!(to_core(&message), track_frame());
    }

    #[test]
    fn a_hand_without_a_position_on_the_bench_was_not_seen() {
        let mut message = Detections::default();
        let mut lost = track_frame();
        lost.hands[0].tips[1][0] = f32::NAN;
        write_frame(&lost, &mut message);
        assert!(to_core(&message).hands.is_empty());
    }

    #[test]
    fn a_message_that_claims_more_than_it_holds_is_read_to_its_end_only() {
        let objects = [ObjectDetection { flags: flag::SEEN, ..ObjectDetection::default() }; OBJECTS];
        let message = Detections { hands_len: 999, objects_len: 999, objects, ..Detections::default() };
        assert_eq!(to_core(&message).objects.len(), OBJECTS);
        assert!(to_core(&message).hands.is_empty(), "no hand has the code 0");
    }

    /// Object 5 is seen, and the marker of object 6 twice.
    fn seen() -> Seen {
        let mut seen = Seen::default();
        let object = seen::ObjectDetection {
            id: 5,
            corners_px: [[1.0; 2]; 4],
            position_m: [0.1, 0.2, 0.0],
            orientation: [1.0, 0.0, 0.0, 0.0],
            quality: 0.8,
        };
        seen.objects.push(object).unwrap();
        seen.twice.push(6).unwrap();
        let hand = seen::HandDetection {
            side: seen::Side::Right,
            score: 0.9,
            landmarks_px: [[7.0; 2]; seen::LANDMARKS],
            shape_m: [[0.0; 3]; seen::LANDMARKS],
            landmarks_m: [[0.5; 2]; seen::LANDMARKS],
        };
        seen.hands.push(hand).unwrap();
        seen
    }

    #[test]
    fn an_object_whose_marker_is_in_view_twice_is_on_the_channel_and_the_method_has_not_seen_it() {
        let mut message = Detections::default();
        write(&seen(), &mut message);
        let [shown, twice] = message.objects() else { unreachable!("two objects were written") };
        assert_eq!((shown.id, shown.flags), (5, flag::SEEN));
        assert_eq!((twice.id, twice.flags, twice.quality), (6, flag::TWICE, 0.0));
        let ids: Vec<u16> = to_core(&message).objects.iter().map(|object| object.id).collect();
        assert_eq!(ids, [5]);
    }

    #[test]
    fn a_metric_message_has_the_positions_of_the_scene() {
        let mut scene = MetricScene::default();
        let placed = MetricHand { side: seen::Side::Right, landmarks_m: [[0.5, 0.6, 0.7]; seen::LANDMARKS] };
        scene.hands.push(placed).unwrap();
        let tilted = [0.8, 0.6, 0.0, 0.0];
        let pose =
            MetricObject { id: 5, position_m: [0.1, 0.2, 0.3], orientation: tilted, unambiguous: false };
        scene.objects.push(pose).unwrap();
        let mut message = Detections::default();
        write_metric(&seen(), &scene, &mut message);
        let [object, _twice] = message.objects() else { unreachable!("two objects were written") };
        assert_eq!((object.position_m, object.orientation), ([0.1, 0.2, 0.3], tilted));
        assert_eq!(object.quality, 0.4, "another pose fits as well");
        assert_eq!(to_core(&message).hands[0].tips, [[0.5, 0.6, 0.7]; 3]);
    }

    #[test]
    fn while_the_bench_is_not_found_nothing_has_a_position() {
        let mut message = Detections::default();
        write_metric(&seen(), &MetricScene::default(), &mut message);
        assert_eq!(message.hands().len(), 1, "it can be drawn");
        assert!(to_core(&message).hands.is_empty() && to_core(&message).objects.is_empty());
    }
}
