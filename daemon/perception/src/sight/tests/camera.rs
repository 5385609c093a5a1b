//! Whether the camera was moved.

use super::{Bench, good, marker};
use crate::sight::{Expected, Observation, SightMonitor, Trouble};

/// A bench with three parts; the camera is turned by `turn` radians and shifted by `shift` pixels.
fn seen_from(turn: f32, shift: [f32; 2]) -> Observation {
    let mut observation = good();
    observation.markers.push(marker(7, [400.0, 300.0])).unwrap();
    let (sin, cos) = turn.sin_cos();
    for corner in observation.markers.iter_mut().flat_map(|marker| &mut marker.corners) {
        let [x, y] = *corner;
        *corner = [cos * x - sin * y + shift[0], sin * x + cos * y + shift[1]];
    }
    observation
}

/// A hand whose landmarks are all at one point.
fn hand_at(observation: &mut Observation, point: [f32; 2]) {
    observation.hands_px.push([point; crate::detections::LANDMARKS]).unwrap();
}

/// What is said of these pictures, after some seconds at a bench with three parts.
fn said_after(
    is_calibrated: bool,
    seconds: f32,
    observation: impl Fn(u64) -> Observation,
) -> (Bench, Vec<Option<Trouble>>) {
    let mut bench = Bench::new();
    bench.sight = SightMonitor::new(Expected { rate_hz: None, hands: true, is_calibrated });
    assert_eq!(bench.show(5.0, |_| seen_from(0.0, [0.0; 2])), []);
    let said = bench.show(seconds, observation).into_iter().map(|(trouble, _)| trouble).collect();
    (bench, said)
}

const MOVED: Option<Trouble> = Some(Trouble::CameraMoved);

#[test]
fn a_camera_that_was_moved_is_said_and_so_is_that_it_is_back() {
    // The third is a turn about one of the markers.
    for (turn, shift) in [(0.0, [12.0, 0.0]), (0.1, [0.0, 0.0]), (0.1, [11.0, -10.0]), (-0.03, [40.0, -25.0])]
    {
        let (mut bench, said) = said_after(true, 5.0, |_| seen_from(turn, shift));
        assert_eq!(said, [MOVED], "{turn} {shift:?}");
        assert_eq!(bench.show(60.0, |_| seen_from(turn, shift)), [], "it lasts until it is mended");
        assert!(matches!(bench.show(5.0, |_| seen_from(0.0, [0.0; 2]))[..], [(None, _)]));
        assert_eq!(bench.show(20.0, |_| seen_from(0.0, [0.0; 2])), []);
    }
}

#[test]
fn nothing_is_seen_from_the_first_picture_on_that_a_moved_camera_shows() {
    for (turn, shift) in [(0.0, [12.0, 0.0]), (0.1, [0.0, 0.0]), (-0.03, [40.0, -25.0])] {
        let (bench, said) = said_after(true, 0.01, |_| seen_from(turn, shift));
        assert_eq!((bench.sight.is_seen(), &said[..]), (false, &[][..]), "{turn} {shift:?}");
    }
    // A part that a hand moves, or two at once, is seen.
    for parts in 1..=2 {
        let observation = |_| {
            let mut observation = seen_from(0.0, [0.0; 2]);
            hand_at(&mut observation, [105.0, 105.0]);
            hand_at(&mut observation, [285.0, 105.0]);
            for corner in observation.markers.iter_mut().take(parts).flat_map(|marker| &mut marker.corners) {
                corner[0] += 20.0;
            }
            observation
        };
        let (bench, said) = said_after(true, 0.01, observation);
        assert_eq!((bench.sight.is_seen(), &said[..]), (true, &[][..]), "{parts} parts");
    }
}

#[test]
fn without_a_calibration_a_new_view_is_as_good_as_the_old_one_after_a_while() {
    let (mut bench, said) = said_after(false, 20.0, |_| seen_from(0.0, [30.0, 0.0]));
    assert_eq!(said, [MOVED, None]);
    assert_eq!(bench.show(20.0, |_| seen_from(0.0, [30.0, 0.0])), []);
}

#[test]
fn a_camera_is_moved_although_a_hand_is_at_a_part_and_another_part_is_hidden() {
    let observation = |_| {
        let mut observation = seen_from(0.0, [30.0, 10.0]);
        hand_at(&mut observation, [300.0, 110.0]);
        observation.markers.remove(0);
        observation
    };
    assert_eq!(said_after(true, 5.0, observation).1, [MOVED]);
}

