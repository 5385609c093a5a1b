//! The state machine on scripted observations; what real pictures measure is in the measurement `perception_accuracy sight`.
#![allow(clippy::unwrap_used, clippy::panic)]

use super::{Expected, Observation, Rates, SeenMarker, SightMonitor, Spell, Trouble};
use crate::picture::{CELLS, Picture};

mod camera;

const FRAME_NS: u64 = 33_333_333;

/// A camera whose pictures are scripted.
struct Bench {
    sight: SightMonitor,
    now_ns: u64,
    number: u64,
}

/// The side of every marker, in pixels.
const SIDE: f32 = 30.0;

fn marker(id: u16, [x, y]: [f32; 2]) -> SeenMarker {
    SeenMarker { id, corners: [[x, y], [x + SIDE, y], [x + SIDE, y + SIDE], [x, y + SIDE]] }
}

/// A good picture of a bench with two parts and a hand.
fn good() -> Observation {
    let picture = Picture {
        noise: 2.0,
        edges: 0.05,
        sharpness: Some(0.9),
        patches: 20.0,
        cells: std::array::from_fn(|cell| [80 + 3 * cell as u8; 3]),
        ..Picture::default()
    };
    let markers = [marker(5, [90.0, 90.0]), marker(6, [270.0, 90.0])].into_iter().collect();
    let hands_px = Default::default();
    Observation { at_ns: 0, dropped: 0, picture, markers, foreign_markers: 0, hands: 1, hands_px }
}

/// Nothing is found, and the picture measures this.
fn blind(change: impl Fn(&mut Picture)) -> Observation {
    let mut observation = good();
    observation.markers.clear();
    observation.hands = 0;
    change(&mut observation.picture);
    observation
}

impl Bench {
    fn new() -> Self {
        Self {
            sight: SightMonitor::new(Expected { rate_hz: None, hands: true, is_calibrated: false }),
            now_ns: 0,
            number: 0,
        }
    }

    /// A bench at which all has been well for some seconds.
    fn known() -> Self {
        let mut bench = Self::new();
        assert_eq!(bench.show(5.0, |_| good()), []);
        bench
    }

    /// Shows these for some seconds, each with a noise of its own. Gives what was said when, in seconds since then.
    fn show(
        &mut self,
        seconds: f32,
        observation: impl Fn(u64) -> Observation,
    ) -> Vec<(Option<Trouble>, f32)> {
        let begin_ns = self.now_ns;
        let mut said = Vec::new();
        let mut newest = self.sight_now();
        while ((self.now_ns - begin_ns) as f32) < seconds * 1e9 {
            self.now_ns += FRAME_NS;
            self.number += 1;
            let mut observation = observation(self.number);
            observation.at_ns = self.now_ns;
            observation.picture.fingerprint = observation.picture.fingerprint.wrapping_add(self.number);
            let spell = self.sight.step(&observation).map(|spell| spell.trouble);
            if spell != newest {
                said.push((spell, (self.now_ns - begin_ns) as f32 / 1e9));
                newest = spell;
            }
        }
        said
    }

    fn sight_now(&self) -> Option<Trouble> {
        self.sight.current().map(|Spell { trouble, .. }| trouble)
    }

    /// Shows this for some seconds and then what is good again: the trouble is said once, within two seconds, and so is its end. From the first
    /// pictures on, long before it is said, and until it is over, nothing is seen that it hides.
    fn says(mut self, trouble: Trouble, observation: impl Fn(u64) -> Observation) {
        assert!(self.sight.is_seen());
        assert_eq!(self.show(0.05, &observation), []);
        assert_eq!(self.sight.is_seen(), !trouble.hides_bench(), "{trouble:?} in its second picture");
        let said = self.show(6.0, observation);
        assert_eq!(self.sight.is_seen(), !trouble.hides_bench(), "{trouble:?}");
        let [(first, after_s)] = said[..] else { panic!("{trouble:?}: {said:?}") };
        assert_eq!(first, Some(trouble));
        assert!((0.3..=2.0).contains(&after_s), "{trouble:?} after {after_s} s");
        let said = self.show(6.0, |_| good());
        let [(None, over_s)] = said[..] else { panic!("after {trouble:?}: {said:?}") };
        assert!(over_s <= 2.0, "{trouble:?} is over after {over_s} s");
        assert!(self.sight.is_seen());
    }
}

