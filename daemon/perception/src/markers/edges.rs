//! Corners to a hundredth of a pixel: a line is fitted to each edge of a marker, corners are where lines meet.

use crate::image::ImageView;
use crate::points::PixelPoint;
use std::sync::LazyLock;

/// Maximum number of points that are measured along an edge: one per pixel up to a marker of 80 pixels.
const SAMPLES: usize = 80;
/// Share of an edge that is left out at each end: blur rounds the corners, and the neighbouring edge disturbs there.
const MARGIN: f64 = 0.08;
/// An edge with fewer good points is taken to be hidden.
const MIN_SAMPLES: usize = 6;
/// Minimum sum of squared grey steps across an edge: a step of 8 in one pixel, four times the noise of a camera.
const MIN_CONTRAST: f64 = 60.0;
/// Steps across the edge, in pixels.
const STEP: f64 = 0.25;
/// Half a pixel in these steps.
const HALF: usize = 2;
/// Maximum reach across the edge, in pixels.
const MAX_REACH: f64 = 6.0;
/// Maximum number of places across the edge that are sampled.
const PLACES: usize = 2 * ((MAX_REACH / STEP) as usize + HALF) + 1;
/// How far lens and pixels spread an edge, in pixels to either side.
const BLUR: f64 = 1.5;
/// A point further from the line than this does not belong to the edge, in pixels.
const OUTLIER: f64 = 0.6;
/// A corner that moves further than this was refined to something else, in pixels.
const MAX_MOVE_PX: f64 = 4.0;
/// A shorter edge has modules of less than a pixel, and cannot be refined.
const MIN_EDGE_PX: f64 = 6.0;

/// The first pass finds the edge, and the second one measures it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Pass {
    /// Steps are squared, and only those to the bright side count, so that other things near the edge hardly matter.
    Coarse,
    /// Steps count as they are, near the edge: their centroid is where the edge is, wherever it cuts the pixels.
    Fine,
}

/// `a x + b y + c = 0` with `a² + b² = 1`.
type Line = [f64; 3];

/// Refines the corners (clockwise in the picture) of a marker with this number of `modules` per side.
///
/// An edge that is hidden or blurred away keeps the line through its given corners. Returns the share of edges that were
/// found, 0..1; the corners stay as given where the result would be absurd.
pub(crate) fn refine(gray: &ImageView<'_>, corners: &mut [PixelPoint; 4], modules: f64) -> f64 {
    let given = *corners;
    let sampler = Sampler::new(gray);
    let mut found = 0;
    for pass in [Pass::Coarse, Pass::Fine] {
        found = 0;
        let mut lines = [[0.0; 3]; 4];
        for (edge, line) in lines.iter_mut().enumerate() {
            let (from, to) = (corners[edge], corners[(edge + 1) % 4]);
            *line = match fit_edge(&sampler, from, to, modules, pass) {
                Some(fitted) => {
                    found += 1;
                    fitted
                }
                None => line_through(from, to),
            };
        }
        for corner in 0..4 {
            match meet(lines[(corner + 3) % 4], lines[corner]) {
                Some(point) if point.distance(given[corner]) <= MAX_MOVE_PX => corners[corner] = point,
                _ => {
                    *corners = given;
                    return 0.0;
                }
            }
        }
    }
    f64::from(found) / 4.0
}

/// The line along the step from dark (inside) to bright (outside) between two corners.
fn fit_edge(
    sampler: &Sampler<'_>,
    from: PixelPoint,
    to: PixelPoint,
    modules: f64,
    pass: Pass,
) -> Option<Line> {
    let length = from.distance(to);
    if length < MIN_EDGE_PX {
        return None;
    }
    let along = [(to.x - from.x) / length, (to.y - from.y) / length];
    // Outward, for corners that run clockwise with y down.
    let outward = [along[1], -along[0]];
    // Half a module: the modules of the pattern begin further in.
    let half_module = (0.55 * length / modules).clamp(BLUR, MAX_REACH);
    let reach = if pass == Pass::Coarse { half_module } else { BLUR };
    let wanted = (length as usize).clamp(10, SAMPLES);

    let mut points = [(PixelPoint::default(), 0.0); SAMPLES];
    let mut count = 0;
    for sample in 0..wanted {
        let share = MARGIN + (1.0 - 2.0 * MARGIN) * (sample as f64 + 0.5) / wanted as f64;
        let base = moved(from, along, share * length);
        if let Some((offset, contrast)) = step_outward(sampler, base, outward, reach, pass) {
            points[count] = (moved(base, outward, offset), contrast.sqrt());
            count += 1;
        }
    }
    if count < MIN_SAMPLES.max(wanted / 2) {
        return None;
    }
    let points = &mut points[..count];
    let line = total_least_squares(points)?;
    for (point, weight) in points.iter_mut() {
        if (line[0] * point.x + line[1] * point.y + line[2]).abs() > OUTLIER {
            *weight = 0.0;
        }
    }
    total_least_squares(points)
}

