//! The sections: their fields, defaults, allowed ranges and meanings, in the order of the data path.

pub(super) mod bench;
pub(super) mod board;
pub(super) mod camera;
pub(super) mod executor;
pub(super) mod method;
pub(super) mod perception;
pub(super) mod record;
pub(super) mod service;
pub(super) mod station;
