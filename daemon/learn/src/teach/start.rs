//! Where parts lie before the job moves them for good. A part that still lies there shows that the activities which move it have not been
//! done, whatever was not seen of the hands.
//!
//! A part counts only if the runs put it down far enough away. It must have a place of its own, to which they put it back. It may come to lie at its
//! first place again in one of 200 jobs at most. Before, 8 of 140 right jobs ended in their middle, because a tool was put down 3 cm from its first
//! place.

use super::contact_regions::{PUT_BACK_M, PUT_DOWN_M};
use super::measures::{RARE, interval};
use super::people::People;
use super::sequence::Agreement;
use super::strength::Strength;
use crate::job_file::TaughtStep;
use crate::recording::NamedObject;
use crate::run::{Activity, Run};
use crate::statistics::median_point;
use andon_core::bounds::Around;
use andon_core::input::{Point, Space};
use andon_core::object::ObjectShape;

/// How people in general differ in where they put a part down that has no place of its own, in metres. With 3 cm a part of the films has no start
/// any more; halved and doubled, no verdict on 198 other jobs changes.
const PRIOR_PUT_DOWN_M: f64 = 0.02;

/// The objects of the runs, each with where it lies first, if the runs show that. Takes note of which steps move it from there.
pub(super) fn found(
    runs: &[Run],
    agreement: &Agreement,
    space: Space,
    steps: &mut [TaughtStep],
) -> Vec<NamedObject> {
    steps.iter_mut().for_each(|step| step.moves.clear());
    let mut objects = runs[0].objects.clone();
    for ObjectShape { id, start, .. } in objects.iter_mut().map(|object| &mut object.shape) {
        let (place, moved_by) = start_of(*id, runs, agreement, space).unzip();
        *start = place;
        moved_by.into_iter().flatten().for_each(|step: usize| steps[step].moves.push(*id));
    }
    objects
}

/// Where an object lies first, and the steps that move it from there for good.
fn start_of(id: u16, runs: &[Run], agreement: &Agreement, space: Space) -> Option<(Around<3>, Vec<usize>)> {
    // One run shows one place, and not that it is always there.
    if agreement.used.len() < 2 {
        return None;
    }
    let firsts: Vec<Point> =
        agreement.used.iter().map(|run| first_position(id, &runs[*run], space)).collect::<Option<_>>()?;
    let centre = median_point(firsts.iter().copied());
    let place = |max: f32| Around { centre, max };
    let shown_m = firsts.iter().map(|first| place(0.0).distance(*first)).fold(0.0, f32::max);
    let place = place(shown_m + PUT_DOWN_M);
    let moves = |activity: &usize| -> bool {
        let of_runs = agreement.steps[*activity].iter().zip(&agreement.used);
        let shown = of_runs.filter_map(|(index, run)| Some((&runs[*run], (*index)?)));
        let away: Option<Vec<f64>> =
            shown.map(|(run, index)| away_m(id, run, &run.activities[index], &place, space)).collect();
        away.filter(|away| !away.is_empty()).is_some_and(|away| {
            let (centre, apart) =
                interval(&away, PRIOR_PUT_DOWN_M, 2.0 * RARE, People::IN_GENERAL, Strength::GENERAL);
            centre - apart > f64::from(place.max)
        })
    };
    let moved_by: Vec<usize> = (0..agreement.steps.len()).filter(moves).collect();
    (place.max <= PUT_BACK_M && !moved_by.is_empty()).then_some((place, moved_by))
}

/// How near its place an object comes after this activity, in metres. `None` if that does not act on it, or it is not seen any more.
fn away_m(id: u16, run: &Run, activity: &Activity, place: &Around<3>, space: Space) -> Option<f64> {
    if !acts_on(activity, id) {
        return None;
    }
    let after = seen(id, run, space).filter(|(time_ns, _)| *time_ns >= activity.ended_ns());
    after.map(|(_, position)| place.distance(position)).min_by(f32::total_cmp).map(f64::from)
}

/// Where an object lies before the first activity of the run that acts on it.
fn first_position(id: u16, run: &Run, space: Space) -> Option<Point> {
    let until_ns = run.activities.iter().find(|activity| acts_on(activity, id))?.ius.first()?.began_ns;
    let before: Vec<Point> =
        seen(id, run, space).take_while(|(time_ns, _)| *time_ns < until_ns).map(|(_, at)| at).collect();
    (!before.is_empty()).then(|| median_point(before.into_iter()))
}

fn seen(id: u16, run: &Run, space: Space) -> impl Iterator<Item = (u64, Point)> {
    run.frames().iter().filter_map(move |frame| {
        let object = frame.objects.iter().find(|object| object.id == id)?;
        Some((frame.captured_ns, space.flat(object.position)))
    })
}

fn acts_on(activity: &Activity, id: u16) -> bool {
    activity.ius.iter().any(|iu| iu.context.involves(id))
}
