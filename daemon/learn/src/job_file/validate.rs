//! The rules of the method that a job file must obey.

use super::{JobFault, JobFile, ShownValues, TaughtActivity, TaughtIu};
use crate::recording::NamedObject;
use andon_core::bounds::{Bounds, Range};
use andon_core::capacity::{ACTIVITIES, ACTIVITY_IUS, OBJECTS};
use andon_core::couple::{Context, Motion};
use andon_core::input::Point;
use andon_core::job::{MeasureBounds, Shown};
use andon_core::object::{ContactRegion, ObjectShape};

/// Checks everything that the types do not guarantee.
pub(super) fn validate(job: &JobFile) -> Result<(), JobFault> {
    job.method.check().map_err(|fault| JobFault::Invalid {
        key: format!("method.{}", fault.key),
        problem: format!("it must be {}", fault.allowed),
    })?;
    rule(job.max_slowdown.is_finite() && job.max_slowdown >= 1.0, "method.max_slowdown", || {
        "it must be a number of at least 1".to_owned()
    })?;
    rule((0.0..=job.method.rate_hz).contains(&job.min_rate_hz), "min_rate_hz", || {
        "it must be 0 to method.rate_hz".to_owned()
    })?;
    rule(job.objects.len() <= OBJECTS, "object", || format!("at most {OBJECTS} objects can be followed"))?;
    (0..job.objects.len()).try_for_each(|index| object(&job.objects, index))?;
    let count = job.activities.len();
    rule((1..=ACTIVITIES).contains(&count), "activity", || {
        format!("there are {count}; 1 to {ACTIVITIES} can be judged")
    })?;
    job.activities.iter().enumerate().try_for_each(|(index, taught)| activity(job, index, taught))?;
    job.with_job(|lent| {
        let count = lent.numbers().iter().count();
        rule(job.steps.len() == count && lent.misplaced().is_none(), "step", || {
            format!(
                "there are {} for {count} activities, or one cannot be kept: it names an activity that there is not, or two are behind each \
                 other",
                job.steps.len()
            )
        })
    })?;
    let is_sequence = |index: &u16| usize::from(*index) < job.activities.len();
    job.steps.iter().enumerate().try_for_each(|(number, step)| {
        rule(step.completes.iter().all(is_sequence), &format!("step[{number}].completes"), || {
            format!("it names a sequence that there is not: they are 0 to {}", job.activities.len() - 1)
        })
    })?;
    names(job)
}

/// A name stands in tables and at the end of a line.
fn names(job: &JobFile) -> Result<(), JobFault> {
    let (given, needed) = (job.step_names.len(), job.steps.len());
    rule(given == 0 || given == needed, "names.steps", || {
        format!("there are {given} names for {needed} steps: give each one, in the order of the steps")
    })?;
    job.step_names.iter().enumerate().try_for_each(|(index, name)| {
        let is_possible = !name.trim().is_empty() && !name.contains(char::is_control);
        rule(is_possible, &format!("names.steps[{index}]"), || {
            format!("{name:?} is no name: it needs a letter, and stands on one line")
        })
    })
}

fn object(objects: &[NamedObject], index: usize) -> Result<(), JobFault> {
    let key = format!("object[{index}]");
    let ObjectShape { id, interaction_points, contact_regions, incidental, start, .. } =
        &objects[index].shape;
    let is_unique = objects[..index].iter().all(|other| other.shape.id != *id);
    rule(*id != 0 && is_unique, &key, || format!("id is {id}; ids are 1 to 65535 and differ"))?;
    let is_finite = |points: &[Point]| points.iter().flatten().all(|value| value.is_finite());
    rule(is_finite(interaction_points) && !interaction_points.is_empty(), &key, || {
        "it needs at least one interaction point, and its coordinates must be finite".to_owned()
    })?;
    let is_known =
        |other: u16| other == ContactRegion::HAND || objects.iter().any(|object| object.shape.id == other);
    let is_possible = |met: &ContactRegion| {
        is_finite(&met.points) && met.contact.is_valid() && met.with != *id && is_known(met.with)
    };
    rule(contact_regions.iter().all(is_possible), &format!("{key}.meetings"), || {
        "each must be with 0 or another object of the job, with finite points and 0 < on_m <= off_m"
            .to_owned()
    })?;
    let is_other = |other: &u16| *other != *id && *other != ContactRegion::HAND && is_known(*other);
    rule(incidental.iter().all(is_other), &format!("{key}.incidental"), || {
        "each must be the id of another object of the job".to_owned()
    })?;
    rule(start.is_none_or(|place| place.is_valid()), &format!("{key}.start"), || {
        "its place must be a finite centre and a distance of at least 0".to_owned()
    })
}

