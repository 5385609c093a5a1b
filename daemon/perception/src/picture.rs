//! What a picture alone says of how well it can be seen.

use crate::image::ImageView;

/// Columns and rows of the cells whose mean colour is kept.
const COLUMNS: usize = 8;
const ROWS: usize = 4;
/// Number of cells.
pub(crate) const CELLS: usize = COLUMNS * ROWS;
/// Columns and rows of the patches, in which parts are distinguished from the table: a part covers some of them, each has 25 points.
const PATCH_COLUMNS: usize = 4 * COLUMNS;
const PATCH_ROWS: usize = 6 * ROWS;
const PATCHES: usize = PATCH_COLUMNS * PATCH_ROWS;
/// How many patches away a patch is compared: over this distance shade and vignetting are even.
const ASIDE: usize = 2;

/// Points per row that are examined. More would cost time and say the same.
const POINTS: usize = 160;
/// How far around a point the picture is compared, in pixels. An edge that is sharp has all of its step within the near points.
const NEAR: usize = 1;
const FAR: usize = 4;
/// Up to this grey level a pixel is black: the noise of a covered sensor stays below.
const BLACK_LEVEL: u8 = 16;
/// From this grey level on a pixel is white. Noise takes some levels from one that is as bright as it can be, and video keeps the last ones free.
const WHITE_LEVEL: u8 = 244;
/// Minimum step across an edge, in grey levels.
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
    /// By how many grey levels patches of the size of a part differ from what lies on both sides of them. It is a root mean square, without noise.
    /// Unlike an edge, this stays where the lens is far out of focus.
    pub patches: f32,
    /// How much of the step across an edge lies within two pixels, 0..1, at the sharp tenth of all edges. `None` where the picture has no edges.
    pub sharpness: Option<f32>,
    /// Mean red, green and blue in a coarse grid.
    pub cells: [[u8; 3]; CELLS],
    /// Two pictures with the same number are the same to the bit.
    pub fingerprint: u64,
}

