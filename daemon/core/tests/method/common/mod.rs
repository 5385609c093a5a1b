//! A worker at a bench, scripted: as frames for the encoder, and as couples for what comes after it.

pub(crate) mod bench;
pub(crate) mod cases;
pub(crate) mod gaps;
pub(crate) mod hiding;
pub(crate) mod script;
pub(crate) mod seed;
pub(crate) mod work;
