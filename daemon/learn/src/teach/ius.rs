//! The IUs of the nominal sequences: reference, threshold and bounds of each, from its demonstrations.
//!
//! DTW stretches time, so by distance alone it forgives a motion that never ends. At another part without strokes the duration has a prediction
//! interval, and 3 s above it for a pause. With strokes it has a minimum that only three times the speed falls short of. On the way it has no
//! minimum: what was taken was taken. Of 15 runs in which a real person stops for 8 s none was found without the maximum, and all are with it.

use super::kind::{is_taking, way_of};
use super::measures::{Rates, UNBOUNDED, what_was_shown};
use super::report::IuReport;
use super::sequence::{Sequence, ShownIu};
use super::strength::{Rule, Strength};
use super::threshold::{self, Memory, compared};
use super::{TeachError, TeachOptions, Teaching};
use crate::barycentre::Barycentres;
use crate::job_file::{ShownValues, TaughtActivity, TaughtIu, context_words};
use crate::recording::object_name;
use crate::rule::{BoundsRule, ThresholdRule};
use crate::statistics::{deviation, mean};
use crate::warp::Warp;
use andon_core::bounds::Bounds;
use andon_core::capacity::IU_FRAMES;
use andon_core::couple::{Context, Motion};
use andon_core::dtw::Refused;
use andon_core::job::MeasureBounds;
use andon_core::object::ContactRegion;
use andon_core::segment::Measures;
use andon_core::verdict::Measure;

/// Teaches one nominal sequence after the other, and collects what it found.
pub(super) struct Teacher<'a> {
    shown: &'a Teaching<'a>,
    memory: &'a mut Memory,
    warp: Warp,
    tables: Barycentres,
    rates: Rates,
    ius: Vec<IuReport>,
}

impl<'a> Teacher<'a> {
    pub(super) fn new(shown: &'a Teaching<'a>, memory: &'a mut Memory) -> Self {
        let TeachOptions { cost, has_free_ends, method, bounds, .. } = *shown.options;
        memory.prepare(cost, has_free_ends);
        Self {
            shown,
            memory,
            warp: Warp::new(cost),
            tables: Barycentres::new(cost, method.bins),
            rates: Rates::new(bounds.false_alarms, shown.people, &shown.agreement),
            ius: Vec::new(),
        }
    }

    /// # Errors
    /// If an IU was seen well in no run, or cannot be compared.
    pub(super) fn teach(mut self) -> Result<(Vec<TaughtActivity>, Vec<IuReport>), TeachError> {
        let sequences = self.shown.agreement.sequences.iter().enumerate();
        let activities = sequences.map(|(number, sequence)| {
            let ius = (0..sequence.ius.len()).map(|index| self.iu(number, sequence, index));
            Ok(TaughtActivity { activity: sequence.activity, ius: ius.collect::<Result<_, _>>()? })
        });
        Ok((activities.collect::<Result<_, TeachError>>()?, self.ius))
    }

    fn iu(&mut self, number: usize, sequence: &Sequence, index: usize) -> Result<TaughtIu, TeachError> {
        let iu = &sequence.ius[index];
        self.check(sequence, index)?;
        let TeachOptions { rule, max_slowdown, method, .. } = *self.shown.options;
        let learned = self
            .memory
            .recall((number, index), || {
                let motions: Vec<_> =
                    iu.ius(&self.shown.runs).map(|(_, iu)| compared(iu, self.shown.options)).collect();
                let motions: Vec<&[Motion]> = motions.iter().map(AsRef::as_ref).collect();
                threshold::learn(&mut self.warp, &self.tables, &motions)
            })
            .map_err(|refused| iu_error("all", usize::from(sequence.activity), index, refused))?
            .slowed(max_slowdown, !matches!(rule, ThresholdRule::Paper { .. }));
        let step = self.shown.agreement.keys[usize::from(sequence.activity)];
        // A hand that rests has only a time.
        let strength_of = |rule| match rule {
            Rule::Measure(_, _, Measure::Duration) => self.shown.strengths.of(rule),
            _ if sequence.is_steadied => Strength::NONE,
            _ => self.shown.strengths.of(rule),
        };
        let strength = |measure| strength_of(Rule::Measure(step, iu.context, measure));
        let of_motion = strength_of(Rule::Motion(step, iu.context));
        let way = way(sequence, index);
        let (reversals, bounds) = self.rates.bounds(iu, way, self.met_within_m(iu.context), &strength);
        let shown = iu
            .context
            .is_touch()
            .then(|| what_was_shown(iu, way.unwrap_or(&iu.measured), learned.distances(), &bounds));
        let rate_hz = f64::from(method.rate_hz);
        let taught = TaughtIu {
            context: iu.context,
            threshold: learned.threshold(rule, rate_hz, &self.shown.people, of_motion) as f32,
            frames: self.frames(sequence, index, strength(Measure::Duration)),
            reversals,
            measures: MeasureBounds { shown: shown.as_ref().map(ShownValues::ranges), ..bounds },
            reference: learned.reference.clone(),
            demonstrations: iu.shown.len() as u32,
            shown,
        };
        let distances = learned.distances();
        self.ius.push(IuReport {
            activity: sequence.activity,
            iu: index,
            taught: taught.clone(),
            distance: [mean(distances), deviation(distances, 1)],
            is_by_feel: iu.is_by_feel(),
        });
        Ok(taught)
    }

