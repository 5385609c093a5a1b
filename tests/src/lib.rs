//! Tests that need more than one crate, and their equipment.
#![forbid(unsafe_code)]

pub mod fuzz;
pub mod line;
pub mod simulator;
