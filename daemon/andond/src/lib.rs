//! The Andon daemon as a library, so that its binary and tests share it.
//!
//! Along the data path: [`video`] brings pictures, [`perception`] and, with depth, [`metric`] look at them. [`role`] has the processes of the line,
//! [`perceiving`] and [`encoding`] what `perceive` and `encode` do. [`wire`] has what crosses shared memory, and [`report`] verdicts for people and
//! programs. [`file`] opens what people and other programs made. [`sight`] names what the line cannot see. [`recorder`] writes down what they saw.
//! [`recording`] and [`tool`] run the same code over files, and [`picture`] draws the result. [`cli`] and [`compatibility`] serve them all, and so does
//! the crate `andon_host`: configuration, log, exit codes and the cycle of a role.
#![forbid(unsafe_code)]

mod backup;
pub mod blackbox;
mod boards;
pub mod cli;
mod clock;
pub mod compatibility;
mod confirmed;
pub mod encoding;
mod identity;
mod made;
mod made_with;
mod mark;
pub mod metric;
mod outage;
pub mod perceiving;
pub mod perception;
pub mod picture;
pub mod recorder;
pub mod recording;
pub mod report;
pub mod role;
pub mod sight;
mod step_pictures;
pub mod tool;
pub mod video;
pub mod watch;
pub mod wire;

pub use andon_learn::file;
