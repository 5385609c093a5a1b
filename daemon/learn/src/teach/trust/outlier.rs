//! Demonstrations of an IU that are not like the others.
//!
//! Each demonstration is held against all others, so that it cannot hide in a spread that it makes itself. Centre and spread are medians, so that a
//! second one like it does not hide it either. Ratios are compared: a slow person takes longer in every step.

use crate::distribution::{Distribution, PER_STROKE, Right};
use crate::run::{Iu, Run};
use crate::statistics::{deviation, ends, median};
use crate::teach::kind::MIN_REPEATED_REVERSALS;
use crate::teach::measures::{COUNTED_SHARE, PRIOR_PATH, do_agree, likely_reversals};
use crate::teach::options::TeachOptions;
use crate::teach::sequence::{Agreement, MIN_RUNS, Sequence};
use andon_core::couple::Context;
use andon_core::segment::Measures;
use andon_core::verdict::Measure;

/// From a median absolute deviation to the standard deviation of a normal distribution.
const DEVIATIONS_PER_MEDIAN: f64 = 1.4826;

/// Fewer reversals than this are no strokes that are missing, but noise at the beginning or end of one. Halved or doubled, the reports on 6 or 2 of
/// 70 sets differ.
const MIN_REVERSALS: f64 = 4.0;

/// A tracker that loses a part for a moment may add or hide as many reversals, as a share of those of the others. They are beside those that are
/// known to be hidden. Half of the strokes are 7 of 12; one of 600 correct sets is doubted with this share, and with two thirds.
const SEEN_REVERSALS: f64 = 0.8;

/// How demonstrations are compared in one measure.
struct Comparison {
    measure: Measure,
    /// A demonstration stands out if it is more than this many spreads away from the centre of the others.
    max_spreads: f64,
    /// Fewer demonstrations than this cannot tell which of them is the odd one.
    min_runs: usize,
    /// The minimum spread of the logarithm: four demonstrations may be alike by chance.
    min_spread: f64,
    /// What is added before the logarithm is taken, because noise is not a share of what is small.
    noise: f64,
}

/// All comparisons; what explains the others comes first. Durations of simulated people differ by 0.05 to 0.2 (standard deviation of the logarithm),
/// and the reversals of six strokes by 0.03. Cycles are counted, so that fewer spreads are enough, and two that count alike to find a third. The
/// noise is one reversal, and the five frames of a contact. Of 70 sets 5 or 1 have another report with half or twice the spreads of strokes, 25 or 3
/// with those of durations. It is none with another minimum spread of strokes, and 10 or 3 of durations.
const COMPARISONS: [Comparison; 2] = [
    Comparison { measure: Measure::Strokes, max_spreads: 3.2, min_runs: 3, min_spread: 0.08, noise: 1.0 },
    Comparison {
        measure: Measure::Duration,
        max_spreads: 5.0,
        min_runs: MIN_RUNS,
        min_spread: 0.15,
        noise: 0.17,
    },
];

impl Comparison {
    /// What was hidden may be of the IU before or behind, and a hand that waits may be about to work. It is as much less, or as much more, as brings
    /// the value nearest to the others.
    fn nearest(&self, value: f64, iu: &Iu, others: &[f64]) -> f64 {
        if self.measure == Measure::Strokes {
            return value;
        }
        let seen = 1.0 - f64::from(iu.measures.hidden);
        let waited = f64::from(iu.waited) / f64::from(iu.worked_frames());
        median(others).clamp(seen.max(0.0) * value, (1.0 + waited) * value)
    }

    /// How far the value of an IU is away from the others, as a share of what is allowed.
    fn exceeds(&self, iu: &Iu, value: f64, others: &[f64]) -> f64 {
        let value = self.nearest(value, iu, others);
        if self.is_noise(iu.context, value, median(others)) {
            return 0.0;
        }
        let log = |value: f64| (value + self.noise).ln();
        let logs: Vec<f64> = others.iter().copied().map(log).collect();
        let centre = median(&logs);
        // Where most do not make the same number of strokes, how they differ shows how people do who make them by feel.
        let spread = if self.measure == Measure::Strokes && !do_most_agree(value, others) {
            deviation(&logs, 1).hypot(PRIOR_PATH)
        } else {
            let deviations: Vec<f64> = logs.iter().map(|log| (log - centre).abs()).collect();
            (DEVIATIONS_PER_MEDIAN * median(&deviations)).hypot(self.min_spread)
        };
        (log(value) - centre).abs() / (self.max_spreads * spread)
    }

