#![allow(clippy::unwrap_used)]

use super::*;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

const FRAME_NS: u64 = 33_333_333;

/// A hand that points away from the worker, moved by `pose`.
fn hand(pose: &Isometry3<f64>) -> PlacedHand {
    let landmarks_m = std::array::from_fn(|index| {
        let (finger, joint) = (index.saturating_sub(1) / 4, index.saturating_sub(1) % 4);
        let at = Point3::new(0.02 * finger as f64 - 0.04, 0.08 + 0.025 * joint as f64, 0.01 * joint as f64);
        (pose * if index == 0 { Point3::origin() } else { at }).coords.map(|value| value as f32).into()
    });
    PlacedHand { side: Side::Right, landmarks_m }
}

/// An object in front of the fingers, moved by `pose`.
fn object(pose: &Isometry3<f64>) -> PlacedObject {
    let own = Isometry3::from_parts(
        Translation3::new(0.03, 0.2, 0.02),
        UnitQuaternion::from_euler_angles(0.1, 0.0, 0.5),
    );
    let Isometry3 { rotation, translation } = pose * own;
    let [x, y, z, w] = rotation.coords.into();
    let orientation = [w, x, y, z].map(|value: f64| value as f32);
    PlacedObject { id: 5, position_m: translation.vector.map(|value| value as f32).into(), orientation }
}

/// The pose of the hand in a frame: a curve over the bench, with a turn.
fn path(frame: u64) -> Isometry3<f64> {
    let t = frame as f64 / 30.0;
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.8 * t);
    Isometry3::from_parts(Translation3::new(0.3 * t, 0.1 * (3.0 * t).sin(), 0.05 * t), turn)
}

/// Hand and object move along `path` for the first 30 frames.
fn carried() -> CarriedObjects {
    let mut carried = CarriedObjects::default();
    for frame in 0..30 {
        assert!(carried.step(frame * FRAME_NS, &[hand(&path(frame))], &[object(&path(frame))]).is_empty());
    }
    carried
}

#[test]
fn a_carried_object_whose_marker_is_hidden_moves_and_turns_with_the_hand() {
    let mut carried = carried();
    for frame in 30..55 {
        let found = carried.step(frame * FRAME_NS, &[hand(&path(frame))], &[]);
        let wanted = object(&path(frame));
        assert_eq!(found.len(), 1);
        assert!(distance_m(found[0].position_m, wanted.position_m) < 1e-5, "{found:?} is not {wanted:?}");
        let dot: f32 = (0..4).map(|index| found[0].orientation[index] * wanted.orientation[index]).sum();
        assert!(dot.abs() > 1.0 - 1e-6, "{found:?} is not {wanted:?}");
    }
}

#[test]
fn an_object_at_rest_does_not_move_with_a_hand_that_passes_over_it() {
    let mut carried = CarriedObjects::default();
    let rest = object(&path(15));
    for frame in 0..15 {
        carried.step(frame * FRAME_NS, &[hand(&path(frame))], &[rest]);
    }
    for frame in 15..30 {
        assert!(carried.step(frame * FRAME_NS, &[hand(&path(frame))], &[]).is_empty());
    }
}

#[test]
fn an_object_that_was_put_down_stays_when_the_hand_has_gone() {
    let mut carried = carried();
    let down = object(&path(29));
    for frame in 30..40 {
        carried.step(frame * FRAME_NS, &[hand(&path(frame))], &[down]);
    }
    assert!(carried.step(40 * FRAME_NS, &[hand(&path(40))], &[]).is_empty());
}

#[test]
fn a_pose_follows_the_hand_for_a_bounded_time() {
    let mut carried = carried();
    let last_ns = 29 * FRAME_NS;
    assert_eq!(carried.step(last_ns + MAX_HIDDEN_NS, &[hand(&path(59))], &[]).len(), 1);
    assert!(carried.step(last_ns + MAX_HIDDEN_NS + 1, &[hand(&path(59))], &[]).is_empty());
}

#[test]
fn without_the_hand_there_is_nothing_to_follow() {
    let mut carried = carried();
    assert!(carried.step(30 * FRAME_NS, &[], &[]).is_empty());
    let mut unplaced = hand(&path(31));
    unplaced.landmarks_m[9] = [f32::NAN; 3];
    assert!(carried.step(31 * FRAME_NS, &[unplaced], &[]).is_empty());
    let left = PlacedHand { side: Side::Left, ..hand(&path(32)) };
    assert!(carried.step(32 * FRAME_NS, &[left], &[]).is_empty());
    assert_eq!(carried.step(33 * FRAME_NS, &[hand(&path(33))], &[]).len(), 1);
}

/// The hand with its thumb moved outwards by `by_m`.
fn opened(pose: &Isometry3<f64>, by_m: f32) -> PlacedHand {
    let mut hand = hand(pose);
    hand.landmarks_m[4][0] -= by_m;
    hand
}

#[test]
fn an_object_that_is_put_down_behind_the_hand_stays_when_the_hand_opens() {
    let mut carried = carried();
    // Hidden and at rest, then let go, then the hand leaves: the opening counts when it has lasted for two frames.
    for (frame, by_m) in [(30, 0.0), (31, 0.0), (32, 0.010), (33, 0.018)] {
        assert_eq!(carried.step(frame * FRAME_NS, &[opened(&path(29), by_m)], &[]).len(), 1, "frame {frame}");
    }
    for frame in 34..50 {
        assert!(
            carried.step(frame * FRAME_NS, &[opened(&path(frame - 5), 0.018)], &[]).is_empty(),
            "{frame}"
        );
    }
}

#[test]
fn a_tip_that_leaps_in_one_frame_opens_no_hand() {
    let mut carried = carried();
    for frame in 30..50 {
        let by_m = if frame == 35 { 0.040 } else { 0.0 };
        assert_eq!(
            carried.step(frame * FRAME_NS, &[opened(&path(frame), by_m)], &[]).len(),
            1,
            "frame {frame}"
        );
    }
}

#[test]
fn an_object_that_moves_on_with_an_open_hand_is_carried() {
    let mut carried = carried();
    for frame in 30..40 {
        carried.step(frame * FRAME_NS, &[opened(&path(frame), 0.018)], &[object(&path(frame))]);
    }
    assert_eq!(carried.step(40 * FRAME_NS, &[opened(&path(40), 0.018)], &[]).len(), 1);
}

#[test]
fn a_grip_that_widens_slowly_still_carries() {
    let mut carried = carried();
    for frame in 30..55 {
        let by_m = 0.001 * (frame - 29) as f32;
        assert_eq!(
            carried.step(frame * FRAME_NS, &[opened(&path(frame), by_m)], &[]).len(),
            1,
            "frame {frame}"
        );
    }
}
