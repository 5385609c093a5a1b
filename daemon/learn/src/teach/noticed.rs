//! The smallest deviation of each kind that the bounds of a job notice, and what more runs would change in it.

use super::iu_report::IuReport;
use super::measures::narrower_with_more;
use andon_core::bounds::{Bounds, Range};
use andon_core::job::Shown;
use std::fmt;

/// How many more runs are offered as a measure of what they bring.
const MORE_RUNS: usize = 5;

/// By how much less and by how much more than what was shown is noticed; `None` where nothing is.
type LessAndMore = [Option<f32>; 2];

/// What would be noticed of each IU. `Display` prints it as a table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Noticed<'a> {
    pub(super) ius: &'a [IuReport],
    pub(super) rate_hz: f32,
}

impl fmt::Display for Noticed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "what would be noticed: the smallest difference from what was shown, less and more")?;
        writeln!(
            f,
            "step  IU  strokes       seconds        path cm      bow cm  stroke cm      place cm  degrees"
        )?;
        self.ius.iter().try_for_each(|iu| self.line(iu, f))
    }
}

impl Noticed<'_> {
    fn line(&self, iu: &IuReport, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(cells) = self.cells(iu) else { return Ok(()) };
        let [strokes, seconds, path, bow, stroke, place, degrees] = cells;
        writeln!(
            f,
            "{:>4}  {:>2}  {strokes:<12}  {seconds:<13}  {path:<11}  {bow:<6}  {stroke:<13}  {place:<8}  {degrees}",
            iu.activity + 1,
            iu.iu + 1,
        )
    }

    /// What would be noticed of an IU: strokes, seconds, the length of the path and how far off the
    /// straight line it leads, the length of strokes, place and axis. `None` where nothing was
    /// measured.
    pub(super) fn cells(&self, iu: &IuReport) -> Option<[String; 7]> {
        let bounds = &iu.measures;
        let Shown { frames, reversals, stroke_m, path_m, detour_m, bow_m, .. } = bounds.shown?;
        let strokes = counts(reversals, iu.reversals).map(|count| count.map(|count| count / 2.0));
        let seconds = counts(frames, iu.frames).map(|count| count.map(|count| count / self.rate_hz));
        let off = |bound: f32| bound.is_finite().then_some(bound);
        let [path_less, _] = lengths(path_m, bounds.path_m);
        // An axis is that of twice the angle.
        let degrees = off(bounds.axis.max).map(|max| (max / 2.0).min(1.0).asin().to_degrees());
        Some([
            both(strokes, 1),
            both(seconds, 1),
            both([path_less, off(bounds.max_detour_m - detour_m).map(centimetres)], 0),
            both([None, off(bounds.max_bow_m - bow_m).map(centimetres)], 0),
            both(lengths(stroke_m, bounds.stroke_m), 1),
            one(off(bounds.place_m.max).map(centimetres), 1),
            one(degrees, 0),
        ])
    }
}

/// What a number of runs, all of one kind, could gain by more of them.
pub(super) fn what_more_would_bring(runs: usize, false_alarms: f64) -> String {
    let share = narrower_with_more(runs, MORE_RUNS, false_alarms);
    format!(
        "{MORE_RUNS} more runs like these would bring these bounds {:.0} % nearer to what was shown; runs of other people move them to where \
         people differ",
        100.0 * share
    )
}

fn counts(shown: Bounds, right: Bounds) -> LessAndMore {
    let less = (right.min > 0).then(|| (shown.min + 1).saturating_sub(right.min));
    let more = (right.max < u32::MAX).then(|| (right.max + 1).saturating_sub(shown.max));
    [less, more].map(|count| count.map(|count| count as f32))
}

/// In centimetres.
fn lengths(shown: Range, right: Range) -> LessAndMore {
    let less = (right.min > 0.0).then(|| (shown.min - right.min).max(0.0));
    let more = right.max.is_finite().then(|| (right.max - shown.max).max(0.0));
    [less, more].map(|metres| metres.map(centimetres))
}

fn centimetres(metres: f32) -> f32 {
    100.0 * metres
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

    #[test]
    fn the_smallest_difference_is_the_first_count_that_is_not_right() {
        let bounds = |min, max| Bounds { min, max };
        assert_eq!(counts(bounds(12, 13), bounds(11, 14)), [Some(2.0), Some(2.0)]);
        assert_eq!(counts(bounds(0, 1), bounds(0, 3)), [None, Some(3.0)]);
        assert_eq!(counts(bounds(0, 1), bounds(0, u32::MAX)), [None, None]);
    }

    #[test]
    fn a_length_is_told_in_centimetres_less_and_more() {
        let range = |min, max| Range { min, max };
        let text = both(lengths(range(0.5, 0.6), range(0.25, 1.0)), 0);
        assert_eq!(text, "-25 +40");
        assert_eq!(both(lengths(range(0.5, 0.6), range(0.0, f32::INFINITY)), 0), "any");
    }
}
