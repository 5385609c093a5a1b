//! What the runs showed of a measure, and where one more execution lies among them. Whoever knows the work sees by it whether an accusation is right.
//! The line of text, the picture of a page and the fields for programs come from the same [`Distribution`].

use crate::html::escaped;
use crate::job_file::{JobFile, ShownValues, TaughtIu};
use crate::statistics::ends;
use crate::svg::Svg;
use andon_core::bounds::Bounds;
use andon_core::job::{MeasureBounds, Shown};
use andon_core::verdict::{Level, Measure, Outcome, Reason, Verdict};
use std::fmt;

/// Characters of the scale in a line of text. With its words the line has about a hundred.
const COLUMNS: usize = 36;

/// What the signs in a line of text mean.
pub const LEGEND: &str =
    "X is this run, | a run that was shown and a digit so many, = a range, [ ] what is right";

/// What a strip on a page shows.
pub(crate) const STRIP: &str = "How to read a strip: a tick is a run that was shown, with the number of runs where several are alike. \
     The shaded part is right, and the cross is the run that the sentence is about.";

/// Between the ends of the scale and those of the row there is room for a bound, and for what lies beyond it.
const MARGIN: usize = 2;

/// A bound is drawn if it lies this near to what was shown and measured, as a share of their span. Others would press these together.
const NEAR: f32 = 0.5;

/// Two reversals are a stroke.
pub(crate) const PER_STROKE: f32 = 2.0;

/// A verdict and a job are about the same IU if the ranges that were shown are as near as this. Counts of strokes to half of one, all others as they
/// are kept.
const SAME: f32 = 1e-3;

/// What is right of an IU.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Right<'a> {
    pub(crate) frames: Bounds,
    pub(crate) reversals: Bounds,
    pub(crate) measures: &'a MeasureBounds,
    pub(crate) rate_hz: f32,
}

/// One measure of an execution beside what the runs showed of it, in the unit of the verdicts: s, strokes, m or degrees.
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution {
    /// What was measured; `None` is how far the motion is from the learned one.
    pub measure: Option<Measure>,
    /// The number of runs that show it; 0 where that is not known.
    pub runs: usize,
    /// What these measured, sorted; empty where only its range is known.
    pub shown: Vec<f32>,
    /// The minimum and the maximum of that.
    pub range: [f32; 2],
    /// The bounds in force, each if there is one; `None` where they are not known.
    pub right: Option<[Option<f32>; 2]>,
    /// Of the length of a path: how much longer than the straight way it may be, which decides instead of a maximum.
    pub max_detour: Option<f32>,
    /// What this execution measured.
    pub value: f32,
}

impl Distribution {
    /// That on which a verdict on an IU depends that is not right, if it is a measure or its motion.
    pub fn of_verdict(job: &JobFile, verdict: &Verdict) -> Option<Self> {
        if verdict.level != Level::Iu || verdict.outcome == Outcome::Ok {
            return None;
        }
        let rate_hz = job.method.rate_hz;
        let (measure, value, range) = match (verdict.measured, verdict.reason) {
            (Some(of), _) => (Some(of.measure), of.value, Some([of.shown_min, of.shown_max])),
            (None, Reason::Motion) => (None, verdict.distance?, None),
            _ => return None,
        };
        let iu = iu_of(job, verdict, measure.zip(range));
        let shown = iu.and_then(|iu| iu.shown.as_ref());
        let shown = shown.map(|shown| values_of(measure, shown, rate_hz)).unwrap_or_default();
        let right = iu.map(|iu| Right::of(iu, rate_hz));
        let bounds =
            right.map(|right| measure.map_or([None, verdict.threshold], |measure| right.of_measure(measure)));
        Some(Self {
            measure,
            runs: iu.map_or(0, |iu| iu.demonstrations as usize),
            range: shown.first().zip(shown.last()).map(|(min, max)| [*min, *max]).or(range)?,
            shown,
            right: bounds,
            max_detour: right.and_then(|right| right.max_detour(measure)),
            value: match bounds.filter(|_| measure == Some(Measure::Strokes)) {
                Some(bounds) => with_half(value, bounds),
                None => value,
            },
        })
    }

