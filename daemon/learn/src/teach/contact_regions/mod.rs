//! Where and how near hands and objects meet, as the runs show it. A station need not say where its parts are touched.
//!
//! What a hand carries moves with it: that shows where the object is held. Where it comes to dwell at another object, having been carried
//! there, the two meet. Interaction points that were given count, and only the distances are learnt.
//!
//! Runs of a real person, recorded without points, had no contact at all. With the contacts that the runs show, each is right by the job of
//! the others. The job file has them, and `encode` follows the job in force: its couples carry the hash, and the judge takes no others.

mod hold;
mod joining;
mod orientation;
mod steadying;
mod trajectory;
mod unsure;

use super::measures::{RARE, interval};
use super::people::People;
use super::strength::Strength;
use crate::recording::{NamedObject, shapes};
use crate::run::Run;
use crate::statistics::median_point;
use andon_core::capacity::INTERACTION_POINTS;
use andon_core::config::{Contact, Method};
use andon_core::object::{ContactRegion, ObjectShape};
use nalgebra::Point3;
use trajectory::{Tips, Trajectories};
pub(super) use unsure::incidental;

/// Two positions that are no farther apart are one place, in metres. They are of finger tips at a part, of a part at another one, or of a part that
/// no hand has moved. Halved or doubled, 16 or 8 of 70 jobs differ, and 3 or 2 faults fewer are found.
pub(super) const SAME_PLACE_M: f32 = 0.03;

/// What is put back lies where it lay before, and what dwells stays where it is, to this many metres. Halved or doubled, 43 of 70 jobs differ, and 53
/// or 24 faults fewer are found.
pub(super) const PUT_BACK_M: f32 = 0.05;

/// What has a place of its own is put down there as exactly as this, in metres. What is put down beside a part is not. Halved or doubled, 51 or 52 of
/// 70 jobs differ, and 4 or 7 faults fewer are found.
pub(super) const PUT_DOWN_M: f32 = 0.01;

/// A place that is learnt is no wider than this, in metres: a shelf is wider than the runs show. Halved, 33 of 70 jobs differ, and 1 more fault is
/// found. Doubled, 31 do, and 26 faults are called right instead of 13.
const MAX_REGION_M: f32 = 0.1;

/// How people in general differ in how near they come, in metres. Halved or doubled, 17 or 48 of 70 jobs differ, and 1 fault fewer is found.
const PRIOR_M: f64 = 0.004;

/// The objects of the runs, with where and how near they are met, and what is not sure of it.
pub(super) fn learn(runs: &[Run], method: &Method) -> (Vec<NamedObject>, Vec<String>) {
    let mut objects: Vec<NamedObject> = Vec::new();
    for object in runs.iter().flat_map(|run| &run.objects) {
        if objects.iter().all(|other| other.shape.id != object.shape.id) {
            objects.push(object.clone());
        }
    }
    let shapes = shapes(&objects);
    let mut shown: Vec<Trajectories> =
        runs.iter().map(|run| Trajectories::new(run.frames(), &shapes, method.space)).collect();
    for (index, object) in objects.iter_mut().enumerate() {
        if !object.shape.has_points() && orientation::means_nothing(index, &shown) {
            object.shape.is_position_only = true;
            shown.iter_mut().for_each(|run| run.forget_orientation(index));
        }
    }
    let unsure = unsure::of(runs, &objects, &shown);
    let mut found: Vec<(usize, ContactRegion)> = Vec::new();
    for at in 0..shapes.len() {
        found.extend(hold::of(at, &shapes[at], &shown, method.hand_contact).map(|met| (at, met)));
        for with in 0..at {
            let [with, at] = in_order([with, at], &shown);
            let met = joining::of([with, at], &shapes, &shown, method.object_contact);
            found.extend(met.map(|met| (at, met)));
        }
    }
    for (at, met) in found {
        // What exceeds the capacity is met as the station says.
        let _ = objects[at].shape.contact_regions.push(met);
    }
    (objects, unsure)
}

/// Two objects, the one that is carried more before the other one. The place is in the frame of that which lies more.
fn in_order([with, at]: [usize; 2], shown: &[Trajectories]) -> [usize; 2] {
    let carried = |object: usize| shown.iter().map(|run| run.carried_frames(object)).sum::<usize>();
    if carried(with) >= carried(at) { [with, at] } else { [at, with] }
}

fn points_of(shape: &ObjectShape) -> Vec<Point3<f32>> {
    shape.interaction_points.iter().map(|[x, y, z]| Point3::new(*x, *y, *z)).collect()
}

/// `None` where it is as it would be without.
fn contact_region(
    with: u16,
    points: &[Point3<f32>],
    contact: Contact,
    default: Contact,
) -> Option<ContactRegion> {
    (!points.is_empty() || contact != default).then(|| ContactRegion {
        with,
        points: points.iter().map(|point| [point.x, point.y, point.z]).collect(),
        contact,
    })
}

/// How near one more execution comes, as these came, in metres, but no less than by default.
fn contact_of(distances_m: &[f64], default: Contact) -> Contact {
    if distances_m.is_empty() {
        return default;
    }
    let (centre, apart) = interval(distances_m, PRIOR_M, 2.0 * RARE, People::IN_GENERAL, Strength::GENERAL);
    widened(default, (centre + apart) as f32)
}

/// The contact that begins within `on_m`, rounded up to whole millimetres and no less than the default.
fn widened(default: Contact, on_m: f32) -> Contact {
    in_proportion(default, f32::max(default.on_m, (1000.0 * on_m).ceil() / 1000.0))
}

/// The contact that begins within exactly `on_m`; it ends in proportion to the default, to the nearest tenth of a millimetre.
fn in_proportion(default: Contact, on_m: f32) -> Contact {
    Contact { on_m, off_m: (10_000.0 * on_m * default.off_m / default.on_m).round() / 10_000.0 }
}

fn apart_m(one: &[Point3<f32>], other: &[Point3<f32>]) -> f32 {
    let all = one.iter().flat_map(|one| other.iter().map(move |other| (one - other).norm()));
    all.fold(f32::INFINITY, f32::min)
}

/// As few points as are within a distance of all these, at most as many as an object can have. Each next one is that which is farthest from those
/// before (Gonzalez 1985).
fn centres(points: &[Point3<f32>], near_m: f32) -> Vec<Point3<f32>> {
    let middle = median(points.iter().copied());
    let from_middle_m = |point: &Point3<f32>| (point - middle).norm();
    let nearest = points.iter().min_by(|one, other| from_middle_m(one).total_cmp(&from_middle_m(other)));
    // Between points that are apart there is none.
    let first = nearest.filter(|point| from_middle_m(point) > near_m).copied().unwrap_or(middle);
    let mut centres = vec![first];
    while centres.len() < INTERACTION_POINTS {
        let apart = |point: &Point3<f32>| apart_m(&[*point], &centres);
        let farthest = points.iter().max_by(|one, other| apart(one).total_cmp(&apart(other)));
        let Some(point) = farthest.filter(|point| apart(point) > near_m) else { break };
        centres.push(*point);
    }
    centres.iter().map(|point| point.map(|value| (1000.0 * value).round() / 1000.0)).collect()
}

/// The middle of each finger tip.
fn middle_of(tips: &[Tips]) -> Tips {
    [0, 1, 2].map(|tip| median(tips.iter().map(|tips| tips[tip])))
}

fn median(points: impl Iterator<Item = Point3<f32>> + Clone) -> Point3<f32> {
    Point3::from(median_point(points.map(|point| [point.x, point.y, point.z])))
}
