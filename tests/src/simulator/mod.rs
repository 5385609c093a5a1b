//! People at a bench, simulated: test equipment with contacts and labels known.
//!
//! A [`Person`] carries out a [`Script`] on a [`Bench`]: reaches, carries, strokes and holds with minimum-jerk movements
//! (Flash and Hogan 1985), at a speed, with a path, dwell and grip of their own. [`Noise`] then takes away what a
//! camera and a tracker would take away. All of it follows from one seed, on every machine.
//!
//! What it leaves out: the height over the bench (plane mode only), the forearm, the other fingers, learning and
//! fatigue. It shares no code with the method: what it says of contacts comes from the script, not from distances.

mod bench;
mod experiment;
mod job;
mod movement;
mod noise;
mod person;

pub use bench::{Bench, Part, Pose};
pub use experiment::{ACTIVITIES, Recorded, experiment_1, experiment_2, floor, save};
pub use job::{Expected, Flaw, Layout, Performance, perform, perform_activity};
pub use movement::{Action, Instant, Labels, Script, TrueIu, Truth};
pub use noise::Noise;
pub use person::Person;

use oorandom::Rand64;

/// A plane vector in metres.
pub(crate) type Vector = [f64; 2];

/// Random numbers from one seed.
#[derive(Clone, Debug)]
pub struct Random(Rand64);

impl Random {
    /// The stream of this seed and these labels; streams of different labels are independent.
    pub fn new(seed: u64, labels: &[u64]) -> Self {
        // FNV-1a over the words: neighbouring seeds must not give neighbouring streams.
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
    pub fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.uniform()
    }

    /// Normal with mean 0 and deviation 1 (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// A factor around 1 whose logarithm has this deviation, at most two deviations off.
    pub fn factor(&mut self, deviation: f64) -> f64 {
        (deviation * self.normal().clamp(-2.0, 2.0)).exp()
    }

    /// A whole number under `count`.
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
