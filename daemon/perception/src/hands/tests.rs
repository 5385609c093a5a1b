//! The tracker on scripted models: hands are where the script says, and every palm detection is counted.

#![allow(clippy::unwrap_used)]

use super::models::{LandmarkModel, Landmarks, PalmModel};
use super::palm::{Palm, Palms};
use super::region::Region;
use super::tracker::{Found, Tracker};
use crate::config::{HandsConfig, ThreadsConfig};
use crate::detections::{HANDS, LANDMARKS, Side, Timings};
use crate::error::PerceptionError;
use crate::image::ImageView;
use crate::pixel_format::PixelFormat;
use crate::workers::Workers;
use std::sync::{Arc, Mutex, MutexGuard};

const FRAME_NS: u64 = 33_333_333;

/// A hand of the script: fingers up, 100 px from wrist to the middle knuckle.
#[derive(Clone, Copy)]
struct Scripted {
    wrist: [f32; 2],
    /// The model's probability that it is a right hand.
    right: f32,
}

#[derive(Default)]
struct Script {
    hands: Vec<Scripted>,
    palm_detections: usize,
    /// Searches whose palms were taken, and waited for where they were not there yet.
    searches_waited_for: usize,
    /// The palms of the picture that was searched last.
    searched: Palms,
    /// The next landmarks lie this far beside the hand.
    slip: f32,
    /// The number of the next looks that read the hand as one of the other side, with its fingers in the opposite order.
    misread: usize,
}

#[derive(Clone, Default)]
struct Models(Arc<Mutex<Script>>);

impl Models {
    fn script(&self) -> MutexGuard<'_, Script> {
        self.0.lock().unwrap()
    }
}

impl PalmModel for Models {
    fn palms(&mut self, image: &ImageView<'_>) -> Result<Palms, PerceptionError> {
        self.begin(image)?;
        Ok(self.finish()?.0)
    }

    fn begin(&mut self, _: &ImageView<'_>) -> Result<(), PerceptionError> {
        let mut script = self.script();
        script.palm_detections += 1;
        script.searched = script.hands.iter().map(|hand| palm(hand.wrist)).collect();
        Ok(())
    }

    fn finish(&mut self) -> Result<(Palms, u64), PerceptionError> {
        let mut script = self.script();
        script.searches_waited_for += 1;
        Ok((std::mem::take(&mut script.searched), 0))
    }
}

impl LandmarkModel for Models {
    /// The hand whose middle is nearest to the middle of the region, if it lies inside.
    fn landmarks(&mut self, _: &ImageView<'_>, region: Region) -> Result<Landmarks, PerceptionError> {
        let away = |hand: &Scripted| {
            (hand.wrist[0] - region.centre[0]).hypot(hand.wrist[1] - 100.0 - region.centre[1])
        };
        let mut script = self.script();
        let slip = std::mem::take(&mut script.slip);
        let is_misread = script.misread > 0;
        script.misread = script.misread.saturating_sub(1);
        let nearest = script.hands.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        Ok(match nearest.filter(|hand| away(hand) < region.side / 2.0) {
            Some(hand) => {
                let mut points_px = landmarks([hand.wrist[0] + slip, hand.wrist[1]]);
                if is_misread {
                    points_px[5..].rotate_left(8);
                }
                Landmarks {
                    points_px,
                    shape_m: [[0.0; 3]; LANDMARKS],
                    presence: 0.9,
                    right: if is_misread { 1.0 - hand.right } else { hand.right },
                }
            }
            None => Landmarks {
                points_px: landmarks(region.centre),
                shape_m: [[0.0; 3]; LANDMARKS],
                presence: 0.1,
                right: 0.5,
            },
        })
    }
}