#[test]
fn a_picture_that_shows_nothing_is_said_once_and_so_is_its_return() {
    Bench::known().says(Trouble::Black, |_| blind(|picture| picture.black = 1.0));
    Bench::known().says(Trouble::White, |_| blind(|picture| picture.white = 0.99));
    Bench::known().says(Trouble::Covered, |_| {
        blind(|picture| {
            (picture.edges, picture.patches, picture.sharpness) = (0.0, 1.0, None);
            picture.cells = [[30; 3]; CELLS];
        })
    });
    // Skin that is as bright as the bench.
    Bench::known().says(Trouble::Covered, |_| {
        blind(|picture| {
            (picture.edges, picture.patches, picture.sharpness) = (0.0, 1.0, None);
            picture.cells = picture.cells.map(|[red, green, blue]| [red + 20, green, blue - 20]);
        })
    });
    Bench::known().says(Trouble::Blurred, |_| blind(|picture| picture.sharpness = Some(0.3)));
    // So far out of focus that no edge is left.
    Bench::known().says(Trouble::Blurred, |_| {
        blind(|picture| (picture.edges, picture.patches, picture.sharpness) = (0.0, 9.0, None))
    });
    Bench::known().says(Trouble::Noisy, |_| blind(|picture| picture.noise = 40.0));
}

#[test]
fn the_same_picture_again_and_again_is_said_and_the_same_scene_is_not() {
    let frozen = |number: u64| {
        let mut observation = good();
        observation.picture.fingerprint = 7_u64.wrapping_sub(number);
        observation
    };
    Bench::known().says(Trouble::Frozen, frozen);
    let mut pause = Bench::known();
    assert_eq!(pause.show(60.0, |_| good()), []);
}

#[test]
fn a_rendered_film_that_pauses_as_it_has_paused_before_is_not_frozen() {
    let mut film = Bench::known();
    for _ in 0..3 {
        let until = film.number + 40;
        let still = move |number: u64| {
            let mut observation = good();
            if number < until {
                observation.picture.fingerprint = 7_u64.wrapping_sub(number);
            }
            observation
        };
        assert_eq!(film.show(3.0, still), []);
    }
    let still = |number: u64| {
        let mut observation = good();
        observation.picture.fingerprint = 7_u64.wrapping_sub(number);
        observation
    };
    assert_eq!(film.show(2.5, still), []);
}

#[test]
fn too_few_frames_are_said_and_a_frame_that_is_late_now_and_then_is_not() {
    let few = |_| Observation { dropped: 3, ..good() };
    Bench::known().says(Trouble::TooFewFrames, few);
    let mut bench = Bench::known();
    let now_and_then = |number: u64| Observation { dropped: u32::from(number.is_multiple_of(2)), ..good() };
    assert_eq!(bench.show(20.0, now_and_then), []);
}

#[test]
fn too_few_frames_are_said_once_where_their_share_varies_about_what_is_enough() {
    let mut bench = Bench::known();
    assert_eq!(bench.show(5.0, |_| Observation { dropped: 3, ..good() }).len(), 1);
    let more_than_half =
        |number: u64| Observation { dropped: u32::from(!number.is_multiple_of(5)), ..good() };
    assert_eq!(bench.show(20.0, more_than_half), []);
    assert!(matches!(bench.show(5.0, |_| good())[..], [(None, _)]));
}

#[test]
fn frames_are_too_few_where_the_job_needs_more_of_them() {
    let two_of_three = |number: u64| Observation { dropped: u32::from(number.is_multiple_of(2)), ..good() };
    let mut bench = Bench::known();
    bench.sight.set_needed_hz(Some(28.0));
    assert_eq!(bench.show(20.0, two_of_three), [], "30 of 45 are enough for this job");
    bench.sight.set_needed_hz(Some(40.0));
    let said = bench.show(20.0, two_of_three);
    assert!(matches!(said[..], [(Some(Trouble::TooFewFrames), _)]), "{said:?}");
    let Rates { processed_hz, expected_hz, needed_hz } = bench.sight.rates();
    assert!(
        (processed_hz - 30.0).abs() < 1.0 && (expected_hz - 45.0).abs() < 1.5,
        "{processed_hz} {expected_hz}"
    );
    assert_eq!(needed_hz, Some(40.0));
}