    /// How near the runs show the two parts of an IU to come, in metres; 0 where the station says it.
    fn met_within_m(&self, Context([_, _, j, l]): Context) -> f32 {
        let place = |at: u16, with: u16| {
            let mut at = self.shown.runs[0].objects.iter().filter(move |object| object.shape.id == at);
            let regions = &at.next()?.shape.contact_regions;
            let met = regions.iter().find(|met| met.with == with && !met.points.is_empty())?;
            (with != ContactRegion::HAND).then_some(met.contact.off_m)
        };
        place(l, j).or_else(|| place(j, l)).unwrap_or_default()
    }

    /// The bounds of the duration of one of these IUs, from that of the demonstrations, in frames.
    fn frames(&self, sequence: &Sequence, index: usize, strength: Strength) -> Bounds {
        let TeachOptions { bounds, method, .. } = self.shown.options;
        let iu = &sequence.ius[index];
        if strength == Strength::NONE || !iu.context.is_touch() {
            return UNBOUNDED;
        }
        let (min, likely_max) = self.rates.frames(iu, method.rate_hz, strength).unwrap_or_default();
        let max = max_frames(*bounds, iu, method.rate_hz, self.shown.people.variety, likely_max);
        let is_taking = is_taking(&sequence.contexts, index) && !iu.is_repeated();
        Bounds { min: if is_taking { 0 } else { min }, max }
    }

    /// Checks that there is a demonstration, and compares each with its own first frame. So one that cannot be compared is reported with its run.
    fn check(&mut self, sequence: &Sequence, index: usize) -> Result<(), TeachError> {
        let Teaching { runs, options, .. } = self.shown;
        let iu = &sequence.ius[index];
        if iu.shown.is_empty() {
            let what = context_words(iu.context, |id| object_name(&runs[0].objects, id));
            let activity = usize::from(sequence.activity) + 1;
            return Err(TeachError::NeverSeen(activity, index + 1, what));
        }
        for (&[run, activity, _], (_, shown)) in iu.shown.iter().zip(iu.ius(runs)) {
            let motion = compared(shown, options);
            self.warp
                .distance(&motion, &motion[..1.min(motion.len())])
                .map_err(|refused| iu_error(&runs[run].name, activity, index, refused))?;
        }
        Ok(())
    }
}

/// The maximum duration of an IU in frames of the grid, from `likely_max`, or else from the durations of the demonstrations. Who differs `variety`
/// times as much from others as people in general does so in the logarithm of the duration.
fn max_frames(rule: BoundsRule, iu: &ShownIu, rate_hz: f32, variety: f64, likely_max: Option<f64>) -> u32 {
    let longest = iu.frames.iter().copied().max().unwrap_or_default();
    let max = rule.max_duration.powf(variety) * f64::from(longest);
    let max = likely_max.filter(|_| max.is_finite()).unwrap_or(max);
    ((max + rule.pause_s * f64::from(rate_hz)).ceil() as u32).min(IU_FRAMES as u32)
}

/// What the demonstrations measured of a way at its end, where the IU is a part of one. It ends with the time at the part that it leads to, unless
/// strokes are made there.
fn way(sequence: &Sequence, index: usize) -> Option<&[Measures]> {
    let way = way_of(&sequence.contexts, index)?;
    let [begin, end]: [&ShownIu; 2] = [*way.start(), *way.end()].map(|iu| &sequence.ius[iu]);
    match (end.is_repeated(), index == *way.start()) {
        (false, _) => Some(&end.measured),
        (true, true) => Some(&begin.measured),
        (true, false) => None,
    }
}

/// An IU that cannot be compared; activity and IU by their indices from 0.
fn iu_error(run: &str, activity: usize, iu: usize, refused: Refused) -> TeachError {
    TeachError::Iu(run.to_owned(), activity + 1, iu + 1, refused)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_who_differ_more_may_be_slower() {
        let rule = BoundsRule { max_duration: 2.0, pause_s: 1.0, ..BoundsRule::NONE };
        let iu = ShownIu::measuring(Context([1, 5, 0, 0]), &[], &[40, 48]);
        let frames = |variety| max_frames(rule, &iu, 30.0, variety, None);
        assert_eq!([frames(1.0), frames(2.0)], [126, 222]);
    }
}