#[test]
fn a_camera_is_turned_although_only_one_marker_lies_far_from_the_hand() {
    let observation = |_| {
        let mut observation = seen_from(0.06, [0.0; 2]);
        let far_away = observation.markers[2].corners[0];
        hand_at(&mut observation, far_away);
        observation.markers.remove(1);
        // A third of a pixel at the corners of the one is six pixels at the other.
        let corners = &mut observation.markers[0].corners;
        let middle = [(corners[0][0] + corners[2][0]) / 2.0, (corners[0][1] + corners[2][1]) / 2.0];
        for corner in corners {
            let [x, y] = [corner[0] - middle[0], corner[1] - middle[1]];
            *corner = [corner[0] - 0.016 * y, corner[1] + 0.016 * x];
        }
        observation
    };
    assert_eq!(said_after(true, 5.0, observation).1, [MOVED]);
}

#[test]
fn parts_that_are_moved_one_by_one_or_each_elsewhere_or_by_a_hand_do_not_move_the_camera() {
    let at = |places: [[f32; 2]; 3]| {
        let mut observation = seen_from(0.0, [0.0; 2]);
        for (marker_now, place) in observation.markers.iter_mut().zip(places) {
            *marker_now = marker(marker_now.id, place);
        }
        observation
    };
    let nowhere: [Option<Trouble>; 0] = [];
    // Two stay and one goes; all go at once and each elsewhere.
    for places in
        [[[120.0, 90.0], [270.0, 90.0], [400.0, 300.0]], [[60.0, 200.0], [300.0, 40.0], [410.0, 200.0]]]
    {
        assert_eq!(said_after(true, 20.0, |_| at(places)).1, nowhere, "{places:?}");
    }
    // One after the other by the same way, two seconds apart.
    let one_by_one = |number: u64| {
        let gone = |after: u64| if number > 150 + after { 30.0 } else { 0.0 };
        at([[90.0 + gone(0), 90.0], [270.0 + gone(60), 90.0], [400.0 + gone(120), 300.0]])
    };
    assert_eq!(said_after(true, 20.0, one_by_one).1, nowhere);
    // Two that lie on each other, carried by a hand, while the third is hidden.
    let carried = |_| {
        let mut observation = at([[150.0, 130.0], [330.0, 130.0], [400.0, 300.0]]);
        observation.markers.pop();
        hand_at(&mut observation, [150.0, 130.0]);
        hand_at(&mut observation, [330.0, 130.0]);
        observation
    };
    assert_eq!(said_after(true, 20.0, carried).1, nowhere);
}

/// The bench with the second part at this place, and a hand at it if there is one.
fn with_second_part(at: [f32; 2], is_held: bool) -> Observation {
    let mut observation = seen_from(0.0, [0.0; 2]);
    observation.markers[1] = marker(6, at);
    if is_held {
        hand_at(&mut observation, at);
    }
    observation
}

/// As another camera sees it.
fn pushed(mut observation: Observation, shift: [f32; 2]) -> Observation {
    for point in observation.markers.iter_mut().flat_map(|marker| &mut marker.corners) {
        *point = [point[0] + shift[0], point[1] + shift[1]];
    }
    observation
}

#[test]
fn a_camera_is_moved_although_a_part_was_put_down_elsewhere_just_before() {
    // It is carried for a second, and the camera is pushed half a second after it was put down.
    let observation = |number: u64| match number - 150 {
        after @ 0..30 => with_second_part([270.0, 90.0 + 2.0 * after as f32], true),
        30..45 => with_second_part([270.0, 150.0], true),
        _ => pushed(with_second_part([270.0, 150.0], false), [30.0, 20.0]),
    };
    assert_eq!(said_after(true, 6.5, observation).1, [MOVED]);
}

#[test]
fn a_camera_is_moved_although_a_part_that_is_carried_passes_by_where_it_lay() {
    let observation = |number: u64| match number - 150 {
        0..15 => seen_from(0.0, [0.0; 2]),
        // The camera is pushed while a hand takes the part back by as much, and on from there.
        after @ 15..40 => {
            pushed(with_second_part([240.0, 90.0 - (after - 15) as f32 / 5.0], true), [30.0, 0.0])
        }
        after => pushed(with_second_part([240.0 - after as f32, 200.0], true), [30.0, 0.0]),
    };
    assert_eq!(said_after(true, 5.0, observation).1, [MOVED]);
}

#[test]
fn a_part_lies_where_it_has_settled() {
    // What is put down comes to lie within a tenth of its side of where it touched the bench first.
    let settling = |after: u64| with_second_part([270.0 + 0.1 * after.min(29) as f32, 130.0], after < 30);
    let observation = |number: u64| match number - 150 {
        after @ 0..90 => settling(after),
        after => pushed(settling(after), [8.0, 0.0]),
    };
    assert_eq!(said_after(true, 8.0, observation).1, [MOVED]);
}
