//! Detections: perception to shared memory, and either of them to the method.

use andon_core::input::{Frame, Hand, Object, Side};
use andon_perception::detections::{self as seen, Detections as Seen};
use shm_schemas::{Detections, HANDS, HandCode, OBJECTS, flag};

/// Writes what was seen into the loaned message.
pub fn write(seen: &Seen, message: &mut Detections) {
    for (hand, place) in seen.hands.iter().zip(message.hands.iter_mut()) {
        place.hand = match hand.side {
            seen::Side::Right => HandCode::Right.code(),
            seen::Side::Left => HandCode::Left.code(),
        };
        place.score = hand.score;
        place.landmarks_px = hand.landmarks_px;
        place.landmarks_m = hand.landmarks_m.map(|[x, y]| [x, y, 0.0]);
    }
    message.hands_len = seen.hands.len().min(HANDS) as u32;
    for (object, place) in seen.objects.iter().zip(message.objects.iter_mut()) {
        place.id = object.id;
        place.flags = flag::SEEN;
        place.quality = object.quality;
        place.position_m = object.position_m;
        place.orientation = object.orientation;
        place.corners_px = object.corners_px;
    }
    message.objects_len = seen.objects.len().min(OBJECTS) as u32;
}

/// Writes the frame of a track file, which has no picture and no more landmarks than the method uses.
pub fn write_frame(frame: &Frame, message: &mut Detections) {
    for (hand, place) in frame.hands.iter().zip(message.hands.iter_mut()) {
        place.hand = hand.side as u8;
        place.score = hand.score;
        place.landmarks_px = [[f32::NAN; 2]; shm_schemas::LANDMARKS];
        place.landmarks_m = [[f32::NAN; 3]; shm_schemas::LANDMARKS];
        for (landmark, point) in
            USED.into_iter().zip([hand.wrist, hand.tips[0], hand.middle_knuckle, hand.tips[1], hand.tips[2]])
        {
            place.landmarks_m[landmark] = point;
        }
    }
    message.hands_len = frame.hands.len().min(HANDS) as u32;
    for (object, place) in frame.objects.iter().zip(message.objects.iter_mut()) {
        place.id = object.id;
        place.flags = flag::SEEN;
        place.quality = 1.0;
        place.position_m = object.position;
        place.orientation = object.orientation;
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

/// What the method takes of a message. A hand that could not be placed on the bench is one that was not seen.
pub fn frame(message: &Detections) -> Frame {
    let mut frame = Frame { captured_ns: message.source_ns, ..Frame::default() };
    for detected in message.hands() {
        let side = match HandCode::try_from(detected.hand) {
            Ok(HandCode::Right) => Side::Right,
            Ok(HandCode::Left) => Side::Left,
            _ => continue,
        };
        if let Some(hand) = hand(side, detected.score, &detected.landmarks_m) {
            // The capacities are equal: what fits the message fits the frame.
            let _ = frame.hands.push(hand);
        }
    }
    for object in message.objects() {
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
        assert_eq!(frame(&message), track_frame());
    }

    #[test]
    fn a_hand_that_is_nowhere_on_the_bench_was_not_seen() {
        let mut message = Detections::default();
        let mut lost = track_frame();
        lost.hands[0].tips[1][0] = f32::NAN;
        write_frame(&lost, &mut message);
        assert!(frame(&message).hands.is_empty());
    }

    #[test]
    fn a_message_that_claims_more_than_it_holds_is_read_to_its_end_only() {
        let message = Detections { hands_len: 999, objects_len: 999, ..Detections::default() };
        assert_eq!(frame(&message).objects.len(), OBJECTS);
        assert!(frame(&message).hands.is_empty(), "no hand has the code 0");
    }
}
