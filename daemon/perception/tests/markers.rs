//! Markers, from drawn pictures to metres on the bench. No hand is wanted, so no model is needed.

#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use andon_perception::config::{HandsConfig, MarkerObject, MarkerSearch, MarkersConfig, ThreadsConfig};
use andon_perception::detections::ObjectDetection;
use andon_perception::{Dictionary, ImageView, Perceiver, PerceptionConfig, PerceptionError, PixelFormat};
use common::{DAYLIGHT, Drawn, Light, centre_px, gray, picture, straight_down};

/// A bench of 0.8 m in 640 pixels: markers of 36 mm have 29 pixels.
const PX_PER_M: f64 = 800.0;
const SIDE_M: f64 = 0.036;

fn perceiver(ids: &[u16]) -> Perceiver {
    Perceiver::new(&config(ids), None).unwrap()
}

fn config(ids: &[u16]) -> PerceptionConfig {
    let objects = ids.iter().map(|&id| MarkerObject { id, marker: id, side_m: SIDE_M as f32 }).collect();
    PerceptionConfig {
        runtime: "unused".into(),
        hands: HandsConfig { sides: Vec::new(), ..HandsConfig::default() },
        markers: MarkersConfig { objects, ..MarkersConfig::default() },
        threads: ThreadsConfig::default(),
    }
}

fn see(perceiver: &mut Perceiver, image: ImageView<'_>) -> Vec<ObjectDetection> {
    perceiver.perceive(image, 0).unwrap().objects.to_vec()
}

fn small_picture(markers: &[Drawn], light: Light) -> Vec<u8> {
    picture(640, 480, &straight_down(640, 480, PX_PER_M), markers, Dictionary::default(), light)
}