#[test]
fn a_film_that_is_slower_than_the_job_needs_is_said_although_none_of_its_frames_is_dropped() {
    for (needed_hz, is_enough) in [(29.0, true), (45.0, false)] {
        let mut bench = Bench::new();
        bench.sight.set_needed_hz(Some(needed_hz));
        let said = bench.show(10.0, |_| good());
        assert_eq!(said.is_empty(), is_enough, "{said:?}");
    }
}

#[test]
fn a_camera_that_sends_less_than_half_of_what_it_was_asked_for_is_too_slow() {
    let mut bench = Bench::new();
    bench.sight = SightMonitor::new(Expected { rate_hz: Some(90.0), hands: true, is_calibrated: false });
    let said = bench.show(10.0, |_| good());
    assert!(matches!(said[..], [(Some(Trouble::TooFewFrames), _)]), "{said:?}");
}

#[test]
fn markers_of_another_dictionary_are_said_and_an_empty_bench_is_not() {
    let bench_with = |foreign_markers| {
        let mut observation = blind(|_| {});
        observation.foreign_markers = foreign_markers;
        observation
    };
    Bench::new().says(Trouble::NoMarkers, |_| bench_with(3));
    let mut empty = Bench::new();
    assert_eq!(empty.show(60.0, |_| bench_with(0)), []);
    // And one on which the parts have been, and others lie now.
    let mut known = Bench::known();
    assert_eq!(known.show(60.0, |_| bench_with(3)), []);
}

#[test]
fn hands_that_work_where_no_marker_was_ever_seen_are_said() {
    let mut bench = Bench::new();
    let working = |_| {
        let mut observation = good();
        observation.markers.clear();
        observation
    };
    let said = bench.show(20.0, working);
    assert!(matches!(said[..], [(Some(Trouble::NoMarkers), _)]), "{said:?}");
}

/// The bench without a hand, the first part this far to the right.
fn moved(by: f32) -> Observation {
    let mut observation = good();
    observation.hands = 0;
    observation.markers[0] = marker(5, [90.0 + by * SIDE, 90.0]);
    observation
}

#[test]
fn a_part_that_moves_without_a_hand_is_said_and_one_that_moves_with_a_hand_is_not() {
    Bench::known().says(Trouble::NoHands, |number| moved(0.05 * number as f32));
    let mut bench = Bench::known();
    let held = |number: u64| Observation { hands: 1, ..moved(0.05 * number as f32) };
    assert_eq!(bench.show(20.0, held), []);
}

#[test]
fn a_part_that_is_pushed_and_lies_elsewhere_is_not_said() {
    let mut bench = Bench::known();
    assert_eq!(bench.show(0.5, |number| moved(0.05 * number as f32)), []);
    assert_eq!(bench.show(20.0, |_| moved(4.0)), []);
}

#[test]
fn a_part_that_is_carried_slowly_and_put_down_without_a_hand_is_said() {
    // A marker's side in 1.3 s, and then it lies there.
    let mut bench = Bench::known();
    let said = bench.show(4.0, |number| moved(0.025 * number.saturating_sub(151).min(40) as f32));
    assert!(matches!(said[..], [(Some(Trouble::NoHands), after_s)] if after_s < 2.0), "{said:?}");
}

#[test]
fn a_bench_that_is_cleared_darker_brighter_or_shaded_is_not_said() {
    for change in [
        // The table is as bright as before, and no edge is left.
        (|picture: &mut Picture| {
            (picture.edges, picture.patches, picture.sharpness) = (0.0, 4.0, None);
        }) as fn(&mut Picture),
        |picture| picture.black = 0.9,
        |picture| picture.cells = [[250; 3]; CELLS],
        |picture| picture.cells = [[20; 3]; CELLS],
        |picture| picture.noise = 15.0,
        |picture| picture.sharpness = Some(0.7),
    ] {
        let mut bench = Bench::known();
        let mut cleared = blind(change);
        // Where the parts lay it is darker now.
        for cell in [3, 4, 9, 10, 11] {
            cleared.picture.cells[cell] = cleared.picture.cells[cell].map(|part| part.saturating_sub(20));
        }
        assert_eq!(bench.show(30.0, |_| cleared.clone()), [], "{:?}", cleared.picture);
        assert_eq!(bench.show(5.0, |_| good()), []);
    }
}

