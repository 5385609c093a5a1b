//! What the runs do not show for sure of where hands and objects meet.

use super::trajectory::Trajectories;
use super::{in_order, is_given, joining};
use crate::recording::NamedObject;
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
            Self::PositionOnly { object } => write!(
                f,
                "{object} lies turned in another way in each run and goes the same way: only its position counts; give it \
                 interaction_points if its orientation matters"
            ),
        }
    }
}

pub(super) fn of(runs: &[Run], objects: &[NamedObject], shown: &[Trajectories]) -> Vec<Unsure> {
    let mut unsure = Vec::new();
    for (index, object) in objects.iter().enumerate() {
        let is_alone =
            |shown: &Trajectories| shown.carried(index).is_empty() && shown.moved_m(index) > MOVED_M;
        let alone = runs.iter().zip(shown).filter(|(_, shown)| is_alone(shown));
        let runs: Vec<String> = alone.map(|(run, _)| run.name.clone()).collect();
        if !runs.is_empty() {
            unsure.push(Unsure::MovedAlone { object: object.name.clone(), runs });
        }
        if object.shape.is_position_only {
            unsure.push(Unsure::PositionOnly { object: object.name.clone() });
        }
        let is_learnt = |object: usize| !is_given(&objects[object].shape);
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
