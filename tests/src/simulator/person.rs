//! What makes one person different from another.

use super::Random;

/// A person. The spreads are those of healthy adults at unconstrained bench work. Movement times differ by about a fifth between people, and by less
/// than a tenth between repetitions of one person.
#[derive(Clone, Debug)]
pub struct Person {
    /// Movement time relative to the average.
    pub tempo: f64,
    /// Lateral deviation of a path, as a share of its length; positive values deviate to the left.
    pub lateral: f64,
    /// Time for which the hand is still after taking and before releasing a part, in seconds.
    pub dwell_s: f64,
    /// Half the distance between index tip and ring tip in a grip, in metres.
    pub grip_m: f64,
    /// Offset from the grasp point of a part to the point at which the person takes it, in metres.
    pub grip_offset_m: [f64; 2],
    /// Length of a stroke in metres.
    pub stroke_m: f64,
    /// Duration of half a stroke in seconds.
    pub half_stroke_s: f64,
    /// Distance between middle knuckle and middle tip in the plane, in metres.
    pub finger_m: f64,
    /// Twice the standard deviation of the parts on this person's bench from the plan, in metres.
    pub layout_m: f64,
}

impl Person {
    /// The person with this number under this seed.
    pub fn new(seed: u64, number: u64) -> Self {
        let mut random = Random::new(seed, &[1, number]);
        Self {
            tempo: random.factor(0.18),
            lateral: random.between(-0.12, 0.12),
            dwell_s: 0.2 * random.factor(0.3),
            grip_m: random.between(0.006, 0.011),
            grip_offset_m: [random.between(-0.007, 0.007), random.between(-0.007, 0.007)],
            stroke_m: random.between(0.045, 0.075),
            half_stroke_s: 0.34 * random.factor(0.15),
            finger_m: random.between(0.055, 0.075),
            layout_m: 0.02,
        }
    }

    /// The same person in another repetition.
    pub fn repetition(&self, random: &mut Random) -> Self {
        Self {
            tempo: self.tempo * random.factor(0.07),
            lateral: self.lateral + 0.03 * random.normal(),
            dwell_s: self.dwell_s * random.factor(0.25),
            stroke_m: self.stroke_m * random.factor(0.06),
            half_stroke_s: self.half_stroke_s * random.factor(0.06),
            ..self.clone()
        }
    }

    /// Duration in seconds of a movement of this length, by Fitts' law for a target of 3 cm.
    pub fn movement_s(&self, length_m: f64) -> f64 {
        self.tempo * (0.25 + 0.17 * (length_m / 0.03 + 1.0).log2())
    }
}
