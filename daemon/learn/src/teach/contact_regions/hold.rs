//! Where and how near a hand is to what it carries.
//!
//! Of two hands that move with a part both hold it, not only the nearer one. Of 144 faulty executions of two hands 117 were found with the
//! nearer one alone, and 141 are.

use super::steadying;
use super::trajectory::{Tips, Trajectories};
use super::{apart_m, centres, contact_of, contact_region, middle_of, points_of};
use andon_core::config::Contact;
use andon_core::object::{ContactRegion, ObjectShape};

/// Two finger tips that hold an object are at one interaction point if they are no farther apart, in metres. Halved, 21 of 70 jobs differ and no
/// verdict. Doubled, 15 do: 2 more right runs are accepted, and 1 more fault is found.
const SAME_POINT_M: f32 = 0.02;

/// How a hand meets an object; `None` if it does as the station says, or never carries it.
pub(super) fn of(
    object: usize,
    shape: &ObjectShape,
    shown: &[Trajectories],
    default: Contact,
) -> Option<ContactRegion> {
    let mut holds: Vec<Vec<Tips>> = shown.iter().flat_map(|run| run.holds(object)).collect();
    if holds.is_empty() {
        holds = steadying::of(object, shown).into_iter().map(|tips| vec![tips]).collect();
    }
    if holds.is_empty() {
        return None;
    }
    let learnt = if shape.has_points() {
        Vec::new()
    } else {
        centres(&holds.iter().flat_map(|hold| middle_of(hold)).collect::<Vec<_>>(), SAME_POINT_M)
    };
    let points = if shape.has_points() { points_of(shape) } else { learnt.clone() };
    // All but the farthest tenth: markers jump.
    let farthest = |hold: &Vec<Tips>| {
        let mut distances: Vec<f32> = hold.iter().map(|tips| apart_m(tips, &points)).collect();
        distances.sort_by(f32::total_cmp);
        f64::from(distances[distances.len() * 9 / 10])
    };
    let contact = contact_of(&holds.iter().map(farthest).collect::<Vec<_>>(), default);
    contact_region(ContactRegion::HAND, &learnt, contact, default)
}
