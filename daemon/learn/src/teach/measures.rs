//! Bounds of the measures of an IU, with a stated rate of false alarms.
//!
//! A bound is a prediction interval of Student's t for what one more execution will measure. It comes from the mean of those shown and their spread,
//! pooled with that of people in general. Lengths are compared by their ratios, because people differ by them.
//!
//! DTW stretches time and forgets size: without measures 4 of 6 strokes were found in 36 %, half the length never. The length of a path
//! depends on where its part lay. So a detour is told by how much longer the path is than the straight way. It was found in 1 of 15 runs of
//! motion capture by the path, and in 15 of 15 by the detour.
//!
//! The spread of the lateral deviation that people are given in general was chosen knowing the runs of motion capture. So these do not test it.

use super::kind::{Strokes, is_on_the_way};
use super::people::{IN_GENERAL, OF_ONE_PERSON, People, beyond_border, border_frames};
use super::sequence::{Agreement, ShownIu};
use super::strength::Strength;
use crate::job_file::{ShownValues, of_runs};
use crate::statistics::{mean, median, pooled_freedom, student_t, variance_of_one_more};
use andon_core::bounds::{Around, Bounds, Range};
use andon_core::job::MeasureBounds;
use andon_core::object::HAND_WIDTH_M;
use andon_core::segment::{MOVED_M, Measures};
use andon_core::verdict::Measure;

/// The bounds of a release state: it lasts until the hand comes back, at once or never.
pub(super) const UNBOUNDED: Bounds = Bounds { min: 0, max: u32::MAX };

/// How people in general differ in the logarithm of the length of a stroke, of a path and of a detour. Also in the number of reversals beside those
/// at the border, in the axis, and in the place in metres. Five simulated people each of three drawn seeds differ so (standard deviation, the median
/// over the IUs of twelve jobs). In brackets are runs of motion capture by one person. Strokes differ by 0.11 to 0.18, paths on the way by 0.04 to
/// 0.11 (0.05) and with strokes by 0.15 to 0.28. Detours differ by 0.02 to 0.10 (0.12) and 0.18 to 0.26, counted reversals by 0 to 0.45 with those at
/// the border. Axes differ by 0.07 to 0.16 (0.24), places by 2 to 8 mm (5 mm).
const PRIOR_STROKE: f64 = 0.15;
pub(super) const PRIOR_PATH: f64 = 0.12;
const PRIOR_DETOUR: f64 = 0.14;
/// How people in general differ at another part where they work by feel and count no strokes. It is in the logarithm: of the time there beside the
/// way in and out, of a path, a detour and the reversals. It is 0.2 to 0.3 in the median of simulated people who do.
pub(super) const PRIOR_BY_FEEL: f64 = 0.3;
/// How people in general differ in how far off the straight line their way leads. It is a share of how far it does and [`HAND_WIDTH_M`]. It is 0.04
/// to 0.07 in the median of simulated people, 0.12 in nine of ten IUs, and 0.11 in motion capture.
const PRIOR_LATERAL: f64 = 0.12;
const PRIOR_REVERSALS: f64 = 0.2;
const PRIOR_AXIS: f64 = 0.15;
const PRIOR_PLACE_M: f64 = 0.008;

/// How often one more right job may break a rule that ends it or calls a step left out. It is rare beside the stated rate of false alarms, of which
/// every pair of parts would take its share. Of 200 jobs it is one.
pub(super) const RARE: f64 = 0.005;

/// Where a hand comes from and where it goes to may make one reversal more of a repeated motion, or one less. The way out of the contact is seen to
/// go back before the contact ends, or only after that. Without it 27 of 70 jobs differ, and 50 faults fewer are found. With two, 7 do, and 1 more
/// fault is found.
const BORDER_REVERSALS: u32 = 1;

/// Strokes are counted if this share of the runs has as many. Who makes five or so by feel makes as many in four of five runs by chance. That is as
/// often as who counts them makes a mistake. With two thirds 1 of 70 jobs differs, with all none, and no verdict.
pub(super) const COUNTED_SHARE: (usize, usize) = (5, 6);

