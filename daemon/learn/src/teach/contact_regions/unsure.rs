//! What the runs do not show for sure of where hands and objects meet.

use super::trajectory::Trajectories;
use super::{SAME_PLACE_M, in_order, joining};
use crate::recording::{NamedObject, incidental_pairs};
use crate::run::Run;

/// The pairs of these objects that do not count.
pub(in crate::teach) fn incidental(objects: &[NamedObject]) -> impl Iterator<Item = String> {
    incidental_pairs(objects).into_iter().map(|[one, other]| {
        format!(
            "{one} and {other} only come near each other while both are elsewhere: a contact between them is not counted; if there is one, \
             show more runs in which they meet alike"
        )
    })
}

/// What the runs do not show for sure, a sentence each, with what to do.
pub(super) fn of(runs: &[Run], objects: &[NamedObject], shown: &[Trajectories]) -> Vec<String> {
    let mut unsure = Vec::new();
    for (index, object) in objects.iter().enumerate() {
        let is_alone =
            |shown: &Trajectories| shown.carried_frames(index) == 0 && shown.moved_m(index) > SAME_PLACE_M;
        let alone = runs.iter().zip(shown).filter(|(_, shown)| is_alone(shown));
        let alone: Vec<&str> = alone.map(|(run, _)| run.name.as_str()).collect();
        let name = &object.name;
        if !alone.is_empty() {
            unsure.push(format!(
                "{name} was moved in {}, and no hand was seen to carry it: see that the hand stays in view",
                alone.join(", ")
            ));
        }
        if object.shape.is_position_only {
            unsure.push(format!(
                "{name} lies turned in another way in each run and goes the same way: only its position counts; give it \
                 interaction_points if its orientation matters"
            ));
        }
        unsure.extend(brought_beside(index, objects, shown));
        let is_learnt = |object: usize| !objects[object].shape.has_points();
        for other in (0..index).filter(|other| is_learnt(index) && is_learnt(*other)) {
            let count = joining::shown_by(in_order([other, index], shown), shown);
            if (1..shown.len()).contains(&count) {
                unsure.push(format!(
                    "{name} and {} are seen to meet in {count} of {} runs, so where they do is not sure: show more runs in which they \
                     meet, or give them interaction_points",
                    objects[other].name,
                    shown.len()
                ));
            }
        }
    }
    unsure
}

/// That this object is brought to others in most runs, and does not touch them as far as markers show.
fn brought_beside(index: usize, objects: &[NamedObject], shown: &[Trajectories]) -> Vec<String> {
    let others = (0..objects.len()).filter(|other| *other != index);
    let learnt =
        others.filter(|other| [index, *other].iter().all(|object| !objects[*object].shape.has_points()));
    let beside = learnt.filter_map(|other| {
        // What lies there anyway was not brought.
        let is_brought =
            |shown: &&Trajectories| shown.carried_frames(index) > 0 && shown.carried_frames(other) == 0;
        let runs = shown.iter().filter(is_brought);
        let places: Vec<_> = runs.filter_map(|shown| joining::beside([index, other], shown)).collect();
        let is_shown = joining::shown_by(in_order([other, index], shown), shown) > 0;
        if 2 * places.len() < shown.len()
            || places.is_empty()
            || is_shown
            || !joining::are_one_place(&places)
        {
            return None;
        }
        let [object, other] = [index, other].map(|index| &objects[index].name);
        Some(format!(
            "{object} comes to rest {:.0} cm from {other} in {} of {} runs, at the same place: two objects count as touching if their \
             markers are within {:.0} cm, farther apart only if at least three runs show it. \
             So it is not noticed if {object} does not come there; if they touch, show it once more, give both \
             interaction_points, or move the markers nearer to where they do",
            100.0 * places[0].coords.norm(),
            places.len(),
            shown.len(),
            100.0 * joining::TOUCH_M
        ))
    });
    beside.collect()
}
