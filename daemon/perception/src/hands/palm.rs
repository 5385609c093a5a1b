//! Reads the palm model's output (MediaPipe's `palm_detection_cpu.pbtxt`).

use super::region::{Region, upright};
use heapless::Vec;

/// Side of the model's input in pixels.
pub(super) const INPUT: usize = 192;
/// Numbers per candidate: box centre and size, then seven points.
const NUMBERS: usize = 18;
/// Candidates that overlap more than this are one palm.
const SAME_PALM: f32 = 0.3;
/// Maximum number of palms that are kept: the hands of two workers, to choose from.
const PALMS: usize = 4;

/// A palm: in pixels of the picture, or while it is decoded 0..1 on both axes of the model's input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Palm {
    pub(crate) score: f32,
    /// Left, top, right, bottom.
    pub(crate) bounds: [f32; 4],
    /// 0 wrist, 1 index, 2 middle, 3 ring, 4 little knuckle, 5 and 6 thumb.
    pub(crate) keypoints: [[f32; 2]; 7],
}

impl Palm {
    /// Where its hand is (MediaPipe's `palm_detection_detection_to_roi`).
    pub(super) fn region(&self) -> Region {
        let [left, top, right, bottom] = self.bounds;
        // Wrist and middle knuckle.
        let rotation = upright(self.keypoints[0], self.keypoints[2]);
        let centre = [(left + right) / 2.0, (top + bottom) / 2.0];
        Region::grown(centre, [right - left, bottom - top], rotation, 2.6, 0.5)
    }
}

/// Palms of one frame, best first.
pub(crate) type Palms = Vec<Palm, PALMS>;

/// Turns candidates into palms.
pub(super) struct PalmDecoder {
    anchors: std::vec::Vec<[f32; 2]>,
    candidates: std::vec::Vec<Palm>,
}

impl PalmDecoder {
    pub(super) fn new() -> Self {
        let anchors = anchors();
        let candidates = std::vec::Vec::with_capacity(anchors.len());
        Self { anchors, candidates }
    }

    /// Number of candidates that the model gives.
    pub(super) fn candidates(&self) -> usize {
        self.anchors.len()
    }

    /// `boxes` has 18 numbers per candidate, in pixels of the input and relative to its anchor; `logits` has one.
    pub(super) fn decode(&mut self, boxes: &[f32], logits: &[f32], min_score: f32, whole: Region) -> Palms {
        self.candidates.clear();
        for ((numbers, logit), anchor) in boxes.chunks_exact(NUMBERS).zip(logits).zip(&self.anchors) {
            let score = 1.0 / (1.0 + (-logit.clamp(-100.0, 100.0)).exp());
            if score >= min_score {
                self.candidates.push(candidate(score, numbers, *anchor));
            }
        }
        self.candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
        let mut palms = Palms::new();
        while let Some(best) = self.candidates.first().copied() {
            let palm = merged(&self.candidates, &best);
            self.candidates.retain(|other| !same_palm(&best, other));
            if palms.push(to_image(palm, whole)).is_err() {
                break;
            }
        }
        palms
    }
}

/// Centres of the candidates, 0..1: a grid of 24 x 24 with two each, then one of 12 x 12 with six each.
fn anchors() -> std::vec::Vec<[f32; 2]> {
    let mut anchors = std::vec::Vec::new();
    for (stride, each) in [(8, 2), (16, 6)] {
        let cells = INPUT / stride;
        for cell in 0..cells * cells {
            let centre = [cell % cells, cell / cells].map(|index| (index as f32 + 0.5) / cells as f32);
            anchors.extend(std::iter::repeat_n(centre, each));
        }
    }
    anchors
}

fn candidate(score: f32, numbers: &[f32], anchor: [f32; 2]) -> Palm {
    let number = |index: usize| numbers[index] / INPUT as f32;
    let (x, y) = (number(0) + anchor[0], number(1) + anchor[1]);
    let (half_width, half_height) = (number(2) / 2.0, number(3) / 2.0);
    Palm {
        score,
        bounds: [x - half_width, y - half_height, x + half_width, y + half_height],
        keypoints: std::array::from_fn(|point| {
            [number(4 + 2 * point) + anchor[0], number(5 + 2 * point) + anchor[1]]
        }),
    }
}

/// The mean of all candidates of one palm, weighted by their scores, with the best score.
fn merged(candidates: &[Palm], best: &Palm) -> Palm {
    let mut sum = Palm { score: best.score, bounds: [0.0; 4], keypoints: [[0.0; 2]; 7] };
    let mut weight = 0.0;
    for other in candidates.iter().filter(|other| same_palm(best, other)) {
        weight += other.score;
        for (total, value) in numbers_mut(&mut sum).zip(numbers(other)) {
            *total += other.score * value;
        }
    }
    numbers_mut(&mut sum).for_each(|total| *total /= weight);
    sum
}

fn numbers(palm: &Palm) -> impl Iterator<Item = f32> {
    palm.bounds.into_iter().chain(palm.keypoints.into_iter().flatten())
}

fn numbers_mut(palm: &mut Palm) -> impl Iterator<Item = &mut f32> {
    palm.bounds.iter_mut().chain(palm.keypoints.iter_mut().flatten())
}

fn same_palm(best: &Palm, other: &Palm) -> bool {
    if std::ptr::eq(best, other) || best == other {
        return true;
    }
    let [a, b] = [best.bounds, other.bounds];
    let shared = (a[2].min(b[2]) - a[0].max(b[0])).max(0.0) * (a[3].min(b[3]) - a[1].max(b[1])).max(0.0);
    let area = |bounds: [f32; 4]| (bounds[2] - bounds[0]) * (bounds[3] - bounds[1]);
    shared > SAME_PALM * (area(a) + area(b) - shared)
}

fn to_image(palm: Palm, whole: Region) -> Palm {
    let [left, top] = whole.to_image([palm.bounds[0], palm.bounds[1]]);
    let [right, bottom] = whole.to_image([palm.bounds[2], palm.bounds[3]]);
    Palm {
        score: palm.score,
        bounds: [left, top, right, bottom],
        keypoints: palm.keypoints.map(|point| whole.to_image(point)),
    }
}
