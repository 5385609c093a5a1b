//! The smallest deviation of each kind that the bounds of a job notice, and what more runs would change in it.

use super::measures::narrower_with_more;
use super::report::IuReport;
use crate::distribution::{Distribution, Right, range_of};
use crate::job_file::TaughtIu;
use andon_core::verdict::Measure;
use std::fmt;

/// By how much less and by how much more than what was shown is noticed; `None` where nothing is.
type LessAndMore = [Option<f32>; 2];

/// Prints what would be noticed of each IU as a table.
pub(super) fn write(ius: &[IuReport], rate_hz: f32, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    writeln!(f, "what would be noticed: the smallest difference from what was shown, less and more")?;
    writeln!(
        f,
        "step  IU  strokes       seconds        path cm      lateral cm  stroke cm      place cm  degrees"
    )?;
    for iu in ius {
        let Some(cells) = cells(&iu.taught, rate_hz) else { continue };
        let [strokes, seconds, path, lateral, stroke, place, degrees] = cells;
        writeln!(
            f,
            "{:>4}  {:>2}  {strokes:<12}  {seconds:<13}  {path:<11}  {lateral:<10}  {stroke:<13}  {place:<8}  {degrees}",
            iu.activity + 1,
            iu.iu + 1,
        )?;
    }
    Ok(())
}

/// What would be noticed of an IU: strokes, seconds, the length of strokes, place and axis. It has also the length of the path and how far off the
/// straight line it leads. `None` where nothing was measured.
pub(super) fn cells(iu: &TaughtIu, rate_hz: f32) -> Option<[String; 7]> {
    let shown = iu.measures.shown?;
    let right = Right::of(iu, rate_hz);
    let differs = |measure, step: f32| {
        let (_, per) = Distribution::unit(Some(measure));
        let [least, most] = range_of(measure, shown, rate_hz);
        let [min, max] = right.of_measure(measure);
        let differences = [min.map(|min| least - min), max.map(|max| max - most)];
        differences.map(|difference| difference.map(|value| per * (value + step).max(0.0)))
    };
    let most = |measure| right.of_measure(measure)[1].map(|most| Distribution::unit(Some(measure)).1 * most);
    // The first count that is not right is noticed.
    let (stroke, frame) = (0.5, 1.0 / rate_hz);
    let [path_less, path_more] = differs(Measure::Path, 0.0);
    let detour = right.max_detour(Some(Measure::Path)).map(|max| 100.0 * (max - shown.detour_m));
    Some([
        both(differs(Measure::Strokes, stroke), 1),
        both(differs(Measure::Duration, frame), 1),
        both([path_less, detour.or(path_more)], 0),
        both(differs(Measure::LateralDeviation, 0.0), 0),
        both(differs(Measure::StrokeLength, 0.0), 1),
        one(most(Measure::Place), 1),
        one(most(Measure::Direction), 0),
    ])
}

/// How many more runs are offered as a measure of what they bring.
const MORE_RUNS: usize = 5;

/// What a number of runs, all of one kind, could gain by more of them.
pub(super) fn what_more_would_bring(runs: usize, false_alarms: f64) -> String {
    let share = narrower_with_more(runs, MORE_RUNS, false_alarms);
    format!(
        "{MORE_RUNS} more runs like these would bring these bounds {:.0} % nearer to what was shown; runs of other people move them to where \
         people differ",
        100.0 * share
    )
}

fn both([less, more]: LessAndMore, decimals: usize) -> String {
    let words = |sign: &str, value: Option<f32>| value.map(|value| format!("{sign}{value:.decimals$}"));
    let words: Vec<String> = [words("-", less), words("+", more)].into_iter().flatten().collect();
    if words.is_empty() { "any".to_owned() } else { words.join(" ") }
}

fn one(value: Option<f32>, decimals: usize) -> String {
    value.map_or("any".to_owned(), |value| format!("{value:.decimals$}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_core::bounds::{Bounds, Range};
    use andon_core::couple::Context;
    use andon_core::job::{MeasureBounds, Shown};

    #[test]
    fn the_first_count_that_is_not_right_is_noticed_and_lengths_are_told_in_centimetres() {
        let shown = Shown {
            frames: Bounds { min: 30, max: 60 },
            reversals: Bounds { min: 12, max: 13 },
            stroke_m: Range { min: 0.05, max: 0.06 },
            path_m: Range { min: 0.5, max: 0.6 },
            detour_m: 0.1,
            lateral_m: 0.05,
            axis: 0.0,
            place_m: 0.01,
        };
        let path_m = Range { min: 0.25, max: f32::INFINITY };
        let measures = MeasureBounds { path_m, max_detour_m: 0.5, shown: Some(shown), ..MeasureBounds::ANY };
        let iu = TaughtIu {
            context: Context([1, 5, 5, 6]),
            threshold: 0.0,
            frames: Bounds { min: 0, max: 90 },
            reversals: Bounds { min: 11, max: 14 },
            measures,
            shown: None,
            reference: Vec::new(),
            demonstrations: 5,
        };
        let cells = cells(&iu, 30.0);
        let expected = ["-1.0 +1.0", "+1.0", "-25 +40", "any", "any", "any", "any"];
        assert_eq!(cells, Some(expected.map(str::to_owned)));
    }
}
