//! The Andon daemon as a library, so that tests and the two binaries, `andond` and `andond-video`, share it.
//!
//! Along the data path: [`video`] brings pictures, [`perception`] and, with depth, [`metric`] look at them, [`role`] has the
//! processes of the line, [`wire`] what crosses shared memory, and [`report`] verdicts for people and programs.
//! [`file`] opens what people and other programs made. [`sight`] names what the line cannot see. [`recording`] and [`tool`] run the same code over files, and [`picture`] draws the result. [`cli`], [`config`], [`exit`],
//! [`compatibility`], [`taken`], [`unwritten`] and [`log`] serve them all.
#![forbid(unsafe_code)]

mod atomic;
mod backup;
pub mod cli;
pub mod compatibility;
pub mod config;
pub mod exit;
mod http;
mod identity;
pub mod log;
pub mod metric;
mod outage;
pub mod perception;
pub mod picture;
pub mod recording;
pub mod report;
pub mod role;
pub mod sight;
pub mod taken;
pub mod tool;
pub mod unwritten;
pub mod video;
pub mod wire;

pub use andon_learn::file;
