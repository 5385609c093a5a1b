//! Where and how near one object comes to another.

use super::trajectory::{Dwell, Trajectories};
use super::{apart_m, centres, contact_of, is_given, median, meeting, points_of, widened};
use andon_core::config::Contact;
use andon_core::object::{Meeting, ObjectShape};
use nalgebra::Point3;
use std::collections::BTreeSet;

/// Two places where an object dwells at another are one if they are no farther apart, in metres.
const PLACES_M: f32 = 0.03;

/// The positions of two objects that touch are no farther apart, in metres: parts of a bench are no larger.
pub(super) const TOUCH_M: f32 = 0.15;

/// Farther than this from each other nobody takes two objects for such that touch, in metres.
const BESIDE_M: f32 = 0.25;

/// A place that is learnt is no wider than this, in metres: a shelf is wider than the runs show.
const WIDE_M: f32 = 0.1;

/// A distance that exceeds the one before by less than this factor is of the same kind.
const NEXT: f32 = 1.25;

/// How the first one meets the second; `None` if it does as the station says, or never.
pub(super) fn of(
    [with, at]: [usize; 2],
    shapes: &[ObjectShape],
    shown: &[Trajectories],
    default: Contact,
) -> Option<Meeting> {
    let dwells: Vec<(usize, Dwell)> = shown
        .iter()
        .enumerate()
        .flat_map(|(run, shown)| shown.dwells(with, at).into_iter().map(move |dwell| (run, dwell)))
        .collect();
    let id = shapes[with].id;
    if is_given(&shapes[with]) || is_given(&shapes[at]) {
        let contact = at_given_points([with, at], shapes, shown, &dwells, default);
        return meeting(id, &[], contact, default);
    }
    let places: Vec<(usize, Point3<f32>)> =
        dwells.iter().map(|(run, dwell)| (*run, place_of(dwell))).collect();
    at_learnt_places(id, &places, shown.len(), default)
}

/// Whether a run shows one of the two to dwell at the other so near that they may touch.
pub(super) fn is_shown([one, other]: [usize; 2], shown: &Trajectories) -> bool {
    shown.dwells(one, other).iter().any(|dwell| place_of(dwell).coords.norm() < TOUCH_M)
}

/// Where a run shows the first of the two to dwell beside the other, a little too far away for two that touch.
pub(super) fn beside([one, other]: [usize; 2], shown: &Trajectories) -> Option<Point3<f32>> {
    let is_beside = |place: &Point3<f32>| (TOUCH_M..BESIDE_M).contains(&place.coords.norm());
    shown.dwells(one, other).iter().map(place_of).find(is_beside)
}

/// Whether places in several runs are one.
pub(super) fn are_one_place(places: &[Point3<f32>]) -> bool {
    let middle = median(places.iter().copied());
    places.iter().all(|place| nalgebra::distance(place, &middle) < PLACES_M)
}

fn place_of(dwell: &Dwell) -> Point3<f32> {
    median(dwell.iter().map(|(_, place)| *place))
}

/// How near the two come to each other where their points are given.
fn at_given_points(
    [with, at]: [usize; 2],
    shapes: &[ObjectShape],
    shown: &[Trajectories],
    dwells: &[(usize, Dwell)],
    default: Contact,
) -> Contact {
    let [points, places] = [with, at].map(|object| points_of(&shapes[object]));
    let nearest = |(run, dwell): &(usize, Dwell)| {
        let apart = |(frame, _): &(usize, Point3<f32>)| {
            let pose = shown[*run].relative_pose(with, at, *frame)?;
            let points: Vec<Point3<f32>> = points.iter().map(|point| pose * point).collect();
            Some(apart_m(&points, &places))
        };
        dwell.iter().filter_map(apart).fold(f32::INFINITY, f32::min)
    };
    let mut distances: Vec<f32> = dwells.iter().map(nearest).collect();
    distances.sort_by(f32::total_cmp);
    // From those that touch by the given distance on, up to the first gap.
    let mut reached = distances.partition_point(|distance| *distance <= default.on_m);
    while reached > 0
        && reached < distances.len()
        && distances[reached] <= NEXT * distances[reached - 1]
        && distances[reached] <= 2.0 * default.on_m
    {
        reached += 1;
    }
    let near: Vec<f64> = distances[..reached].iter().map(|distance| f64::from(*distance)).collect();
    let next_m = distances.get(reached).copied().unwrap_or(f32::INFINITY);
    let contact = contact_of(&near, default);
    if contact.on_m > next_m { widened(default, next_m) } else { contact }
}

/// Where and how near an object comes if nobody says where the two are touched. A place shown by fewer than half of the runs does not count.
fn at_learnt_places(
    id: u16,
    places: &[(usize, Point3<f32>)],
    runs: usize,
    default: Contact,
) -> Option<Meeting> {
    let (near, others): (Vec<_>, Vec<_>) =
        places.iter().partition(|(_, place)| place.coords.norm() < TOUCH_M);
    let shown_by: BTreeSet<usize> = near.iter().map(|(run, _)| *run).collect();
    if near.is_empty() || 2 * shown_by.len() < runs {
        return None;
    }
    let points = centres(&near.iter().map(|(_, place)| *place).collect::<Vec<_>>(), PLACES_M);
    let apart = |(_, place): &(usize, Point3<f32>)| apart_m(&[*place], &points);
    let distances: Vec<f64> = near.iter().map(|place| f64::from(apart(place))).collect();
    let next_m = others.iter().map(apart).fold(f32::INFINITY, f32::min);
    let contact = contact_of(&distances, default);
    let wide = widened(default, contact.on_m.max(WIDE_M.min(next_m / 2.0)));
    meeting(id, &points, wide, default)
}