fn activity(job: &JobFile, index: usize, activity: &TaughtActivity) -> Result<(), JobFault> {
    let count = activity.ius.len();
    rule((1..=ACTIVITY_IUS).contains(&count), &format!("activity[{index}].iu"), || {
        format!("there are {count}; 1 to {ACTIVITY_IUS} can be judged")
    })?;
    activity.ius.iter().enumerate().try_for_each(|(number, taught)| {
        let key_of = |key: &str| format!("activity[{index}].iu[{number}].{key}");
        rule(context_is_possible(job, taught.context), &key_of("context"), || {
            format!(
                "{:?} is not a context of this job's objects, which is [h, j, 0, 0], [h, j, j, l] or [0, 0, j, l]",
                taught.context.0
            )
        })?;
        iu(job, taught, &key_of)
    })
}

fn iu(job: &JobFile, iu: &TaughtIu, key_of: &dyn Fn(&str) -> String) -> Result<(), JobFault> {
    rule(iu.threshold.is_finite() && iu.threshold >= 0.0, &key_of("threshold"), || {
        "it must be a number of at least 0".to_owned()
    })?;
    for (key, Bounds { min, max }) in [("frames", iu.frames), ("reversals", iu.reversals)] {
        rule(min <= max, &key_of(key), || format!("the minimum {min} is greater than the maximum {max}"))?;
    }
    let MeasureBounds { stroke_m, path_m, max_detour_m, max_lateral_m, axis, place_m, shown } = iu.measures;
    for (key, Range { min, max }) in [("stroke_m", stroke_m), ("path_m", path_m)] {
        rule(0.0 <= min && min <= max, &key_of(key), || format!("{min} to {max} is no range of lengths"))?;
    }
    for (key, max) in [
        ("axis", axis.max),
        ("place_m", place_m.max),
        ("max_detour_m", max_detour_m),
        ("max_lateral_deviation_m", max_lateral_m),
    ] {
        rule(max >= 0.0, &key_of(key), || {
            format!("the maximum distance {max} is not a number of at least 0")
        })?;
    }
    let is_finite = axis.centre.iter().chain(&place_m.centre).all(|value| value.is_finite());
    rule(is_finite, &key_of("axis"), || "a centre of axis or place_m is not a number".to_owned())?;
    let is_finite = |shown: Shown| {
        let Shown { stroke_m, path_m, detour_m, lateral_m, axis, place_m, .. } = shown;
        let values = [stroke_m.min, stroke_m.max, path_m.min, path_m.max, detour_m, lateral_m, axis, place_m];
        values.into_iter().all(f32::is_finite)
    };
    rule(shown.is_none_or(is_finite), &key_of("shown"), || "a value is not a number".to_owned())?;
    let misfit = iu.shown.as_ref().and_then(ShownValues::misfit);
    rule(misfit.is_none(), &key_of(&format!("runs.{}", misfit.unwrap_or_default())), || {
        "the values must be sorted numbers of at least 0, and no more than are kept".to_owned()
    })?;
    rule(!iu.reference.is_empty(), &key_of("reference"), || "it has no rows".to_owned())?;
    let bins = job.method.bins as i8;
    let is_possible = |Motion([a, t1, p1, j1, t2, p2, j2]): &Motion| {
        (-1..=1).contains(a)
            && [t1, p1, t2, p2].into_iter().all(|direction| (0..=bins).contains(direction))
            && [j1, j2].into_iter().all(|joint| (0..=1).contains(joint))
    };
    rule(iu.reference.iter().all(is_possible), &key_of("reference"), || {
        format!("a feature is out of its range: a_h -1 to 1, directions 0 to {bins}, jm 0 or 1")
    })
}

fn context_is_possible(job: &JobFile, Context([hand, first, j, l]): Context) -> bool {
    let known = |id: u16| job.objects.iter().any(|object| object.shape.id == id);
    match hand {
        0 => first == 0 && known(j) && known(l) && j != l,
        1 | 2 if j == 0 => known(first) && l == 0,
        1 | 2 => known(first) && j == first && known(l) && j != l,
        _ => false,
    }
}

fn rule(is_kept: bool, key: &str, problem: impl FnOnce() -> String) -> Result<(), JobFault> {
    if is_kept { Ok(()) } else { Err(JobFault::Invalid { key: key.to_owned(), problem: problem() }) }
}
