use super::scene::{self, HEIGHT, Rectangle, WIDTH, sampled};
use crate::bench::Calibration;
use crate::metric::bench::BenchFrame;
use crate::metric::depth::DepthImage;
use crate::metric::lens::Lens;
use crate::points::PixelPoint;
use nalgebra::{Isometry3, Matrix3, Point3, Translation3, UnitQuaternion, Vector3};

const TABLE: f64 = 0.76;

fn table() -> Rectangle {
    Rectangle::facing([0.0, 0.0, TABLE], [5.0, 5.0])
}

/// A finger, 16 mm wide, 60 mm long and 100 mm above the table.
fn finger() -> Rectangle {
    Rectangle::facing([0.02, 0.01, TABLE - 0.1], [0.008, 0.03])
}

/// The colour pixel of the middle of the finger.
fn finger_pixel() -> PixelPoint {
    scene::rig().colour.project(&Point3::new(0.02, 0.01, TABLE - 0.1)).unwrap()
}

fn finger_depth(bytes: &[u8]) -> Option<f64> {
    sampled(bytes, |depth| depth.surface(finger_pixel(), 0.006)).map(|point| point.z)
}

/// Column and row of the depth pixel that sees a point of the depth camera's frame.
fn pixel_of(point: &Point3<f64>) -> [usize; 2] {
    let PixelPoint { x, y } = scene::rig().depth.project(point).unwrap();
    [x, y].map(|value| value.round() as usize)
}

#[test]
fn a_colour_pixel_finds_its_depth_through_the_extrinsics() {
    let bytes = scene::depth(&[table()]);
    for pixel in [(60.0, 40.0), (319.5, 239.5), (580.0, 440.0)].map(|(x, y)| PixelPoint::new(x, y)) {
        let point = sampled(&bytes, |depth| depth.surface(pixel, 0.006)).unwrap();
        assert!((point.z - TABLE).abs() < 0.0015, "{pixel:?}: {point}");
        let wanted = scene::rig().colour.deproject(pixel, TABLE);
        assert!((point - wanted).norm() < 0.002, "{pixel:?}: {point}");
    }
}

#[test]
fn the_finger_is_measured_and_not_the_table_beside_it() {
    let depth = finger_depth(&scene::depth(&[table(), finger()])).unwrap();
    assert!((depth - (TABLE - 0.1)).abs() < 0.002, "{depth}");
}

#[test]
fn a_hole_in_the_depth_is_bridged_by_its_rim() {
    let mut bytes = scene::depth(&[table(), finger()]);
    let rig = scene::rig();
    let point = rig.colour_from_depth.inverse_transform_point(&Point3::new(0.02, 0.01, TABLE - 0.1));
    let [column, row] = pixel_of(&point);
    for beside in 0..2 {
        scene::put(&mut bytes, column + beside, row, 0.0);
    }
    let depth = finger_depth(&bytes).unwrap();
    assert!((depth - (TABLE - 0.1)).abs() < 0.002, "{depth}");
}

#[test]
fn points_that_fly_in_front_of_the_finger_do_not_count() {
    let mut bytes = scene::depth(&[table(), finger()]);
    let rig = scene::rig();
    let point = rig.colour_from_depth.inverse_transform_point(&Point3::new(0.02, 0.01, TABLE - 0.1));
    let [column, row] = pixel_of(&point);
    scene::put(&mut bytes, column, row - 1, 0.40);
    scene::put(&mut bytes, column + 1, row + 1, 0.52);
    let depth = finger_depth(&bytes).unwrap();
    assert!((depth - (TABLE - 0.1)).abs() < 0.002, "{depth}");
}

#[test]
fn without_any_depth_there_is_no_surface() {
    assert_eq!(finger_depth(&vec![0; WIDTH * HEIGHT * 2]), None);
}

#[test]
fn a_pixel_outside_the_depth_picture_has_no_surface() {
    let bytes = scene::depth(&[table()]);
    assert_eq!(sampled(&bytes, |depth| depth.surface(PixelPoint::new(-4000.0, 0.0), 0.006)), None);
}

