//! The bench plane from a drawn picture of four markers: where it is right, and why it is refused.

#![allow(clippy::unwrap_used)]

mod common;

use andon_perception::bench::{BenchMarker, Calibration, CalibrationError, calibrate, examine};
use andon_perception::metric::{Distortion, Lens};
use andon_perception::{BenchPoint, Dictionary};
use common::{DAYLIGHT, Drawn, blurred, gray, picture, straight_down};

const SIDE_M: f64 = 0.04;

/// The corners of a rectangle.
const CORNERS: [[f64; 2]; 4] = [[-0.25, -0.18], [0.25, -0.18], [0.25, 0.18], [-0.25, 0.18]];

/// The markers from 0 on, as they are named.
fn named(centres: &[[f64; 2]]) -> Vec<BenchMarker> {
    let marker =
        |(id, [x, y]): (u16, [f64; 2])| BenchMarker { id, centre: BenchPoint::new(x, y), side_m: SIDE_M };
    (0..).zip(centres.iter().copied()).map(marker).collect()
}

/// Calibrates by a picture of the markers from 0 on, which lie here.
fn calibrated(lie: &[[f64; 2]], named: &[BenchMarker]) -> Result<Calibration, CalibrationError> {
    let drawn: Vec<_> = (0..).zip(lie).map(|(id, centre)| Drawn::new(id, *centre, SIDE_M, 0.0)).collect();
    let pixels = picture(640, 480, &straight_down(640, 480, 800.0), &drawn, Dictionary::default(), DAYLIGHT);
    calibrate(&gray(640, 480, &pixels), named, Dictionary::default())
}

fn refused(lie: &[[f64; 2]], named: &[BenchMarker]) -> CalibrationError {
    calibrated(lie, named).unwrap_err()
}

#[test]
fn a_calibration_is_read_as_it_was_written_and_places_a_pixel_on_the_bench() {
    let calibration = calibrated(&CORNERS, &named(&CORNERS)).unwrap();
    assert!(calibration.centre_error_m < 0.001 && calibration.side_error < 0.01, "{calibration:?}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bench.toml");
    calibration.save(&path).unwrap();
    assert_eq!(Calibration::load(&path).unwrap(), calibration);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else is left");
}

/// A picture as `andond look --save` gives it where the lens is not focused, with the markers of the bench.
#[test]
fn blur_hides_no_marker() {
    let ids = 46..50;
    let drawn: Vec<_> =
        ids.clone().zip(CORNERS).map(|(id, centre)| Drawn::new(id, centre, SIDE_M, 0.0)).collect();
    let named: Vec<_> = ids.zip(named(&CORNERS)).map(|(id, marker)| BenchMarker { id, ..marker }).collect();
    let sharp =
        picture(1280, 720, &straight_down(1280, 720, 1000.0), &drawn, Dictionary::default(), DAYLIGHT);
    // 47 is the first that is lost.
    for deviation_px in [1.0, 1.5, 2.0] {
        let blurred = blurred(1280, &sharp, deviation_px);
        let calibration = calibrate(&gray(1280, 720, &blurred), &named, Dictionary::default()).unwrap();
        assert!(calibration.centre_error_m < 0.002, "{deviation_px}: {calibration:?}");
    }
}

#[test]
fn fewer_than_four_markers_are_too_few() {
    assert!(matches!(refused(&CORNERS, &named(&CORNERS)[..3]), CalibrationError::TooFew(3)));
}

#[test]
fn a_marker_without_a_usable_position_or_side_or_that_is_named_twice_is_named_in_the_message() {
    let changes: [fn(&mut BenchMarker); 4] = [
        |marker| marker.side_m = 0.0,
        |marker| marker.side_m = f64::INFINITY,
        |marker| marker.centre.x = f64::NAN,
        |marker| marker.id = 1,
    ];
    for change in changes {
        let mut markers = named(&CORNERS);
        change(&mut markers[2]);
        let id = markers[2].id;
        let error = refused(&CORNERS, &markers);
        assert!(matches!(error, CalibrationError::Marker(named) if named == id), "{error}");
    }
}

#[test]
fn markers_that_are_not_in_the_picture_are_named() {
    let mut markers = named(&CORNERS);
    (markers[1].id, markers[3].id) = (11, 13);
    let error = refused(&CORNERS, &markers);
    assert!(matches!(&error, CalibrationError::NotSeen(ids) if *ids == [11, 13]), "{error}");
}