    /// Where a value lies among those of other runs, which are sorted.
    pub(crate) fn among(
        measure: Option<Measure>,
        others: impl Iterator<Item = f64>,
        value: f64,
        right: Option<Right<'_>>,
    ) -> Self {
        let shown: Vec<f32> = others.map(|other| other as f32).collect();
        Self {
            measure,
            runs: shown.len(),
            range: ends(&shown),
            shown,
            right: right.zip(measure).map(|(right, measure)| right.of_measure(measure)),
            max_detour: right.and_then(|right| right.max_detour(measure)),
            value: value as f32,
        }
    }

    pub(crate) const fn name(measure: Option<Measure>) -> &'static str {
        match measure {
            None => "motion",
            Some(Measure::Duration) => "duration",
            Some(Measure::Strokes) => "strokes",
            Some(Measure::StrokeLength) => "stroke length",
            Some(Measure::Path) => "path length",
            Some(Measure::LateralDeviation) => "lateral deviation",
            Some(Measure::Direction) => "direction",
            Some(Measure::Place) => "place",
        }
    }

    /// Where this execution lies among those shown, in words.
    pub fn place(&self) -> String {
        let Self { value, runs, range: [min, max], shown, .. } = self;
        let all = match runs {
            0 => "than was shown".to_owned(),
            1 => "than the one shown".to_owned(),
            runs => format!("than all {runs} shown"),
        };
        if value > max {
            return format!("more {all}");
        } else if value < min {
            return format!("less {all}");
        }
        let count = |is_so: &dyn Fn(&f32) -> bool| shown.iter().filter(|other| is_so(other)).count();
        match (count(&|other| other < value), count(&|other| other > value)) {
            _ if shown.is_empty() => "within what was shown".to_owned(),
            (0, 0) => "as all shown".to_owned(),
            (less, more) if shown.len() == *runs => {
                format!("more than {less} and less than {more} of the {runs} shown")
            }
            (less, _) => {
                format!(
                    "more than about {:.0} % of the {runs} shown",
                    100.0 * less as f32 / shown.len() as f32
                )
            }
        }
    }

    /// What is right, in words, if it is known.
    fn right_words(&self) -> Option<String> {
        let number = |value: f32| format!("{}{}", self.number(value), Self::unit(self.measure).0);
        let bounds = match self.right? {
            [Some(min), Some(max)] if min == max => Some(number(min)),
            [Some(min), Some(max)] => Some(format!("{} to {}", self.number(min), number(max))),
            [Some(min), None] => Some(format!("{} or more", number(min))),
            [None, Some(max)] => Some(format!("up to {}", number(max))),
            [None, None] => None,
        };
        let detour = self.max_detour.map(|max| format!("a detour of up to {}", number(max)));
        let right: Vec<String> = bounds.into_iter().chain(detour).collect();
        Some(if right.is_empty() {
            "any is right".to_owned()
        } else {
            format!("right is {}", right.join(" and "))
        })
    }

    fn words(&self) -> String {
        [self.place()].into_iter().chain(self.right_words()).collect::<Vec<_>>().join("; ")
    }

    /// The unit as people read it behind a number, and how many of it the verdict's unit is.
    pub(crate) const fn unit(measure: Option<Measure>) -> (&'static str, f32) {
        match measure {
            Some(Measure::Duration) => (" s", 1.0),
            Some(Measure::StrokeLength | Measure::Path | Measure::LateralDeviation | Measure::Place) => {
                (" cm", 100.0)
            }
            Some(Measure::Direction) => (" degrees", 1.0),
            Some(Measure::Strokes) | None => ("", 1.0),
        }
    }

    /// A number for people: as exact as the span of all of them needs, and strokes as they are counted.
    fn number(&self, value: f32) -> String {
        let (_, factor) = Self::unit(self.measure);
        let [least, most] = self.ends().map(|end| factor * end);
        let decimals = match most - least {
            _ if self.measure == Some(Measure::Strokes) => return value.to_string(),
            30.0.. => 0,
            3.0.. => 1,
            _ => 2,
        };
        format!("{:.decimals$}", factor * value)
    }

    fn bounds(&self) -> [Option<f32>; 2] {
        self.right.unwrap_or_default()
    }

    /// The ends of the scale: all that was shown and measured, and the bounds that are near that.
    fn ends(&self) -> [f32; 2] {
        let [min, max] = self.range;
        let (least, most) = (min.min(self.value), max.max(self.value));
        let room = NEAR * (most - least);
        let [lower, upper] = self.bounds();
        let lower = lower.filter(|lower| *lower >= least - room).map_or(least, |lower| lower.min(least));
        let upper = upper.filter(|upper| *upper <= most + room).map_or(most, |upper| upper.max(most));
        [lower, upper]
    }

    /// Where a value lies between the ends of the scale, 0 to 1; `None` beyond them.
    fn share(&self, value: f32) -> Option<f32> {
        let [least, most] = self.ends();
        let share = if most > least { (value - least) / (most - least) } else { 0.5 };
        (0.0..=1.0).contains(&share).then_some(share)
    }

    fn column(&self, value: f32) -> Option<usize> {
        let last = (COLUMNS - 1 - 2 * MARGIN) as f32;
        self.share(value).map(|share| MARGIN + (share * last).round() as usize)
    }

    /// What was shown, divided by the columns in which it lies.
    fn stacks(&self) -> impl Iterator<Item = &[f32]> {
        self.shown.chunk_by(|one, next| self.column(*one) == self.column(*next))
    }

    /// The range that was shown, where nothing more is known.
    fn only_range(&self) -> Option<[f32; 2]> {
        self.shown.is_empty().then_some(self.range)
    }

    /// The scale in characters that every font has, see [`LEGEND`].
    fn row(&self) -> String {
        let column = |value: f32| self.column(value);
        let mut row = vec!['-'; COLUMNS];
        if let Some([Some(from), Some(to)]) = self.only_range().map(|range| range.map(column)) {
            row[from..=to].fill('=');
        }
        for stack in self.stacks() {
            let sign = match stack.len() {
                1 => '|',
                count => char::from_digit(count as u32, 10).unwrap_or('+'),
            };
            column(stack[0]).into_iter().for_each(|at| row[at] = sign);
        }
        let [lower, upper] = self.bounds().map(|bound| bound.and_then(column));
        lower.into_iter().for_each(|at| row[at - 1] = '[');
        upper.into_iter().for_each(|at| row[at + 1] = ']');
        // It is on the same side of a bound here as it is in truth.
        let is_less = self.bounds()[0].is_some_and(|least| self.value < least);
        let is_more = self.bounds()[1].is_some_and(|most| self.value > most);
        let at = column(self.value).unwrap_or(MARGIN);
        let at = match (lower, upper) {
            (Some(bound), _) if is_less => at.min(bound - MARGIN),
            (_, Some(bound)) if is_more => at.max(bound + MARGIN),
            _ => at,
        };
        row[at] = 'X';
        row.into_iter().collect()
    }

    /// The same as a strip for a page, with its words beneath, which begin with these.
    pub(crate) fn html(&self, begin: &str) -> String {
        let [left, right, width] = [60.0, 340.0, 420.0];
        let [top, middle, bottom] = [3.0, 14.0, 25.0];
        let mut svg = Svg::new(width, 38.0, &self.to_string());
        let at = |value: f32| self.share(value).map(|share| left + f64::from(share) * (right - left));
        let bounds = self.bounds().map(|bound| bound.and_then(at));
        let [from, to] = [bounds[0].unwrap_or(left), bounds[1].unwrap_or(right)];
        let shade = if self.right.is_some() { 0.25 } else { 0.0 };
        svg.add(format_args!(
            "<rect class=\"h\" opacity=\"{shade}\" x=\"{from:.1}\" y=\"{top}\" width=\"{:.1}\" height=\"{:.1}\"/>",
            to - from,
            bottom - top
        ));
        svg.line("a", [left, middle], [right, middle]);
        bounds.into_iter().flatten().for_each(|at| svg.line("a", [at, top], [at, bottom]));
        if let Some([Some(from), Some(to)]) = self.only_range().map(|range| range.map(at)) {
            svg.line("b", [from, middle], [to, middle]);
        }
        for stack in self.stacks() {
            stack
                .iter()
                .copied()
                .filter_map(at)
                .for_each(|at| svg.line("b", [at, top + 4.0], [at, bottom - 4.0]));
            if let (2.., Some(at)) = (stack.len(), at(stack[stack.len() / 2])) {
                svg.text(at, 36.0, "s m", &stack.len().to_string());
            }
        }
        let x = at(self.value).unwrap_or(left);
        for rise in [-6.0, 6.0] {
            svg.line("o", [x - 6.0, middle - rise], [x + 6.0, middle + rise]);
        }
        let [least, most] = self.ends().map(|end| self.number(end));
        svg.text(left - 10.0, middle + 4.0, "e", &least);
        svg.text(right + 10.0, middle + 4.0, "", &format!("{most}{}", Self::unit(self.measure).0));
        let words = escaped(&format!("{begin}{}: {}", Self::name(self.measure), self.words()));
        format!("<figure>{}<figcaption>{words}</figcaption></figure>", svg.finish())
    }
}

