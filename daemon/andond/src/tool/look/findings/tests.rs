#![allow(clippy::unwrap_used)]
use super::*;
use andon_perception::Picture;
use andon_perception::sight::SeenMarker;
use shm_schemas::{Detections, HandCode, ObjectDetection, flag};

const FORMAT: PictureFormat = PictureFormat { width: 640, height: 480, rate_hz: 30.0, count: 1 };

/// A station with one part, the brick with marker 1 of 33 mm, and a right hand.
fn config() -> Config {
    let brick = Object { id: 1, name: "brick".into(), marker_side_m: Some(0.033), ..Object::default() };
    let mut config = Config { objects: vec![brick], ..Config::default() };
    config.perception.hands = vec![Side::Right];
    config
}

fn square([x, y]: [f32; 2], side: f32) -> [[f32; 2]; 4] {
    [[x, y], [x + side, y], [x + side, y + side], [x, y + side]]
}

/// A picture in good light, with the brick's marker of this side at a place.
fn inspection(place: Option<([f32; 2], f32)>) -> Inspection {
    let mut seen = Detections::default();
    if let Some((at, side)) = place {
        seen.objects_len = 1;
        seen.objects[0] = ObjectDetection {
            id: 1,
            flags: flag::SEEN,
            corners_px: square(at, side),
            ..ObjectDetection::default()
        };
    }
    let picture = Picture { sharpness: Some(0.9), noise: 2.0, cells: [[90; 3]; _], ..Picture::default() };
    Inspection {
        seen,
        picture,
        twice: Vec::new(),
        odd: Default::default(),
        hands: 0,
        others: Vec::new(),
        foreign: 0,
    }
}

/// What is said about something.
fn about(inspections: &[Inspection], what: &str) -> (bool, String) {
    let lines = sentences(inspections, &config(), FORMAT);
    let line = lines.into_iter().find(|line| line.about == what).unwrap();
    (line.is_good, line.sentence)
}

fn improve(sentence: &str) -> (bool, String) {
    (false, sentence.to_owned())
}

#[test]
fn a_marker_that_is_too_small_is_told_with_the_size_that_is_enough() {
    let small = inspection(Some(([300.0, 200.0], 22.0)));
    assert_eq!(
        about(&[small.clone(), small.clone(), small, inspection(None)], "brick"),
        improve(
            "its marker is 22 px wide; 30 are needed: come nearer, or print it at 45 mm (seen in 75 % of the pictures)"
        )
    );
}

#[test]
fn why_a_part_is_not_seen_is_told_where_the_pictures_say_it() {
    let seen = inspection(Some(([300.0, 200.0], 40.0)));
    let twice = Inspection { twice: vec![1], ..inspection(None) };
    let said = about(&[twice.clone(), twice, seen], "brick");
    assert!(!said.0 && said.1.starts_with("its marker 1 is in view twice"), "{said:?}");
    let mirrored = Inspection { odd: [vec![1], Vec::new()], ..inspection(None) };
    assert!(about(&[mirrored.clone(), mirrored], "brick").1.contains("the picture is mirrored"));
    let negative = Inspection { odd: [Vec::new(), vec![1]], ..inspection(None) };
    assert!(about(&[negative], "brick").1.contains("a negative"));
}

#[test]
fn a_hand_that_is_not_configured_is_told_apart_from_none() {
    let other = Inspection { hands: 1, ..inspection(None) };
    assert!(about(&[other], "right hand").1.contains("perception.hands does not name"));
    assert!(about(&[inspection(None)], "right hand").1.starts_with("not seen: hold it over the bench"));
}