#[test]
fn a_marker_that_does_not_lie_where_it_is_said_to_lie_is_named_with_the_place_where_it_lies() {
    for wrong in 0..4_u16 {
        for shift in [[0.02, 0.0], [0.0, -0.01], [-0.03, 0.04]] {
            let mut elsewhere = CORNERS;
            let lies = &mut elsewhere[usize::from(wrong)];
            *lies = [lies[0] + shift[0], lies[1] + shift[1]];
            let lies = BenchPoint::new(lies[0], lies[1]);
            let error = refused(&elsewhere, &named(&CORNERS));
            let CalibrationError::Elsewhere { id, measured, .. } = error else {
                unreachable!("{wrong} {shift:?}: {error}")
            };
            assert_eq!(id, wrong);
            assert!((measured.x - lies.x).hypot(measured.y - lies.y) < 0.003, "{measured:?} is not {lies:?}");
        }
    }
}

#[test]
fn beside_a_marker_that_is_wrong_the_others_are_right() {
    let mut elsewhere = CORNERS;
    elsewhere[2][0] += 0.02;
    let drawn: Vec<_> =
        (0..).zip(elsewhere).map(|(id, centre)| Drawn::new(id, centre, SIDE_M, 0.0)).collect();
    let pixels = picture(640, 480, &straight_down(640, 480, 800.0), &drawn, Dictionary::default(), DAYLIGHT);
    let examined = examine(&gray(640, 480, &pixels), &named(&CORNERS), Dictionary::default()).unwrap();
    assert!(examined.outcome.is_err());
    let off: Vec<bool> = examined.markers.iter().map(|marker| marker.distance_m() > 0.002).collect();
    assert_eq!(off, [false, false, true, false]);
    let pixel = examined.pixel(BenchPoint::new(0.0, 0.0)).unwrap();
    assert!((pixel[0] - 319.5).hypot(pixel[1] - 239.5) < 1.5, "{pixel:?} is not the middle of the picture");
}

#[test]
fn under_a_tilted_camera_the_same_marker_is_named() {
    // The far edge of the bench appears a fifth smaller than the near one.
    let camera = [[640.0, -70.0, 319.5], [0.0, -620.0, 239.5], [0.0, 0.3, 1.0]];
    for wrong in 0..4_u16 {
        let mut elsewhere = CORNERS;
        elsewhere[usize::from(wrong)][1] += 0.015;
        let drawn: Vec<_> =
            (0..).zip(elsewhere).map(|(id, centre)| Drawn::new(id, centre, SIDE_M, 0.2)).collect();
        let pixels = picture(640, 480, &camera, &drawn, Dictionary::default(), DAYLIGHT);
        let error = calibrate(&gray(640, 480, &pixels), &named(&CORNERS), Dictionary::default()).unwrap_err();
        assert!(matches!(error, CalibrationError::Elsewhere { id, .. } if id == wrong), "{wrong}: {error}");
    }
}

#[test]
fn a_marker_of_another_size_is_named_with_its_size() {
    for wrong in 0..4 {
        let mut larger = named(&CORNERS);
        larger[wrong].side_m = 0.043;
        let error = refused(&CORNERS, &larger);
        let CalibrationError::Side { id, measured_m, .. } = error else { unreachable!("{error}") };
        assert_eq!(usize::from(id), wrong);
        assert!((measured_m - SIDE_M).abs() < 0.0005, "{error}");
    }
}

#[test]
fn a_print_in_another_size_is_not_blamed_on_one_marker() {
    let mut larger = named(&CORNERS);
    larger.iter_mut().for_each(|marker| marker.side_m = 0.0425);
    let message = refused(&CORNERS, &larger).to_string();
    assert!(message.starts_with("by their positions all markers have a side of 40."), "{message}");
}

#[test]
fn markers_at_each_others_positions_are_named() {
    for [one, other] in [[0, 1], [1, 2], [0, 2], [2, 3]] {
        let mut exchanged = CORNERS;
        exchanged.swap(one, other);
        let error = refused(&exchanged, &named(&CORNERS));
        assert!(
            matches!(error, CalibrationError::Exchanged(ids) if ids.map(usize::from) == [one, other]),
            "{error}"
        );
    }
}

