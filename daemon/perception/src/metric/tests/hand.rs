use super::scene::{self, Rectangle, sampled};
use crate::detections::LANDMARKS;
use crate::metric::hand::{DepthSource, Hand3, place};

const TABLE: f64 = 0.76;
/// The back of the hand.
const BACK: f64 = 0.66;

/// A flat hand, palm down, fingers away from the worker: palm 80 mm wide, fingers in rows of 20 mm.
fn landmark(k: usize) -> [f64; 2] {
    let (finger, joint) = (k.saturating_sub(1) / 4, k.saturating_sub(1) % 4);
    match k {
        0 => [0.0, 0.10],
        1..=4 => [-0.05, 0.07 - 0.025 * joint as f64],
        _ => [-0.03 + 0.02 * (finger as f64 - 1.0), -0.005 - 0.025 * joint as f64],
    }
}

fn pixels() -> [[f32; 2]; LANDMARKS] {
    std::array::from_fn(|k| {
        let [x, y] = landmark(k);
        let point = nalgebra::Point3::new(x, y, BACK);
        scene::rig().colour.project(&point).unwrap().map(|value| value as f32)
    })
}

/// Its depth, with something over the tip of the index finger.
fn hand(cover: Option<f64>) -> Vec<u8> {
    let mut parts = vec![
        Rectangle::facing([0.0, 0.0, TABLE], [5.0, 5.0]),
        Rectangle::facing([0.0, 0.02, BACK], [0.07, 0.12]),
    ];
    if let Some(depth) = cover {
        let [x, y] = landmark(8);
        parts.push(Rectangle::facing([x * depth / BACK, y * depth / BACK, depth], [0.012, 0.012]));
    }
    scene::depth(&parts)
}

fn placed(bytes: &[u8], relative: Option<&[f32; LANDMARKS]>) -> Hand3 {
    sampled(bytes, |depth| place(&pixels(), relative, depth, &scene::rig().colour)).unwrap()
}

#[test]
fn landmarks_lie_half_a_hand_s_thickness_under_the_skin() {
    let hand = placed(&hand(None), None);
    assert_eq!(hand.sources, [DepthSource::Measured; LANDMARKS]);
    assert!((hand.points[0].z - (BACK + 0.020)).abs() < 0.002, "wrist: {}", hand.points[0]);
    assert!((hand.points[8].z - (BACK + 0.007)).abs() < 0.002, "tip: {}", hand.points[8]);
}

#[test]
fn what_hides_a_landmark_is_not_taken_for_it() {
    let hand = placed(&hand(Some(0.55)), None);
    assert_eq!(hand.sources[8], DepthSource::Neighbour);
    assert!((hand.points[8].z - hand.points[7].z).abs() < 1e-9, "it takes its neighbour's depth");
}

#[test]
fn the_relative_depth_fills_in_where_a_landmark_is_hidden() {
    // The index finger is bent down by 20 mm at its tip: in pixels at the hand, smaller is nearer.
    let mut relative = [0.0; LANDMARKS];
    let scale = scene::rig().colour.focal[0] as f32 / BACK as f32;
    relative[8] = 0.020 * scale;
    let hand = placed(&hand(Some(0.55)), Some(&relative));
    assert_eq!(hand.sources[8], DepthSource::Relative);
    let wanted = hand.points[12].z + 0.020;
    assert!((hand.points[8].z - wanted).abs() < 0.004, "{} instead of {wanted}", hand.points[8].z);
}

#[test]
fn a_hand_without_depth_is_not_placed() {
    let empty = vec![0; scene::WIDTH * scene::HEIGHT * 2];
    assert_eq!(sampled(&empty, |depth| place(&pixels(), None, depth, &scene::rig().colour)), None);
}
