//! Pictures of markers, drawn by a renderer of its own: an oracle that shares nothing with the detector but the pattern.

#![allow(clippy::unwrap_used, dead_code)]

use andon_perception::markers::{Dictionary, draw};
use andon_perception::{ImageView, PixelFormat};
use opencv::prelude::*;

/// Bench metres to pixels, homogeneous.
pub type Matrix = [[f64; 3]; 3];

/// A marker on the bench.
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    pub id: u16,
    pub centre_m: [f64; 2],
    pub side_m: f64,
    /// Counter-clockwise seen from above, radians.
    pub yaw: f64,
    /// How much larger it appears than on the bench, about the picture's centre.
    pub enlarged: f64,
}

impl Drawn {
    pub fn new(id: u16, centre_m: [f64; 2], side_m: f64, yaw: f64) -> Self {
        Self { id, centre_m, side_m, yaw, enlarged: 1.0 }
    }
}

/// How the picture is taken.
#[derive(Clone, Copy)]
pub struct Light {
    pub black: f64,
    pub white: f64,
    /// Greatest deviation of a pixel, grey levels.
    pub noise: f64,
    pub seed: u64,
}

pub const DAYLIGHT: Light = Light { black: 30.0, white: 200.0, noise: 2.0, seed: 1 };

/// A camera that looks straight down; the origin is the picture's centre.
pub fn straight_down(width: usize, height: usize, px_per_m: f64) -> Matrix {
    let (x, y) = ((width as f64 - 1.0) / 2.0, (height as f64 - 1.0) / 2.0);
    [[px_per_m, 0.0, x], [0.0, -px_per_m, y], [0.0, 0.0, 1.0]]
}

/// Where the centre of a marker is in the picture.
pub fn centre_px(camera: &Matrix, marker: &Drawn) -> [f64; 2] {
    apply(camera, marker.centre_m.map(|value| value * marker.enlarged))
}

/// Grey pixels of a bench with markers on it: white around each marker, the bench itself is mid-grey.
pub fn picture(
    width: usize,
    height: usize,
    camera: &Matrix,
    markers: &[Drawn],
    dictionary: Dictionary,
    light: Light,
) -> Vec<u8> {
    const SAMPLES: usize = 4;
    let bench_from_image = inverse(camera);
    let patterns: Vec<_> = markers.iter().map(|marker| pattern(marker.id, dictionary)).collect();
    let (black, white) = (light.black, light.white);
    let brightness = |pixel: [f64; 2]| {
        let bench = apply(&bench_from_image, pixel);
        let on =
            markers.iter().zip(&patterns).find_map(|(marker, pattern)| marker_at(marker, pattern, bench));
        match on {
            Some(true) => white,
            Some(false) => black,
            None => (black + white) / 2.0,
        }
    };
    let mut noise = Noise(light.seed);
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        for column in 0..width {
            let mut sum = 0.0;
            for sample in 0..SAMPLES * SAMPLES {
                let offset = |place: usize| (place as f64 + 0.5) / SAMPLES as f64 - 0.5;
                sum += brightness([
                    column as f64 + offset(sample % SAMPLES),
                    row as f64 + offset(sample / SAMPLES),
                ]);
            }
            let mean = sum / (SAMPLES * SAMPLES) as f64;
            pixels.push((mean + light.noise * noise.next()).round().clamp(0.0, 255.0) as u8);
        }
    }
    pixels
}

pub fn gray(width: usize, height: usize, pixels: &[u8]) -> ImageView<'_> {
    ImageView::new(width, height, width, PixelFormat::Gray8, pixels).unwrap()
}

pub fn apply(matrix: &Matrix, [x, y]: [f64; 2]) -> [f64; 2] {
    let [u, v, w] = matrix.map(|row| row[0] * x + row[1] * y + row[2]);
    [u / w, v / w]
}

/// Brightness of the modules, row by row, black border included.
fn pattern(id: u16, dictionary: Dictionary) -> (usize, Vec<bool>) {
    let modules = match dictionary.name().as_bytes()[5] {
        digit @ b'4'..=b'7' => usize::from(digit - b'0') + 2,
        // DICT_APRILTAG_36h11
        _ => 8,
    };
    let picture = draw(dictionary, id, modules as i32).unwrap();
    (modules, picture.data_bytes().unwrap().iter().map(|value| *value > 127).collect())
}

/// White or black of a marker at a point of the bench; white to one module around it.
fn marker_at(marker: &Drawn, (modules, pattern): &(usize, Vec<bool>), bench: [f64; 2]) -> Option<bool> {
    let (sin, cos) = marker.yaw.sin_cos();
    let [x, y] = [0, 1].map(|axis| bench[axis] / marker.enlarged - marker.centre_m[axis]);
    // In sides of the marker, y down, from its top left corner.
    let place = [(x * cos + y * sin) / marker.side_m + 0.5, (x * sin - y * cos) / marker.side_m + 0.5];
    let module = place.map(|value| (value * *modules as f64).floor() as i64);
    let count = *modules as i64;
    if module.iter().any(|value| !(-1..=count).contains(value)) {
        return None;
    }
    if module.iter().any(|value| !(0..count).contains(value)) {
        return Some(true);
    }
    Some(pattern[module[1] as usize * modules + module[0] as usize])
}

fn inverse(m: &Matrix) -> Matrix {
    let cofactor = |row: usize, column: usize| {
        let (a, b) = ((row + 1) % 3, (row + 2) % 3);
        let (c, d) = ((column + 1) % 3, (column + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant: f64 = (0..3).map(|column| m[0][column] * cofactor(0, column)).sum();
    std::array::from_fn(|row| std::array::from_fn(|column| cofactor(column, row) / determinant))
}

/// The same noise on every run (an xorshift generator), -1..1.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