/// Nobody notices a path that is longer by this, in metres. Halved, 1 right run fewer of 435 is accepted, and 1 more fault of 540 found. Doubled, no
/// verdict differs.
const TOLERATED_PATH_M: f64 = 0.05;

/// The share of the job's rate of false alarms for each of the two measures by which people differ much. With these, what is wrong is found only near
/// the limit: strokes half as long, no pause at a part. The five measures without a share of their own have the rest. Counts are whole, so that a
/// stroke less is found at any rate. Halved, 3 more right runs of 435 are accepted, and 4 faults fewer of 540 found. With 0.42, which leaves the
/// others next to nothing, it is 3 faults fewer.
const NEAR_SHARE: f64 = 0.35;

/// The share that a way has that leads too far off the straight line. Halved, 1 right run fewer of 435 is accused. With 0.28 it is 1 more, and 4
/// faults fewer of 540 are found.
const LATERAL_SHARE: f64 = 0.15;

/// How often each measure of an IU may be out of its bounds in a right job. Each measure has a share of the rate of the job, and the IUs
/// that have it share that equally.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rates {
    reversals: f64,
    stroke: f64,
    path: f64,
    lateral: f64,
    axis: f64,
    place: f64,
    duration: f64,
    pace: f64,
    people: People,
}

impl Rates {
    /// For the IUs of a job.
    pub(super) fn new(false_alarms: f64, people: People, agreement: &Agreement) -> Self {
        let rate = |share: f64, has: &dyn Fn(&ShownIu) -> bool| {
            let count = agreement.ius().filter(|iu| iu.context.is_touch() && has(iu)).count();
            false_alarms * share / count.max(1) as f64
        };
        let other = (1.0 - 2.0 * NEAR_SHARE - LATERAL_SHARE) / 5.0;
        Self {
            reversals: rate(other, &|_| true),
            stroke: rate(NEAR_SHARE, &|iu| iu.is_repeated()),
            path: rate(other, &|_| true),
            lateral: rate(LATERAL_SHARE, &|iu| is_on_the_way(iu.context)),
            axis: rate(other, &is_directed),
            place: rate(other, &|iu| iu.context.is_pair()),
            duration: rate(NEAR_SHARE, &|iu| iu.is_timed()),
            pace: rate(other, &|iu| iu.context.is_pair() && iu.is_repeated()),
            people,
        }
    }

    /// The bounds of reversals and of the measures in metres of one IU. `met_within_m` is how near the runs show its two parts to come, 0 where the
    /// station says it. `way` is what they measured at the end of the way that the IU is a part of.
    pub(super) fn bounds(
        &self,
        iu: &ShownIu,
        way: Option<&[Measures]>,
        met_within_m: f32,
        strength: &dyn Fn(Measure) -> Strength,
    ) -> (Bounds, MeasureBounds) {
        let any = MeasureBounds::ANY;
        if !iu.context.is_touch() || self.path <= 0.0 {
            return (UNBOUNDED, any);
        }
        // How strong it is where it is law.
        let law = |measure, has: bool| Some(strength(measure)).filter(|of| has && *of != Strength::NONE);
        let path = law(Measure::Path, true);
        let lateral = way.zip(law(Measure::LateralDeviation, true));
        let bounds = MeasureBounds {
            stroke_m: law(Measure::StrokeLength, iu.is_repeated())
                .map_or(any.stroke_m, |of| self.stroke_m(iu, of)),
            path_m: path.map_or(any.path_m, |of| self.path_m(iu, met_within_m, of)),
            max_detour_m: path.map_or(any.max_detour_m, |of| self.max_detour_m(iu, of)),
            max_lateral_m: lateral.map_or(any.max_lateral_m, |(way, of)| self.max_lateral_m(way, of)),
            axis: law(Measure::Direction, is_directed(iu)).map_or(any.axis, |of| self.axis(iu, of)),
            place_m: law(Measure::Place, iu.context.is_pair())
                .map_or(any.place_m, |of| self.place_m(iu, met_within_m, of)),
            shown: None,
        };
        (self.reversals(iu, strength(Measure::Strokes)), bounds)
    }

