//! Where and how near one object comes to another.
//!
//! Two parts that are both put back meet only if that is the same place in all runs, to a centimetre. Tools that lay side by side met in some runs. A
//! tool that makes strokes meets a part in their middle.

use super::trajectory::{Dwell, Trajectories};
use super::{
    MAX_REGION_M, PUT_BACK_M, PUT_DOWN_M, SAME_PLACE_M, apart_m, centres, contact_of, contact_region,
    in_proportion, median, points_of, widened,
};
use crate::teach::sequence::MIN_ALIKE;
use andon_core::config::Contact;
use andon_core::object::{ContactRegion, ObjectShape};
use nalgebra::Point3;
use std::collections::BTreeSet;

/// The positions of two objects that come near each other so may touch, in metres: most parts of a bench are no larger. Halved, 16 of 70 jobs differ,
/// and 32 faults are called right instead of 13. Doubled, 30 do, and 38 faults fewer are found.
pub(super) const TOUCH_M: f32 = 0.15;

/// No part of a bench is larger, in metres. Markers lie at the far ends of two long parts that touch. With 15 cm 14 of 70 jobs differ, and 3 faults
/// fewer are found. With 50 cm 12 do, and no verdict.
const MAX_PART_M: f32 = 0.25;

/// Two parts of which one is only put back beside the other touch where their points come as near as this, in metres. Halved or
/// doubled, 7 of 70 jobs differ, and no verdict.
const BESIDE_CONTACT_M: f32 = 0.005;

/// How the first one meets the second; `None` if it does as the station says, or never.
pub(super) fn of(
    [with, at]: [usize; 2],
    shapes: &[ObjectShape],
    shown: &[Trajectories],
    default: Contact,
) -> Option<ContactRegion> {
    let dwells = dwells([with, at], shown);
    let places: Vec<Place> = dwells.iter().map(|(_, place)| *place).collect();
    let id = shapes[with].id;
    if shapes[with].has_points() || shapes[at].has_points() {
        let may_meet = may_meet(&places);
        let met: Vec<&(Dwell, Place)> = dwells.iter().filter(|(_, place)| may_meet(place)).collect();
        let elsewhere =
            || if met.len() < dwells.len() { in_proportion(default, BESIDE_CONTACT_M) } else { default };
        let contact = at_given_points([with, at], shapes, shown, &met, default);
        return contact_region(id, &[], contact.unwrap_or_else(elsewhere), default);
    }
    let first: Vec<Point3<f32>> = shown.iter().filter_map(|run| run.first_place(with, at)).collect();
    at_learnt_places(id, &places, &first, shown.len(), default)
}

/// How many runs show the first one to dwell at the second so that they may touch.
pub(super) fn shown_by([with, at]: [usize; 2], shown: &[Trajectories]) -> usize {
    let places: Vec<Place> = dwells([with, at], shown).into_iter().map(|(_, place)| place).collect();
    runs_of(&touching(&places, shown.len()).0)
}

/// Where the first one dwells at the second, in all runs.
fn dwells([with, at]: [usize; 2], shown: &[Trajectories]) -> Vec<(Dwell, Place)> {
    let of_run = |(run, shown): (usize, &Trajectories)| -> Vec<(Dwell, Place)> {
        let placed = |dwell: Dwell| {
            let place = Place::new(run, &dwell, [with, at], shown);
            (dwell, place)
        };
        shown.dwells(with, at).into_iter().map(placed).collect()
    };
    shown.iter().enumerate().flat_map(of_run).collect()
}

/// Where one object dwells at another.
#[derive(Clone, Copy)]
struct Place {
    run: usize,
    at: Point3<f32>,
    /// What was carried there is nearer to a third object that lies.
    is_at_another: bool,
    /// It was put back to where it lay in the beginning.
    is_back: bool,
    /// It was put back, and is let go of there beside a part that is carried in this run as well.
    is_beside: bool,
}

impl Place {
    fn new(run: usize, dwell: &Dwell, objects: [usize; 2], shown: &Trajectories) -> Self {
        let is_at_another = shown.is_brought_to_another(objects, dwell);
        let at = shown.place(objects[0], objects[1], dwell);
        let first = shown.first_place(objects[0], objects[1]);
        let is_back = first.is_some_and(|first| nalgebra::distance(&at, &first) < PUT_BACK_M);
        let is_put_down =
            dwell.iter().any(|(frame, _)| objects.iter().all(|object| shown.is_let_go(*object, *frame)));
        let is_beside =
            is_back && is_put_down && objects.iter().all(|object| shown.carried_frames(*object) > 0);
        Self { run, at, is_at_another, is_back, is_beside }
    }
}

