//! Confusion matrices as in the paper, where an anomaly is positive.

use andon_learn::statistics::{deviation, mean};

/// Counts of one round.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Confusion {
    /// Number of cases that were correct and were judged correct.
    pub true_negative: u32,
    /// Number of cases that were correct and were judged anomalous.
    pub false_positive: u32,
    /// Number of cases that were wrong and were judged correct.
    pub false_negative: u32,
    /// Number of cases that were wrong and were judged anomalous.
    pub true_positive: u32,
}

impl Confusion {
    /// Counts one case.
    pub(super) fn count(&mut self, is_wrong: bool, is_accused: bool) {
        *match (is_wrong, is_accused) {
            (false, false) => &mut self.true_negative,
            (false, true) => &mut self.false_positive,
            (true, false) => &mut self.false_negative,
            (true, true) => &mut self.true_positive,
        } += 1;
    }

    /// Number of all cases.
    fn all(&self) -> u32 {
        self.true_negative + self.false_positive + self.false_negative + self.true_positive
    }

    /// Share of the cases that were judged as they should be; 1 if there is no case.
    fn accuracy(&self) -> f64 {
        if self.all() == 0 {
            1.0
        } else {
            f64::from(self.true_negative + self.true_positive) / f64::from(self.all())
        }
    }
}

/// The counts of each round.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rounds(pub Vec<Confusion>);

impl Rounds {
    /// The sum of all rounds.
    pub fn sum(&self) -> Confusion {
        self.0.iter().fold(Confusion::default(), |sum, round| Confusion {
            true_negative: sum.true_negative + round.true_negative,
            false_positive: sum.false_positive + round.false_positive,
            false_negative: sum.false_negative + round.false_negative,
            true_positive: sum.true_positive + round.true_positive,
        })
    }

    /// Mean and standard deviation of the accuracies of the rounds, each 0 to 1.
    pub fn accuracy(&self) -> (f64, f64) {
        let accuracies: Vec<f64> = self.0.iter().map(Confusion::accuracy).collect();
        (mean(&accuracies), deviation(&accuracies, 1))
    }
}
