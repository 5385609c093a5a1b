//! What the runs showed of a measure, and where one more execution lies among them: whoever knows the work sees by it whether an accusation is
//! right. The line of text, the picture of a page and the fields for programs come from the same [`Distribution`].

use crate::analysis::Svg;
use crate::html::escaped;
use crate::job_file::{JobFile, ShownValues, TaughtIu};
use andon_core::bounds::Bounds;
use andon_core::job::{MeasureBounds, Shown};
use andon_core::verdict::{Level, Measure, Outcome, Reason, Verdict};
use std::fmt;

/// Characters of the scale in a line of text. With its words the line has about a hundred.
const COLUMNS: usize = 36;

/// What the signs in a line of text mean.
pub const LEGEND: &str =
    "X is this run, | a run that was shown and a digit so many, = a range, [ ] what is right";

/// Between the ends of the scale and those of the row there is room for a bound, and for what lies beyond it.
const MARGIN: usize = 2;

/// A bound is drawn if it lies this near to what was shown and measured, as a share of their span. Others would press these together.
const NEAR: f32 = 0.5;

/// Two reversals are a stroke.
const PER_STROKE: f32 = 2.0;

/// A verdict and a job are about the same IU if the ranges that were shown are as near as this: counts of strokes to half of one, all others as they
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
    /// The bounds in force.
    pub right: [Option<f32>; 2],
    /// Of the length of a path: how much longer than the straight way it may be, which decides instead of a maximum.
    pub max_detour: Option<f32>,
    /// What this execution measured.
    pub value: f32,
}