    /// How long an IU at another part may last, in frames; `None` for other IUs: somebody may be quick on the way. It has no maximum where a motion
    /// is repeated. Strokes are counted, so that their time tells no more than that nobody makes them so quickly. The maximum leaves no room for a
    /// pause.
    pub(super) fn frames(
        &self,
        iu: &ShownIu,
        rate_hz: f32,
        strength: Strength,
    ) -> Option<(u32, Option<f64>)> {
        let is_timed = iu.is_timed();
        let (prior, rate) =
            if is_timed { (PRIOR_BY_FEEL, self.duration) } else { (IN_GENERAL.sqrt(), self.pace) };
        if !iu.context.is_pair() || rate <= 0.0 {
            return None;
        }
        let border = border_frames(rate_hz);
        let durations: Vec<f64> =
            iu.frames.iter().map(|frames| beyond_border(*frames, border).ln()).collect();
        // Right work is near the minimum only, because of the pause, so the whole rate is there.
        let (centre, apart) = self.interval(&durations, prior, 2.0 * rate, strength);
        let least = (centre - apart).exp();
        // One frame beyond the border may be none. Among people who differ more, the quick ones pass the border more quickly, too.
        let min = if least < 1.0 { 0 } else { (least + border / self.people.variety) as u32 };
        // Who is half as quick takes twice as long for the way.
        Some((min, is_timed.then(|| (centre + apart).exp() + 2.0 * border)))
    }

    fn reversals(&self, iu: &ShownIu, strength: Strength) -> Bounds {
        let likely: Vec<u32> = likely_reversals(&iu.measured).collect();
        // Where not all runs go to and fro, it means nothing that one does.
        if strength == Strength::NONE || !iu.is_repeated() {
            return UNBOUNDED;
        }
        // Who makes strokes by feel contradicts a number.
        if strength != Strength::GENERAL || iu.is_by_feel() {
            return self.by_feel(&likely, strength);
        }
        let usual = usual_reversals(&likely);
        let beyond: Vec<f64> = likely.iter().map(|count| beyond(usual, *count)).collect();
        // How many strokes are right is the same for people who are slow or quick, or make long ones, and for one of them.
        let (centre, apart) =
            interval(&beyond, PRIOR_REVERSALS, self.reversals, People::IN_GENERAL, strength);
        let [less, more] = [(apart - centre).max(0.0) as u32, (apart + centre).max(0.0) as u32];
        // Where the runs show no reversal more or less at the border, others may. A circle has no ends, so that it may have one at each border.
        let border = if usual.min == usual.max || is_round(&iu.measured) { BORDER_REVERSALS } else { 0 };
        let less = less.max(border) + self.uncounted(iu);
        let most = counts(likely.iter().copied()).max;
        Bounds { min: usual.min - less.min(usual.min), max: most.max(usual.max + more.max(border)) }
    }

    /// Where people make strokes by feel. Such an IU divides the rate of its strokes between their number and their length.
    fn by_feel(&self, likely: &[u32], strength: Strength) -> Bounds {
        let logs: Vec<f64> = likely.iter().map(|count| f64::from(count + 1).ln()).collect();
        let (centre, apart) = self.interval(&logs, PRIOR_BY_FEEL, self.stroke / 2.0, strength);
        let [min, max] = [centre - apart, centre + apart].map(|log| log.exp() - 1.0);
        // Half of the strokes are too few, whatever people make by feel.
        let numbers: Vec<f64> = likely.iter().copied().map(f64::from).collect();
        let half = (median(&numbers) / 2.0) as u32 + 1;
        let shown = counts(likely.iter().copied());
        Bounds { min: shown.min.min(half.max(min.ceil() as u32)), max: shown.max.max(max as u32) }
    }

