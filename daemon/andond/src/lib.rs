//! The Andon daemon as a library, so that tests and the two binaries share it.
//!
//! Along the data path: [`video`] pictures in → [`perception`] as configured, [`metric`] with depth → [`role`] one process each → [`wire`] what
//! crosses shared memory → [`report`] verdicts for people and programs. [`recording`] and [`tool`] run the same code over
//! files, and [`picture`] draws it. [`cli`], [`config`], [`exit`], [`fit`] and [`log`] serve them all.
#![forbid(unsafe_code)]

pub mod cli;
pub mod config;
pub mod exit;
pub mod fit;
pub mod journal;
pub mod log;
pub mod metric;
pub mod perception;
pub mod picture;
pub mod recording;
pub mod report;
pub mod role;
pub mod tool;
pub mod video;
pub mod wire;