fn palm([x, y]: [f32; 2]) -> Palm {
    let keypoints = [
        [x, y],
        [x - 20.0, y - 95.0],
        [x, y - 100.0],
        [x + 15.0, y - 95.0],
        [x + 30.0, y - 85.0],
        [x; 2],
        [x; 2],
    ];
    Palm { score: 0.9, bounds: [x - 60.0, y - 110.0, x + 60.0, y + 10.0], keypoints }
}

fn landmarks([x, y]: [f32; 2]) -> [[f32; 2]; LANDMARKS] {
    std::array::from_fn(|landmark| match landmark {
        0 => [x, y],
        1..=4 => [x - 30.0 - 10.0 * landmark as f32, y - 20.0 * landmark as f32],
        finger => {
            let (column, joint) = ((finger - 5) / 4, (finger - 5) % 4);
            [x - 20.0 + 15.0 * column as f32, y - 100.0 - 25.0 * joint as f32]
        }
    })
}

/// A bench with a tracker over it and a clock.
struct Bench {
    script: Models,
    tracker: Tracker<Models, Models>,
    workers: Workers,
    now_ns: u64,
    /// The brightness of the picture, and that of a corner of it.
    grey: [u8; 2],
}

impl Bench {
    fn wanting(sides: &[Side]) -> Self {
        let script = Models::default();
        let config = HandsConfig { sides: sides.to_vec(), ..HandsConfig::default() };
        let looks = sides.iter().map(|_| script.clone()).collect();
        let tracker = Tracker::new(script.clone(), looks, config);
        Self {
            tracker,
            workers: Workers::new(&ThreadsConfig::default()).unwrap(),
            script,
            now_ns: 0,
            grey: [0; 2],
        }
    }

    fn frame(&mut self, hands: &[Scripted]) -> heapless::Vec<Found, HANDS> {
        self.frame_after(1, hands)
    }

    fn frame_after(&mut self, frames: u64, hands: &[Scripted]) -> heapless::Vec<Found, HANDS> {
        self.now_ns += frames * FRAME_NS;
        self.script.script().hands = hands.to_vec();
        let [grey, corner] = self.grey;
        let mut pixels = vec![grey; 1280 * 720];
        for row in pixels.chunks_exact_mut(1280).take(20) {
            row[..20].fill(corner);
        }
        let image = ImageView::new(1280, 720, 1280, PixelFormat::Gray8, &pixels).unwrap();
        self.tracker.step(&image, self.now_ns, &self.workers, &mut Timings::default()).unwrap()
    }

    fn palm_detections(&self) -> usize {
        self.script.script().palm_detections
    }
}

fn hand(x: f32, right: f32) -> Scripted {
    Scripted { wrist: [x, 500.0], right }
}

fn sides(hands: &[Found]) -> Vec<Side> {
    hands.iter().map(|hand| hand.side).collect()
}

#[test]
fn a_hand_that_is_followed_needs_no_palm_detection() {
    let mut bench = Bench::wanting(&[Side::Right]);
    for frame in 0..50 {
        let hands = bench.frame(&[hand(300.0 + 5.0 * frame as f32, 0.9)]);
        assert_eq!(hands[0].landmarks_px, landmarks([300.0 + 5.0 * frame as f32, 500.0]));
    }
    assert_eq!(bench.palm_detections(), 1);
}

#[test]
fn a_lost_hand_is_looked_for_in_the_same_frame() {
    let mut bench = Bench::wanting(&[Side::Right]);
    bench.frame(&[hand(300.0, 0.9)]);
    let hands = bench.frame(&[hand(900.0, 0.9)]);
    assert_eq!(hands[0].landmarks_px[0], [900.0, 500.0]);
    assert_eq!(bench.palm_detections(), 2);
}

#[test]
fn an_empty_bench_is_searched_on_every_frame_until_it_is_known_to_be_empty_and_then_on_every_tenth() {
    let mut bench = Bench::wanting(&[Side::Right]);
    for _ in 0..50 {
        assert!(bench.frame(&[]).is_empty());
    }
    assert_eq!(bench.palm_detections(), 10 + 4);
}