/// Where along `outward` the picture gets brighter, relative to `base`, and by how much: the centroid of the steps.
///
/// A lens blurs light, and the camera turns light into grey values after that. The middle of a blurred edge is where the light is half, not where the
/// grey value is half. In grey values a marker of 30 px would come out 0.4 px too small.
fn step_outward(
    sampler: &Sampler<'_>,
    base: PixelPoint,
    outward: [f64; 2],
    reach: f64,
    pass: Pass,
) -> Option<(f64, f64)> {
    let steps = (reach / STEP) as usize;
    // Half a pixel to either side of every step: most places are the outer end of one and the inner end of another.
    let mut samples = [Sample::default(); PLACES];
    let samples = &mut samples[..2 * (steps + HALF) + 1];
    for (place, sample) in samples.iter_mut().enumerate() {
        let offset = (place as f64 - (steps + HALF) as f64) * STEP;
        *sample = sampler.at(moved(base, outward, offset))?;
    }
    let (mut contrast, mut sum, mut moment) = (0.0, 0.0, 0.0);
    for (step, (inner, outer)) in samples.iter().zip(&samples[2 * HALF..]).enumerate() {
        let offset = (step as f64 - steps as f64) * STEP;
        contrast += (outer.grey - inner.grey).max(0.0).powi(2);
        let rise = outer.light - inner.light;
        let weight = if pass == Pass::Coarse { rise.max(0.0).powi(2) } else { rise };
        sum += weight;
        moment += weight * offset;
    }
    let offset = moment / sum;
    (contrast >= MIN_CONTRAST && offset.abs() <= reach).then_some((offset, contrast))
}

/// Light of a grey value, 0..1, by the transfer curve of sRGB, which cameras and video follow.
static LIGHT: LazyLock<[f64; 256]> = LazyLock::new(|| {
    std::array::from_fn(|grey| {
        let grey = grey as f64 / 255.0;
        if grey <= 0.04045 { grey / 12.92 } else { ((grey + 0.055) / 1.055).powf(2.4) }
    })
});

/// The brightness at a point of the picture.
#[derive(Clone, Copy, Default)]
struct Sample {
    grey: f64,
    light: f64,
}

/// Reads the picture between its pixels.
struct Sampler<'a> {
    data: &'a [u8],
    stride: usize,
    last: [f64; 2],
    light: &'static [f64; 256],
}

impl<'a> Sampler<'a> {
    fn new(gray: &ImageView<'a>) -> Self {
        let last = [gray.width(), gray.height()].map(|side| side as f64 - 1.0);
        Self { data: gray.data(), stride: gray.stride(), last, light: &LIGHT }
    }

    /// Interpolates between four pixels; `None` outside the picture.
    fn at(&self, PixelPoint { x, y }: PixelPoint) -> Option<Sample> {
        // Written so that NaN is outside.
        if !(x >= 0.0 && y >= 0.0 && x < self.last[0] && y < self.last[1]) {
            return None;
        }
        // A cast rounds down what is not negative; `floor` is a call into the mathematical library, for every point.
        let (left, top) = (x as usize, y as usize);
        let (right_share, bottom_share) = (x - left as f64, y - top as f64);
        let first = top * self.stride + left;
        let (above, below) =
            (&self.data[first..first + 2], &self.data[first + self.stride..first + self.stride + 2]);
        let pixels = [
            (above[0], (1.0 - right_share) * (1.0 - bottom_share)),
            (above[1], right_share * (1.0 - bottom_share)),
            (below[0], (1.0 - right_share) * bottom_share),
            (below[1], right_share * bottom_share),
        ];
        let mut sum = Sample::default();
        for (grey, share) in pixels {
            sum.grey += share * f64::from(grey);
            sum.light += share * self.light[usize::from(grey)];
        }
        Some(sum)
    }
}

fn total_least_squares(points: &[(PixelPoint, f64)]) -> Option<Line> {
    let sum = |value: &dyn Fn(PixelPoint) -> f64| {
        points.iter().map(|&(point, weight)| weight * value(point)).sum::<f64>()
    };
    let weight = sum(&|_| 1.0);
    if weight <= 0.0 {
        return None;
    }
    let (x, y) = (sum(&|p| p.x) / weight, sum(&|p| p.y) / weight);
    let (xx, xy, yy) =
        (sum(&|p| (p.x - x) * (p.x - x)), sum(&|p| (p.x - x) * (p.y - y)), sum(&|p| (p.y - y) * (p.y - y)));
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    let (a, b) = (-angle.sin(), angle.cos());
    Some([a, b, -(a * x + b * y)])
}

fn line_through(from: PixelPoint, to: PixelPoint) -> Line {
    let length = from.distance(to).max(f64::MIN_POSITIVE);
    let (a, b) = ((from.y - to.y) / length, (to.x - from.x) / length);
    [a, b, -(a * from.x + b * from.y)]
}

/// Where two lines meet; `None` for parallel ones.
fn meet(first: Line, second: Line) -> Option<PixelPoint> {
    let determinant = first[0] * second[1] - first[1] * second[0];
    if determinant.abs() < 1e-6 {
        return None;
    }
    Some(PixelPoint {
        x: (first[1] * second[2] - second[1] * first[2]) / determinant,
        y: (second[0] * first[2] - first[0] * second[2]) / determinant,
    })
}

fn moved(point: PixelPoint, direction: [f64; 2], by_px: f64) -> PixelPoint {
    PixelPoint::new(point.x + by_px * direction[0], point.y + by_px * direction[1])
}