#[test]
fn who_still_finds_markers_or_hands_is_not_blind() {
    for (markers, hands) in [(true, 0), (false, 1)] {
        let mut bench = Bench::known();
        let mut observation =
            blind(|picture| (picture.edges, picture.black, picture.cells) = (0.0, 0.99, [[9; 3]; CELLS]));
        if markers {
            observation.markers = good().markers;
        }
        observation.hands = hands;
        assert_eq!(bench.show(20.0, |_| observation.clone()), []);
    }
}

#[test]
fn what_lasts_for_half_a_second_is_not_said() {
    let mut bench = Bench::known();
    for _ in 0..20 {
        assert_eq!(bench.show(0.5, |_| blind(|picture| picture.black = 1.0)), []);
        assert_eq!(bench.show(1.0, |_| good()), []);
    }
}

#[test]
fn the_trouble_that_was_first_stays_until_it_is_over() {
    let mut bench = Bench::known();
    let black = |_| blind(|picture| picture.black = 1.0);
    assert_eq!(bench.show(3.0, black).len(), 1);
    let black_and_frozen = |number: u64| {
        let mut observation = black(number);
        observation.picture.fingerprint = 7_u64.wrapping_sub(number);
        observation
    };
    assert_eq!(bench.show(5.0, black_and_frozen), []);
    assert_eq!(bench.sight_now(), Some(Trouble::Black));
}

/// A picture with stripes and dots, of this brightness and sharpness.
fn striped(blur: usize, noise: u32) -> Vec<u8> {
    let mut random = 1_u32;
    let pixel = |index: usize| {
        let x = index % 640;
        let place = (x % 64) as f32 / (blur.max(1) as f32);
        let shade = if x % 128 < 64 { place.min(1.0) } else { 1.0 - place.min(1.0) };
        60.0 + 120.0 * shade
    };
    (0..640 * 480)
        .map(|index| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let shift = if noise == 0 { 0.0 } else { (random >> 16) as f32 / 65_535.0 - 0.5 };
            (pixel(index) + shift * noise as f32).clamp(0.0, 255.0) as u8
        })
        .collect()
}

fn measured(data: &[u8]) -> Picture {
    let image = crate::ImageView::new(640, 480, 640, crate::PixelFormat::Gray8, data).unwrap();
    Picture::of(&image, &image)
}

#[test]
fn a_picture_measures_what_was_done_to_it() {
    let [sharp, blurred] = [1, 12].map(|blur| measured(&striped(blur, 0)));
    assert!(sharp.sharpness.unwrap() > 0.9 && blurred.sharpness.unwrap() < 0.5, "{sharp:?} {blurred:?}");
    assert!(sharp.edges > 0.02 && sharp.noise < 0.5);
    // Numbers spread evenly over 40 have a standard deviation of 11.5.
    let noisy = measured(&striped(1, 40));
    assert!((9.0..14.0).contains(&noisy.noise), "{noisy:?}");
    let (black, white) = (measured(&[0; 640 * 480]), measured(&[255; 640 * 480]));
    assert_eq!((black.black, black.white, black.edges, black.sharpness), (1.0, 0.0, 0.0, None));
    assert_eq!((white.white, white.cells, white.patches), (1.0, [[255; 3]; CELLS], 0.0));
    let over_exposed: Vec<u8> = (0..640 * 480).map(|index| 255 - (index * 7 % 10) as u8).collect();
    assert_eq!(measured(&over_exposed).white, 1.0);
    assert!(sharp.patches > 20.0 && (measured(&striped(1, 40)).patches / sharp.patches - 1.0).abs() < 0.05);
    assert_eq!(measured(&striped(1, 40)), measured(&striped(1, 40)));
    let mut other = striped(1, 40);
    other[8 * 640 + 100] ^= 1;
    assert_ne!(measured(&other).fingerprint, noisy.fingerprint);
    let tiny = crate::ImageView::new(3, 3, 3, crate::PixelFormat::Gray8, &[9; 9]).unwrap();
    assert_eq!(Picture::of(&tiny, &tiny), Picture::default());
}