#[test]
fn where_two_markers_are_wrong_all_are_listed() {
    let mut elsewhere = CORNERS;
    elsewhere[0][0] += 0.03;
    elsewhere[2][0] += 0.04;
    let message = refused(&elsewhere, &named(&CORNERS)).to_string();
    assert!(message.starts_with("more than one marker does not fit: marker 0 is"), "{message}");
}

#[test]
fn four_markers_do_not_fit_to_zero_whatever_was_measured() {
    // Half a centimetre is not enough to be refused.
    let mut elsewhere = CORNERS;
    elsewhere[1][0] += 0.005;
    let calibration = calibrated(&elsewhere, &named(&CORNERS)).unwrap();
    assert!(calibration.centre_error_m > 0.004, "{calibration:?}");
}

#[test]
fn markers_in_a_line_or_at_one_position_give_no_plane_unless_there_are_four_others() {
    let in_a_line = [[-0.25, 0.0], [-0.1, 0.0], [0.1, 0.0], [0.25, 0.0]];
    let three_in_a_line = [[-0.25, 0.1], [0.0, 0.1], [0.25, 0.1], [0.0, -0.1]];
    for centres in [in_a_line, three_in_a_line] {
        let error = refused(&centres, &named(&centres));
        assert!(matches!(error, CalibrationError::Degenerate), "{error}");
    }
    let mut at_one_position = CORNERS;
    at_one_position[1] = at_one_position[0];
    let error = refused(&CORNERS, &named(&at_one_position));
    assert!(matches!(error, CalibrationError::Degenerate), "{error}");
    let with_a_fifth = [[-0.25, -0.18], [0.25, -0.18], [0.25, 0.18], [-0.25, 0.18], [0.0, -0.18]];
    calibrated(&with_a_fifth, &named(&with_a_fifth)).unwrap();
}

#[test]
fn a_bench_whose_y_runs_towards_the_worker_is_mirrored() {
    let mirrored = CORNERS.map(|[x, y]| [x, -y]);
    assert!(matches!(refused(&CORNERS, &named(&mirrored)), CalibrationError::Mirrored));
}

#[test]
fn a_camera_with_another_lens_does_not_fit_a_calibration() {
    let calibration = calibrated(&CORNERS, &named(&CORNERS)).unwrap();
    let lens =
        |focal| Lens { focal, centre: [319.5, 239.5], distortion: Distortion::None, coefficients: [0.0; 5] };
    calibration.bench_frame(&lens([600.0, 600.0])).unwrap();
    let error = calibration.bench_frame(&lens([600.0, 900.0])).unwrap_err();
    assert!(matches!(error, CalibrationError::OtherCamera { pixels } if pixels > 2.0), "{error}");
}

#[test]
fn a_file_that_is_missing_or_no_calibration_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bench.toml");
    let error = Calibration::load(&path).unwrap_err();
    assert!(matches!(error, CalibrationError::File { verb: "read", .. }), "{error}");
    let calibration = calibrated(&CORNERS, &named(&CORNERS)).unwrap();
    let error = calibration.save(&folder.path().join("none/bench.toml")).unwrap_err();
    assert!(matches!(error, CalibrationError::File { verb: "written", .. }), "{error}");
    // A folder has the name: what was written before that is found is gone again.
    std::fs::create_dir(&path).unwrap();
    assert!(calibration.save(&path).is_err());
    std::fs::remove_dir(&path).unwrap();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left");
    std::fs::write(&path, "width = 640\n").unwrap();
    let error = Calibration::load(&path).unwrap_err();
    assert!(matches!(error, CalibrationError::Content { .. }), "{error}");
    let singular = Calibration { bench_from_image: [[0.0; 3]; 3], ..calibration };
    singular.save(&path).unwrap();
    let error = Calibration::load(&path).unwrap_err();
    assert!(error.to_string().contains("no homography"), "{error}");
}

#[test]
fn a_pipe_in_place_of_a_calibration_is_refused_and_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("bench.toml");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for path in [pipe.as_path(), std::path::Path::new("/dev/null")] {
        let refused = Calibration::load(path).unwrap_err();
        assert!(
            std::error::Error::source(&refused).unwrap().to_string().contains("pipe or a device"),
            "{refused}"
        );
    }
}
