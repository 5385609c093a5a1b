//! What a picture alone says of how well it can be seen.

use crate::image::ImageView;

/// Columns and rows of the cells whose mean brightness is kept.
const COLUMNS: usize = 8;
const ROWS: usize = 4;
/// Number of cells.
pub(super) const CELLS: usize = COLUMNS * ROWS;

/// Points per row that are looked at. More would cost time and say the same.
const POINTS: usize = 160;
/// How far around a point the picture is compared, in pixels. An edge that is sharp has all of its step within the near points.
const NEAR: usize = 1;
const FAR: usize = 4;
/// Where the lens is far out of focus, an edge is as wide as this.
const WIDE: usize = 24;
/// Up to this grey level a pixel is black: the noise of a covered sensor stays below.
const BLACK_LEVEL: u8 = 16;
/// From this grey level on a pixel is white: video keeps the last levels free.
const WHITE_LEVEL: u8 = 250;
/// The least step across an edge, in grey levels.
const EDGE: f32 = 16.0;
/// A step across an edge is over this many times the noise.
const OVER_NOISE: f32 = 7.0;
/// Fewer points on edges than this say nothing about how sharp they are.
const MIN_EDGE_POINTS: u32 = 30;
/// Only every eighth row counts for the fingerprint: each has the noise of hundreds of pixels.
const FINGERPRINT_ROWS: usize = 8;

/// Measures of one picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Picture {
    /// Share of the pixels that are black.
    pub black: f32,
    /// Share of the pixels that are white.
    pub white: f32,
    /// Standard deviation of the noise, in grey levels of 255.
    pub noise: f32,
    /// Share of the points that lie on a sharp edge.
    pub edges: f32,
    /// Share of the points on an edge of any width.
    pub wide_edges: f32,
    /// How much of the step across an edge lies within two pixels, 0..1, at the sharp tenth of all edges; `None` where the picture has
    /// no edges.
    pub sharpness: Option<f32>,
    /// Mean brightness in a coarse grid.
    pub cells: [u8; CELLS],
    /// Two pictures with the same number are the same to the bit.
    pub fingerprint: u64,
}

impl Picture {
    /// Measures a picture of which `gray` holds the brightness. One of a few pixels has nothing to measure.
    pub fn of(gray: &ImageView<'_>) -> Self {
        let step = (gray.width() / POINTS).max(1);
        if gray.width() <= 2 * FAR || gray.height() <= 2 * FAR {
            return Self::default();
        }
        let mut count = Count::default();
        for y in (FAR..gray.height() - FAR).step_by(step) {
            for x in (FAR..gray.width() - FAR).step_by(step) {
                count.point(gray, x, y);
            }
        }
        count.picture(fingerprint(gray))
    }
}