    /// Whether it says nothing that the value differs from this centre of the others.
    fn is_noise(&self, context: Context, value: f64, centre: f64) -> bool {
        if self.measure == Measure::Strokes {
            let [few, many] = [value.min(centre), value.max(centre)];
            return many - few < MIN_REVERSALS || few >= SEEN_REVERSALS * many;
        }
        // Somebody may be quick on the way.
        value < centre && !context.is_pair()
    }
}

/// Whether two of three demonstrations make as many strokes. Then the others are exceptions, though they be two.
fn do_most_agree(count: f64, others: &[f64]) -> bool {
    let counts: Vec<u32> = others.iter().chain([&count]).map(|count| *count as u32).collect();
    do_agree(&counts, (2, 3))
}

/// Whether a count of reversals contradicts what the others prove. They prove the number that they make, or that half of it is too few, whatever
/// people make by feel. Who repeats no motion proves no number. Of 210 sets of work by feel 9 were refused because one run had two reversals more
/// there.
fn contradicts_number(count: f64, others: &[f64]) -> bool {
    let counts: Vec<u32> = others.iter().map(|count| *count as u32).collect();
    if counts.iter().any(|count| *count < MIN_REPEATED_REVERSALS) {
        return false;
    }
    do_agree(&counts, COUNTED_SHARE) || count <= median(others) / 2.0 + 1.0
}

/// A demonstration of one IU that stands out.
#[derive(Clone, Debug, PartialEq)]
pub struct Outlier {
    /// The run's name.
    pub run: String,
    /// Index of the activity in the job, from 0.
    pub activity: u16,
    /// Index of the IU in the activity, from 0.
    pub iu: usize,
    /// The context of the IU.
    pub context: Context,
    /// In what it stands out: in strokes or in its duration.
    pub measure: Measure,
    /// Its value, in reversals or in seconds.
    pub value: f64,
    /// Those of the others, sorted.
    pub others: Vec<f64>,
    /// It only lasts longer than most, and longer than all others by no more than a pause that is no anomaly.
    pub is_pause: bool,
    /// The others make a law of it, which would be another one with it: strokes and time at another part.
    pub is_law_of_others: bool,
}

impl Outlier {
    /// Where it lies among the others, beside what the job that was taught says is right of the IU.
    pub(in crate::teach) fn distribution(&self, right: Option<Right<'_>>) -> Distribution {
        let per = if self.measure == Measure::Strokes { PER_STROKE.into() } else { 1.0 };
        Distribution::among(
            Some(self.measure),
            self.others.iter().map(|other| other / per),
            self.value / per,
            right,
        )
    }

    /// Where and how far it stands out, for a sentence about its run. `words` puts a context into words.
    pub(in crate::teach) fn figures(&self, words: &dyn Fn(Context) -> String) -> String {
        let [least, most] = ends(&self.others);
        let figures = if self.measure == Measure::Strokes {
            format!("reverses its motion {} times, the others {least} to {most} times", self.value)
        } else {
            format!("takes {:.1} s, the others {least:.1} to {most:.1} s", self.value)
        };
        let place = format!("step {}, IU {}", self.activity + 1, self.iu + 1);
        format!("in {place} ({}) it {figures}", words(self.context))
    }
}

/// The demonstrations that stand out, at most one per run. It is the one that stands out most, and a pause only if there is no other.
pub(super) fn of_runs(runs: &[Run], agreement: &Agreement, options: &TeachOptions) -> Vec<Outlier> {
    let mut found: Vec<(usize, f64, Outlier)> = Vec::new();
    for sequence in &agreement.sequences {
        for (index, iu) in sequence.ius.iter().enumerate() {
            // How long a release state lasts says nothing about the work.
            if iu.context.is_touch() {
                of_iu(runs, sequence, index, options, &mut found);
            }
        }
    }
    found.sort_by(|one, other| {
        let order = |(run, _, outlier): &(usize, f64, Outlier)| (*run, outlier.is_pause);
        order(one).cmp(&order(other)).then(other.1.total_cmp(&one.1))
    });
    found.dedup_by_key(|(run, ..)| *run);
    found.into_iter().map(|(.., outlier)| outlier).collect()
}

