//! One execution of something by one person.

use super::bench::Bench;
use super::movement::{Truth, carry_out};
use super::noise::Noise;
use super::script::Script;
use super::{Person, Random};
use andon_learn::recording::Recording;

/// Who does something, and its repetition number.
#[derive(Clone, Copy, Debug)]
pub struct Performance {
    /// The seed that everything follows from.
    pub seed: u64,
    /// The number of the person.
    pub person: u64,
    /// Repetition number.
    pub repetition: u64,
    /// The noise of camera and tracker.
    pub noise: Noise,
}

/// Parts whose points are farther from each other do not touch, however they are put back: `off_m` of their contact, and three times what they are
/// moved by, in metres.
const APART_M: f64 = 0.045 + 3.0 * 0.006;

impl Performance {
    /// The person in this repetition, and the random numbers of what they do. `what` identifies what they do.
    pub(super) fn person(&self, what: u64) -> (Person, Random) {
        let mut random = Random::new(self.seed, &[2, self.person, self.repetition, what]);
        let person = Person::new(self.seed, self.person).repetition(&mut random);
        (person, random)
    }

    /// Moves the parts to the person's habitual poses, which are a little different in each repetition. Parts that lie apart by the plan lie apart in
    /// every habit: the scripts say that a part that is put back touches no other.
    pub(super) fn settle(&self, bench: &mut Bench, person: &Person, random: &mut Random) {
        let mut habit = Random::new(self.seed, &[3, self.person]);
        let (planned, apart) = (bench.clone(), bench.apart(APART_M));
        loop {
            bench.clone_from(&planned);
            bench.jitter(&mut habit, 0.5 * person.layout_m, 0.05);
            let habitual = bench.apart(APART_M);
            if apart.iter().all(|pair| habitual.contains(pair)) {
                break;
            }
        }
        bench.jitter(random, 0.006, 0.04);
    }

    /// Carries out a script and records it.
    pub(super) fn record(
        &self,
        script: &Script,
        person: &Person,
        bench: &Bench,
        random: &mut Random,
    ) -> (Recording, Truth) {
        let truth = carry_out(script, person, bench, self.noise.rate_hz, random);
        let mut habit = Random::new(self.seed, &[4, self.person]);
        (self.noise.see(&truth, person, &mut habit, random), truth)
    }
}
