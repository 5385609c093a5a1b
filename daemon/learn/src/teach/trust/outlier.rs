//! Demonstrations of an IU that are not like the others.
//!
//! Each demonstration is held against all others, so that it cannot hide in a spread that it makes itself. Centre and spread are medians, so that a
//! second one like it does not hide it either. Ratios are compared: a slow person takes longer in every step.

use crate::distribution::{Distribution, PER_STROKE, Right};
use crate::run::{Iu, Run};
use crate::statistics::{deviation, ends, median};
use crate::teach::contact_regions::MAX_REGION_M;
use crate::teach::kind::MIN_REPEATED_REVERSALS;
use crate::teach::measures::{COUNTED_SHARE, PRIOR_PATH, do_agree, likely_reversals};
use crate::teach::options::TeachOptions;
use crate::teach::sequence::{Agreement, MIN_RUNS, Sequence};
use crate::teach::threshold::compared;
use crate::warp::{DistanceMatrix, Warp};
use andon_core::couple::Context;
use andon_core::dtw::Refused;
use andon_core::job::LocalCost;
use andon_core::object::HAND_WIDTH_M;
use andon_core::segment::Measures;
use andon_core::verdict::Measure;

/// From a median absolute deviation to the standard deviation of a normal distribution.
const DEVIATIONS_PER_MEDIAN: f64 = 1.4826;

/// Fewer reversals than this are no strokes that are missing, but noise at the beginning or end of one.
const MIN_REVERSALS: f64 = 4.0;

/// A tracker that loses a part for a moment may add or hide as many reversals, as a share of those of the others. They are beside those that are
/// known to be hidden. Half of the strokes are 7 of 12; one of 600 correct sets is doubted with this share, and with two thirds.
const SEEN_REVERSALS: f64 = 0.8;

/// How demonstrations are compared in one measure.
struct Comparison {
    /// What is compared; `None` is the motion, by the median DTW distance to the other demonstrations.
    measure: Option<Measure>,
    /// A demonstration stands out if it is more than this many spreads away from the centre of the others.
    max_spreads: f64,
    /// Fewer demonstrations than this cannot tell which of them is the odd one.
    min_runs: usize,
    /// The minimum spread of the logarithm: four demonstrations may be alike by chance.
    min_spread: f64,
    /// What is added before the logarithm is taken, because noise is not a share of what is small.
    noise: f64,
    /// How many times as much of it a hidden frame of an IU has as a mean one.
    per_hidden: f64,
}

/// All comparisons; what explains the others comes first. Durations and ways of simulated people differ by 0.05 to 0.2 (standard deviation of the
/// logarithm). The reversals of six strokes differ by 0.03 and their DTW distances by 0.3. Cycles are counted, so that fewer spreads are enough, and
/// two that count alike to find a third. The noise is one reversal, the five frames of a contact, and a hand's width. Of motions it is the distance
/// of two that differ in a frame or two. A part that comes in unseen goes farther than one that is there.
const COMPARISONS: [Comparison; 4] = [
    Comparison::new(Some(Measure::Strokes), (3.2, 3), 0.08, 1.0, 0.0),
    Comparison::new(Some(Measure::Duration), (5.0, MIN_RUNS), 0.15, 0.17, 1.0),
    Comparison::new(Some(Measure::Path), (5.0, MIN_RUNS), 0.15, HAND_WIDTH_M as f64, 2.0),
    Comparison::new(None, (5.0, MIN_RUNS), 0.3, 2.0, 0.0),
];

impl Comparison {
    const fn new(
        measure: Option<Measure>,
        (max_spreads, min_runs): (f64, usize),
        min_spread: f64,
        noise: f64,
        per_hidden: f64,
    ) -> Self {
        Self { measure, max_spreads, min_runs, min_spread, noise, per_hidden }
    }

