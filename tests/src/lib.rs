//! Tests that need more than one crate, and their equipment.

pub mod fuzz;
pub mod line;
pub mod simulator;
