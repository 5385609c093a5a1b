//! Between what lies in shared memory and what the crates reckon with, one file a message.
//!
//! The crates do not know each other: `andon-perception` and `andon-core` have types of their own and
//! `shm-schemas` has none but wire types. Nothing is computed here.

pub mod command;
pub mod couples;
pub mod detections;
pub mod verdict;
