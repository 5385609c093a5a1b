//! What came of the comparison.

use crate::Error;
use crate::clip::TruthFrame;
use andon_perception::Detections;
use andon_perception::detections::Side;
use std::io::Write;
use std::time::Duration;

/// A hand whose landmarks are this far off in the median is on something else; as a share of the picture's width.
const ELSEWHERE: f64 = 0.06;
/// The fingertips that touch.
const TIPS: [usize; 3] = [8, 12, 16];

#[derive(Default)]
pub(crate) struct Score {
    frames: usize,
    hands: usize,
    hands_found: usize,
    hands_elsewhere: usize,
    hands_wrong_side: usize,
    palm_runs: usize,
    landmark_px: Vec<f64>,
    tip_px: Vec<f64>,
    tip_mm: Vec<f64>,
    markers: usize,
    markers_found: usize,
    markers_hidden_found: usize,
    centre_px: Vec<f64>,
    centre_mm: Vec<f64>,
    held_mm: Vec<f64>,
    yaw_deg: Vec<f64>,
    step_mm: Vec<f64>,
    previous: Vec<(u16, [f64; 2])>,
    frame_ms: Vec<f64>,
    palm_ms: Vec<f64>,
    landmarks_ms: Vec<f64>,
    markers_ms: Vec<f64>,
}

impl Score {
    pub(crate) fn frame(
        &mut self,
        truth: &TruthFrame,
        seen: &Detections,
        side: Side,
        [width, height]: [usize; 2],
        took: Duration,
    ) {
        self.frames += 1;
        self.frame_ms.push(took.as_secs_f64() * 1e3);
        let ms = |ns: u64| ns as f64 / 1e6;
        self.markers_ms.push(ms(seen.spent.markers_ns));
        if seen.spent.landmarks_ns > 0 {
            self.landmarks_ms.push(ms(seen.spent.landmarks_ns));
        }
        if seen.flags.palm_detection_ran {
            self.palm_runs += 1;
            self.palm_ms.push(ms(seen.spent.palm_ns));
        }
        self.hand(truth, seen, side, [width as f64, height as f64]);
        self.objects(truth, seen);
    }

    fn hand(&mut self, truth: &TruthFrame, seen: &Detections, side: Side, [width, height]: [f64; 2]) {
        self.hands_wrong_side += seen.hands.iter().filter(|hand| hand.side != side).count();
        let found = seen.hands.iter().find(|hand| hand.side == side);
        let inside = |[x, y]: &[f64; 2]| (0.0..width).contains(x) && (0.0..height).contains(y);
        // A hand is there when most of it is in the picture.
        let there =
            truth.hand.as_ref().filter(|(px, _)| px.iter().filter(|point| inside(point)).count() > 10);
        self.hands += usize::from(there.is_some());
        let Some(found) = found else { return };
        let Some((px, m)) = &truth.hand else {
            self.hands_elsewhere += 1;
            return;
        };
        let errors: Vec<f64> =
            (0..21).map(|point| distance(px[point], found.landmarks_px[point].map(f64::from))).collect();
        if median(&errors) > ELSEWHERE * width {
            self.hands_elsewhere += 1;
        } else if there.is_some() {
            self.hands_found += 1;
            self.tip_px.extend(TIPS.map(|tip| errors[tip]));
            self.tip_mm.extend(TIPS.map(|tip| 1e3 * distance(m[tip], found.landmarks_m[tip].map(f64::from))));
            self.landmark_px.extend(errors);
        }
    }

    fn objects(&mut self, truth: &TruthFrame, seen: &Detections) {
        let mut positions = Vec::new();
        for object in &truth.objects {
            self.markers += usize::from(object.visible);
            let Some(found) = seen.objects.iter().find(|found| found.id == object.id) else { continue };
            let centre = [0, 1]
                .map(|axis| found.corners_px.iter().map(|corner| f64::from(corner[axis])).sum::<f64>() / 4.0);
            let position = [0, 1].map(|axis| f64::from(found.position_m[axis]));
            let error_mm = 1e3 * distance(position, object.position_m);
            self.markers_found += usize::from(object.visible);
            self.markers_hidden_found += usize::from(!object.visible);
            self.centre_px.push(distance(centre, object.centre_px));
            self.centre_mm.push(error_mm);
            if object.held {
                self.held_mm.push(error_mm);
            }
            let yaw = 2.0 * f64::from(found.orientation[3]).atan2(f64::from(found.orientation[0]));
            let turn = (yaw - object.yaw).sin().atan2((yaw - object.yaw).cos());
            self.yaw_deg.push(turn.abs().to_degrees());
            // How the error moves from frame to frame: this is what the method takes for motion.
            let error = [0, 1].map(|axis| position[axis] - object.position_m[axis]);
            if let Some((_, before)) = self.previous.iter().find(|(id, _)| *id == object.id) {
                self.step_mm.push(1e3 * distance(error, *before));
            }
            positions.push((object.id, error));
        }
        self.previous = positions;
    }

