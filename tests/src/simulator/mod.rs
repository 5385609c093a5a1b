//! Simulated people at a bench: recordings for tests, with known contacts and labels.
//!
//! A [`Person`] carries out a [`Script`] on a [`Bench`]. The person reaches, carries, strokes and holds with minimum-jerk movements (Flash and Hogan
//! 1985). Speed, path, dwell time and grip are the person's own. [`Noise`] then removes what a camera and a tracker would not see. Everything follows
//! from one seed, on every machine.
//!
//! The simulation leaves out the height above the bench (there is only plane mode), the forearm, the other fingers, learning and fatigue.
//! It shares no code with the method: the contacts in its labels come from the script, not from distances.

mod activity;
mod arm;
mod bench;
mod by_feel;
mod experiment;
mod flaw;
mod job;
mod lasting;
mod movement;
mod noise;
mod performance;
mod person;
mod script;
mod two_hands;

pub use activity::{Layout, perform_activity};
pub use bench::{Bench, Part, PlannedPart, Pose};
pub use by_feel::{ByFeel, Lapse, perform_by_feel};
pub use experiment::{Recorded, experiment_1, experiment_2, floor, save, save_as};
pub use flaw::{Expected, Flaw};
pub use job::perform;
pub use lasting::LastingErrors;
pub use movement::{Instant, Truth};
pub use noise::{Noise, SeenHand};
pub use performance::Performance;
pub use person::Person;
pub use script::{Action, Labels, Script, TrueIu};
pub use two_hands::{TwoHanded, perform_with_two_hands};

use oorandom::Rand64;

/// A plane vector in metres.
pub(crate) type Vector = [f64; 2];

/// Random numbers from one seed.
#[derive(Clone, Debug)]
pub struct Random(Rand64);

impl Random {
    /// The stream of random numbers for this seed and these labels; streams with different labels are independent.
    pub fn new(seed: u64, labels: &[u64]) -> Self {
        // FNV-1a, because neighbouring seeds must not give similar streams.
        let state = [seed]
            .iter()
            .chain(labels)
            .flat_map(|word| word.to_le_bytes())
            .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
                (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
            });
        Self(Rand64::new(u128::from(state)))
    }

    /// Uniform in 0..1.
    pub fn uniform(&mut self) -> f64 {
        self.0.rand_float()
    }

    /// Uniform in a range.
    pub fn between(&mut self, min: f64, max: f64) -> f64 {
        min + (max - min) * self.uniform()
    }

    /// Normal with mean 0 and standard deviation 1 (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// A factor around 1 whose logarithm is normal with this standard deviation, cut off at two deviations.
    pub fn factor(&mut self, deviation: f64) -> f64 {
        (deviation * self.normal().clamp(-2.0, 2.0)).exp()
    }

    /// A uniform integer below `count`.
    pub fn index(&mut self, count: usize) -> usize {
        self.0.rand_range(0..count as u64) as usize
    }
}

pub(crate) fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1]]
}

pub(crate) fn subtract(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1]]
}

pub(crate) fn scale(a: Vector, factor: f64) -> Vector {
    [a[0] * factor, a[1] * factor]
}

pub(crate) fn length(a: Vector) -> f64 {
    a[0].hypot(a[1])
}

pub(crate) fn turn(a: Vector, yaw: f64) -> Vector {
    let (sin, cos) = yaw.sin_cos();
    [cos * a[0] - sin * a[1], sin * a[0] + cos * a[1]]
}