    /// What was hidden may be of the IU before or behind, and a hand that waits may be about to work. What comes quickly to another part touches it
    /// later. It is as much less, or as much more, as brings the value nearest to the others.
    fn nearest(&self, value: f64, iu: &Iu, others: &[f64], in_and_out_m: f64) -> f64 {
        let seen = 1.0 - self.per_hidden * f64::from(iu.measures.hidden);
        let (waited, uncounted) = match self.measure {
            Some(Measure::Duration) => (f64::from(iu.waited) / f64::from(iu.worked_frames()), 0.0),
            Some(Measure::Path) => (0.0, in_and_out_m),
            _ => (0.0, 0.0),
        };
        median(others).clamp(seen.max(0.0) * value, (1.0 + waited) * value + uncounted)
    }

    /// How far the value of an IU is away from the others, as a share of what is allowed.
    fn exceeds(&self, iu: &Iu, value: f64, others: &[f64], in_and_out_m: f64) -> f64 {
        let value = self.nearest(value, iu, others, in_and_out_m);
        if self.is_noise(iu.context, value, median(others)) {
            return 0.0;
        }
        let log = |value: f64| (value + self.noise).ln();
        let logs: Vec<f64> = others.iter().copied().map(log).collect();
        let centre = median(&logs);
        let spread = match self.measure {
            // Where most do not make the same number of strokes, how they differ shows how people do who make them by feel.
            Some(Measure::Strokes) if !do_most_agree(value, others) => deviation(&logs, 1).hypot(PRIOR_PATH),
            _ => {
                let deviations: Vec<f64> = logs.iter().map(|log| (log - centre).abs()).collect();
                (DEVIATIONS_PER_MEDIAN * median(&deviations)).hypot(self.min_spread)
            }
        };
        (log(value) - centre).abs() / (self.max_spreads * spread)
    }

    /// Whether it says nothing that the value differs from this centre of the others.
    fn is_noise(&self, context: Context, value: f64, centre: f64) -> bool {
        match self.measure {
            Some(Measure::Strokes) => {
                let [few, many] = [value.min(centre), value.max(centre)];
                many - few < MIN_REVERSALS || few >= SEEN_REVERSALS * many
            }
            // Nobody is too much like the others.
            None => value < centre,
            // Somebody may be quick on the way.
            Some(Measure::Duration) => value < centre && !context.is_pair(),
            Some(_) => false,
        }
    }
}

/// Whether two of three demonstrations make as many strokes. Then the others are exceptions, though they be two.
fn do_most_agree(count: f64, others: &[f64]) -> bool {
    let counts: Vec<u32> = others.iter().chain([&count]).map(|count| *count as u32).collect();
    do_agree(&counts, (2, 3))
}

/// Whether a count of reversals contradicts what the others prove. They prove the number that they make, or that half of it is too few, whatever
/// people make by feel. Who repeats no motion proves no number: of 210 sets of work by feel 9 were refused because one run had two reversals more
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
    /// In what it stands out; `None` is its motion.
    pub measure: Option<Measure>,
    /// Its value: in seconds, reversals or metres, or the median DTW distance to the others.
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
        let per = if self.measure == Some(Measure::Strokes) { PER_STROKE.into() } else { 1.0 };
        Distribution::among(
            self.measure,
            self.others.iter().map(|other| other / per),
            self.value / per,
            right,
        )
    }

    /// Where and how far it stands out, for a sentence about its run. `words` puts a context into words.
    pub(in crate::teach) fn figures(&self, words: &dyn Fn(Context) -> String) -> String {
        let [least, most] = ends(&self.others);
        let figures = match self.measure {
            Some(Measure::Duration) => {
                format!("takes {:.1} s, the others {least:.1} to {most:.1} s", self.value)
            }
            Some(Measure::Strokes) => {
                format!("reverses its motion {} times, the others {least} to {most} times", self.value)
            }
            Some(_) => {
                let [way, least, most] = [self.value, least, most].map(|metres| 100.0 * metres);
                format!("has a way of {way:.0} cm, the others of {least:.0} to {most:.0} cm")
            }
            None => format!(
                "has distance {:.1} to the others, which have {least:.1} to {most:.1} to each other",
                self.value
            ),
        };
        let place = format!("step {}, IU {}", self.activity + 1, self.iu + 1);
        format!("in {place} ({}) it {figures}", words(self.context))
    }
}

