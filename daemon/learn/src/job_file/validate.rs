//! The rules of the method that a job file must keep.

use super::{JobFault, JobFile, TaughtActivity, TaughtIu};
use andon_core::capacity::{ACTIVITIES, ACTIVITY_IUS, OBJECTS};
use andon_core::couple::{Context, Motion};
use andon_core::job::Bounds;

/// Checks everything that the types leave open.
pub(super) fn validate(job: &JobFile) -> Result<(), JobFault> {
    job.method.check().map_err(|fault| JobFault::Invalid {
        place: format!("method.{}", fault.key),
        problem: format!("it must be {}", fault.allowed),
    })?;
    rule(job.slowness.is_finite() && job.slowness >= 1.0, "method.slowness", || {
        "it must be a number from 1".to_owned()
    })?;
    rule(job.objects.len() <= OBJECTS, "object", || format!("at most {OBJECTS} objects can be followed"))?;
    for (place, object) in job.objects.iter().enumerate() {
        let here = format!("object[{place}]");
        let id = object.shape.id;
        let twice = job.objects[..place].iter().any(|other| other.shape.id == id);
        rule(id != 0 && !twice, &here, || format!("id is {id}; ids are 1 to 65535 and differ"))?;
        let finite = object.shape.interaction_points.iter().flatten().all(|value| value.is_finite());
        let some = !object.shape.interaction_points.is_empty();
        rule(finite && some, &here, || {
            "it needs at least one interaction point, of finite numbers".to_owned()
        })?;
    }
    let count = job.activities.len();
    rule((1..=ACTIVITIES).contains(&count), "activity", || {
        format!("there are {count}; 1 to {ACTIVITIES} can be judged")
    })?;
    job.activities.iter().enumerate().try_for_each(|(place, taught)| activity(job, place, taught))
}

fn not_negative() -> String {
    "it must be a number from 0".to_owned()
}

fn activity(job: &JobFile, place: usize, activity: &TaughtActivity) -> Result<(), JobFault> {
    let count = activity.ius.len();
    rule((1..=ACTIVITY_IUS).contains(&count), &format!("activity[{place}].iu"), || {
        format!("there are {count}; 1 to {ACTIVITY_IUS} can be judged")
    })?;
    activity.ius.iter().enumerate().try_for_each(|(number, taught)| {
        let here = |key: &str| format!("activity[{place}].iu[{number}].{key}");
        rule(context_is_possible(job, taught.context), &here("context"), || {
            format!(
                "{:?} is no context of this job's objects: [h, j, 0, 0], [h, j, j, l] or [0, 0, j, l]",
                taught.context.0
            )
        })?;
        iu(job, taught, &here)
    })
}

fn iu(job: &JobFile, iu: &TaughtIu, here: &dyn Fn(&str) -> String) -> Result<(), JobFault> {
    rule(iu.threshold.is_finite() && iu.threshold >= 0.0, &here("threshold"), not_negative)?;
    for (key, Bounds { least, most }) in [("frames", iu.frames), ("reversals", iu.reversals)] {
        rule(least <= most, &here(key), || {
            format!("[{least}, {most}] is empty; the first must not be over the second")
        })?;
    }
    rule(!iu.reference.is_empty(), &here("reference"), || "it has no row".to_owned())?;
    let bins = job.method.bins as i8;
    let possible = |Motion([a, t1, p1, j1, t2, p2, j2]): &Motion| {
        (-1..=1).contains(a)
            && [t1, p1, t2, p2].into_iter().all(|direction| (0..=bins).contains(direction))
            && [j1, j2].into_iter().all(|joint| (0..=1).contains(joint))
    };
    rule(iu.reference.iter().all(possible), &here("reference"), || {
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

fn rule(kept: bool, place: &str, problem: impl FnOnce() -> String) -> Result<(), JobFault> {
    if kept { Ok(()) } else { Err(JobFault::Invalid { place: place.to_owned(), problem: problem() }) }
}
