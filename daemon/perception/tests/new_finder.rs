//! What another finder of objects takes: one that knows a part by its brightness, beside a part with a marker.

#![allow(clippy::unwrap_used)]

mod common;

use andon_perception::config::{HandsConfig, MarkerObject, MarkersConfig, ThreadsConfig};
use andon_perception::{
    Dictionary, FoundObjects, ImageView, ObjectFinder, Perceiver, PerceptionConfig, PerceptionError,
    PixelPoint, SeenObject,
};
use common::{DAYLIGHT, Drawn, gray, picture, straight_down};

const PX_PER_M: f64 = 800.0;
const SIDE_M: f64 = 0.036;
const WIDTH: usize = 640;
const HEIGHT: usize = 480;

/// The part with a marker; the marker has another number than the part.
const CUP: u16 = 21;
const MARKER: u16 = 4;
/// The part without one.
const LAMP: u16 = 7;

/// The example: the part is whatever is as white as paper is not.
struct BrightSpot;

impl ObjectFinder for BrightSpot {
    fn find(&mut self, image: &ImageView<'_>, _: Option<f64>) -> Result<FoundObjects, PerceptionError> {
        let mut found = FoundObjects::default();
        let bright = image.data().iter().enumerate().filter(|(_, level)| **level == u8::MAX);
        let places: Vec<[f64; 2]> =
            bright.map(|(at, _)| [(at % image.stride()) as f64, (at / image.stride()) as f64]).collect();
        let edge =
            |axis: usize, pick: fn(f64, f64) -> f64| places.iter().map(|place| place[axis]).reduce(pick);
        if let (Some(left), Some(right), Some(top), Some(bottom)) =
            (edge(0, f64::min), edge(0, f64::max), edge(1, f64::min), edge(1, f64::max))
        {
            let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
            let corners = corners.map(|(x, y)| PixelPoint::new(x, y));
            found.objects.push(SeenObject { id: LAMP, corners, side_m: None, quality: 1.0 }).unwrap();
        }
        Ok(found)
    }
}

/// A picture with the marker, and with a white square of 20 pixels whose top left corner is here.
fn bench(marker_m: [f64; 2], [x, y]: [usize; 2]) -> Vec<u8> {
    let drawn = [Drawn::new(MARKER, marker_m, SIDE_M, 0.0)];
    let camera = straight_down(WIDTH, HEIGHT, PX_PER_M);
    let mut pixels = picture(WIDTH, HEIGHT, &camera, &drawn, Dictionary::default(), DAYLIGHT);
    pixels.iter_mut().for_each(|level| *level = (*level).min(250));
    for row in y..y + 20 {
        pixels[row * WIDTH + x..row * WIDTH + x + 20].fill(u8::MAX);
    }
    pixels
}

fn perceiver() -> Perceiver {
    let config = PerceptionConfig {
        runtime: "unused".into(),
        hands: HandsConfig { sides: Vec::new(), ..HandsConfig::default() },
        markers: MarkersConfig {
            objects: vec![MarkerObject { id: CUP, marker: MARKER, side_m: SIDE_M as f32 }],
            ..MarkersConfig::default()
        },
        threads: ThreadsConfig::default(),
    };
    Perceiver::new(&config, None).unwrap().with_finder(Box::new(BrightSpot))
}

#[test]
fn a_part_without_a_marker_is_placed_beside_one_whose_marker_has_another_number() {
    let pixels = bench([0.1, 0.05], [100, 300]);
    let seen = perceiver().perceive(gray(WIDTH, HEIGHT, &pixels), 0).unwrap();
    let ids: Vec<u16> = seen.objects.iter().map(|object| object.id).collect();
    assert_eq!(ids, [LAMP, CUP], "by their own numbers, in their order");
    let at = |index: usize| [0, 1].map(|axis| f64::from(seen.objects[index].position_m[axis]));
    let off = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    // The bench's origin is the middle of the picture, and y points up.
    let lamp = [(109.5 - 320.0) / PX_PER_M, (240.0 - 309.5) / PX_PER_M];
    assert!(off(at(0), lamp) < 0.002, "{:?} {lamp:?}", at(0));
    assert!(off(at(1), [0.1, 0.05]) < 0.002, "{:?}", at(1));
}

#[test]
fn nothing_is_placed_before_something_gives_the_scale() {
    // The marker lies outside of the picture.
    let pixels = bench([5.0, 5.0], [100, 300]);
    let seen = perceiver().perceive(gray(WIDTH, HEIGHT, &pixels), 0).unwrap();
    assert!(seen.objects.is_empty(), "{:?}", seen.objects);
}