    /// How many reversals are not counted of the shortest strokes that may be right, where people differ more than people in general. The first and
    /// the last stroke begin and end in the middle.
    fn uncounted(&self, iu: &ShownIu) -> u32 {
        let is_short = self.people.differ_more() && self.stroke_m(iu, Strength::GENERAL).min < 2.0 * MOVED_M;
        if is_short { 2 * BORDER_REVERSALS } else { 0 }
    }

    /// The maximum length of a stroke, in metres; `None` where the motion is not a repeated one.
    pub(super) fn longest_stroke_m(&self, iu: &ShownIu) -> Option<f32> {
        (self.stroke > 0.0 && iu.is_repeated()).then(|| self.stroke_m(iu, Strength::GENERAL).max)
    }

    fn stroke_m(&self, iu: &ShownIu, strength: Strength) -> Range {
        let lengths = iu.measured.iter().filter_map(|measures| measures.stroke_m);
        let lengths: Vec<f64> = lengths.map(|length| f64::from(length).ln()).collect();
        let rate = if iu.is_by_feel() { self.stroke / 2.0 } else { self.stroke };
        let (centre, apart) = self.interval(&lengths, PRIOR_STROKE, rate, strength);
        Range { min: (centre - apart).exp() as f32, max: (centre + apart).exp() as f32 }
    }

    /// Two parts that come near each other quickly touch later than two that do so slowly. So it does not matter how little of the way in and out
    /// lies within the contact, unless strokes are made there.
    fn path_m(&self, iu: &ShownIu, met_within_m: f32, strength: Strength) -> Range {
        let length = |measures: &Measures| measures.path_m;
        let [min, max] = self.length_m(iu, &length, (PRIOR_PATH, TOLERATED_PATH_M), self.path, strength);
        let in_and_out_m = if iu.is_repeated() { 0.0 } else { 2.0 * met_within_m };
        Range { min: (min - in_and_out_m).max(0.0), max }
    }

    /// People differ in where a part lies and in how straight they go, and a way can only become longer.
    fn max_detour_m(&self, iu: &ShownIu, strength: Strength) -> f32 {
        let detour = |measures: &Measures| measures.detour_m;
        self.length_m(iu, &detour, (PRIOR_DETOUR, HAND_WIDTH_M.into()), 2.0 * self.path, strength)[1]
    }

    /// From which length to which one is right, in metres: beside what nobody notices, people differ by a factor. They differ more at another part
    /// where they count no strokes.
    fn length_m(
        &self,
        iu: &ShownIu,
        of: &dyn Fn(&Measures) -> f32,
        (prior, stray_m): (f64, f64),
        rate: f64,
        strength: Strength,
    ) -> [f32; 2] {
        let is_uncounted = iu.context.is_pair() && iu.strokes != Strokes::Counted;
        let prior = if is_uncounted { PRIOR_BY_FEEL } else { prior };
        let logs: Vec<f64> =
            iu.measured.iter().map(|measures| (f64::from(of(measures)) + stray_m).ln()).collect();
        let (centre, apart) = self.interval(&logs, prior, rate, strength);
        [centre - apart, centre + apart].map(|log| (log.exp() - stray_m) as f32)
    }

    /// The more a way leads off the straight line, the more people differ in it; and who goes straight does not always do so. They differ by a share of
    /// how far it leads and of [`HAND_WIDTH_M`], as in paths: by 0.04 to 0.07 in the median of simulated people, 0.11 in motion capture.
    fn max_lateral_m(&self, shown: &[Measures], strength: Strength) -> f32 {
        let laterals: Vec<f64> = shown.iter().map(|measures| measures.lateral_m.into()).collect();
        let (centre, apart) = self.interval(
            &laterals,
            PRIOR_LATERAL * (mean(&laterals) + f64::from(HAND_WIDTH_M)),
            2.0 * self.lateral,
            strength,
        );
        (centre + apart) as f32
    }

    fn axis(&self, iu: &ShownIu, strength: Strength) -> Around<2> {
        let axes: Vec<_> = iu.measured.iter().map(|measures| measures.axis).collect();
        self.around(&axes, PRIOR_AXIS, self.axis, strength)
    }