fn runs_of(places: &[Place]) -> usize {
    places.iter().map(|place| place.run).collect::<BTreeSet<usize>>().len()
}

/// The places at which the two may touch, and the others. They are near, or as far as those that are near in another run. Where fewer than half of
/// the runs have such a place, those farther away count. They must be the same in all runs that have one, and no third object nearer. What is put
/// back beside a part that is put back as well touches it in one case only. It is at the same place in all runs that have one.
fn touching(places: &[Place], runs: usize) -> (Vec<Place>, Vec<Place>) {
    let may_meet = may_meet(places);
    let met = places.iter().filter(|place| may_meet(place)).map(|place| place.at);
    let near: Vec<Point3<f32>> = met.filter(|place| place.coords.norm() < TOUCH_M).collect();
    let split: (Vec<Place>, Vec<Place>) =
        places.iter().partition(|place| apart_m(&[place.at], &near) < PUT_DOWN_M);
    if 2 * runs_of(&split.0) >= runs {
        return split;
    }
    let is_far =
        |place: &&Place| place.at.coords.norm() < MAX_PART_M && !place.is_at_another && !place.is_back;
    let (far, others): (Vec<Place>, Vec<Place>) = places.iter().partition(is_far);
    let is_shown = runs_of(&far) >= MIN_ALIKE && 2 * runs_of(&far) >= runs;
    if are_same(&far) && is_shown { (far, others) } else { split }
}

/// Whether the two may meet at one of these places. Two parts that are put back side by side do not, unless it is at the same place in all runs that
/// have one.
fn may_meet(places: &[Place]) -> impl Fn(&Place) -> bool {
    let back: Vec<Place> = places.iter().filter(|place| place.is_beside).copied().collect();
    let is_put_together = are_same(&back) && runs_of(&back) >= MIN_ALIKE;
    move |place| is_put_together || !place.is_beside
}

fn are_same(places: &[Place]) -> bool {
    are_within(PUT_DOWN_M, &places.iter().map(|place| place.at).collect::<Vec<_>>())
}

/// Whether places are as near to their middle as this, in metres.
fn are_within(max_m: f32, places: &[Point3<f32>]) -> bool {
    let middle = median(places.iter().copied());
    places.iter().all(|place| nalgebra::distance(place, &middle) < max_m)
}

/// Where a run shows the first of the two to dwell beside the other. It is farther away than two that come near each other so may touch.
pub(super) fn beside([one, other]: [usize; 2], shown: &Trajectories) -> Option<Point3<f32>> {
    let is_beside = |place: &Point3<f32>| (TOUCH_M..MAX_PART_M).contains(&place.coords.norm());
    shown.dwells(one, other).iter().map(|dwell| shown.place(one, other, dwell)).find(is_beside)
}

/// Whether places in several runs are one.
pub(super) fn are_one_place(places: &[Point3<f32>]) -> bool {
    are_within(SAME_PLACE_M, places)
}

/// How near the two come to each other where their points are given, in the dwells in which they may meet. `None` if not as near as by default.
fn at_given_points(
    [with, at]: [usize; 2],
    shapes: &[ObjectShape],
    shown: &[Trajectories],
    met: &[&(Dwell, Place)],
    default: Contact,
) -> Option<Contact> {
    let [points, places] = [with, at].map(|object| points_of(&shapes[object]));
    let nearest = |(dwell, place): &&(Dwell, Place)| {
        let apart = |(frame, _): &(usize, Point3<f32>)| {
            let pose = shown[place.run].relative_pose(with, at, *frame)?;
            let points: Vec<Point3<f32>> = points.iter().map(|point| pose * point).collect();
            Some(apart_m(&points, &places))
        };
        dwell.iter().filter_map(apart).fold(f32::INFINITY, f32::min)
    };
    let mut distances: Vec<f32> = met.iter().map(nearest).collect();
    distances.sort_by(f32::total_cmp);
    // How these differ shows how near others come that touch as well.
    let reached = distances.partition_point(|distance_m| *distance_m <= default.on_m);
    if reached == 0 {
        return None;
    }
    let near: Vec<f64> = distances[..reached].iter().map(|distance| f64::from(*distance)).collect();
    let next_m = distances.get(reached).copied().unwrap_or(f32::INFINITY);
    let contact = contact_of(&near, default);
    Some(if contact.on_m > next_m { widened(default, next_m) } else { contact })
}