impl fmt::Display for Distribution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [least, most] = self.ends().map(|end| self.number(end));
        let (name, unit) = (Self::name(self.measure), Self::unit(self.measure).0);
        write!(f, "{name}: {least} {} {most}{unit}; {}", self.row(), self.words())
    }
}

impl<'a> Right<'a> {
    pub(crate) fn of(iu: &'a TaughtIu, rate_hz: f32) -> Self {
        Self { frames: iu.frames, reversals: iu.reversals, measures: &iu.measures, rate_hz }
    }

    pub(crate) fn of_measure(&self, measure: Measure) -> [Option<f32>; 2] {
        let counts = |Bounds { min, max }: Bounds, per: f32| {
            [(min > 0).then_some(min), (max < u32::MAX).then_some(max)]
                .map(|bound| bound.map(|count| count as f32 / per))
        };
        let lengths = |min: f32, max: f32| [(min > 0.0).then_some(min), max.is_finite().then_some(max)];
        let MeasureBounds { stroke_m, path_m, max_lateral_m, axis, place_m, .. } = *self.measures;
        match measure {
            Measure::Duration => counts(self.frames, self.rate_hz),
            Measure::Strokes => counts(self.reversals, PER_STROKE),
            Measure::StrokeLength => lengths(stroke_m.min, stroke_m.max),
            Measure::Path if self.measures.max_detour_m.is_finite() => lengths(path_m.min, f32::INFINITY),
            Measure::Path => lengths(path_m.min, path_m.max),
            Measure::LateralDeviation => lengths(0.0, max_lateral_m),
            Measure::Direction => {
                lengths(0.0, if axis.max.is_finite() { degrees(axis.max) } else { axis.max })
            }
            Measure::Place => lengths(0.0, place_m.max),
        }
    }

