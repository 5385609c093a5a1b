//! Conversions between the messages in shared memory and the types of the crates, one file per message.
//!
//! The crates do not know each other: `andon-perception` and `andon-core` have types of their own, and `shm-schemas` has only wire types.
//! Nothing is computed here.

pub mod command;
pub mod couples;
pub mod detections;
pub mod verdict;
