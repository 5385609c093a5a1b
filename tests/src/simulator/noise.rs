//! What a camera and a tracker see of the truth.

use super::bench::{Part, Pose};
use super::lasting::LastingErrors;
use super::movement::{Instant, Truth};
use super::{Person, Random, Vector, add, length, subtract, turn};
use andon_core::input::{Frame, Hand, Object, Point, Side, Space};
use andon_learn::recording::{Header, Landmarks, Recording};
use std::collections::BTreeMap;

/// Within this distance of a part, a hand covers some of it, in metres.
const COVERED_M: f64 = 0.12;

/// How a hand is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeenHand {
    /// Each finger by itself.
    Fingers,
    /// A rigid body on the back of the hand, with the finger tips at a fixed place in front of it.
    Body,
    /// The middle of a box about the whole hand.
    Box,
}

/// Measurement noise and losses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// How hands are seen.
    pub hand: SeenHand,
    /// Frame rate of the camera.
    pub rate_hz: f64,
    /// Pixels per metre on the bench.
    pub px_per_m: f64,
    /// Standard deviation of the part of a landmark's error that changes with time, in pixels.
    pub landmark_px: f64,
    /// Standard deviation of the part of a landmark's error that is constant for a person, in pixels.
    pub landmark_bias_px: f64,
    /// Share of a landmark's error that remains one frame later.
    pub landmark_memory: f64,
    /// Share of a landmark's error (of its variance) that all landmarks of the hand have in common.
    pub landmark_common: f64,
    /// Standard deviation of a marker's centre in pixels; that of its yaw follows from corners 18 mm away from the centre.
    pub marker_px: f64,
    /// Share of a marker's error that remains one frame later.
    pub marker_memory: f64,
    /// How much more inexact a part is seen that a hand covers, as a factor.
    pub covered: f64,
    /// Probability per frame that a hand or a part is seen somewhere else, a metre away.
    pub leap_begins: f64,
    /// Maximum number of frames that it is seen there; all numbers up to this one are equally likely.
    pub leap_frames: f64,
    /// Probability per frame that the marker of a held part becomes hidden.
    pub hidden_begins: f64,
    /// Maximum number of frames that it stays hidden; all numbers up to this one are equally likely.
    pub hidden_frames: f64,
    /// Probability per frame that the hand gets lost.
    pub lost_begins: f64,
    /// Maximum number of frames that it stays lost; all numbers up to this one are equally likely.
    pub lost_frames: f64,
    /// Probability per frame that the camera drops it.
    pub dropped: f64,
}

impl Default for Noise {
    /// What `andon-perception` measured on the recordings of two people, 640 x 480 pixels over a bench 0.76 m below the camera. It was
    /// `perception_accuracy detected` on two correct recordings, 907 frames. The median error of finger tips is 4.4 px, of which 4 px are constant.
    /// The rest has a standard deviation of 1.3 px (index tip) to 8 px (ring tip). It changes by 0.6 to 1.3 px from frame to frame. A fifth is common
    /// to the hand. The error of markers has a median of 0.02 px and a 95th percentile of 0.08 px. One recording has a hidden marker in 15 frames. No
    /// hand was lost.
    fn default() -> Self {
        Self {
            hand: SeenHand::Fingers,
            rate_hz: 30.0,
            px_per_m: 800.0,
            landmark_px: 3.0,
            landmark_bias_px: 4.0,
            // 3 px then change by 0.95 px per frame: a tracker crops the next picture around the last landmarks.
            landmark_memory: 0.95,
            landmark_common: 0.2,
            marker_px: 0.05,
            marker_memory: 0.0,
            covered: 1.0,
            leap_begins: 0.0,
            leap_frames: 1.0,
            hidden_begins: 0.01,
            hidden_frames: 15.0,
            // Worse than in the recordings, which lose no hand and no frame: light and load of a shop floor are worse too.
            lost_begins: 0.002,
            lost_frames: 6.0,
            dropped: 0.002,
        }
    }
}

impl Noise {
    /// Motion capture: a body on the back of each hand, which turns over the finger tips by a centimetre, and hardly any other error.
    pub fn motion_capture() -> Self {
        Self {
            hand: SeenHand::Body,
            landmark_px: 2.5,
            landmark_bias_px: 4.0,
            landmark_memory: 0.98,
            landmark_common: 1.0,
            marker_px: 0.3,
            hidden_begins: 0.0,
            lost_begins: 0.0,
            dropped: 0.0,
            ..Self::default()
        }
    }

