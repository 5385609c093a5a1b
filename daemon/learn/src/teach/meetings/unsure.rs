//! What the runs do not show for sure of where hands and objects meet.

use super::trajectory::Trajectories;
use super::{in_order, joining};
use crate::recording::{NamedObject, incidental_pairs};
use crate::run::Run;
use std::fmt;

/// An object that is elsewhere at the end, by at least this, has been moved, in metres.
const MOVED_M: f32 = 0.05;

/// Something that the runs do not show for sure. `Display` says it in one sentence, with what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unsure {
    /// An object was moved, and no hand was seen to carry it.
    MovedAlone {
        /// The name of the object.
        object: String,
        /// The names of the runs.
        runs: Vec<String>,
    },
    /// Not all runs show two objects to meet.
    SeldomMet {
        /// The names of the two.
        objects: [String; 2],
        /// How many runs show it.
        runs: usize,
        /// Of how many.
        of: usize,
    },
    /// Most runs show an object to be brought to the same place beside another one, too far away for two that touch.
    Beside {
        /// The name of what is brought.
        object: String,
        /// The name of the other one.
        other: String,
        /// The distance of their markers, in centimetres.
        apart_cm: u32,
        /// How many runs show it.
        runs: usize,
        /// Of how many.
        of: usize,
    },
    /// Two objects come near each other by chance only.
    Incidental {
        /// The names of the two.
        objects: [String; 2],
    },
    /// The orientation of an object is not used.
    PositionOnly {
        /// The name of the object.
        object: String,
    },
}

impl fmt::Display for Unsure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MovedAlone { object, runs } => write!(
                f,
                "{object} was moved in {}, and no hand was seen to carry it: see that the hand stays in view",
                runs.join(", ")
            ),
            Self::SeldomMet { objects: [one, other], runs, of } => write!(
                f,
                "{one} and {other} are seen to meet in {runs} of {of} runs, so where they do is not sure: show more runs in which they \
                 meet, or give them interaction_points"
            ),
            Self::Beside { object, other, apart_cm, runs, of } => write!(
                f,
                "{object} comes to rest {apart_cm} cm from {other} in {runs} of {of} runs, at the same place: two objects count as touching if their \
                 markers are within {:.0} cm, farther apart only if at least three runs show it, so that it is not noticed if {object} does not come there; if they touch, show it once more, give both interaction_points, or move the \
                 markers nearer to where they do",
                100.0 * joining::TOUCH_M
            ),
            Self::Incidental { objects: [one, other] } => write!(
                f,
                "{one} and {other} only come near each other while both are elsewhere: a contact between them is not counted; if there is one, \
                 show more runs in which they meet alike"
            ),
            Self::PositionOnly { object } => write!(
                f,
                "{object} lies turned in another way in each run and goes the same way: only its position counts; give it \
                 interaction_points if its orientation matters"
            ),
        }
    }
}

impl Unsure {
    /// The pairs of these objects that do not count.
    pub(in crate::teach) fn incidental(objects: &[NamedObject]) -> Vec<Self> {
        incidental_pairs(objects).into_iter().map(|objects| Self::Incidental { objects }).collect()
    }
}

pub(super) fn of(runs: &[Run], objects: &[NamedObject], shown: &[Trajectories]) -> Vec<Unsure> {
    let mut unsure = Vec::new();
    for (index, object) in objects.iter().enumerate() {
        let is_alone =
            |shown: &Trajectories| shown.carried_frames(index) == 0 && shown.moved_m(index) > MOVED_M;
        let alone = runs.iter().zip(shown).filter(|(_, shown)| is_alone(shown));
        let runs: Vec<String> = alone.map(|(run, _)| run.name.clone()).collect();
        if !runs.is_empty() {
            unsure.push(Unsure::MovedAlone { object: object.name.clone(), runs });
        }
        if object.shape.is_position_only {
            unsure.push(Unsure::PositionOnly { object: object.name.clone() });
        }
        unsure.extend(brought_beside(index, objects, shown));
        let is_learnt = |object: usize| !objects[object].shape.has_points();
        for other in (0..index).filter(|other| is_learnt(index) && is_learnt(*other)) {
            let count = joining::shown_by(in_order([other, index], shown), shown);
            if (1..shown.len()).contains(&count) {
                let names = [index, other].map(|object| objects[object].name.clone());
                unsure.push(Unsure::SeldomMet { objects: names, runs: count, of: shown.len() });
            }
        }
    }
    unsure
}

/// The objects that this one is brought to in most runs, and does not touch as far as markers show.
fn brought_beside(index: usize, objects: &[NamedObject], shown: &[Trajectories]) -> Vec<Unsure> {
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
        (2 * places.len() >= shown.len()
            && !places.is_empty()
            && !is_shown
            && joining::are_one_place(&places))
        .then(|| Unsure::Beside {
            object: objects[index].name.clone(),
            other: objects[other].name.clone(),
            apart_cm: (100.0 * places[0].coords.norm()).round() as u32,
            runs: places.len(),
            of: shown.len(),
        })
    });
    beside.collect()
}