#[test]
fn a_bench_at_rest_is_searched_in_the_frame_in_which_anything_changes() {
    let mut bench = Bench::wanting(&[Side::Right]);
    for _ in 0..15 {
        bench.frame(&[]);
    }
    assert_eq!(bench.palm_detections(), 10);
    bench.grey[1] = 20;
    assert_eq!(bench.frame(&[hand(300.0, 0.9)]).len(), 1);
}

#[test]
fn a_bench_whose_picture_goes_on_changing_is_searched_on_every_frame() {
    let mut bench = Bench::wanting(&[Side::Right]);
    for frame in 0..50 {
        bench.grey[0] = 100 + 4 * (frame % 2);
        bench.frame(&[]);
    }
    assert_eq!(bench.palm_detections(), 50);
}

#[test]
fn a_hand_that_comes_back_to_an_empty_bench_is_found_at_once() {
    let mut bench = Bench::wanting(&[Side::Right]);
    for _ in 0..20 {
        bench.frame(&[]);
    }
    bench.grey[1] = 20;
    assert_eq!(bench.frame(&[hand(300.0, 0.9)]).len(), 1);
    bench.grey[1] = 0;
    let before = bench.palm_detections();
    for _ in 0..5 {
        bench.frame(&[]);
    }
    assert_eq!(bench.palm_detections(), before + 5);
}

#[test]
fn wanting_two_hands_with_one_in_view_searches_every_tenth_frame() {
    let mut bench = Bench::wanting(&[Side::Right, Side::Left]);
    for _ in 0..101 {
        assert_eq!(sides(&bench.frame(&[hand(300.0, 0.9)])), [Side::Right]);
    }
    assert_eq!(bench.palm_detections(), 11);
    let found =
        (0..11).map(|_| bench.frame(&[hand(300.0, 0.9), hand(900.0, 0.1)])).find(|hands| hands.len() == 2);
    assert_eq!(sides(&found.unwrap()), [Side::Right, Side::Left]);
}

#[test]
fn the_frame_in_which_a_search_begins_does_not_wait_for_it_while_a_hand_is_followed() {
    let mut bench = Bench::wanting(&[Side::Right, Side::Left]);
    bench.frame(&[hand(300.0, 0.9)]);
    let mut waited = Vec::new();
    for _ in 0..41 {
        let [began, ended] = [bench.palm_detections(), bench.script.script().searches_waited_for];
        assert_eq!(sides(&bench.frame(&[hand(300.0, 0.9)])), [Side::Right]);
        let has_begun = bench.palm_detections() > began;
        let has_waited = bench.script.script().searches_waited_for > ended;
        assert!(!(has_begun && has_waited), "the frame has waited for its own search");
        waited.push(has_waited);
    }
    assert_eq!(waited.iter().filter(|waited| **waited).count(), 4, "{waited:?}");
}

#[test]
fn an_unwanted_hand_is_not_reported_and_does_not_keep_palm_detection_busy() {
    let mut bench = Bench::wanting(&[Side::Right]);
    for _ in 0..40 {
        assert!(bench.frame(&[hand(300.0, 0.1)]).is_empty());
    }
    assert_eq!(bench.palm_detections(), 4);
    assert!((0..11).any(|_| sides(&bench.frame(&[hand(300.0, 0.1), hand(900.0, 0.9)])) == [Side::Right]));
}

#[test]
fn after_dropped_frames_palm_detection_runs_and_the_hand_keeps_its_side() {
    let mut bench = Bench::wanting(&[Side::Right]);
    for _ in 0..10 {
        bench.frame(&[hand(300.0, 0.99)]);
    }
    let hands = bench.frame_after(6, &[hand(380.0, 0.3)]);
    assert_eq!(bench.palm_detections(), 2);
    assert_eq!(sides(&hands), [Side::Right]);
    assert_eq!(hands[0].landmarks_px[0], [380.0, 500.0]);
    bench.frame(&[hand(380.0, 0.3)]);
    assert_eq!(bench.palm_detections(), 2);
}