impl Distribution {
    /// That on which a verdict on an IU rests that is not right, if it rests on a measure or on its motion.
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
        let Some(iu) = iu_of(job, verdict, measure.zip(range)) else {
            let (shown, right) = (Vec::new(), [None; 2]);
            return Some(Self { measure, runs: 0, shown, range: range?, right, max_detour: None, value });
        };
        let shown = iu.shown.as_ref().map(|shown| values_of(measure, shown, rate_hz)).unwrap_or_default();
        let right = Right::of(iu, rate_hz);
        Some(Self {
            measure,
            runs: iu.demonstrations as usize,
            range: shown.first().zip(shown.last()).map(|(min, max)| [*min, *max]).or(range)?,
            shown,
            right: measure.map_or([None, verdict.threshold], |measure| right.of_measure(measure)),
            max_detour: right.max_detour(measure),
            value,
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
        let [min, max] = [shown.first(), shown.last()].map(|end| end.copied().unwrap_or_default());
        Self {
            measure,
            runs: shown.len(),
            range: [min, max],
            shown,
            right: right.zip(measure).map_or([None; 2], |(right, measure)| right.of_measure(measure)),
            max_detour: right.and_then(|right| right.max_detour(measure)),
            value: value as f32,
        }
    }

    /// Its name.
    pub(crate) const fn name(measure: Option<Measure>) -> &'static str {
        match measure {
            None => "motion",
            Some(Measure::Duration) => "duration",
            Some(Measure::Strokes) => "strokes",
            Some(Measure::StrokeLength) => "stroke length",
            Some(Measure::Path) => "path length",
            Some(Measure::Bow) => "bow",
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

    /// What is right, in words; nothing where anything is.
    fn right_words(&self) -> Option<String> {
        let number = |value: f32| format!("{}{}", self.number(value), self.unit().0);
        let bounds = match self.right {
            [Some(min), Some(max)] if min == max => Some(number(min)),
            [Some(min), Some(max)] => Some(format!("{} to {}", self.number(min), number(max))),
            [Some(min), None] => Some(format!("{} or more", number(min))),
            [None, Some(max)] => Some(format!("up to {}", number(max))),
            [None, None] => None,
        };
        let detour = self.max_detour.map(|max| format!("a detour of up to {}", number(max)));
        let right: Vec<String> = bounds.into_iter().chain(detour).collect();
        (!right.is_empty()).then(|| format!("right is {}", right.join(" and ")))
    }

    /// Where it lies, and what is right.
    fn words(&self) -> String {
        [self.place()].into_iter().chain(self.right_words()).collect::<Vec<_>>().join("; ")
    }

    /// The unit as people read it behind a number, and how many of it the verdict's unit is.
    const fn unit(&self) -> (&'static str, f32) {
        match self.measure {
            Some(Measure::Duration) => (" s", 1.0),
            Some(Measure::StrokeLength | Measure::Path | Measure::Bow | Measure::Place) => (" cm", 100.0),
            Some(Measure::Direction) => (" degrees", 1.0),
            Some(Measure::Strokes) | None => ("", 1.0),
        }
    }

    /// A number for people: as exact as the span of all of them needs, and strokes as they are counted.
    fn number(&self, value: f32) -> String {
        let (_, factor) = self.unit();
        let [least, most] = self.ends().map(|end| factor * end);
        let decimals = match most - least {
            _ if self.measure == Some(Measure::Strokes) => return value.to_string(),
            30.0.. => 0,
            3.0.. => 1,
            _ => 2,
        };
        format!("{:.decimals$}", factor * value)
    }

    /// The ends of the scale: all that was shown and measured, and the bounds that are near that.
    fn ends(&self) -> [f32; 2] {
        let [min, max] = self.range;
        let (least, most) = (min.min(self.value), max.max(self.value));
        let room = NEAR * (most - least);
        let [lower, upper] = self.right;
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

    /// The scale in characters that every font has: `|` is a run, a digit so many of them, `=` what was shown where the runs are not known, `[` and
    /// `]` are the bounds and `X` is this execution.
    fn row(&self) -> String {
        let last = COLUMNS - 1 - 2 * MARGIN;
        let column =
            |value: f32| self.share(value).map(|share| MARGIN + (share * last as f32).round() as usize);
        let mut row = vec![b'-'; COLUMNS];
        if let (true, Some(from), Some(to)) =
            (self.shown.is_empty(), column(self.range[0]), column(self.range[1]))
        {
            row[from..=to].fill(b'=');
        }
        for at in self.shown.iter().filter_map(|value| column(*value)) {
            row[at] = match row[at] {
                b'-' => b'|',
                b'|' => b'2',
                b'9' => b'+',
                b'+' => b'+',
                digit => digit + 1,
            };
        }
        let [lower, upper] = self.right.map(|bound| bound.and_then(column));
        lower.into_iter().for_each(|at| row[at - 1] = b'[');
        upper.into_iter().for_each(|at| row[at + 1] = b']');
        // It is on the same side of a bound here as it is in truth.
        let [is_less, is_more] = [
            self.right[0].is_some_and(|least| self.value < least),
            self.right[1].is_some_and(|most| self.value > most),
        ];
        let at = column(self.value).unwrap_or(MARGIN);
        let at = match (lower, upper) {
            (Some(bound), _) if is_less => at.min(bound - MARGIN),
            (_, Some(bound)) if is_more => at.max(bound + MARGIN),
            _ => at,
        };
        row[at] = b'X';
        row.into_iter().map(char::from).collect()
    }

    /// The same as a strip for a page: a tick is a run, the shaded part is right, and the cross is this execution. Its words are beneath it.
    pub(crate) fn html(&self) -> String {
        let [left, right, width] = [60.0, 340.0, 420.0];
        let [top, middle, bottom] = [3.0, 14.0, 25.0];
        let mut svg = Svg::new(width, 28.0, &self.to_string());
        let at = |value: f32| self.share(value).map(|share| left + f64::from(share) * (right - left));
        let [lower, upper] = self.right.map(|bound| bound.and_then(at));
        let [from, to] = [lower.unwrap_or(left), upper.unwrap_or(right)];
        svg.add(format_args!(
            "<rect class=\"h\" opacity=\".25\" x=\"{from:.1}\" y=\"{top}\" width=\"{:.1}\" height=\"{:.1}\"/>",
            to - from,
            bottom - top
        ));
        svg.line("a", [left, middle], [right, middle]);
        for bound in [lower, upper].into_iter().flatten() {
            svg.line("a", [bound, top], [bound, bottom]);
        }
        if let (true, Some(from), Some(to)) = (self.shown.is_empty(), at(self.range[0]), at(self.range[1])) {
            svg.line("b", [from, middle], [to, middle]);
        }
        for tick in self.shown.iter().filter_map(|value| at(*value)) {
            svg.line("b", [tick, top + 4.0], [tick, bottom - 4.0]);
        }
        let x = at(self.value).unwrap_or(left);
        for rise in [-6.0, 6.0] {
            svg.line("o", [x - 6.0, middle - rise], [x + 6.0, middle + rise]);
        }
        let [least, most] = self.ends().map(|end| self.number(end));
        svg.text(left - 10.0, middle + 4.0, "e", &least);
        svg.text(right + 10.0, middle + 4.0, "", &format!("{most}{}", self.unit().0));
        let name = Self::name(self.measure);
        format!(
            "<figure>{}<figcaption>{name}: {}</figcaption></figure>",
            svg.finish(),
            escaped(&self.words())
        )
    }
}

impl fmt::Display for Distribution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [least, most] = self.ends().map(|end| self.number(end));
        let (name, unit) = (Self::name(self.measure), self.unit().0);
        write!(f, "{name}: {least} {} {most}{unit}; {}", self.row(), self.words())
    }
}

impl<'a> Right<'a> {
    fn of(iu: &'a TaughtIu, rate_hz: f32) -> Self {
        Self { frames: iu.frames, reversals: iu.reversals, measures: &iu.measures, rate_hz }
    }