#[test]
fn a_depth_picture_that_is_too_short_is_refused() {
    assert!(DepthImage::new([WIDTH, HEIGHT], 2 * WIDTH, 0.001, &[0; 100]).is_err());
    assert!(DepthImage::new([WIDTH, HEIGHT], WIDTH, 0.001, &[0; WIDTH * HEIGHT * 2]).is_err());
}

/// A camera 0.8 m above the bench that looks 15 degrees askew; a third of the picture is covered by a box.
#[test]
fn the_bench_is_found_under_a_tilted_camera_and_behind_what_lies_on_it() {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 15_f64.to_radians());
    let bench = Isometry3::from_parts(Translation3::new(0.0, 0.0, 0.8), turn);
    let on_it = bench * Isometry3::translation(0.05, 0.05, -0.05);
    let bytes = scene::depth(&[
        Rectangle { pose: bench, half: [5.0, 5.0] },
        Rectangle { pose: on_it, half: [0.25, 0.25] },
    ]);
    let found = sampled(&bytes, BenchFrame::from_depth).unwrap();
    for place in [[0.0, 0.0], [0.2, -0.1], [-0.3, 0.2]] {
        let seen = found.bench_from_camera * (bench * Point3::new(place[0], place[1], 0.0));
        assert!(seen.z.abs() < 0.001, "{place:?}: {seen}");
        let above = found.bench_from_camera * (bench * Point3::new(place[0], place[1], -0.1));
        assert!((above.z - 0.1).abs() < 0.001, "z is up: {above}");
    }
    // The colour camera's foot is the origin, x runs to the right in the picture and y up.
    let camera = found.bench_from_camera * Point3::origin();
    assert!(camera.x.abs() < 1e-9 && camera.y.abs() < 1e-9 && camera.z > 0.7, "{camera}");
    assert!((found.bench_from_camera.rotation * Vector3::x()).x > 0.99);
    assert!((found.bench_from_camera.rotation * Vector3::y()).y < -0.9);
}

#[test]
fn a_wall_is_not_taken_for_the_bench() {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 70_f64.to_radians());
    let wall = Isometry3::from_parts(Translation3::new(0.0, 0.0, 1.0), turn);
    let bytes = scene::depth(&[Rectangle { pose: wall, half: [5.0, 5.0] }]);
    assert!(sampled(&bytes, BenchFrame::from_depth).is_err());
}

#[test]
fn a_calibration_of_the_bench_plane_gives_the_pose_of_the_camera() {
    let lens = scene::rig().colour;
    let turn = UnitQuaternion::from_euler_angles(std::f64::consts::PI - 0.25, 0.1, 0.4);
    let camera_from_bench = Isometry3::from_parts(Translation3::new(0.02, -0.03, 0.9), turn);
    // A point of the bench is K (r1 x + r2 y + t) in the picture.
    let motion = camera_from_bench.to_homogeneous();
    let [fx, fy, cx, cy] = [lens.focal[0], lens.focal[1], lens.centre[0], lens.centre[1]];
    let optics = Matrix3::new(fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0);
    let columns = [0, 1, 3].map(|column| motion.fixed_view::<3, 1>(0, column).into_owned());
    let bench_from_image = (optics * Matrix3::from_columns(&columns)).try_inverse().unwrap();
    let calibration = Calibration {
        width: 640,
        height: 480,
        bench_from_image: [0, 1, 2].map(|row| [0, 1, 2].map(|column| bench_from_image[(row, column)])),
        side_error: 0.0,
        centre_error_m: 0.0,
    };
    let found = calibration.bench_frame(&lens).unwrap();
    let difference = found.bench_from_camera * camera_from_bench;
    assert!(
        difference.translation.vector.norm() < 1e-4 && difference.rotation.angle() < 1e-3,
        "{difference}"
    );
    let other = Lens { focal: [1.5 * fx, fy], ..lens };
    assert!(calibration.bench_frame(&other).is_err(), "the picture of another camera");
}