    /// How much longer than the straight way a path may be; `None` of other measures.
    pub(crate) fn max_detour(&self, measure: Option<Measure>) -> Option<f32> {
        Some(self.measures.max_detour_m).filter(|max| measure == Some(Measure::Path) && max.is_finite())
    }
}

/// The IU of the job that a verdict is about. Where its measure was shown from a minimum to a maximum, one of which the job says that as well.
fn iu_of<'a>(
    job: &'a JobFile,
    verdict: &Verdict,
    shown: Option<(Measure, [f32; 2])>,
) -> Option<&'a TaughtIu> {
    let step = job.activities.iter().filter(|taught| Some(taught.activity) == verdict.nearest);
    let ius = step.flat_map(|taught| taught.ius.iter().enumerate());
    // Either hand may do it.
    let parts = |context: andon_core::couple::Context| [context.0[1], context.0[2], context.0[3]];
    let is_it = |iu: &TaughtIu| {
        let of_job = |(measure, said): (Measure, [f32; 2])| {
            let near = if measure == Measure::Strokes { 1.0 / PER_STROKE } else { SAME };
            let range = iu.measures.shown.map(|shown| range_of(measure, shown, job.method.rate_hz));
            range.is_some_and(|range| range.iter().zip(said).all(|(one, other)| (one - other).abs() <= near))
        };
        parts(iu.context) == parts(verdict.context) && shown.is_none_or(of_job)
    };
    // What was skipped or came in between shifts the numbers.
    let is_elsewhere = |index: usize| verdict.iu.map(usize::from) != Some(index);
    ius.filter(|(_, iu)| is_it(iu)).min_by_key(|(index, _)| is_elsewhere(*index)).map(|(_, iu)| iu)
}

