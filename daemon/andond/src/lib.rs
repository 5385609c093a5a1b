//! The Andon daemon as a library, so that tests and the two binaries share it.
//!
//! Along the data path: [`video`] pictures in → `role` one process each → `wire` what crosses shared memory;
//! `recording` and `tool` run the same code over files. `config`, `exit` and `log` serve them all.

pub mod video;