/// Where and how near an object comes if nobody says where the two are touched. A place shown by fewer than half of the runs does not count.
/// `first` are the places at which it lies in the beginning: one that is wider apart than a place can be is another one.
fn at_learnt_places(
    id: u16,
    places: &[Place],
    first: &[Point3<f32>],
    runs: usize,
    default: Contact,
) -> Option<ContactRegion> {
    let (near, others) = touching(places, runs);
    if near.is_empty() || 2 * runs_of(&near) < runs {
        return None;
    }
    let points = centres(&near.iter().map(|place| place.at).collect::<Vec<_>>(), SAME_PLACE_M);
    let apart = |place: &Point3<f32>| apart_m(&[*place], &points);
    let distances: Vec<f64> = near.iter().map(|place| f64::from(apart(&place.at))).collect();
    let elsewhere = first.iter().map(apart).filter(|apart_m| *apart_m > MAX_REGION_M);
    let next_m = others.iter().map(|place| apart(&place.at)).chain(elsewhere).fold(f32::INFINITY, f32::min);
    let contact = contact_of(&distances, default);
    let wide = widened(default, contact.on_m.max(MAX_REGION_M.min(next_m / 2.0)));
    contact_region(id, &points, wide, default)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_back_does_not_touch_what_lies_beside_it() {
        let of = |is_back: bool| -> Vec<Place> {
            let [over, mut home] = [0.16, 0.24].map(|apart_m| places(&[apart_m; 4], false));
            home.iter_mut().for_each(|place| place.is_back = is_back);
            touching(&[over, home].concat(), 4).0
        };
        assert_eq!([true, false].map(|is_back| of(is_back).len()), [4, 0]);
    }

    #[test]
    fn what_is_put_back_near_a_part_touches_it_where_it_lies_at_the_same_place_in_all_runs() {
        let of = |distances_m: &[f32], is_beside: bool| {
            let mut places = places(distances_m, false);
            places.iter_mut().for_each(|place| (place.is_back, place.is_beside) = (true, is_beside));
            touching(&places, 4).0.len()
        };
        assert_eq!(of(&[0.12, 0.125, 0.118, 0.12], true), 4, "a lid");
        assert_eq!(of(&[0.12, 0.145, 0.1, 0.13], true), 0, "it lies beside the other");
        assert_eq!(of(&[0.12, 0.145, 0.1, 0.13], false), 4, "it lies on a table");
    }

    /// Places at these distances in metres, in one run each.
    fn places(distances_m: &[f32], is_at_another: bool) -> Vec<Place> {
        let place = |(run, x): (usize, &f32)| Place {
            run,
            at: Point3::new(*x, 0.0, 0.0),
            is_at_another,
            is_back: false,
            is_beside: false,
        };
        distances_m.iter().enumerate().map(place).collect()
    }

    /// How many of them count as those of a contact.
    fn touching_of(distances_m: &[f32]) -> usize {
        touching(&places(distances_m, false), distances_m.len()).0.len()
    }

    #[test]
    fn two_long_parts_touch_where_they_are_equally_far_apart_in_all_runs() {
        assert_eq!(touching_of(&[0.158, 0.158, 0.159, 0.157]), 4);
        assert_eq!(
            touching_of(&[0.251, 0.268, 0.288, 0.225]),
            0,
            "it was put down somewhere beside the other"
        );
        assert_eq!(touching_of(&[0.158, 0.158]), 0, "that may be chance");
        assert_eq!(touching_of(&[0.401, 0.402, 0.401, 0.402]), 0, "no part is as large");
        assert_eq!(touching_of(&[0.08, 0.08, 0.2, 0.08]), 3, "one run shows no contact");
        assert_eq!(touching_of(&[0.149, 0.151, 0.152, 0.148]), 4, "they are near within the noise");
        let at_another = |distances_m: &[f32]| touching(&places(distances_m, true), 4).0.len();
        assert_eq!(at_another(&[0.158, 0.158, 0.159, 0.157]), 0, "it was brought to that");
        assert_eq!(at_another(&[0.08, 0.08, 0.08, 0.08]), 4, "it touches both");
    }

    #[test]
    fn a_place_ends_before_where_a_part_lies_in_the_beginning() {
        let default = Contact { on_m: 0.03, off_m: 0.045 };
        let places = places(&[0.12; 4], false);
        let on_m = |first_m: f32| {
            let first = [Point3::new(0.12 + first_m, 0.0, 0.0)];
            at_learnt_places(6, &places, &first, 4, default).map(|met| met.contact.on_m)
        };
        assert_eq!(on_m(0.4), Some(0.1));
        assert_eq!(on_m(0.12), Some(0.06), "it is not half at the other part before it is carried there");
        assert_eq!(on_m(0.05), Some(0.1), "it lies elsewhere on the same shelf");
    }
}