impl Picture {
    /// Measures a picture of which `gray` holds the brightness, in the same size. One of a few pixels has nothing to measure.
    pub fn of(image: &ImageView<'_>, gray: &ImageView<'_>) -> Self {
        let step = (gray.width() / POINTS).max(1);
        if gray.width() <= 2 * FAR || gray.height() <= 2 * FAR {
            return Self::default();
        }
        let mut count = Count::default();
        let columns: Vec<Column> =
            (FAR..gray.width() - FAR).step_by(step).map(|x| Column::new(x, gray.width())).collect();
        for y in (FAR..gray.height() - FAR).step_by(step) {
            count.row(image, gray, y, &columns);
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
            // FNV's prime: any odd number with well-spread bits would do.
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
    /// Answers to a mask that plain surfaces and straight edges leave at 0, by their size, four sizes per bin.
    mask: Histogram,
    /// Near steps by far ones.
    far: Vec<[f32; 2]>,
    /// Sums of red, green and blue, and number of points.
    cells: [([u32; 3], u32); CELLS],
    /// Sum of the grey levels, and number of points.
    patches: [(u32, u32); PATCHES],
}

impl Default for Count {
    fn default() -> Self {
        Self {
            points: 0,
            black: 0,
            white: 0,
            near: [0; 256],
            mask: [0; 256],
            far: Vec::new(),
            cells: [([0; 3], 0); CELLS],
            patches: [(0, 0); PATCHES],
        }
    }
}

/// A column of points, and where its points belong in the patches and cells of their row.
struct Column {
    x: usize,
    patch: usize,
    cell: usize,
}

impl Column {
    fn new(x: usize, width: usize) -> Self {
        Self { x, patch: x * PATCH_COLUMNS / width, cell: x * COLUMNS / width }
    }
}

impl Count {
    fn row(&mut self, image: &ImageView<'_>, gray: &ImageView<'_>, y: usize, columns: &[Column]) {
        let (data, stride) = (gray.data(), gray.stride());
        let rows =
            [y - FAR, y - NEAR, y, y + NEAR, y + FAR].map(|y| &data[y * stride..y * stride + gray.width()]);
        let patches = y * PATCH_ROWS / gray.height() * PATCH_COLUMNS;
        let cells = y * ROWS / gray.height() * COLUMNS;
        for column in columns {
            let value = self.point(rows, column.x);
            let patch = &mut self.patches[patches + column.patch];
            patch.0 += u32::from(value);
            patch.1 += 1;
            let (sums, count) = &mut self.cells[cells + column.cell];
            for (sum, value) in sums.iter_mut().zip(image.rgb(column.x, y)) {
                *sum += u32::from(value);
            }
            *count += 1;
        }
    }

    /// Counts a point of a row, which lies between the rows that are far and near above and below it. Returns its grey level.
    fn point(&mut self, [far_above, above, row, below, far_below]: [&[u8]; 5], x: usize) -> u8 {
        let at = |row: &[u8], x: usize| i32::from(row[x]);
        let near = (at(row, x + NEAR) - at(row, x - NEAR)).abs().max((at(below, x) - at(above, x)).abs());
        let far =
            (at(row, x + FAR) - at(row, x - FAR)).abs().max((at(far_below, x) - at(far_above, x)).abs());
        let value = row[x];
        self.points += 1;
        self.black += u32::from(value <= BLACK_LEVEL);
        self.white += u32::from(value >= WHITE_LEVEL);
        self.near[near as usize] += 1;
        if far as f32 >= EDGE {
            self.far.push([near as f32, far as f32]);
        }
        let corners = at(above, x - 1) + at(above, x + 1) + at(below, x - 1) + at(below, x + 1);
        let sides = at(above, x) + at(row, x - 1) + at(row, x + 1) + at(below, x);
        let mask = (corners - 2 * sides + 4 * i32::from(value)).unsigned_abs() as usize;
        self.mask[(mask / 4).min(255)] += 1;
        value
    }

    fn picture(self, fingerprint: u64) -> Picture {
        let share = |count: u32| count as f32 / self.points.max(1) as f32;
        let noise = self.noise();
        let min_step = EDGE.max(OVER_NOISE * noise);
        let sharp: u32 = self.near[(min_step.ceil() as usize).min(256)..].iter().sum();
        Picture {
            black: share(self.black),
            white: share(self.white),
            noise,
            edges: share(sharp),
            sharpness: self.sharpness(2.0 * min_step),
            patches: self.patches(noise),
            cells: self.cells.map(|(sums, count)| sums.map(|sum| (sum / count.max(1)) as u8)),
            fingerprint,
        }
    }

    fn patches(&self, noise: f32) -> f32 {
        let means = self.patches.map(|(sum, count)| sum as f32 / count.max(1) as f32);
        let (mut square, mut differences) = (0.0, 0.0);
        for (patch, mean) in means.iter().enumerate() {
            let (row, column) = (patch / PATCH_COLUMNS, patch % PATCH_COLUMNS);
            for (at, length, step) in [(column, PATCH_COLUMNS, 1), (row, PATCH_ROWS, PATCH_COLUMNS)] {
                if (ASIDE..length - ASIDE).contains(&at) {
                    let sides = means[patch - ASIDE * step] + means[patch + ASIDE * step];
                    square += (sides - 2.0 * mean) * (sides - 2.0 * mean);
                    differences += 1.0;
                }
            }
        }
        // The weights 1, -2 and 1 have the square sum 6, and each is of a mean.
        let by_noise = 6.0 * noise * noise * PATCHES as f32 / self.points.max(1) as f32;
        (square / differences - by_noise).max(0.0).sqrt()
    }

    /// By the median of the mask's answers, because most points of a picture lie on no edge (J. Immerkær, Fast Noise Variance
    /// Estimation, 1996, with a median in place of the mean).
    fn noise(&self) -> f32 {
        let mut left = self.points / 2;
        for (bin, count) in self.mask.iter().enumerate() {
            if *count > left {
                // Where within the bin the median lies. The mask's weights have the norm 6, and half of all normally distributed numbers lie within
                // 0.6745 standard deviations.
                return 4.0 * (bin as f32 + left as f32 / *count as f32) / (6.0 * 0.6745);
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
