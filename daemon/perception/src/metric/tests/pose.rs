use super::scene::{self, Rectangle, sampled};
use crate::metric::pose::{PreviousPose, candidates, choose};
use crate::points::PixelPoint;
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

const SIDE: f64 = 0.036;

/// A marker 0.7 m under the camera, tilted by `degrees` about an axis of its plane. Its z points at the camera.
fn marker(degrees: f64, axis: f64) -> Isometry3<f64> {
    let facing = UnitQuaternion::from_rotation_matrix(&Rotation3::from_axis_angle(
        &Vector3::x_axis(),
        std::f64::consts::PI,
    ));
    let axis = nalgebra::Unit::new_normalize(Vector3::new(axis.cos(), axis.sin(), 0.0));
    let tilt = UnitQuaternion::from_axis_angle(&axis, degrees.to_radians());
    Isometry3::from_parts(Translation3::new(0.05, -0.04, 0.7), facing * tilt)
}

fn corners(pose: &Isometry3<f64>) -> [PixelPoint; 4] {
    let half = SIDE / 2.0;
    [[-half, half], [half, half], [half, -half], [-half, -half]]
        .map(|[x, y]| scene::rig().colour.project(&(pose * Point3::new(x, y, 0.0))).unwrap())
}

/// Corners with the errors of a detector.
fn noisy(pose: &Isometry3<f64>) -> [PixelPoint; 4] {
    let errors = [[0.06, -0.08], [-0.09, 0.02], [0.05, 0.07], [-0.03, -0.06]];
    let exact = corners(pose);
    std::array::from_fn(|index| {
        let [x, y] = errors[index];
        PixelPoint::new(exact[index].x + x, exact[index].y + y)
    })
}

fn tilt_between(one: &Isometry3<f64>, two: &Isometry3<f64>) -> f64 {
    (one.rotation * Vector3::z()).angle(&(two.rotation * Vector3::z())).to_degrees()
}

#[test]
fn one_of_the_two_poses_is_that_of_the_marker() {
    for degrees in [3.0, 20.0, 45.0] {
        for axis in [0.0, 1.0, 2.5] {
            let pose = marker(degrees, axis);
            let found = candidates(&corners(&pose), SIDE, &scene::rig().colour).unwrap();
            assert_eq!(found.len(), 2);
            let best = found
                .iter()
                .map(|each| each.camera_from_marker.rotation.angle_to(&pose.rotation))
                .fold(9.0, f64::min);
            assert!(best < 0.01, "{degrees} degrees about {axis}: {best} rad off");
        }
    }
}

#[test]
fn depth_on_the_marker_decides_between_the_two_poses() {
    for axis in [0.3, 1.5, 3.6] {
        let pose = marker(20.0, axis);
        let bytes = scene::depth(&[
            Rectangle { pose, half: [0.03, 0.03] },
            Rectangle::facing([0.0, 0.0, 0.8], [5.0, 5.0]),
        ]);
        let seen = noisy(&pose);
        let patch = sampled(&bytes, |depth| depth.patch(&seen)).unwrap();
        let found = candidates(&seen, SIDE, &scene::rig().colour).unwrap();
        let chosen = choose(&found, Some(&patch), None).unwrap();
        assert!(chosen.unambiguous);
        let tilt = tilt_between(&chosen.camera_from_marker, &pose);
        assert!(tilt < 5.0, "about {axis}: {tilt} degrees off");
        let shift = (chosen.camera_from_marker.translation.vector - pose.translation.vector).norm();
        assert!(shift < 0.002, "about {axis}: {shift} m off");
    }
}

#[test]
fn without_depth_the_pose_of_a_moment_ago_decides() {
    let pose = marker(12.0, 0.7);
    let found = candidates(&noisy(&pose), SIDE, &scene::rig().colour).unwrap();
    let other = found
        .iter()
        .map(|each| each.camera_from_marker)
        .max_by(|one, two| tilt_between(one, &pose).total_cmp(&tilt_between(two, &pose)));
    for wanted in [pose, other.unwrap()] {
        let before = PreviousPose { camera_from_marker: wanted, ago_ns: 33_000_000 };
        let chosen = choose(&found, None, Some(&before)).unwrap();
        assert!(tilt_between(&chosen.camera_from_marker, &wanted) < 8.0);
    }
}

#[test]
fn a_pose_of_long_ago_decides_nothing() {
    let pose = marker(3.0, 0.7);
    let found = candidates(&noisy(&pose), SIDE, &scene::rig().colour).unwrap();
    let alone = choose(&found, None, None);
    let before = PreviousPose { camera_from_marker: marker(40.0, 2.0), ago_ns: 600_000_000 };
    assert_eq!(choose(&found, None, Some(&before)), alone);
}

#[test]
fn a_marker_that_is_nearly_face_on_is_ambiguous_without_depth_and_past() {
    let flat = candidates(&noisy(&marker(3.0, 0.7)), SIDE, &scene::rig().colour).unwrap();
    assert!(!choose(&flat, None, None).unwrap().unambiguous);
    let steep = candidates(&corners(&marker(45.0, 0.7)), SIDE, &scene::rig().colour).unwrap();
    assert!(choose(&steep, None, None).unwrap().unambiguous);
}

#[test]
fn a_marker_without_depth_on_half_of_it_has_no_patch() {
    let pose = marker(0.0, 0.0);
    let mut bytes = scene::depth(&[Rectangle { pose, half: [0.03, 0.03] }]);
    assert!(sampled(&bytes, |depth| depth.patch(&corners(&pose))).is_some());
    for pixel in bytes.chunks_exact_mut(4) {
        // Every other pixel, and then some more.
        pixel[..2].fill(0);
    }
    for pixel in bytes.chunks_exact_mut(12) {
        pixel.fill(0);
    }
    assert!(sampled(&bytes, |depth| depth.patch(&corners(&pose))).is_none());
}