/// Adds the demonstrations of one IU that stand out, each with its run and with how far.
fn of_iu(
    runs: &[Run],
    sequence: &Sequence,
    index: usize,
    options: &TeachOptions,
    found: &mut Vec<(usize, f64, Outlier)>,
) {
    let shown: Vec<(usize, &Iu)> = sequence.ius[index].ius(runs).collect();
    for comparison in COMPARISONS.iter().filter(|comparison| shown.len() >= comparison.min_runs) {
        let measure = comparison.measure;
        let values = values(measure, options.method.rate_hz, &shown);
        for (at, &(run, iu)) in shown.iter().enumerate() {
            let mut others = values.clone();
            let value = others.remove(at);
            let share = comparison.exceeds(iu, value, &others);
            if share > 1.0 {
                others.sort_by(f64::total_cmp);
                let [min, max] = ends(&others);
                let is_number = measure != Measure::Strokes || contradicts_number(value, &others);
                let outlier = Outlier {
                    run: runs[run].name.clone(),
                    activity: sequence.activity,
                    iu: index,
                    context: iu.context,
                    measure,
                    value,
                    is_pause: measure == Measure::Duration
                        && (median(&others)..=max + options.bounds.pause_s).contains(&value),
                    others,
                    // What the runs have only in part in common is in pieces, and what lies between others contradicts none of them.
                    is_law_of_others: iu.context.is_pair()
                        && !sequence.allows_insertions
                        && !(min < value && value < max)
                        && is_number,
                };
                found.push((run, share, outlier));
            }
        }
    }
}

/// The value of each demonstration.
fn values(measure: Measure, rate_hz: f32, shown: &[(usize, &Iu)]) -> Vec<f64> {
    let ius = shown.iter().map(|(_, iu)| iu);
    if measure == Measure::Duration {
        return ius.map(|iu| f64::from(iu.worked_frames()) / f64::from(rate_hz)).collect();
    }
    // What was hidden may have been strokes, but not at any pace: a gap in half of the strokes would hide the other half.
    let at_pace = |of: &Measures| Measures { hidden_reversals: of.hidden_reversals_at_pace(), ..*of };
    let measures: Vec<Measures> = ius.map(|iu| at_pace(&iu.measures)).collect();
    likely_reversals(&measures).map(f64::from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const POLISHING: [u16; 4] = [1, 5, 5, 6];
    const STROKES: &Comparison = &COMPARISONS[0];
    const DURATION: &Comparison = &COMPARISONS[1];

    fn iu(context: [u16; 4], hidden: f32) -> Iu {
        let measures = Measures { hidden, ..Measures::default() };
        Iu { context: Context(context), measures, ..Iu::default() }
    }

    #[test]
    fn what_was_hidden_or_waited_of_an_iu_does_not_make_it_longer_or_shorter_than_others() {
        let iu = |hidden| iu(POLISHING, hidden);
        let exceeds = |hidden| DURATION.exceeds(&iu(hidden), 8.0, &[1.9, 2.0, 2.1]);
        assert!(exceeds(0.0) > 1.0 && exceeds(0.7) < 0.5);
        let waits = Iu { frames: 150, waited: 120, ..iu(0.0) };
        let nearest = |others: [f64; 3]| DURATION.nearest(1.0, &waits, &others);
        assert_eq!([nearest([0.5; 3]), nearest([3.0; 3]), nearest([9.0; 3])], [1.0, 3.0, 5.0]);
        // A time that is too short was not made so by what was hidden of it.
        assert_eq!(DURATION.nearest(0.5, &iu(0.4), &[1.9, 2.0, 2.1]), 0.5);
    }

    #[test]
    fn who_makes_strokes_by_feel_is_no_exception_and_who_leaves_half_of_them_out_is() {
        let exceeds =
            |value: f64, others: [f64; 4]| STROKES.exceeds(&iu(POLISHING, 0.0), value, &others) > 1.0;
        assert!(exceeds(7.0, [13.0; 4]) && exceeds(7.0, [13.0, 12.0, 15.0, 13.0]));
        assert!(!exceeds(11.0, [7.0, 7.0, 11.0, 7.0]) && !exceeds(7.0, [9.0, 11.0, 11.0, 11.0]));
    }

    #[test]
    fn a_count_contradicts_only_a_number_that_is_proven() {
        assert!(contradicts_number(7.0, &[12.0; 4]) && contradicts_number(14.0, &[12.0; 4]));
        assert!(!contradicts_number(5.0, &[1.0, 1.0, 1.0, 2.0]), "nobody repeats a motion");
    }

    #[test]
    fn who_is_quick_stands_out_only_where_the_time_shows_what_was_done() {
        let exceeds = |context| DURATION.exceeds(&iu(context, 0.0), 0.3, &[2.0; 4]) > 1.0;
        assert!(exceeds(POLISHING) && !exceeds([1, 5, 0, 0]));
    }
}