    /// The boxes of a stereo camera that uses no markers. Errors of millimetres where nothing is near, of centimetres where a hand covers a part, and
    /// leaps.
    pub fn boxes() -> Self {
        Self {
            hand: SeenHand::Box,
            landmark_px: 5.0,
            landmark_bias_px: 12.0,
            landmark_memory: 0.8,
            landmark_common: 1.0,
            marker_px: 3.0,
            marker_memory: 0.6,
            covered: 4.0,
            leap_begins: 0.004,
            leap_frames: 4.0,
            hidden_begins: 0.0,
            lost_begins: 0.0,
            dropped: 0.0,
            ..Self::default()
        }
    }

    /// What is seen of the truth. `habit` gives the errors that are constant for the person.
    pub fn see(&self, truth: &Truth, person: &Person, habit: &mut Random, random: &mut Random) -> Recording {
        let ids: Vec<u16> = truth
            .instants
            .first()
            .map(|first| first.poses.iter().map(|(id, _)| *id).collect())
            .unwrap_or_default();
        let header = Header {
            rate_hz: self.rate_hz as f32,
            space: Space::Plane,
            hands: vec![truth.side],
            landmarks: Landmarks::Five,
            objects: ids.iter().map(|id| Part::of(*id).named()).collect(),
        };
        let bias = self.landmark_bias_px / self.px_per_m;
        let biases = [(); 5].map(|()| [bias * habit.normal(), bias * habit.normal()]);
        let mut eye = Eye {
            noise: self,
            biases,
            common: [0.0; 2],
            errors: [[0.0; 2]; 5],
            of_markers: LastingErrors::new(self.marker_memory),
            hidden: 0.0,
            lost: 0.0,
            leaps: BTreeMap::new(),
        };
        // This is long enough for nothing to be left of the initial errors.
        for _ in 0..60 {
            eye.drift(random);
        }
        let frames =
            truth.instants.iter().filter_map(|instant| eye.look(truth, instant, person, random)).collect();
        Recording { header, frames, truncation: None }
    }
}

/// The camera and the tracker. Errors are in metres on the bench; the landmarks are wrist, middle knuckle, and the tips of index,
/// middle and ring finger.
struct Eye<'a> {
    noise: &'a Noise,
    /// The constant error of each landmark.
    biases: [Vector; 5],
    /// The error that all landmarks have in common.
    common: Vector,
    /// The error that each landmark has alone.
    errors: [Vector; 5],
    /// The error of the marker of each part along both axes and around it.
    of_markers: LastingErrors,
    /// Number of frames that the marker of the held part stays hidden.
    hidden: f64,
    /// Number of frames that the hand stays lost.
    lost: f64,
    /// Number of frames that the hand (none) or a part is seen somewhere else.
    leaps: BTreeMap<Option<u16>, f64>,
}

