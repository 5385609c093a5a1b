//! Pictures between the programs of a station: as a stream between two of them, and in the frames of shared memory.

pub mod frame;
pub mod pipe;
