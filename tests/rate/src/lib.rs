//! Whether a count contradicts the rate that is wanted: the bars of tests that work by chance.
//!
//! A test that works by chance draws other people, errors or deletions in each run. A floor under the count that one draw has reached would guard
//! that draw alone, and fail with others by chance. So a bar states the rate that is wanted. It fails only where the count contradicts that rate.
//! That is where the rate would give so few, or so many, in less than one of [`DRAWS_PER_FALSE_ALARM`] draws. That is the exact test of a binomial
//! count. It is the same as whether the one-sided interval of the counted rate (Clopper and Pearson, 99.9 %) misses the wanted one.
//!
//! The test takes the cases for independent. Those of one taught job are not: a job that was taught too leniently misses all of its faults. So a
//! rate over several jobs is put [together](Rate::of_groups) from theirs. It counts for as many independent cases as its scatter shows (J. N. K. Rao
//! and A. J. Scott, "A simple method for the analysis of clustered binary data", Biometrics 48, 1992). A small sample contradicts only large faults:
//! more cases see smaller ones.

#![forbid(unsafe_code)]

use std::fmt;

/// A bar fails by chance in no more than one of this many draws, where the true rate is the wanted one. A suite of thirty such bars is then red by
/// chance in one of thirty runs at the worst. It hardly ever is where the true rates are better than the wanted ones.
pub const DRAWS_PER_FALSE_ALARM: f64 = 1000.0;

/// The quantile of the normal distribution of a two-sided interval of 95 %.
const QUANTILE_95: f64 = 1.96;

/// In how many of some cases something was so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    count: u64,
    of: u64,
    /// For how many of these cases one independent case counts, at least 1.
    design_effect: f64,
}

impl Rate {
    /// In so many of these cases.
    ///
    /// # Panics
    /// If it is more than all of them.
    pub fn new(count: usize, of: usize) -> Self {
        assert!(count <= of, "{count} of {of}");
        Self { count: count as u64, of: of as u64, design_effect: 1.0 }
    }

    /// In how many of these cases it is so.
    pub fn of(cases: impl IntoIterator<Item = bool>) -> Self {
        let (mut count, mut of) = (0, 0);
        cases.into_iter().for_each(|is_so| (count, of) = (count + usize::from(is_so), of + 1));
        Self::new(count, of)
    }

    /// In how many cases of all groups it is so, where the cases of one group resemble each other. A single group tells nothing of its likeness, so
    /// that its cases are taken for independent.
    pub fn of_groups(groups: impl IntoIterator<Item = Self>) -> Self {
        let groups: Vec<Self> = groups.into_iter().collect();
        let count = groups.iter().map(|group| group.count).sum();
        let of = groups.iter().map(|group| group.of).sum();
        Self { count, of, design_effect: design_effect(&groups, count as f64 / of as f64) }
    }

    /// Fails where the count is so small that it contradicts this rate.
    ///
    /// # Panics
    /// If it does; the message says what was counted.
    #[track_caller]
    pub fn expect_at_least(self, rate: f64, what: &str) {
        println!("{what}: {self}");
        assert!(!self.is_below(rate), "{what}: {self} contradicts at least {:.1} %", 100.0 * rate);
    }

    /// Fails where the count is so large that it contradicts this rate.
    ///
    /// # Panics
    /// If it does; the message says what was counted.
    #[track_caller]
    pub fn expect_at_most(self, rate: f64, what: &str) {
        println!("{what}: {self}");
        assert!(
            !self.others().is_below(1.0 - rate),
            "{what}: {self} contradicts at most {:.1} %",
            100.0 * rate
        );
    }

    /// The bounds between which the true rate lies in 95 of 100 samples (Wilson).
    pub fn interval(self) -> [f64; 2] {
        if self.of == 0 {
            return [0.0, 1.0];
        }
        let (of, share) = (self.of as f64 / self.design_effect, self.count as f64 / self.of as f64);
        let square = QUANTILE_95 * QUANTILE_95;
        let middle = share + square / (2.0 * of);
        let half = QUANTILE_95 * (share * (1.0 - share) / of + square / (4.0 * of * of)).sqrt();
        [middle - half, middle + half].map(|bound| (bound / (1.0 + square / of)).clamp(0.0, 1.0))
    }

    /// The cases in which it was not so.
    fn others(self) -> Self {
        Self { count: self.of - self.count, ..self }
    }

    /// As few independent cases as tell as much. Of two whole counts it is the larger one, so that it contradicts no more.
    fn independent(self) -> Self {
        let of = (self.of as f64 / self.design_effect).round();
        let count = (self.count as f64 * of / self.of as f64).ceil();
        Self::new(count as usize, of as usize)
    }

    /// Whether this rate gives so few or fewer in less than one of [`DRAWS_PER_FALSE_ALARM`] draws.
    fn is_below(self, rate: f64) -> bool {
        if self.count == self.of {
            return false;
        }
        if rate >= 1.0 {
            return true;
        }
        if rate <= 0.0 {
            return false;
        }
        self.independent().chance_of_so_few(rate) < 1.0 / DRAWS_PER_FALSE_ALARM
    }