impl Eye<'_> {
    /// Lets the errors drift as a first-order autoregression of constant deviation.
    fn drift(&mut self, random: &mut Random) {
        let keep = self.noise.landmark_memory;
        let deviation = self.noise.landmark_px / self.noise.px_per_m * (1.0 - keep * keep).sqrt();
        let mut step = |error: &mut Vector, share: f64| {
            for part in error {
                *part = keep * *part + deviation * share.sqrt() * random.normal();
            }
        };
        step(&mut self.common, self.noise.landmark_common);
        for error in &mut self.errors {
            step(error, 1.0 - self.noise.landmark_common);
        }
    }

    fn look(
        &mut self,
        truth: &Truth,
        instant: &Instant,
        person: &Person,
        random: &mut Random,
    ) -> Option<Frame> {
        self.drift(random);
        begin(&mut self.hidden, self.noise.hidden_begins, self.noise.hidden_frames, random);
        begin(&mut self.lost, self.noise.lost_begins, self.noise.lost_frames, random);
        let dropped = random.uniform() < self.noise.dropped;
        let mut frame = Frame { captured_ns: (instant.time_s * 1e9).round() as u64, ..Frame::default() };
        if let Some(grip) = instant.grip.filter(|_| self.lost <= 0.0) {
            // There is room for one hand.
            let leap = self.leap(None, random);
            let _ = frame.hands.push(self.hand(truth, add(grip, leap), instant, person));
        }
        for (id, pose) in &instant.poses {
            if instant.held != Some(*id) || self.hidden <= 0.0 {
                // There are at most seven parts, and there is room for 32.
                let is_covered = instant.grip.is_some_and(|grip| length(subtract(grip, pose.at)) < COVERED_M);
                let leap = self.leap(Some(*id), random);
                let at = add(pose.at, leap);
                let _ = frame.objects.push(self.object(*id, Pose { at, ..*pose }, is_covered, random));
            }
        }
        (!dropped).then_some(frame)
    }

    fn hand(&self, truth: &Truth, grip: Vector, instant: &Instant, person: &Person) -> Hand {
        match self.noise.hand {
            SeenHand::Fingers => self.fingers(truth, grip, instant, person),
            SeenHand::Body => self.body(truth.side, grip, instant.hand_yaw, [0.0, 0.06, 0.125]),
            SeenHand::Box => self.body(truth.side, grip, instant.hand_yaw, [0.07, 0.07, 0.13]),
        }
    }

    /// All finger tips are at one place. Tips, middle knuckle and wrist are so far behind the grip, in metres.
    fn body(&self, side: Side, grip: Vector, yaw: f64, [tips, knuckle, wrist]: [f64; 3]) -> Hand {
        let tip = add(grip, add(self.biases[0], self.common));
        let at = |behind_m: f64| -> Point {
            let [x, y] = add(tip, turn([0.0, -behind_m], yaw));
            [x as f32, y as f32, 0.0]
        };
        Hand { side, score: 1.0, wrist: at(wrist), middle_knuckle: at(knuckle), tips: [at(tips); 3] }
    }

    fn fingers(&self, truth: &Truth, grip: Vector, instant: &Instant, person: &Person) -> Hand {
        let spread = person.grip_m + (1.0 - instant.closed) * 0.012;
        let at = |own: Vector, landmark: usize| -> Point {
            let seen = add(
                add(grip, turn(own, instant.hand_yaw)),
                add(self.biases[landmark], add(self.common, self.errors[landmark])),
            );
            [seen[0] as f32, seen[1] as f32, 0.0]
        };
        let thumb_side = if truth.side == Side::Right { -1.0 } else { 1.0 };
        Hand {
            side: truth.side,
            score: 0.95,
            wrist: at([0.0, -person.finger_m - 0.09], 0),
            middle_knuckle: at([0.0, -person.finger_m], 1),
            tips: [
                at([thumb_side * spread, -0.004], 2),
                at([0.0, 0.004], 3),
                at([-thumb_side * spread, -0.004], 4),
            ],
        }
    }

    /// How far away from where it is the hand (none) or a part is seen.
    fn leap(&mut self, of: Option<u16>, random: &mut Random) -> Vector {
        if self.noise.leap_begins == 0.0 {
            return [0.0; 2];
        }
        let left = self.leaps.entry(of).or_default();
        begin(left, self.noise.leap_begins, self.noise.leap_frames, random);
        if *left > 0.0 { [-0.4, -0.9] } else { [0.0; 2] }
    }

    fn object(&mut self, id: u16, pose: Pose, is_covered: bool, random: &mut Random) -> Object {
        let factor = if is_covered { self.noise.covered } else { 1.0 };
        let deviation = factor * self.noise.marker_px / self.noise.px_per_m;
        let error = self.of_markers.next(id, random);
        let [x, y] = add(pose.at, [deviation * error[0], deviation * error[1]]);
        let half = 0.5 * (pose.yaw + deviation / 0.018 * error[2]);
        let orientation = [half.cos() as f32, 0.0, 0.0, half.sin() as f32];
        Object { id, position: [x as f32, y as f32, 0.0], orientation }
    }
}

/// Counts down the frames of a loss; after it a new one begins by chance.
fn begin(left: &mut f64, chance: f64, frames: f64, random: &mut Random) {
    *left -= 1.0;
    if *left <= 0.0 && random.uniform() < chance {
        *left = (frames * random.uniform()).ceil();
    }
}