    /// Where the runs show how near two parts come, a part may lie anywhere within that, as on a shelf.
    fn place_m(&self, iu: &ShownIu, met_within_m: f32, strength: Strength) -> Around<3> {
        let places: Vec<_> = iu.measured.iter().map(|measures| measures.place_m).collect();
        let around = self.around(&places, PRIOR_PLACE_M, self.place, strength);
        Around { max: around.max.max(met_within_m), ..around }
    }

    fn interval(&self, values: &[f64], prior: f64, false_alarms: f64, strength: Strength) -> (f64, f64) {
        interval(values, prior, false_alarms, self.people, strength)
    }

    /// The same in the plane or in space: the spread is that of one axis. Where work is done, and in which direction, the job says: people who differ
    /// more in pace, strokes and pauses do not differ more in that. While they did, seven such people of one of nine drawn groups let all that was
    /// rubbed across be right.
    fn around<const N: usize>(
        &self,
        values: &[[f32; N]],
        prior: f64,
        false_alarms: f64,
        strength: Strength,
    ) -> Around<N> {
        let people = People { one_person: self.people.one_person, ..People::IN_GENERAL };
        let axes: [(f64, f64); N] = std::array::from_fn(|axis| {
            let along: Vec<f64> = values.iter().map(|value| f64::from(value[axis])).collect();
            interval(&along, prior, false_alarms, people, strength)
        });
        let apart = axes.iter().map(|(_, apart)| apart.powi(2)).sum::<f64>().sqrt();
        Around { centre: axes.map(|(centre, _)| centre as f32), max: apart as f32 }
    }
}

/// What the demonstrations measured, at the end of their way and of their motion as well.
pub(super) fn what_was_shown(
    iu: &ShownIu,
    way: &[Measures],
    distances: &[f64],
    bounds: &MeasureBounds,
) -> ShownValues {
    let each =
        |of: &dyn Fn(&Measures) -> f32| of_runs(iu.measured.iter().map(|measures| of(measures).into()));
    // Where any direction or place is right there is no centre.
    let from = |max: f32, of: &dyn Fn(&Measures) -> f32| if max.is_finite() { each(of) } else { Vec::new() };
    let MeasureBounds { axis, place_m, .. } = bounds;
    ShownValues {
        frames: of_runs(iu.frames.iter().copied().map(f64::from)),
        reversals: of_runs(likely_reversals(&iu.measured).map(f64::from)),
        stroke_m: of_runs(iu.measured.iter().filter_map(|measures| measures.stroke_m).map(f64::from)),
        path_m: each(&|measures| measures.path_m),
        detour_m: each(&|measures| measures.detour_m),
        lateral_m: of_runs(way.iter().map(|measures| measures.lateral_m.into())),
        axis: from(axis.max, &|measures| axis.distance(measures.axis)),
        place_m: from(place_m.max, &|measures| place_m.distance(measures.place_m)),
        distance: of_runs(distances.iter().copied()),
    }
}

/// The reversals of each demonstration. Where some may have been hidden, as many as bring it nearest to the others. A hand that was not seen for a
/// moment made no fewer strokes.
pub(super) fn likely_reversals(shown: &[Measures]) -> impl Iterator<Item = u32> + Clone {
    let seen: Vec<f64> = shown.iter().map(|measures| f64::from(measures.reversals)).collect();
    let usual = median(&seen) as u32;
    shown.iter().map(move |of| usual.clamp(of.reversals, of.reversals.saturating_add(of.hidden_reversals)))
}

/// The number of reversals of most demonstrations, and the one beside it that others have if there are such. These make as many strokes, and only
/// where the hand comes from or goes to makes one reversal more.
fn usual_reversals(likely: &[u32]) -> Bounds {
    let of = |min: u32| likely.iter().filter(move |count| (min..=min + BORDER_REVERSALS).contains(*count));
    let least = likely.iter().copied().max_by_key(|min| (of(*min).count(), u32::MAX - min));
    counts(of(least.unwrap_or_default()).copied())
}