    pub(crate) fn add(&mut self, other: Self) {
        self.frames += other.frames;
        self.hands += other.hands;
        self.hands_found += other.hands_found;
        self.hands_elsewhere += other.hands_elsewhere;
        self.hands_wrong_side += other.hands_wrong_side;
        self.palm_runs += other.palm_runs;
        self.markers += other.markers;
        self.markers_found += other.markers_found;
        self.markers_hidden_found += other.markers_hidden_found;
        self.landmark_px.extend(other.landmark_px);
        self.tip_px.extend(other.tip_px);
        self.tip_mm.extend(other.tip_mm);
        self.centre_px.extend(other.centre_px);
        self.centre_mm.extend(other.centre_mm);
        self.held_mm.extend(other.held_mm);
        self.yaw_deg.extend(other.yaw_deg);
        self.step_mm.extend(other.step_mm);
        self.frame_ms.extend(other.frame_ms);
        self.palm_ms.extend(other.palm_ms);
        self.landmarks_ms.extend(other.landmarks_ms);
        self.markers_ms.extend(other.markers_ms);
    }

    pub(crate) fn header() -> String {
        format!(
            "{:<20} {:>6} | {:>6} {:>4} {:>4} {:>5} {:>6} {:>6} {:>11} | {:>7} {:>6} {:>11} {:>11} {:>11} {:>9} {:>9} | {:>5} {:>5} {:>5} {:>5} {:>5}",
            "clip",
            "frames",
            "hand",
            "else",
            "side",
            "palms",
            "px",
            "tip px",
            "tip mm p95",
            "markers",
            "hidden",
            "px p95",
            "mm p95",
            "held p95",
            "yaw p95",
            "step p95",
            "palm",
            "marks",
            "marker",
            "frame",
            "p99"
        )
    }

    pub(crate) fn line(&self, name: &str) -> String {
        let share = |part: usize, whole: usize| 100.0 * part as f64 / whole.max(1) as f64;
        let both = |values: &[f64]| format!("{:.2} {:.2}", median(values), quantile(values, 0.95));
        format!(
            "{:<20} {:>6} | {:>5.1}% {:>4} {:>4} {:>5} {:>6.2} {:>6.2} {:>11} | {:>6.1}% {:>6} {:>11} {:>11} {:>11} {:>9} {:>9} | {:>5.1} {:>5.1} {:>5.1} {:>5.1} {:>5.1}",
            name,
            self.frames,
            share(self.hands_found, self.hands),
            self.hands_elsewhere,
            self.hands_wrong_side,
            self.palm_runs,
            median(&self.landmark_px),
            median(&self.tip_px),
            both(&self.tip_mm),
            share(self.markers_found, self.markers),
            self.markers_hidden_found,
            both(&self.centre_px),
            both(&self.centre_mm),
            both(&self.held_mm),
            both(&self.yaw_deg),
            both(&self.step_mm),
            median(&self.palm_ms),
            median(&self.landmarks_ms),
            median(&self.markers_ms),
            median(&self.frame_ms),
            quantile(&self.frame_ms, 0.99),
        )
    }
}

/// Writes the detections of a frame.
pub(crate) fn dump(file: &mut std::fs::File, seen: &Detections) -> Result<(), Error> {
    let hands: Vec<_> = seen
        .hands
        .iter()
        .map(|hand| serde_json::json!({"side": format!("{:?}", hand.side), "score": hand.score, "px": hand.landmarks_px.map(Vec::from).to_vec(), "m": hand.landmarks_m.map(Vec::from).to_vec()}))
        .collect();
    let objects: Vec<_> = seen
        .objects
        .iter()
        .map(|object| serde_json::json!({"id": object.id, "corners": object.corners_px, "p": object.position_m, "q": object.orientation, "quality": object.quality}))
        .collect();
    Ok(writeln!(
        file,
        "{}",
        serde_json::json!({"frame": seen.frame_seq, "hands": hands, "objects": objects})
    )?)
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// NaN where there are none.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    let place = (share * values.len().saturating_sub(1) as f64).round() as usize;
    values.get(place).copied().unwrap_or(f64::NAN)
}