#[test]
fn a_side_does_not_flicker_when_the_model_wavers() {
    let mut bench = Bench::wanting(&[Side::Right, Side::Left]);
    // Three sure looks, then two of five say the opposite.
    for frame in 0..200 {
        let right = if frame >= 3 && frame % 5 < 2 { 0.05 } else { 0.95 };
        assert_eq!(sides(&bench.frame(&[hand(300.0, right)])), [Side::Right], "frame {frame}");
    }
}

#[test]
fn a_side_that_was_wrong_is_corrected() {
    let mut bench = Bench::wanting(&[Side::Right, Side::Left]);
    for _ in 0..3 {
        assert_eq!(sides(&bench.frame(&[hand(300.0, 0.1)])), [Side::Left]);
    }
    for _ in 0..10 {
        bench.frame(&[hand(300.0, 0.95)]);
    }
    assert_eq!(sides(&bench.frame(&[hand(300.0, 0.95)])), [Side::Right]);
}

#[test]
fn a_hand_whose_side_is_unclear_is_not_reported() {
    let mut bench = Bench::wanting(&[Side::Right, Side::Left]);
    assert!(bench.frame(&[hand(300.0, 0.55)]).is_empty());
}

#[test]
fn two_hands_never_have_the_same_side() {
    let mut bench = Bench::wanting(&[Side::Right, Side::Left]);
    for frame in 0..60 {
        let hands = bench.frame(&[hand(300.0, 0.7), hand(900.0, 0.99)]);
        let mut seen: Vec<_> = hands.iter().map(|hand| (hand.landmarks_px[0][0] as i32, hand.side)).collect();
        seen.sort();
        assert_eq!(seen, [(300, Side::Left), (900, Side::Right)], "frame {frame}");
    }
}

#[test]
fn two_tracks_on_one_hand_become_one() {
    let mut bench = Bench::wanting(&[Side::Right, Side::Left]);
    bench.frame(&[hand(300.0, 0.9), hand(700.0, 0.1)]);
    for x in [620.0, 540.0, 460.0, 380.0, 300.0] {
        bench.frame(&[hand(300.0, 0.9), hand(x, 0.1)]);
    }
    assert_eq!(sides(&bench.frame(&[hand(300.0, 0.9)])), [Side::Right]);
}

#[test]
fn landmarks_that_leap_are_looked_at_again() {
    let mut bench = Bench::wanting(&[Side::Right]);
    bench.frame(&[hand(300.0, 0.9)]);
    bench.script.script().slip = 200.0;
    let hands = bench.frame(&[hand(300.0, 0.9)]);
    assert_eq!(bench.palm_detections(), 2);
    assert_eq!(hands[0].landmarks_px[0], [300.0, 500.0]);
}

#[test]
fn a_hand_that_is_read_as_one_of_the_other_side_is_looked_at_nearer() {
    let mut bench = Bench::wanting(&[Side::Right]);
    let right = hand(300.0, 0.95);
    bench.frame(&[right]);
    for (misread, is_read) in [(1, true), (2, true), (3, false)] {
        bench.script.script().misread = misread;
        let hands = bench.frame(&[right]);
        assert_eq!(sides(&hands), [Side::Right], "{misread} looks");
        assert_eq!(hands[0].landmarks_px == landmarks(right.wrist), is_read, "{misread} looks");
    }
    assert_eq!(bench.palm_detections(), 1);
}

#[test]
fn a_model_that_answers_with_nan_loses_the_hand_and_nothing_else() {
    let mut bench = Bench::wanting(&[Side::Right]);
    bench.frame(&[hand(300.0, 0.9)]);
    bench.frame(&[Scripted { wrist: [f32::NAN; 2], right: f32::NAN }]);
    assert_eq!(sides(&bench.frame(&[hand(300.0, 0.9)])), [Side::Right]);
}