fn yaw(object: &ObjectDetection) -> f64 {
    2.0 * f64::from(object.orientation[3]).atan2(f64::from(object.orientation[0]))
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn position(object: &ObjectDetection) -> [f64; 2] {
    [0, 1].map(|axis| f64::from(object.position_m[axis]))
}

/// Asserts where a marker was seen.
fn assert_seen(objects: &[ObjectDetection], drawn: &Drawn, within_mm: f64, within_deg: f64) {
    let object = objects
        .iter()
        .find(|object| object.id == drawn.id)
        .unwrap_or_else(|| panic!("{drawn:?} was not seen"));
    let error_mm = 1e3 * distance(position(object), drawn.centre_m);
    assert!(error_mm <= within_mm, "{drawn:?} is {error_mm} mm off");
    let turn = (yaw(object) - drawn.yaw).sin().asin().to_degrees().abs();
    assert!(turn <= within_deg, "{drawn:?} is turned by {turn} degrees");
    assert!((yaw(object) - drawn.yaw).cos() > 0.0, "{drawn:?} is turned round");
}

#[test]
fn markers_are_seen_where_they_lie_and_how_they_are_turned() {
    let markers: Vec<_> = (0u16..8)
        .map(|id| {
            let [column, row] = [f64::from(id % 4), f64::from(id / 4)];
            Drawn::new(id, [0.17 * column - 0.26, 0.2 * row - 0.1], SIDE_M, 0.8 * f64::from(id) - 3.0)
        })
        .collect();
    let pixels = small_picture(&markers, DAYLIGHT);
    let objects = see(&mut perceiver(&[0, 1, 2, 3, 4, 5, 6, 7]), gray(640, 480, &pixels));
    for marker in &markers {
        assert_seen(&objects, marker, 1.0, 0.5);
    }
    let camera = straight_down(640, 480, PX_PER_M);
    for (object, marker) in objects.iter().zip(&markers) {
        let mean = [0, 1]
            .map(|axis| object.corners_px.iter().map(|corner| f64::from(corner[axis])).sum::<f64>() / 4.0);
        assert!(distance(mean, centre_px(&camera, marker)) < 0.1);
        assert_eq!(object.quality, 1.0);
    }
}

#[test]
fn the_first_corner_is_the_top_left_of_the_markers_own_picture() {
    let marker = Drawn::new(3, [0.1, 0.05], SIDE_M, 0.0);
    let pixels = small_picture(&[marker], DAYLIGHT);
    let object = see(&mut perceiver(&[3]), gray(640, 480, &pixels))[0];
    let [x, y] = centre_px(&straight_down(640, 480, PX_PER_M), &marker);
    let half = SIDE_M * PX_PER_M / 2.0;
    let expected = [[x - half, y - half], [x + half, y - half], [x + half, y + half], [x - half, y + half]];
    for (corner, expected) in object.corners_px.iter().zip(expected) {
        assert!(distance(corner.map(f64::from), expected) < 0.15, "{corner:?} is not {expected:?}");
    }
}

#[test]
fn a_marker_that_stands_higher_is_not_moved_sideways() {
    // 10 cm above a bench 76 cm away, and on it.
    let high = Drawn { enlarged: 0.76 / 0.66, ..Drawn::new(5, [0.2, -0.12], SIDE_M, 0.4) };
    let low = Drawn::new(6, [-0.1, 0.1], SIDE_M, 0.0);
    let pixels = small_picture(&[high, low], DAYLIGHT);
    let objects = see(&mut perceiver(&[5, 6]), gray(640, 480, &pixels));
    assert_seen(&objects, &high, 1.0, 0.5);
    assert_seen(&objects, &low, 1.0, 0.5);
}

#[test]
fn ids_that_are_not_configured_are_ignored() {
    let markers = [5, 6, 7].map(|id| Drawn::new(id, [0.1 * f64::from(id) - 0.6, 0.0], SIDE_M, 0.0));
    let pixels = small_picture(&markers, DAYLIGHT);
    let ids: Vec<_> =
        see(&mut perceiver(&[7, 5]), gray(640, 480, &pixels)).iter().map(|object| object.id).collect();
    assert_eq!(ids, [5, 7]);
}

#[test]
fn markers_are_seen_in_dim_light_and_in_noise() {
    let marker = Drawn::new(9, [0.05, 0.1], SIDE_M, 0.3);
    for (light, within_mm) in [
        (Light { black: 12.0, white: 40.0, noise: 1.0, seed: 2 }, 1.5),
        (Light { black: 30.0, white: 200.0, noise: 25.0, seed: 3 }, 1.5),
    ] {
        let pixels = small_picture(&[marker], light);
        assert_seen(&see(&mut perceiver(&[9]), gray(640, 480, &pixels)), &marker, within_mm, 1.5);
    }
}

#[test]
fn a_large_picture_is_equally_exact_on_every_frame() {
    let camera = straight_down(1280, 720, 1600.0);
    let markers = [2, 4].map(|id| Drawn::new(id, [0.1 * f64::from(id) - 0.3, 0.08], SIDE_M, 0.5));
    let mut perceiver = perceiver(&[2, 4]);
    // The first frame gives the size of the markers; from the second on, half the picture's size is enough.
    for seed in 1..4 {
        let pixels = picture(1280, 720, &camera, &markers, Dictionary::default(), Light { seed, ..DAYLIGHT });
        let objects = see(&mut perceiver, gray(1280, 720, &pixels));
        for marker in &markers {
            assert_seen(&objects, marker, 0.3, 0.2);
        }
    }
}

#[test]
fn an_odd_picture_is_as_exact_as_an_even_one() {
    let camera = straight_down(1281, 721, 1600.0);
    let marker = Drawn::new(2, [0.3, -0.15], SIDE_M, 0.5);
    let mut perceiver = perceiver(&[2]);
    let pixels = picture(1281, 721, &camera, &[marker], Dictionary::default(), DAYLIGHT);
    for _ in 0..2 {
        assert_seen(&see(&mut perceiver, gray(1281, 721, &pixels)), &marker, 0.5, 0.2);
    }
}

#[test]
fn every_pixel_format_shows_the_same() {
    let marker = Drawn::new(1, [0.1, -0.1], SIDE_M, 1.0);
    let pixels = small_picture(&[marker], DAYLIGHT);
    let expected = see(&mut perceiver(&[1]), gray(640, 480, &pixels));
    for format in [PixelFormat::Bgr8, PixelFormat::Rgb8, PixelFormat::Bgra8, PixelFormat::Rgba8] {
        // Rows with padding, which must not be read.
        let stride = 640 * format.bytes() + 13;
        let mut data = vec![255; stride * 480];
        for (row, line) in pixels.chunks_exact(640).enumerate() {
            for (column, value) in line.iter().enumerate() {
                let first = row * stride + column * format.bytes();
                data[first..first + 3].fill(*value);
            }
        }
        let image = ImageView::new(640, 480, stride, format, &data).unwrap();
        assert_eq!(see(&mut perceiver(&[1]), image), expected, "{format:?}");
    }
}

#[test]
fn other_dictionaries_are_read_by_name() {
    for name in ["DICT_5X5_100", "DICT_6X6_250", "DICT_APRILTAG_36h11"] {
        let dictionary = Dictionary::all().find(|dictionary| dictionary.name() == name).unwrap();
        let marker = Drawn::new(17, [0.0, 0.1], 0.05, 0.2);
        let pixels = picture(640, 480, &straight_down(640, 480, PX_PER_M), &[marker], dictionary, DAYLIGHT);
        let mut config = config(&[17]);
        config.markers.dictionary = dictionary;
        config.markers.objects[0].side_m = 0.05;
        assert_seen(
            &see(&mut Perceiver::new(&config, None).unwrap(), gray(640, 480, &pixels)),
            &marker,
            1.0,
            0.5,
        );
    }
}

#[test]
fn a_marker_at_rest_stays_at_rest_and_a_lifted_one_is_followed() {
    let mut perceiver = perceiver(&[5]);
    let mut positions = Vec::new();
    for frame in 0..40u64 {
        // Lifted by 10 cm in a third of a second.
        let height = 0.1 * (frame.saturating_sub(20).min(10) as f64) / 10.0;
        let marker = Drawn { enlarged: 0.76 / (0.76 - height), ..Drawn::new(5, [0.22, 0.1], SIDE_M, 0.2) };
        let pixels = small_picture(&[marker], Light { seed: frame + 1, noise: 6.0, ..DAYLIGHT });
        let detections = perceiver.perceive(gray(640, 480, &pixels), frame * 33_333_333).unwrap();
        assert_seen(&detections.objects, &marker, 3.0, 1.0);
        positions.push(position(&detections.objects[0]));
    }
    let steps = positions[5..20].windows(2).map(|pair| 1e3 * distance(pair[0], pair[1]));
    // 0.5 mm per frame is 15 mm/s, half of what counts as motion.
    assert!(steps.fold(0.0, f64::max) < 0.5);
}

#[test]
fn near_where_markers_were_the_same_ones_are_found_in_the_same_frames_as_in_the_whole_picture() {
    let mut everywhere = config(&[3, 5, 7]);
    everywhere.markers.search = MarkerSearch::Whole;
    let (mut near, mut everywhere) = (perceiver(&[3, 5, 7]), Perceiver::new(&everywhere, None).unwrap());
    for frame in 0..60u64 {
        let resting = Drawn::new(3, [-0.3, 0.2], SIDE_M, 0.3);
        // Carried at 0.9 m/s, then it leaps farther than it is looked for.
        let leap = if frame < 25 { 0.0 } else { 0.25 };
        let carried =
            Drawn::new(5, [0.03 * (frame % 8) as f64 + leap - 0.1, 0.0], SIDE_M, 0.1 * frame as f64);
        // Hidden for a while, and then somewhere else.
        let hidden = Drawn::new(7, [if frame < 20 { 0.0 } else { -0.2 }, -0.2], SIDE_M, 0.0);
        let shown = if (10..20).contains(&frame) { 2 } else { 3 };
        let light = Light { seed: frame + 1, noise: 6.0, ..DAYLIGHT };
        let pixels = small_picture(&[resting, carried, hidden][..shown], light);
        let seen = see(&mut near, gray(640, 480, &pixels));
        assert_eq!(seen.len(), shown, "frame {frame}");
        assert_eq!(seen, see(&mut everywhere, gray(640, 480, &pixels)), "frame {frame}");
    }
}

#[test]
fn a_marker_that_is_not_configured_is_counted_while_the_others_are_looked_for_where_they_were() {
    let mut perceiver = perceiver(&[5]);
    let own = Drawn::new(5, [0.1, 0.0], SIDE_M, 0.0);
    let foreign = Drawn::new(8, [-0.2, 0.1], SIDE_M, 0.0);
    let (alone, both) = (small_picture(&[own], DAYLIGHT), small_picture(&[own, foreign], DAYLIGHT));
    let mut count = |pixels: &[u8]| perceiver.perceive(gray(640, 480, pixels), 0).unwrap().foreign_markers;
    assert_eq!(count(&alone), 0);
    let counts: Vec<_> = (0..20).map(|_| count(&both)).collect();
    assert_eq!(counts[10..], [1; 10], "{counts:?}");
    let counts: Vec<_> = (0..20).map(|_| count(&alone)).collect();
    assert_eq!(counts[10..], [0; 10], "{counts:?}");
}

/// Nobody knows which of two prints lies on the part. One that comes later is found where only the neighbourhood of the first is searched too.
#[test]
fn a_marker_that_is_in_view_twice_is_named_and_its_part_is_not_seen() {
    let mut perceiver = perceiver(&[5, 6]);
    let (part, twin) = (Drawn::new(5, [0.1, 0.0], SIDE_M, 0.0), Drawn::new(5, [-0.2, 0.1], SIDE_M, 0.0));
    let other = Drawn::new(6, [0.0, -0.1], SIDE_M, 0.0);
    let (alone, both) =
        (small_picture(&[part, other], DAYLIGHT), small_picture(&[part, twin, other], DAYLIGHT));
    let mut seen = |pixels: &[u8], at: u64| {
        let seen = perceiver.perceive(gray(640, 480, pixels), at).unwrap();
        let ids: Vec<u16> = seen.objects.iter().map(|object| object.id).collect();
        (ids, seen.twice.to_vec())
    };
    assert_eq!(seen(&alone, 0), (vec![5, 6], vec![]));
    let later: Vec<_> = (1..20).map(|at| seen(&both, at)).collect();
    assert_eq!(later[10..], vec![(vec![6], vec![5]); 9]);
    let gone: Vec<_> = (20..24).map(|at| seen(&alone, at)).collect();
    assert_eq!(gone, vec![(vec![5, 6], vec![]); 4]);
}

#[test]
fn a_marker_half_hidden_is_never_seen_elsewhere() {
    let marker = Drawn::new(5, [0.1, 0.0], SIDE_M, 0.0);
    let whole = small_picture(&[marker], DAYLIGHT);
    let [x, y] = centre_px(&straight_down(640, 480, PX_PER_M), &marker);
    for hidden_px in 1..40usize {
        let mut pixels = whole.clone();
        // Skin from the right.
        for row in (y as usize - 25)..(y as usize + 25) {
            let edge = (x + SIDE_M * PX_PER_M / 2.0 + 6.0) as usize - hidden_px;
            pixels[row * 640 + edge..row * 640 + edge + 60].fill(150);
        }
        for object in see(&mut perceiver(&[5]), gray(640, 480, &pixels)) {
            let error_mm = 1e3 * distance(position(&object), marker.centre_m);
            assert!(error_mm < 10.0, "{hidden_px} px hidden: {error_mm} mm off");
        }
    }
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let refused = |change: &dyn Fn(&mut PerceptionConfig)| {
        let mut config = config(&[1, 2]);
        change(&mut config);
        match Perceiver::new(&config, None) {
            Err(PerceptionError::Setting { key, .. }) => key,
            Err(error) => panic!("{error}"),
            Ok(_) => panic!("it was accepted"),
        }
    };
    assert_eq!(refused(&|config| config.markers.objects[0].side_m = f32::NAN), "side_m");
    assert_eq!(refused(&|config| config.markers.objects[0].side_m = 0.0), "side_m");
    assert_eq!(refused(&|config| config.markers.objects[1].id = 1), "id");
    assert_eq!(refused(&|config| config.markers.objects[1].marker = 1), "marker");
    assert_eq!(refused(&|config| config.markers.objects[1].marker = 50), "marker");
    assert_eq!(refused(&|config| config.markers.threshold_constant = -1.0), "threshold_constant");
    assert_eq!(refused(&|config| config.hands.min_palm_score = 1.5), "min_palm_score");
    assert_eq!(refused(&|config| config.hands.search_every_frames = 0), "search_every_frames");
}

#[test]
fn a_picture_whose_sizes_contradict_one_another_is_refused() {
    let data = [0; 100];
    for (width, height, stride) in
        [(0, 10, 10), (10, 0, 10), (11, 10, 10), (10, 11, 10), (usize::MAX, 1, usize::MAX)]
    {
        assert!(matches!(
            ImageView::new(width, height, stride, PixelFormat::Gray8, &data),
            Err(PerceptionError::Image { .. })
        ));
    }
}