#[test]
fn a_marker_that_is_large_enough_needs_nothing() {
    let large = inspection(Some(([300.0, 200.0], 31.0)));
    assert_eq!(about(&[large], "brick"), (true, "its marker is 31 px wide; 30 are needed (seen)".to_owned()));
    // The brick of the shipped clips.
    let enough = inspection(Some(([300.0, 200.0], 28.0)));
    assert_eq!(
        about(&[enough], "brick"),
        (
            true,
            "its marker is 28 px wide; enough, with little reserve for noise and dim light: 30 are better (seen)".to_owned()
        )
    );
    assert!(!about(&[inspection(Some(([300.0, 200.0], 26.0)))], "brick").0);
}

#[test]
fn a_part_that_is_not_seen_and_one_at_the_edge_are_told_with_what_to_do() {
    assert_eq!(
        about(&[inspection(None)], "brick"),
        improve(
            "its marker 1 is not seen: is it in view, flat, whole, with white around it, and printed by `andond markers`?"
        )
    );
    let (is_good, sentence) = about(&[inspection(Some(([605.0, 200.0], 31.0)))], "brick");
    assert!(!is_good && sentence.starts_with("it lies at the edge of the picture"), "{sentence}");
}

#[test]
fn dark_dazzled_noisy_and_soft_pictures_are_told_apart() {
    let with = |change: fn(&mut Picture)| {
        let mut inspection = inspection(None);
        change(&mut inspection.picture);
        [inspection]
    };
    let says = |inspections: [Inspection; 1], what: &str, begin: &str| {
        let (is_good, sentence) = about(&inspections, what);
        assert!(!is_good && sentence.starts_with(begin), "{what}: {sentence}");
    };
    says(with(|picture| picture.cells = [[9; 3]; _]), "light", "it is dark: more light");
    says(with(|picture| picture.white = 0.3), "light", "parts of the picture are white: less light");
    says(with(|picture| picture.noise = 13.0), "light", "the picture is noisy: more light");
    says(
        with(|picture| picture.sharpness = Some(0.5)),
        "sharpness",
        "50 % of an edge lies within two pixels, and 60 %",
    );
    says(with(|picture| picture.sharpness = None), "sharpness", "no sharp edge is in the picture");
    assert!(about(&with(|_| ()), "light").0 && about(&with(|_| ()), "sharpness").0);
}

#[test]
fn a_hand_is_said_to_be_seen_or_not_and_none_is_no_fault() {
    let mut with_hand = inspection(None);
    with_hand.seen.hands_len = 1;
    with_hand.seen.hands[0].hand = HandCode::Right.code();
    let seen = about(&[with_hand.clone(), inspection(None)], "right hand");
    assert_eq!(seen, (true, "seen in 50 % of the pictures".to_owned()));
    let mut flickers = vec![inspection(None); 10];
    flickers[1] = with_hand.clone();
    flickers[8] = with_hand;
    let (is_good, sentence) = about(&flickers, "right hand");
    assert!(!is_good && sentence.starts_with("it is lost again and again"), "{sentence}");
    assert!(sentence.ends_with("(seen in 20 % of the pictures)"), "{sentence}");
    let (is_good, sentence) = about(&[inspection(None)], "right hand");
    assert!(is_good && sentence.starts_with("not seen: hold it over the bench"), "{sentence}");
}

#[test]
fn markers_of_nobody_are_named_and_a_lucky_pattern_is_not() {
    let with = |ids: &[u16]| {
        let others = ids.iter().map(|id| SeenMarker { id: *id, corners: square([50.0; 2], 31.0) }).collect();
        Inspection { others, ..inspection(None) }
    };
    let inspections = [with(&[46, 47]), with(&[46, 47, 9]), with(&[46]), with(&[46, 47]), with(&[46, 47])];
    let (is_good, sentence) = about(&inspections, "others");
    assert!(
        !is_good && sentence.starts_with("markers 46, 47 are in view and in no [[objects]]"),
        "{sentence}"
    );
    let foreign = Inspection { foreign: 2, ..inspection(None) };
    assert!(about(&[foreign], "others").1.starts_with("markers of another dictionary are in view"));
    assert!(sentences(&[inspection(None)], &config(), FORMAT).iter().all(|line| line.about != "others"));
}
