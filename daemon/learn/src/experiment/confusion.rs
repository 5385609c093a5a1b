//! Confusion matrices as the paper prints them: positive is an anomaly.

use crate::teach::statistics::{deviation, mean};

/// Counts of one round.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Confusion {
    /// Right, and found right.
    pub true_negative: u32,
    /// Right, and accused.
    pub false_positive: u32,
    /// Wrong, and missed.
    pub false_negative: u32,
    /// Wrong, and found.
    pub true_positive: u32,
}

impl Confusion {
    /// Counts one case.
    pub fn count(&mut self, wrong: bool, accused: bool) {
        *match (wrong, accused) {
            (false, false) => &mut self.true_negative,
            (false, true) => &mut self.false_positive,
            (true, false) => &mut self.false_negative,
            (true, true) => &mut self.true_positive,
        } += 1;
    }

    /// Cases counted.
    pub fn all(&self) -> u32 {
        self.true_negative + self.false_positive + self.false_negative + self.true_positive
    }

    /// Share of the cases that came out right; 1 of none.
    pub fn accuracy(&self) -> f64 {
        if self.all() == 0 {
            1.0
        } else {
            f64::from(self.true_negative + self.true_positive) / f64::from(self.all())
        }
    }
}

/// Counts of all rounds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rounds(pub Vec<Confusion>);

impl Rounds {
    /// All rounds together.
    pub fn sum(&self) -> Confusion {
        self.0.iter().fold(Confusion::default(), |sum, round| Confusion {
            true_negative: sum.true_negative + round.true_negative,
            false_positive: sum.false_positive + round.false_positive,
            false_negative: sum.false_negative + round.false_negative,
            true_positive: sum.true_positive + round.true_positive,
        })
    }

    /// Mean and standard deviation of the rounds' accuracies.
    pub fn accuracy(&self) -> (f64, f64) {
        let accuracies: Vec<f64> = self.0.iter().map(Confusion::accuracy).collect();
        (mean(&accuracies), deviation(&accuracies, 1))
    }
}