/// Whether at least this share of the demonstrations have as many reversals, but for one at the border.
pub(super) fn do_agree(likely: &[u32], (share, of): (usize, usize)) -> bool {
    let usual = usual_reversals(likely);
    let agreeing = likely.iter().filter(|count| beyond(usual, **count) == 0.0).count();
    agreeing * of >= likely.len() * share
}

/// The directions of the bench are those of the parts on it only where one part moves along another.
fn is_directed(iu: &ShownIu) -> bool {
    iu.context.is_pair() && iu.measured.iter().all(|measures| measures.path_m >= HAND_WIDTH_M)
}

/// Whether the strokes are circles, or lead up and down, of which the axis does not tell. Its length is 0 for a circle and 1 for a straight line.
fn is_round(shown: &[Measures]) -> bool {
    let along = |measures: &Measures| f64::from(measures.axis[0].hypot(measures.axis[1]));
    mean(&shown.iter().map(along).collect::<Vec<_>>()) < 0.5
}

/// By how many reversals a count is above these bounds, negative if it is below.
fn beyond(usual: Bounds, count: u32) -> f64 {
    f64::from(count.saturating_sub(usual.max)) - f64::from(usual.min.saturating_sub(count))
}

fn counts(values: impl Iterator<Item = u32> + Clone) -> Bounds {
    Bounds { min: values.clone().min().unwrap_or_default(), max: values.max().unwrap_or_default() }
}

/// The share by which the bounds of `runs` runs would be narrower with `more` of them, if these differ as the first ones do.
pub(super) fn narrower_with_more(runs: usize, more: usize, false_alarms: f64) -> f64 {
    let width = |runs: usize| {
        let count = runs.max(1);
        student_t(pooled_freedom(count), false_alarms / 2.0) * (1.0 + 1.0 / count as f64).sqrt()
    };
    1.0 - width(runs + more) / width(runs)
}

