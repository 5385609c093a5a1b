//! What the line's own sight is worth.
//!
//! [`Picture`](crate::Picture) measures a picture, [`SightMonitor`] follows the measures and what was detected, and says when the line cannot see. Neither has
//! a clock: the time of each picture is given.
//!
//! A bench may be empty, change, lie in the shade or under a new lamp, and nothing is wrong. So a picture is held against what this
//! camera has shown so far, and whoever still finds markers or hands is not blind.

mod camera;
mod monitor;
mod observation;

#[cfg(test)]
mod tests;

pub use monitor::{Expected, Rates, SightMonitor, Spell, Trouble};
pub use observation::{Corners, Observation, SeenMarker};