    /// How probable it is that this rate gives so few or fewer: the lower tail of the binomial distribution. Its terms are logarithms, because the
    /// first ones of many cases are too small for a number.
    fn chance_of_so_few(self, rate: f64) -> f64 {
        let mut logarithm = self.of as f64 * (1.0 - rate).ln();
        let mut sum = logarithm.exp();
        for count in 0..self.count {
            let next = (self.of - count) as f64 / (count + 1) as f64 * rate / (1.0 - rate);
            logarithm += next.ln();
            sum += logarithm.exp();
        }
        sum
    }
}

/// By how much the variance of the share over these groups is larger than that of as many independent cases.
fn design_effect(groups: &[Rate], share: f64) -> f64 {
    let deviation = |group: &Rate| group.count as f64 - group.of as f64 * share;
    let squares: f64 = groups.iter().map(|group| deviation(group).powi(2)).sum();
    let of: f64 = groups.iter().map(|group| group.of as f64).sum();
    let number = groups.len() as f64;
    let effect = number / (number - 1.0) * squares / (of * share * (1.0 - share));
    // Without scatter, with one group or with none it is no number.
    if effect.is_finite() { effect.clamp(1.0, of) } else { 1.0 }
}

impl fmt::Display for Rate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [min, max] = self.interval().map(|bound| 100.0 * bound);
        write!(f, "{} of {} ({min:.0} to {max:.0} %)", self.count, self.of)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn holds(check: impl FnOnce() + std::panic::UnwindSafe) -> bool {
        std::panic::catch_unwind(check).is_ok()
    }

    /// By the table of the binomial distribution. Of 12 cases at 90 %, 6 or fewer have a chance of 0.0005, 7 or fewer of 0.0043.
    #[test]
    fn a_count_fails_a_bar_only_where_the_rate_gives_it_in_less_than_one_of_1000_draws() {
        let chance = |count, of, rate| Rate::new(count, of).chance_of_so_few(rate);
        assert!((chance(6, 12, 0.9) - 0.000_541).abs() < 1e-6, "{}", chance(6, 12, 0.9));
        assert!((chance(7, 12, 0.9) - 0.004_329).abs() < 1e-6, "{}", chance(7, 12, 0.9));
        assert!((chance(5, 10, 0.5) - 0.623_047).abs() < 1e-6, "{}", chance(5, 10, 0.5));
        assert!(holds(|| Rate::new(7, 12).expect_at_least(0.9, "right")));
        assert!(!holds(|| Rate::new(6, 12).expect_at_least(0.9, "right")));
        assert!(holds(|| Rate::new(5, 12).expect_at_most(0.1, "accused")));
        assert!(!holds(|| Rate::new(6, 12).expect_at_most(0.1, "accused")));
    }

    /// The first terms of 10,000 cases are less than the smallest number.
    #[test]
    fn many_cases_tell_a_small_difference() {
        assert!(holds(|| Rate::new(8_930, 10_000).expect_at_least(0.9, "right")));
        assert!(!holds(|| Rate::new(8_890, 10_000).expect_at_least(0.9, "right")));
        assert!((Rate::new(9_999, 10_000).chance_of_so_few(0.9) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn what_must_always_be_so_fails_with_the_first_case_that_is_not() {
        assert!(holds(|| Rate::new(3, 3).expect_at_least(1.0, "right")));
        assert!(!holds(|| Rate::new(2, 3).expect_at_least(1.0, "right")));
        assert!(holds(|| Rate::new(0, 3).expect_at_most(0.0, "accused")));
        assert!(!holds(|| Rate::new(1, 3).expect_at_most(0.0, "accused")));
        assert!(holds(|| Rate::new(0, 0).expect_at_least(0.9, "nothing was counted")));
    }

    /// By hand: six groups of five, all or nothing, are six cases.
    #[test]
    fn cases_of_one_group_count_for_as_many_as_their_scatter_shows() {
        let groups = |counts: &[usize]| Rate::of_groups(counts.iter().map(|count| Rate::new(*count, 5)));
        let alike = groups(&[5, 5, 5, 0, 0, 0]);
        assert!((alike.design_effect - 6.0).abs() < 1e-9, "{}", alike.design_effect);
        assert_eq!(alike.independent(), Rate::new(3, 5));
        assert!(
            holds(|| alike.expect_at_least(0.8, "right"))
                && !holds(|| Rate::new(15, 30).expect_at_least(0.8, "right"))
        );
        assert!(!holds(|| groups(&[3, 2, 3, 2, 3, 2]).expect_at_least(0.8, "right")));
        assert!(!holds(|| groups(&[0; 6]).expect_at_least(0.8, "right")));
        assert_eq!(groups(&[4]).independent(), Rate::new(4, 5));
        assert_eq!(groups(&[]).interval(), [0.0, 1.0]);
    }

    /// Wilson's interval of 81 of 263 is 25.5 to 36.6 % (Newcombe 1998, table I).
    #[test]
    fn the_interval_is_wilsons() {
        let [min, max] = Rate::new(81, 263).interval();
        assert!((min - 0.2553).abs() < 1e-3 && (max - 0.3662).abs() < 1e-3, "{min} to {max}");
        assert_eq!(Rate::of([true, true, false]).to_string(), "2 of 3 (21 to 94 %)");
    }
}
