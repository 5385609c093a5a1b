//! Pictures of markers from a renderer of their own: an oracle that shares nothing with the detector but the pattern.

#![allow(clippy::unwrap_used, dead_code, unreachable_pub)]

use andon_perception::{Dictionary, ImageView, PixelFormat};
use opencv::core::Mat;
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

/// How the picture is taken; grey levels of 255.
#[derive(Clone, Copy)]
pub struct Light {
    pub black: f64,
    pub white: f64,
    /// Maximum deviation of a pixel, grey levels.
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
    // Along an edge that runs with the pixels all samples of a column flip at once: the edge is drawn to 1/32 px.
    const SAMPLES: usize = 16;
    let bench_from_image = inverse(camera);
    let patterns: Vec<_> = markers.iter().map(|marker| pattern(marker.id, dictionary)).collect();
    // A pixel collects light, and a grey value is what it reports.
    let (black, white) = (light_of(light.black), light_of(light.white));
    let bench_light = (black + white) / 2.0;
    let brightness = |bench: [f64; 2]| match markers
        .iter()
        .zip(&patterns)
        .find_map(|(marker, pattern)| marker_at(marker, pattern, bench))
    {
        Some(true) => white,
        Some(false) => black,
        None => bench_light,
    };
    let near_a_marker = |[x, y]: [f64; 2]| {
        markers.iter().any(|marker| {
            let [dx, dy] =
                [x - marker.centre_m[0] * marker.enlarged, y - marker.centre_m[1] * marker.enlarged];
            dx.hypot(dy) < 1.2 * marker.side_m * marker.enlarged
        })
    };
    let mut noise = Noise(light.seed);
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        for column in 0..width {
            let centre = [column as f64, row as f64];
            let mut collected = bench_light;
            if near_a_marker(apply(&bench_from_image, centre)) {
                let at =
                    |dx: f64, dy: f64| brightness(apply(&bench_from_image, [centre[0] + dx, centre[1] + dy]));
                let corners = [at(-0.5, -0.5), at(0.5, -0.5), at(-0.5, 0.5), at(0.5, 0.5)];
                // A module is larger than a pixel: where its corners are alike, there is no edge in it.
                collected = corners[0];
                if corners.iter().any(|light| *light != corners[0]) {
                    let offset = |index: usize| (index as f64 + 0.5) / SAMPLES as f64 - 0.5;
                    let lights = (0..SAMPLES * SAMPLES)
                        .map(|index| at(offset(index % SAMPLES), offset(index / SAMPLES)));
                    collected = lights.sum::<f64>() / (SAMPLES * SAMPLES) as f64;
                }
            }
            let grey = grey_of(collected) + light.noise * noise.next();
            pixels.push(grey.round().clamp(0.0, 255.0) as u8);
        }
    }
    pixels
}

/// The light of a grey value, by the power law that displays are built for.
fn light_of(grey: f64) -> f64 {
    (grey / 255.0).powf(2.2)
}

/// The grey value of light.
fn grey_of(light: f64) -> f64 {
    255.0 * light.powf(1.0 / 2.2)
}

pub fn gray(width: usize, height: usize, pixels: &[u8]) -> ImageView<'_> {
    ImageView::new(width, height, width, PixelFormat::Gray8, pixels).unwrap()
}

pub fn apply(matrix: &Matrix, [x, y]: [f64; 2]) -> [f64; 2] {
    let [u, v, w] = matrix.map(|row| row[0] * x + row[1] * y + row[2]);
    [u / w, v / w]
}

/// OpenCV's drawing of a marker: `side` pixels with the black border, no white around it.
fn draw(dictionary: Dictionary, id: u16, side: i32) -> opencv::Result<Mat> {
    let code = Dictionary::all().position(|known| known == dictionary).unwrap() as i32;
    let mut picture = Mat::default();
    #[cfg(not(aruco_in_objdetect))]
    {
        let dictionary = opencv::aruco::get_predefined_dictionary_i32(code)?;
        opencv::aruco::draw_marker(&dictionary, i32::from(id), side, &mut picture, 1)?;
    }
    #[cfg(aruco_in_objdetect)]
    {
        let dictionary = opencv::objdetect::get_predefined_dictionary_i32(code)?;
        opencv::objdetect::generate_image_marker(&dictionary, i32::from(id), side, &mut picture, 1)?;
    }
    Ok(picture)
}

/// Brightness of the modules, row by row, including the black border.
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
    let at = [(x * cos + y * sin) / marker.side_m + 0.5, (x * sin - y * cos) / marker.side_m + 0.5];
    let module = at.map(|value| (value * *modules as f64).floor() as i64);
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

/// The picture through a lens that spreads a point by this standard deviation. It spreads light, not grey values.
pub fn blurred(width: usize, pixels: &[u8], deviation_px: f64) -> Vec<u8> {
    let light: Vec<f32> = pixels.iter().map(|grey| light_of(f64::from(*grey)) as f32).collect();
    let sharp = Mat::from_slice(&light).unwrap();
    let sharp = sharp.reshape(1, (pixels.len() / width) as i32).unwrap();
    let mut soft = Mat::default();
    let size = opencv::core::Size::default();
    opencv::imgproc::gaussian_blur_def(&sharp, &mut soft, size, deviation_px).unwrap();
    let light = soft.data_typed::<f32>().unwrap();
    light.iter().map(|light| grey_of(f64::from(*light)).round() as u8).collect()
}