/// The centre of these values, and how far from it one more may lie at this rate of false alarms. It may lie farther where a run that was left out
/// has shown that. `prior` is the spread of people in general.
pub(super) fn interval(
    values: &[f64],
    prior: f64,
    false_alarms: f64,
    people: People,
    strength: Strength,
) -> (f64, f64) {
    let People { one_person, variety, freedom } = people;
    let prior = (variety * prior).powi(2);
    let of_many = variance_of_one_more(values, prior);
    // The mean is that person's, from whom another one differs, and both do from time to time.
    let of_one = 2.0 * (1.0 - OF_ONE_PERSON) * prior + variance_of_one_more(values, OF_ONE_PERSON * prior);
    let spread = (of_many + one_person * (of_one - of_many).max(0.0)).sqrt();
    // How much more than others these people differ is as uncertain again.
    let known = 1.0 / (1.0 / pooled_freedom(values.len()) + 1.0 / freedom);
    // Half of them on each side.
    (mean(values), strength.wider() * student_t(known, false_alarms / 2.0) * spread)
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_core::couple::Context;

    const POLISHING: Context = Context([1, 5, 5, 6]);

    /// An IU with its demonstrations, and the rates of a job of people that has no other one.
    fn of_people(people: People, context: Context, shown: &[Measures], frames: &[u32]) -> (Rates, ShownIu) {
        let iu = ShownIu::measuring(context, shown, frames);
        (Rates::new(0.03, people, &Agreement::of_iu(&iu)), iu)
    }

    /// The same, of people as they are in general.
    fn job_of(context: Context, shown: &[Measures], frames: &[u32]) -> (Rates, ShownIu) {
        of_people(People::IN_GENERAL, context, shown, frames)
    }

    #[test]
    fn a_demonstration_in_which_strokes_were_hidden_does_not_make_fewer_strokes_right() {
        let shown =
            |reversals, hidden_reversals| Measures { reversals, hidden_reversals, ..Measures::default() };
        let likely = |shown: &[Measures]| likely_reversals(shown).collect::<Vec<_>>();
        assert_eq!(likely(&[shown(13, 0), shown(9, 5), shown(13, 1), shown(12, 0)]), [13, 12, 13, 12]);
        assert_eq!(likely(&[shown(13, 0), shown(9, 1), shown(13, 1)]), [13, 10, 13]);
        assert_eq!(likely(&[shown(13, 0), shown(7, 0)]), [13, 7]);
    }

    #[test]
    fn strokes_are_counted_where_most_runs_have_as_many() {
        let is_counted = |likely: &[u32]| do_agree(likely, COUNTED_SHARE);
        assert!(is_counted(&[12, 13, 12, 12, 12]) && is_counted(&[13, 15, 13, 12, 13, 13, 13]));
        assert!(!is_counted(&[12, 13, 12, 12, 10]) && !is_counted(&[12, 12, 14]));
    }

    #[test]
    fn a_reversal_more_at_the_border_is_as_many_strokes_and_a_stroke_less_is_not() {
        let bounds_along = |axis: [f32; 2], reversals: &[u32]| {
            let shown: Vec<Measures> = reversals
                .iter()
                .map(|count| Measures { reversals: *count, axis, ..Measures::default() })
                .collect();
            let (rates, iu) = job_of(POLISHING, &shown, &[]);
            let Bounds { min, max } = rates.reversals(&iu, Strength::GENERAL);
            (min, max)
        };
        let bounds = |reversals: &[u32]| bounds_along([-0.9, 0.1], reversals);
        // Six strokes; five have 10 or 11 reversals, seven 14 or 15.
        assert_eq!(bounds(&[13, 13, 13, 13, 13]), (12, 14));
        assert_eq!(bounds(&[13, 12, 13, 12, 13, 13, 13]), (12, 13));
        assert_eq!(bounds_along([0.1, -0.2], &[13, 12, 13, 12, 13, 13, 13]), (11, 14), "circles");
        // Somebody made one stroke more, or half a stroke less.
        assert_eq!(bounds(&[13, 15, 13, 12, 13, 13, 13]), (11, 15));
        // Two runs may show the border, too.
        assert_eq!(bounds(&[12, 13]), (12, 13));
    }

    #[test]
    fn how_little_of_the_way_in_and_out_lies_within_a_contact_does_not_matter_unless_strokes_are_made_there()
    {
        let range = |reversals, met_within_m| {
            let shown = [0.2, 0.22, 0.21, 0.19, 0.2].map(|path_m| Measures {
                path_m,
                reversals,
                ..Measures::default()
            });
            let (rates, iu) = job_of(POLISHING, &shown, &[]);
            let Range { min, max } = rates.path_m(&iu, met_within_m, Strength::GENERAL);
            [min, max].map(|path_m| (100.0 * path_m).round() as i32)
        };
        let [min, max] = range(0, 0.0);
        // Who works by feel there makes half as long a way, or three times as long a one.
        assert!((2..10).contains(&min) && (60..90).contains(&max), "{min} {max}");
        assert_eq!(range(0, 0.01), [min - 2, max]);
        assert_eq!(range(0, 0.3), [0, max]);
        assert_eq!(range(6, 0.3), range(6, 0.0));
    }

    #[test]
    fn strokes_that_are_made_by_feel_may_be_some_more_or_less_and_not_half() {
        let shown = [9, 11, 13, 11, 12].map(|reversals| Measures { reversals, ..Measures::default() });
        let (rates, iu) = job_of(POLISHING, &shown, &[]);
        let Bounds { min, max } = rates.reversals(&iu, Strength::GENERAL);
        assert!((6..=8).contains(&min) && (18..=35).contains(&max), "{min} {max}");
    }

    #[test]
    fn strokes_may_be_quick_but_not_three_times_as_quick_as_shown() {
        let shown = [Measures { reversals: 13, ..Measures::default() }; 7];
        let frames = [120, 150, 135, 160, 128, 142, 155];
        let bounds = |context| {
            let (rates, iu) = job_of(context, &shown, &frames);
            rates.frames(&iu, 30.0, Strength::GENERAL)
        };
        let (min, max) = bounds(POLISHING).unwrap_or_default();
        assert!((140 / 3 + 10..140 * 2 / 3).contains(&min), "{min}");
        assert_eq!(max, None, "strokes are counted");
        // The way may be as quick as it likes.
        assert_eq!(bounds(Context([1, 5, 0, 0])), None);
    }

    #[test]
    fn a_time_at_another_part_is_right_as_people_pause_and_not_without_a_pause() {
        let shown = [Measures::default(); 7];
        let at_meter = Context([1, 6, 6, 3]);
        let bounds = |frames: [u32; 7]| {
            let (rates, iu) = job_of(at_meter, &shown, &frames);
            rates.frames(&iu, 30.0, Strength::GENERAL).unwrap_or_default()
        };
        // A second, less or more. On its way in and out the part is at the meter for a third of a second.
        let (min, max) = bounds([28, 34, 31, 47, 25, 36, 40]);
        assert!((14..20).contains(&min), "{min}");
        assert!(max.is_some_and(|max| (60.0..90.0).contains(&max)), "{max:?}");
        // Who only passes has no pause that could be left out.
        assert_eq!(bounds([5, 6, 5, 7, 6, 5, 6]).0, 0);
    }

    #[test]
    fn who_is_quick_among_people_who_differ_more_passes_the_border_quickly_and_need_not_pause() {
        let shown = [Measures::default(); 7];
        let at_meter = Context([1, 6, 6, 3]);
        let frames = [28, 34, 31, 47, 25, 36, 40];
        let min = |variety| {
            let people = People { variety, ..People::IN_GENERAL };
            let (rates, iu) = of_people(people, at_meter, &shown, &frames);
            rates.frames(&iu, 30.0, Strength::GENERAL).map(|(min, _)| min)
        };
        // On its way in and out the part is at the meter for 6 frames, and for 2 if people differ three times as much.
        assert!(min(1.0).is_some_and(|min| min > 14) && min(3.0).is_some_and(|min| (2..6).contains(&min)));
    }

    #[test]
    fn strokes_that_may_be_so_short_that_half_of_one_is_not_counted_may_have_a_reversal_less_at_either_end() {
        let min = |stroke_m: f32, variety: f64| {
            let shown = [12, 13, 13, 12, 13].map(|reversals| Measures {
                reversals,
                stroke_m: Some(stroke_m),
                axis: [1.0, 0.0],
                ..Measures::default()
            });
            let people = People { variety, ..People::IN_GENERAL };
            let (rates, iu) = of_people(people, POLISHING, &shown, &[]);
            rates.reversals(&iu, Strength::GENERAL).min
        };
        assert_eq!([min(0.07, 1.0), min(0.07, 3.0), min(0.04, 1.0), min(0.2, 3.0)], [12, 10, 12, 12]);
    }

    #[test]
    fn that_people_differ_more_is_uncertain_and_makes_the_bounds_wider_than_as_many_times() {
        let values = [0.1, -0.2, 0.3, -0.1, 0.0, 0.2, -0.3];
        let apart = |prior, variety, freedom| {
            interval(&values, prior, 0.01, People { one_person: 0.0, variety, freedom }, Strength::GENERAL).1
        };
        // The spread is the same, and there are half of 22 degrees of freedom instead of 22.
        let ratio = apart(0.1, 2.0, 22.0) / apart(0.2, 1.0, f64::INFINITY);
        assert!((ratio - student_t(11.0, 0.005) / student_t(22.0, 0.005)).abs() < 1e-9, "{ratio}");
    }

    #[test]
    fn runs_that_differ_as_those_of_many_people_do_are_not_widened_for_one_person_as_if_they_were_alike() {
        let wider = |values: &[f64]| {
            let people = |one_person| People { one_person, ..People::IN_GENERAL };
            let apart = |one_person| interval(values, 0.14, 0.01, people(one_person), Strength::GENERAL).1;
            apart(1.0) / apart(0.0)
        };
        let alike = [0.02, -0.04, 0.06, -0.02, 0.0, 0.04, -0.06];
        let apart = alike.map(|value| 5.0 * value);
        assert!(wider(&alike) > 1.4 && wider(&apart) < 1.3, "{} {}", wider(&alike), wider(&apart));
    }
}