/// The strokes of an IU that has too few or too many of them. A verdict does not tell a half that makes no difference to what was shown, but to what
/// is right it may.
fn with_half(strokes: f32, right: [Option<f32>; 2]) -> f32 {
    let half = 1.0 / PER_STROKE;
    match right {
        [Some(least), _] if strokes < least => strokes,
        [_, Some(most)] if strokes <= most => most + half,
        _ => strokes,
    }
}

/// From the minimum to the maximum that was shown.
pub(crate) fn range_of(measure: Measure, shown: Shown, rate_hz: f32) -> [f32; 2] {
    let Shown { frames, reversals, stroke_m, path_m, lateral_m, axis, place_m, .. } = shown;
    match measure {
        Measure::Duration => [frames.min, frames.max].map(|frames| frames as f32 / rate_hz),
        Measure::Strokes => [reversals.min, reversals.max].map(|count| count as f32 / PER_STROKE),
        Measure::StrokeLength => [stroke_m.min, stroke_m.max],
        Measure::Path => [path_m.min, path_m.max],
        Measure::LateralDeviation => [0.0, lateral_m],
        Measure::Direction => [0.0, degrees(axis)],
        Measure::Place => [0.0, place_m],
    }
}

/// What the runs showed of a measure; of the distance of the motion without one.
fn values_of(measure: Option<Measure>, shown: &ShownValues, rate_hz: f32) -> Vec<f32> {
    let each = |values: &[f32], of: &dyn Fn(f32) -> f32| values.iter().copied().map(of).collect();
    match measure {
        None => shown.distance.clone(),
        Some(Measure::Duration) => each(&shown.frames, &|frames| frames / rate_hz),
        Some(Measure::Strokes) => each(&shown.reversals, &|count| count / PER_STROKE),
        Some(Measure::StrokeLength) => shown.stroke_m.clone(),
        Some(Measure::Path) => shown.path_m.clone(),
        Some(Measure::LateralDeviation) => shown.lateral_m.clone(),
        Some(Measure::Direction) => each(&shown.axis, &degrees),
        Some(Measure::Place) => shown.place_m.clone(),
    }
}