    /// The bounds of a measure; `None` where there is none.
    pub(crate) fn of_measure(&self, measure: Measure) -> [Option<f32>; 2] {
        let counts = |Bounds { min, max }: Bounds, per: f32| {
            [(min > 0).then_some(min), (max < u32::MAX).then_some(max)]
                .map(|bound| bound.map(|count| count as f32 / per))
        };
        let lengths = |min: f32, max: f32| [(min > 0.0).then_some(min), max.is_finite().then_some(max)];
        let MeasureBounds { stroke_m, path_m, max_bow_m, axis, place_m, .. } = *self.measures;
        match measure {
            Measure::Duration => counts(self.frames, self.rate_hz),
            Measure::Strokes => counts(self.reversals, PER_STROKE),
            Measure::StrokeLength => lengths(stroke_m.min, stroke_m.max),
            Measure::Path if self.measures.max_detour_m.is_finite() => lengths(path_m.min, f32::INFINITY),
            Measure::Path => lengths(path_m.min, path_m.max),
            Measure::Bow => lengths(0.0, max_bow_m),
            Measure::Direction => {
                lengths(0.0, if axis.max.is_finite() { degrees(axis.max) } else { axis.max })
            }
            Measure::Place => lengths(0.0, place_m.max),
        }
    }

    fn max_detour(&self, measure: Option<Measure>) -> Option<f32> {
        Some(self.measures.max_detour_m).filter(|max| measure == Some(Measure::Path) && max.is_finite())
    }
}

/// The IU of the job that a verdict is about; where its measure was shown from a minimum to a maximum, one of which the job says that as well.
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

/// From the minimum to the maximum that was shown.
pub(crate) fn range_of(measure: Measure, shown: Shown, rate_hz: f32) -> [f32; 2] {
    let Shown { frames, reversals, stroke_m, path_m, bow_m, axis, place_m, .. } = shown;
    match measure {
        Measure::Duration => [frames.min, frames.max].map(|frames| frames as f32 / rate_hz),
        Measure::Strokes => [reversals.min, reversals.max].map(|count| count as f32 / PER_STROKE),
        Measure::StrokeLength => [stroke_m.min, stroke_m.max],
        Measure::Path => [path_m.min, path_m.max],
        Measure::Bow => [0.0, bow_m],
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
        Some(Measure::Bow) => shown.bow_m.clone(),
        Some(Measure::Direction) => each(&shown.axis, &degrees),
        Some(Measure::Place) => shown.place_m.clone(),
    }
}

/// The angle of a path to another one, from the distance of their axes: that is the chord of twice the angle.
pub(crate) fn degrees(distance: f32) -> f32 {
    (distance / 2.0).min(1.0).asin().to_degrees()
}
