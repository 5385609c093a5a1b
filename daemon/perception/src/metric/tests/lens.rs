use crate::metric::lens::{Distortion, Lens, rigid};
use crate::points::PixelPoint;
use nalgebra::Point3;
use opencv::core::{Mat, Point2d, Point3d, Vector};
use opencv::{calib3d, core, prelude::*};

/// A lens that bends more than any D400: errors of the formulas are several pixels.
fn bent(distortion: Distortion) -> Lens {
    let coefficients = [0.12, -0.25, 0.0012, -0.0007, 0.08];
    Lens { focal: [910.5, 908.25], centre: [641.3, 358.7], distortion, coefficients }
}

const POINTS: [[f64; 3]; 3] = [[0.1, -0.2, 0.9], [-0.35, 0.22, 0.7], [0.4, 0.3, 1.1]];

#[test]
fn pixels_are_those_of_librealsense() {
    // rs2_project_point_to_pixel of librealsense 2.56.5 for `bent` and `POINTS`.
    let oracle = [
        (Distortion::None, [[742.46667, 156.86667], [186.04999, 644.15002], [972.39087, 606.40454]]),
        (Distortion::BrownConrady, [[743.01257, 155.76639], [178.41153, 649.18024], [977.21643, 610.33844]]),
        (
            Distortion::InverseBrownConrady,
            [[743.01166, 155.76819], [178.39166, 649.19263], [977.21790, 610.33954]],
        ),
    ];
    for (distortion, wanted) in oracle {
        for (point, wanted) in POINTS.iter().zip(wanted) {
            let seen = bent(distortion).project(&Point3::from(*point)).unwrap();
            // It computes in f32.
            assert!(
                seen.distance(PixelPoint::new(wanted[0], wanted[1])) < 2e-4,
                "{distortion:?} {point:?}: {seen:?}"
            );
        }
    }
}

#[test]
fn brown_conrady_is_that_of_opencv() {
    let lens = bent(Distortion::BrownConrady);
    let points: Vector<Point3d> = POINTS.iter().map(|[x, y, z]| Point3d::new(*x, *y, *z)).collect();
    let [fx, fy] = lens.focal;
    let [cx, cy] = lens.centre;
    let eye = Mat::from_slice_2d(&[[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]).unwrap();
    let distortion = Mat::from_slice(&lens.coefficients).unwrap().clone_pointee();
    let still = Mat::zeros(3, 1, core::CV_64F).unwrap().to_mat().unwrap();
    let mut seen = Vector::<Point2d>::new();
    calib3d::project_points_def(&points, &still, &still, &eye, &distortion, &mut seen).unwrap();
    for (point, wanted) in POINTS.iter().zip(seen.iter()) {
        let own = lens.project(&Point3::from(*point)).unwrap();
        assert!(own.distance(PixelPoint::new(wanted.x, wanted.y)) < 1e-9, "{point:?}");
    }
}

#[test]
fn deprojection_undoes_projection() {
    for distortion in [Distortion::None, Distortion::BrownConrady, Distortion::InverseBrownConrady] {
        // Coefficients as a D435i's colour camera has them.
        let lens = Lens { coefficients: [0.05, -0.08, 0.0004, -0.0003, 0.02], ..bent(distortion) };
        for u in (0..1280).step_by(80) {
            for v in (0..720).step_by(60) {
                let pixel = PixelPoint::new(f64::from(u), f64::from(v));
                let back = lens.project(&lens.deproject(pixel, 0.7)).unwrap();
                assert!(back.distance(pixel) < 1e-6, "{distortion:?} {pixel:?}: {back:?}");
            }
        }
    }
}

#[test]
fn nothing_is_seen_behind_the_camera() {
    assert_eq!(bent(Distortion::None).project(&Point3::new(0.1, 0.1, -0.5)), None);
}

#[test]
fn the_rows_of_a_matrix_make_the_motion_that_they_say() {
    // A quarter turn about z takes x to y.
    let motion = rigid([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [0.5, 0.0, 0.0]);
    assert!((motion * Point3::new(1.0, 0.0, 0.0) - Point3::new(0.5, 1.0, 0.0)).norm() < 1e-12);
}