/// The demonstrations that stand out, at most one per run: the one that stands out most, and a pause only if there is no other.
pub(super) fn of_runs(
    runs: &[Run],
    agreement: &Agreement,
    options: &TeachOptions,
) -> Result<Vec<Outlier>, Refused> {
    // What is like what does not depend on the cost by which the job is judged.
    let mut warp = Warp::new(LocalCost::Circular { bins: options.method.bins });
    let mut found: Vec<(usize, f64, Outlier)> = Vec::new();
    for sequence in &agreement.sequences {
        for (index, iu) in sequence.ius.iter().enumerate() {
            // How long a release state lasts says nothing about the work.
            if iu.context.is_touch() {
                of_iu(runs, sequence, index, options, &mut warp, &mut found)?;
            }
        }
    }
    found.sort_by(|one, other| {
        let order = |(run, _, outlier): &(usize, f64, Outlier)| (*run, outlier.is_pause);
        order(one).cmp(&order(other)).then(other.1.total_cmp(&one.1))
    });
    found.dedup_by_key(|(run, ..)| *run);
    Ok(found.into_iter().map(|(.., outlier)| outlier).collect())
}

/// Adds the demonstrations of one IU that stand out, each with its run and with how far.
fn of_iu(
    runs: &[Run],
    sequence: &Sequence,
    index: usize,
    options: &TeachOptions,
    warp: &mut Warp,
    found: &mut Vec<(usize, f64, Outlier)>,
) -> Result<(), Refused> {
    let shown: Vec<(usize, &Iu)> = sequence.ius[index].ius(runs).collect();
    let motions: Vec<_> = shown.iter().map(|(_, iu)| compared(iu, options)).collect();
    let distances = warp.matrix(&motions)?;
    let in_and_out_m = in_and_out_m(sequence.contexts[index], &sequence.ius[index].measured);
    for comparison in COMPARISONS.iter().filter(|comparison| shown.len() >= comparison.min_runs) {
        let measure = comparison.measure;
        let values = values(measure, options.method.rate_hz, &shown);
        for (at, &(run, iu)) in shown.iter().enumerate() {
            let (value, mut others) = left_out(measure, &values, &distances, at);
            let share = comparison.exceeds(iu, value, &others, in_and_out_m);
            if share > 1.0 {
                others.sort_by(f64::total_cmp);
                let [min, max] = ends(&others);
                let is_number = measure != Some(Measure::Strokes) || contradicts_number(value, &others);
                let outlier = Outlier {
                    run: runs[run].name.clone(),
                    activity: sequence.activity,
                    iu: index,
                    context: iu.context,
                    measure,
                    value,
                    is_pause: measure == Some(Measure::Duration)
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
    Ok(())
}

/// How much of the way in and out may not lie within the contact of an IU with these demonstrations, in metres. None where most make strokes.
fn in_and_out_m(context: Context, shown: &[Measures]) -> f64 {
    let reversals: Vec<f64> = shown.iter().map(|measures| f64::from(measures.reversals)).collect();
    let is_repeated = median(&reversals) as u32 >= MIN_REPEATED_REVERSALS;
    // The widest contact that is learnt ends at half as much again as the widest place.
    if context.is_pair() && !is_repeated { 2.0 * 1.5 * f64::from(MAX_REGION_M) } else { 0.0 }
}

/// The value of each demonstration; those of the distance depend on which one is left out.
fn values(measure: Option<Measure>, rate_hz: f32, shown: &[(usize, &Iu)]) -> Vec<f64> {
    let ius = shown.iter().map(|(_, iu)| iu);
    match measure {
        Some(Measure::Duration) => ius.map(|iu| f64::from(iu.worked_frames()) / f64::from(rate_hz)).collect(),
        // What was hidden may have been strokes, but not at any pace: a gap in half of the strokes would hide the other half.
        Some(Measure::Strokes) => {
            let at_pace = |of: &Measures| Measures { hidden_reversals: of.hidden_reversals_at_pace(), ..*of };
            let measures: Vec<Measures> = ius.map(|iu| at_pace(&iu.measures)).collect();
            likely_reversals(&measures).map(f64::from).collect()
        }
        Some(_) => ius.map(|iu| iu.measures.path_m.into()).collect(),
        None => vec![0.0; shown.len()],
    }
}

/// The value of the demonstration at this place, and those that the others have without it.
fn left_out(
    measure: Option<Measure>,
    values: &[f64],
    distances: &DistanceMatrix,
    at: usize,
) -> (f64, Vec<f64>) {
    let others = (0..values.len()).filter(|&other| other != at);
    if measure.is_some() {
        return (values[at], others.map(|other| values[other]).collect());
    }
    let to_others = |from: usize| {
        let others = (0..values.len()).filter(|&other| other != at && other != from);
        median(&others.map(|other| distances.get(from, other)).collect::<Vec<_>>())
    };
    (to_others(at), others.map(to_others).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const POLISHING: [u16; 4] = [1, 5, 5, 6];
    const STROKES: &Comparison = &COMPARISONS[0];
    const DURATION: &Comparison = &COMPARISONS[1];
    const PATH: &Comparison = &COMPARISONS[2];

    fn iu(context: [u16; 4], hidden: f32) -> Iu {
        let measures = Measures { hidden, ..Measures::default() };
        Iu { context: Context(context), measures, ..Iu::default() }
    }

    #[test]
    fn what_was_hidden_or_waited_of_an_iu_does_not_make_it_longer_or_shorter_than_others() {
        let iu = |hidden| iu(POLISHING, hidden);
        let others = [0.04, 0.05, 0.06];
        let exceeds = |hidden| PATH.exceeds(&iu(hidden), 0.3, &others, 0.0);
        assert!(exceeds(0.0) > 1.0 && exceeds(0.4) < 0.5);
        let waits = Iu { frames: 150, waited: 120, ..iu(0.0) };
        let nearest = |others: [f64; 3]| DURATION.nearest(1.0, &waits, &others, 0.0);
        assert_eq!([nearest([0.5; 3]), nearest([3.0; 3]), nearest([9.0; 3])], [1.0, 3.0, 5.0]);
        // A way that is too short was not made so by what was hidden of it.
        assert_eq!(PATH.nearest(0.01, &iu(0.4), &others, 0.0), 0.01);
    }

    #[test]
    fn a_short_way_within_a_contact_says_nothing_unless_most_make_strokes_there() {
        let in_and_out_m = |context: [u16; 4], reversals: [u32; 3]| {
            let shown = reversals.map(|reversals| Measures { reversals, ..Measures::default() });
            in_and_out_m(Context(context), &shown)
        };
        assert_eq!(in_and_out_m([1, 5, 0, 0], [0; 3]), 0.0);
        assert_eq!(in_and_out_m(POLISHING, [0, 6, 7]), 0.0, "one has left them out");
        let within_m = in_and_out_m(POLISHING, [0, 4, 1]);
        let exceeds = |way_m: f64| {
            PATH.exceeds(&iu(POLISHING, 0.0), 0.02, &[way_m, way_m + 0.01, way_m + 0.02], within_m)
        };
        assert!(exceeds(0.3) < 0.5 && exceeds(1.2) > 1.0);
    }

    #[test]
    fn who_makes_strokes_by_feel_is_no_exception_and_who_leaves_half_of_them_out_is() {
        let exceeds =
            |value: f64, others: [f64; 4]| STROKES.exceeds(&iu(POLISHING, 0.0), value, &others, 0.0) > 1.0;
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
        let exceeds = |context| DURATION.exceeds(&iu(context, 0.0), 0.3, &[2.0; 4], 0.0) > 1.0;
        assert!(exceeds(POLISHING) && !exceeds([1, 5, 0, 0]));
    }
}