fn fingerprint(gray: &ImageView<'_>) -> u64 {
    let mut sum = 0_u64;
    for row in gray.data().chunks_exact(gray.stride()).step_by(FINGERPRINT_ROWS) {
        for word in row[..gray.width()].chunks_exact(8) {
            // The chunks have eight bytes.
            let word = word.iter().fold(0, |word, byte| word << 8 | u64::from(*byte));
            // FNV's prime: any odd number with bits all over does.
            sum = (sum.rotate_left(5) ^ word).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
    sum
}

/// Grey levels, and what is counted by them.
type Histogram = [u32; 256];

struct Count {
    points: u32,
    black: u32,
    white: u32,
    near: Histogram,
    /// Steps over the widest edge, of the points that are far enough from the border.
    wide: Histogram,
    /// Answers to a mask that plain surfaces and straight edges leave at 0, by their size, four to a place.
    mask: Histogram,
    /// Near steps by far ones.
    far: Vec<[f32; 2]>,
    cells: [(u32, u32); CELLS],
}

impl Default for Count {
    fn default() -> Self {
        Self {
            points: 0,
            black: 0,
            white: 0,
            near: [0; 256],
            wide: [0; 256],
            mask: [0; 256],
            far: Vec::new(),
            cells: [(0, 0); CELLS],
        }
    }
}

impl Count {
    fn point(&mut self, gray: &ImageView<'_>, x: usize, y: usize) {
        let (data, stride) = (gray.data(), gray.stride());
        let at = |x: usize, y: usize| i32::from(data[y * stride + x]);
        let step = |by: usize| {
            let across = (at(x + by, y) - at(x - by, y)).abs();
            across.max((at(x, y + by) - at(x, y - by)).abs())
        };
        let value = data[y * stride + x];
        self.points += 1;
        self.black += u32::from(value <= BLACK_LEVEL);
        self.white += u32::from(value >= WHITE_LEVEL);
        let (near, far) = (step(NEAR), step(FAR));
        self.near[near as usize] += 1;
        let is_inside = |at: usize, length: usize| (WIDE..length.saturating_sub(WIDE)).contains(&at);
        if is_inside(x, gray.width()) && is_inside(y, gray.height()) {
            self.wide[step(WIDE) as usize] += 1;
        }
        if far as f32 >= EDGE {
            self.far.push([near as f32, far as f32]);
        }
        let corners = at(x - 1, y - 1) + at(x + 1, y - 1) + at(x - 1, y + 1) + at(x + 1, y + 1);
        let sides = at(x, y - 1) + at(x - 1, y) + at(x + 1, y) + at(x, y + 1);
        let mask = (corners - 2 * sides + 4 * i32::from(value)).unsigned_abs() as usize;
        self.mask[(mask / 4).min(255)] += 1;
        let cell = (y * ROWS / gray.height()) * COLUMNS + x * COLUMNS / gray.width();
        self.cells[cell].0 += u32::from(value);
        self.cells[cell].1 += 1;
    }

    fn picture(self, fingerprint: u64) -> Picture {
        let share = |count: u32| count as f32 / self.points.max(1) as f32;
        let noise = self.noise();
        let min_step = EDGE.max(OVER_NOISE * noise);
        let over =
            |steps: &Histogram, min_step: f32| steps[(min_step.ceil() as usize).min(256)..].iter().sum();
        let sharp: u32 = over(&self.near, min_step);
        // Shades and vignettes reach over so many pixels as well, but not so steeply.
        let wide: u32 = over(&self.wide, 2.0 * min_step);
        Picture {
            black: share(self.black),
            white: share(self.white),
            noise,
            edges: share(sharp),
            wide_edges: share(wide),
            sharpness: self.sharpness(2.0 * min_step),
            cells: self.cells.map(|(sum, count)| (sum / count.max(1)) as u8),
            fingerprint,
        }
    }

    /// By the median of the mask's answers, because most points of a picture lie on no edge (J. Immerkær, Fast Noise Variance
    /// Estimation, 1996, with a median in place of the mean).
    fn noise(&self) -> f32 {
        let mut left = self.points / 2;
        for (place, count) in self.mask.iter().enumerate() {
            if *count > left {
                // Where within the place the median lies; the mask's weights have the norm 6, and half of all normally distributed
                // numbers lie within 0.6745 standard deviations.
                return 4.0 * (place as f32 + left as f32 / *count as f32) / (6.0 * 0.6745);
            }
            left -= count;
        }
        0.0
    }

    fn sharpness(&self, min_step: f32) -> Option<f32> {
        let on_edges = self.far.iter().filter(|[_, far]| *far >= min_step);
        let mut ratios: Vec<f32> = on_edges.map(|[near, far]| (near / far).min(1.0)).collect();
        if (ratios.len() as u32) < MIN_EDGE_POINTS {
            return None;
        }
        let place = ratios.len() * 9 / 10;
        let (_, sharp, _) = ratios.select_nth_unstable_by(place, f32::total_cmp);
        Some(*sharp)
    }
}
