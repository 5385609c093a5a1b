//! How strict a job is: one number for what a right job may be accused of, and for what is law.
//!
//! A rate to be chosen freely asks a person for a figure that nobody has. With five levels of known rates, each about twice as strict, two
//! tries find the right one.

use crate::statistics::student_t;
use serde::Deserialize;

/// How strict a job is, from 1, which accuses right jobs seldom, to 5, which lets little pass.
///
/// Both of its rates are shares of right jobs or of pairs of steps, so that they mean the same whatever the job is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "u8")]
pub struct Strictness(u8);

impl Strictness {
    /// The least strict one.
    pub const MIN: u8 = 1;
    /// The strictest one.
    pub const MAX: u8 = 5;

    const FALSE_ALARMS: [f64; 5] = [0.0075, 0.015, 0.03, 0.06, 0.12];

    /// How often two steps that may come in either order may be taken for a law, given how their times vary.
    const CHANCE_OF_LAW: [f64; 5] = [0.002, 0.005, 0.01, 0.02, 0.05];

    /// By how much that is multiplied for steps that share a part: they are likely to need their order, so less evidence is enough.
    const SHARED_PART_FACTOR: f64 = 5.0;

    const CONTRADICTIONS: [usize; 5] = [1, 1, 1, 2, usize::MAX];

    /// The number, if it is one of those that there are.
    pub fn new(number: u8) -> Option<Self> {
        (Self::MIN..=Self::MAX).contains(&number).then_some(Self(number))
    }

    /// The number.
    pub const fn number(self) -> u8 {
        self.0
    }

    fn index(self) -> usize {
        usize::from(self.0 - Self::MIN)
    }

    /// The share of right jobs that may be accused by their measures.
    pub fn false_alarms(self) -> f64 {
        Self::FALSE_ALARMS[self.index()]
    }

    /// How many runs must contradict a rule, each left out while the others teach, for it to give way.
    pub(crate) fn contradictions(self) -> usize {
        Self::CONTRADICTIONS[self.index()]
    }

    /// The quantile of Student's t that the gap between two steps must exceed to be law, in this number of runs.
    pub(crate) fn law_quantile(self, runs: usize, is_shared: bool) -> f64 {
        let chance =
            Self::CHANCE_OF_LAW[self.index()] * if is_shared { Self::SHARED_PART_FACTOR } else { 1.0 };
        student_t(runs.max(2) as f64 - 1.0, chance)
    }
}

impl Default for Strictness {
    /// In the middle: one right job in 33.
    fn default() -> Self {
        Self(3)
    }
}

impl TryFrom<u8> for Strictness {
    type Error = String;

    fn try_from(number: u8) -> Result<Self, Self::Error> {
        Self::new(number)
            .ok_or_else(|| format!("strictness is {number}; it must be {} to {}", Self::MIN, Self::MAX))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_higher_number_accuses_more_and_makes_law_of_less() {
        let all: Vec<Strictness> = (1..=5).map(|number| Strictness::new(number).unwrap()).collect();
        for pair in all.windows(2) {
            assert!(pair[0].false_alarms() < pair[1].false_alarms());
            assert!(pair[0].contradictions() <= pair[1].contradictions());
            for (runs, is_shared) in [(2, false), (5, true), (20, false)] {
                assert!(pair[0].law_quantile(runs, is_shared) > pair[1].law_quantile(runs, is_shared));
            }
        }
        assert!(Strictness::new(0).is_none() && Strictness::new(6).is_none());
    }

    #[test]
    fn the_middle_asks_for_one_and_for_five_percent_of_students_t() {
        let middle = Strictness::default();
        assert_eq!((1.0 / middle.false_alarms()).round(), 33.0);
        assert!((middle.law_quantile(5, false) - 3.747).abs() < 0.001);
        assert!((middle.law_quantile(5, true) - 2.132).abs() < 0.001);
    }
}