/// The angle of a path to another one, from the distance of their axes: that is the chord of twice the angle.
pub(crate) fn degrees(distance: f32) -> f32 {
    (distance / 2.0).min(1.0).asin().to_degrees()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use andon_core::bounds::Range;

    /// Strokes of nine runs of which eight are alike, beside these.
    fn strokes(value: f64, right: Bounds) -> Distribution {
        let measures = MeasureBounds::ANY;
        let right = Right { frames: right, reversals: right, measures: &measures, rate_hz: 30.0 };
        let others = [4.5, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0, 6.0];
        Distribution::among(Some(Measure::Strokes), others.into_iter(), value, Some(right))
    }

    #[test]
    fn a_line_has_each_run_the_bounds_and_this_run_on_a_scale_and_says_its_place() {
        let line = strokes(3.0, Bounds { min: 9, max: 13 }).to_string();
        let expected =
            "strokes: 3 --X-----------[|-------------8----]- 6.5; less than all 9 shown; right is 4.5 to 6.5";
        assert_eq!(line, expected);
    }

    #[test]
    fn what_is_out_of_a_bound_stands_beyond_it_however_near_it_is() {
        let right = Bounds { min: 0, max: 200 };
        let row = |value| strokes(value, right).row();
        assert!(row(100.5).ends_with("]X") && row(100.0).ends_with("X]-"), "{}\n{}", row(100.5), row(100.0));
        let right = Bounds { min: 8, max: u32::MAX };
        assert!(strokes(3.99, right).row().starts_with("X["), "{}", strokes(3.99, right).row());
    }

    #[test]
    fn a_bound_that_is_far_away_is_told_and_not_drawn() {
        let far = strokes(3.0, Bounds { min: 9, max: 400 });
        assert!(!far.row().contains(']') && far.to_string().ends_with("right is 4.5 to 200"), "{far}");
    }

    #[test]
    fn its_place_is_said_by_how_many_are_less_and_more() {
        let place = |value| strokes(value, Bounds { min: 9, max: 13 }).place();
        assert_eq!(place(7.0), "more than all 9 shown");
        assert_eq!(place(5.0), "more than 1 and less than 8 of the 9 shown");
        let one = Distribution { runs: 1, ..strokes(7.0, Bounds { min: 9, max: 13 }) };
        assert_eq!(one.place(), "more than the one shown");
        let some_of_many = Distribution { runs: 90, ..strokes(5.0, Bounds { min: 9, max: 13 }) };
        assert_eq!(some_of_many.place(), "more than about 11 % of the 90 shown");
        let mut alike = strokes(6.0, Bounds { min: 9, max: 13 });
        (alike.shown, alike.range, alike.runs) = (vec![6.0; 3], [6.0; 2], 3);
        assert_eq!(alike.place(), "as all shown");
        assert_eq!(alike.row().matches(['X', '3']).count(), 1, "{alike}");
    }

    #[test]
    fn where_the_runs_are_not_known_their_range_is_shown() {
        let known = strokes(3.0, Bounds { min: 9, max: 13 });
        let range = Distribution { shown: Vec::new(), ..known };
        assert!(range.row().contains("X-----------[===============----]"), "{range}");
        assert!(range.to_string().contains("; less than all 9 shown; right is 4.5 to 6.5"), "{range}");
        assert_eq!(Distribution { value: 5.0, ..range }.place(), "within what was shown");
    }

    #[test]
    fn a_strip_says_in_words_what_it_shows() {
        let strip = strokes(3.0, Bounds { min: 9, max: 13 });
        let html = strip.html("run <1>, ");
        assert!(html.contains(&format!("<title>{strip}</title>")), "{html}");
        assert!(
            html.contains(
                "<figcaption>run &lt;1&gt;, strokes: less than all 9 shown; right is 4.5 to 6.5</figcaption>"
            ),
            "{html}"
        );
        // Nine runs, of which eight lie in one place, and the two strokes of the cross.
        assert_eq!((html.matches("class=\"b\"").count(), html.matches("class=\"o\"").count()), (9, 2));
        assert!(html.contains("class=\"t s m\">8</text>"), "{html}");
    }

    #[test]
    fn half_a_stroke_that_is_too_much_is_told() {
        let right = [Some(2.0), Some(6.0)];
        assert_eq!([1.0, 6.0, 6.5, 7.0].map(|strokes| with_half(strokes, right)), [1.0, 6.5, 6.5, 7.0]);
        assert_eq!(with_half(1.0, [None, Some(1.0)]), 1.5);
    }

    #[test]
    fn a_path_is_told_by_the_detour_where_that_decides_and_lengths_in_centimetres() {
        let measures =
            MeasureBounds { path_m: Range { min: 0.2, max: 0.6 }, max_detour_m: 0.095, ..MeasureBounds::ANY };
        let any = Bounds { min: 0, max: u32::MAX };
        let right = Right { frames: any, reversals: any, measures: &measures, rate_hz: 30.0 };
        let lies = Distribution::among(Some(Measure::Path), [0.31, 0.42].into_iter(), 0.5, Some(right));
        assert_eq!(
            lies.words(),
            "more than all 2 shown; right is 20.0 cm or more and a detour of up to 9.5 cm"
        );
        assert_eq!(right.of_measure(Measure::Duration), [None, None]);
    }
}
