use super::scene::{self, Rectangle, sampled};
use crate::detections::LANDMARKS;
use crate::metric::hand::{DepthSource, Hand3, Memory, Outline};

const TABLE: f64 = 0.76;
/// The back of the hand.
const BACK: f64 = 0.66;

/// A landmark of a flat hand, palm down, fingers away from the worker. The palm is 80 mm wide, the fingers are 20 mm apart.
fn landmark(index: usize) -> [f64; 2] {
    let (finger, joint) = (index.saturating_sub(1) / 4, index.saturating_sub(1) % 4);
    match index {
        0 => [0.0, 0.10],
        1..=4 => [-0.05, 0.07 - 0.025 * joint as f64],
        _ => [-0.03 + 0.02 * (finger as f64 - 1.0), -0.005 - 0.025 * joint as f64],
    }
}

fn pixels() -> [[f32; 2]; LANDMARKS] {
    std::array::from_fn(|index| {
        let [x, y] = landmark(index);
        let point = nalgebra::Point3::new(x, y, BACK);
        scene::rig().colour.project(&point).unwrap().into()
    })
}

/// The depth picture of the hand. `cover` is the depth of something over the tip of the index finger.
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

/// The shape that a hand model guesses: a fifth smaller than the hand, and with the tip of the index finger bent down.
fn outline(tip_below: f64) -> Outline {
    let shape: [[f32; 3]; LANDMARKS] = std::array::from_fn(|index| {
        let [x, y] = landmark(index);
        [x, y, if index == 8 { tip_below } else { 0.0 }].map(|value| (0.8 * value) as f32)
    });
    Outline::new(&pixels(), &shape)
}

fn placed(bytes: &[u8], outline: &Outline) -> Hand3 {
    let lens = scene::rig().colour;
    sampled(bytes, |depth| outline.place(Some(depth), &lens, 0, &mut Memory::default())).unwrap()
}

#[test]
fn landmarks_lie_half_a_hand_s_thickness_under_the_skin() {
    let hand = placed(&hand(None), &outline(0.0));
    assert_eq!(hand.sources, [DepthSource::Measured; LANDMARKS]);
    assert!((hand.points[0].z - (BACK + 0.020)).abs() < 0.002, "wrist: {}", hand.points[0]);
    assert!((hand.points[8].z - (BACK + 0.007)).abs() < 0.002, "tip: {}", hand.points[8]);
}

#[test]
fn what_hides_a_landmark_is_not_taken_for_it() {
    let hand = placed(&hand(Some(0.55)), &outline(0.0));
    assert_eq!(hand.sources[8], DepthSource::Shape);
    // The palm is thinner at the knuckles than at the wrist, which tilts it by 7 mm.
    assert!((hand.points[8].z - hand.points[5].z).abs() < 0.007, "{} is in the hand", hand.points[8].z);
}

#[test]
fn a_tip_under_the_hand_is_as_far_below_as_the_shape_says_in_the_size_of_this_hand() {
    let hand = placed(&hand(None), &outline(0.040));
    assert_eq!(hand.sources[8], DepthSource::Shape);
    let below = hand.points[8].z - hand.points[5].z;
    assert!((below - 0.040).abs() < 0.007, "{below}");
    assert_eq!(hand.sources[12], DepthSource::Measured, "its neighbour is not bent");
}

#[test]
fn without_depth_a_hand_stays_as_high_as_it_was_for_half_a_second() {
    let lens = scene::rig().colour;
    let (mut memory, outline) = (Memory::default(), outline(0.0));
    let mut at = |bytes: &[u8], now_ns: u64| {
        sampled(bytes, |depth| outline.place(Some(depth), &lens, now_ns, &mut memory))
    };
    let empty = vec![0; scene::WIDTH * scene::HEIGHT * 2];
    assert_eq!(at(&empty, 0), None, "it was never measured");
    let seen = at(&hand(None), 1).unwrap();
    let guessed = at(&empty, 500_000_001).unwrap();
    assert_eq!(guessed.sources, [DepthSource::Shape; LANDMARKS]);
    let away = (guessed.points[9] - seen.points[9]).norm();
    assert!(away < 0.005, "{away} m");
    assert_eq!(at(&empty, 500_000_002), None, "that was long ago");
    assert_eq!(outline.place(None, &lens, 2, &mut memory).map(|hand| hand.sources), Some(guessed.sources));
}

#[test]
fn a_shape_of_nothing_places_no_hand() {
    let flat = Outline::new(&pixels(), &[[0.0; 3]; LANDMARKS]);
    let lens = scene::rig().colour;
    assert_eq!(sampled(&hand(None), |depth| flat.place(Some(depth), &lens, 0, &mut Memory::default())), None);
}
