//! Where a hand rests at a part that no hand carries: it steadies it.
//!
//! Nothing that moves shows such a contact. It is one where the hand comes to the same place at the part in all runs. It rests there, leaves again,
//! and holds nothing meanwhile. Where the hand rests in the beginning or at the end is no place at a part.

use super::joining;
use super::middle_of;
use super::trajectory::{Tips, Trajectories, centre};
use crate::teach::sequence::MIN_ALIKE;
use andon_core::capacity::HANDS;
use nalgebra::Point3;

/// The finger tips of the hands that rest at an object, in its frame of reference. None where not all runs show one hand at one place there.
pub(super) fn of(object: usize, shown: &[Trajectories]) -> Vec<Tips> {
    if shown.len() < MIN_ALIKE || shown.iter().any(|run| run.carried_frames(object) > 0) {
        return Vec::new();
    }
    let places = |hand: usize| -> Vec<Vec<Tips>> {
        shown.iter().map(|run| run.rests(hand, object).iter().map(|rest| middle_of(rest)).collect()).collect()
    };
    (0..HANDS).flat_map(|hand| common(&places(hand))).collect()
}

/// Those of these places that are one which all runs have.
fn common(places: &[Vec<Tips>]) -> Vec<Tips> {
    let nearest = |of_run: &Vec<Tips>, to: &Point3<f32>| {
        let apart_m = |tips: &&Tips| nalgebra::distance(&centre(tips), to);
        of_run.iter().min_by(|one, other| apart_m(one).total_cmp(&apart_m(other))).copied()
    };
    let of_all = |first: &Tips| {
        let near: Vec<Tips> =
            places.iter().map(|of_run| nearest(of_run, &centre(first))).collect::<Option<_>>()?;
        joining::are_one_place(&near.iter().map(centre).collect::<Vec<_>>()).then_some(near)
    };
    places.first().and_then(|first| first.iter().find_map(of_all)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_steadies_where_all_runs_have_it_at_one_place() {
        let tips = |cm: &i16| [Point3::new(f32::from(*cm) / 100.0, 0.0, 0.0); 3];
        let found = |runs: &[&[i16]]| {
            let places: Vec<Vec<Tips>> = runs.iter().map(|run| run.iter().map(tips).collect()).collect();
            common(&places).iter().map(|tips| (100.0 * tips[0].x).round() as i16).collect::<Vec<_>>()
        };
        assert_eq!(found(&[&[14, 9], &[8], &[10, 2]]), [9, 8, 10]);
        assert_eq!(found(&[&[9], &[8], &[]]), [0; 0], "one run does without");
        assert_eq!(found(&[&[9], &[2], &[14]]), [0; 0], "it waits somewhere");
    }
}
