//! What makes one person different from another.

use super::Random;

/// A person. Spreads are those of healthy adults at unconstrained bench work: movement times differ by about a fifth
/// between people and by less than a tenth within one.
#[derive(Clone, Debug)]
pub struct Person {
    /// Movement time relative to the average.
    pub tempo: f64,
    /// Sideways bow of a path, as a share of its length; positive bows to the left.
    pub bow: f64,
    /// Seconds of stillness after taking and before letting go.
    pub dwell_s: f64,
    /// Half the distance between index and ring tip in a grip, in metres.
    pub grip_m: f64,
    /// Where the person takes a thing, relative to its grasp point, in metres.
    pub grip_offset_m: [f64; 2],
    /// Length of a stroke in metres.
    pub stroke_m: f64,
    /// Seconds of half a stroke.
    pub half_stroke_s: f64,
    /// Middle knuckle to middle tip in metres, in the plane.
    pub finger_m: f64,
    /// Where this person's bench has its parts, relative to the plan, in metres for each part.
    pub layout_m: f64,
}

impl Person {
    /// The person of this number under this seed.
    pub fn new(seed: u64, number: u64) -> Self {
        let mut random = Random::new(seed, &[1, number]);
        Self {
            tempo: random.factor(0.18),
            bow: random.between(-0.12, 0.12),
            dwell_s: 0.2 * random.factor(0.3),
            grip_m: random.between(0.006, 0.011),
            grip_offset_m: [random.between(-0.007, 0.007), random.between(-0.007, 0.007)],
            stroke_m: random.between(0.045, 0.075),
            half_stroke_s: 0.34 * random.factor(0.15),
            finger_m: random.between(0.055, 0.075),
            layout_m: 0.02,
        }
    }

    /// The same person on another day, or in the next repetition.
    pub fn repetition(&self, random: &mut Random) -> Self {
        Self {
            tempo: self.tempo * random.factor(0.07),
            bow: self.bow + 0.03 * random.normal(),
            dwell_s: self.dwell_s * random.factor(0.25),
            stroke_m: self.stroke_m * random.factor(0.06),
            half_stroke_s: self.half_stroke_s * random.factor(0.06),
            ..self.clone()
        }
    }

    /// Seconds of a movement of this length: Fitts' law for a target of 3 cm.
    pub fn movement_s(&self, length_m: f64) -> f64 {
        self.tempo * (0.25 + 0.17 * (length_m / 0.03 + 1.0).log2())
    }
}
