//! Tests that need more than one crate, and their equipment.

pub mod simulator;
