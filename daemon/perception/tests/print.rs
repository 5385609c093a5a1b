//! Markers to print: what is printed is what is found, and how large it must appear.

#![allow(clippy::unwrap_used)]

mod common;

use andon_perception::{Dictionary, MarkerFinder};
use common::{Drawn, Light, gray, picture, straight_down};

#[test]
fn the_printed_pattern_is_the_one_that_is_found() {
    for name in ["DICT_4X4_50", "DICT_5X5_100", "DICT_APRILTAG_36h11"] {
        let dictionary = Dictionary::all().find(|dictionary| dictionary.name() == name).unwrap();
        let pattern = dictionary.pattern(17).unwrap();
        // Ten pixels for each module, and white around it.
        let (module, side) = (10, (pattern.modules + 4) * 10);
        let is_black = |x: usize, y: usize| {
            let [column, row] =
                [x, y].map(|at| (at / module).checked_sub(2).filter(|at| *at < pattern.modules));
            column.zip(row).is_some_and(|(column, row)| pattern.black[row * pattern.modules + column])
        };
        let pixels: Vec<u8> =
            (0..side * side).map(|at| if is_black(at % side, at / side) { 20 } else { 230 }).collect();
        let found = MarkerFinder::new(dictionary).unwrap().find(&gray(side, side, &pixels)).unwrap();
        let [marker] = found[..] else { unreachable!("{name}: {found:?}") };
        assert_eq!(marker.id, 17);
        let [x, y] = marker.corners[0];
        assert!(
            (x - 19.5).abs() < 0.2 && (y - 19.5).abs() < 0.2,
            "{name}: {x} {y} is not the top left corner"
        );
    }
}

#[test]
fn an_id_that_a_dictionary_does_not_have_has_no_pattern() {
    assert!(Dictionary::default().pattern(49).is_ok());
    assert!(Dictionary::default().pattern(50).unwrap_err().to_string().contains("id is 50"));
}

/// What a bench may look like: little light, or much noise; through a lens that is a little soft.
const DIM: Light = Light { black: 12.0, white: 60.0, noise: 6.0, seed: 2 };
const NOISY: Light = Light { black: 30.0, white: 200.0, noise: 25.0, seed: 3 };

#[test]
fn a_marker_of_the_needed_size_is_found_in_every_light_and_a_smaller_one_is_not() {
    let needed = Dictionary::default().needed_side_px();
    assert!(found_of_100(needed, DIM) >= 99);
    assert!(found_of_100(needed, NOISY) >= 99);
    // At three pixels for each module.
    assert!(found_of_100(18.0, NOISY) <= 80);
}

/// Of a hundred markers of this size, at many places and turns, how many are found.
fn found_of_100(side_px: f64, light: Light) -> usize {
    let mut finder = MarkerFinder::new(Dictionary::default()).unwrap();
    let camera = straight_down(640, 480, 1.0);
    let mut found = 0;
    for round in 0..5_u16 {
        let marker = |id: u16| {
            let [column, row] = [f64::from(id % 5), f64::from(id / 5)];
            let shift = 0.37 * f64::from(id) + 0.11 * f64::from(round);
            let centre = [120.0 * column - 240.0 + shift, 110.0 * row - 165.0 - shift];
            Drawn::new(id, centre, side_px, 0.7 * f64::from(id + 20 * round))
        };
        let markers: Vec<Drawn> = (0..20).map(marker).collect();
        let clean = Light { noise: 0.0, ..light };
        let mut pixels = softened(&picture(640, 480, &camera, &markers, Dictionary::default(), clean));
        // The noise is the sensor's, behind the lens.
        let grey = Light { black: 127.0, white: 127.0, seed: light.seed + 10 * u64::from(round), ..light };
        let noise = picture(640, 480, &camera, &[], Dictionary::default(), grey);
        for (pixel, noise) in pixels.iter_mut().zip(noise) {
            *pixel = (i16::from(*pixel) + i16::from(noise) - 127).clamp(0, 255) as u8;
        }
        let seen = finder.find(&gray(640, 480, &pixels)).unwrap();
        found += seen.iter().filter(|marker| marker.id < 20).count();
    }
    found
}

/// Through a lens that spreads a point over three pixels: weights 1, 2 and 1 along each axis.
fn softened(pixels: &[u8]) -> Vec<u8> {
    let at = |index: usize| u32::from(pixels[index.min(pixels.len() - 1)]);
    let across = |index: usize| at(index.saturating_sub(1)) + 2 * at(index) + at(index + 1);
    let both = |index: usize| across(index.saturating_sub(640)) + 2 * across(index) + across(index + 640);
    (0..pixels.len()).map(|index| (both(index) / 16) as u8).collect()
}
