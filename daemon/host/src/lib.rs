//! What every program of a station needs, whatever it does: `andond`, `andond-video`, and a role that gets a program of its own.
//!
//! [`cli`] names the configuration on the command line, [`config`] reads it, and [`taken`] keeps it while the line runs. [`role`] is the life
//! cycle of a process of the line, [`log`] and [`exit`] say how it does and how it ends. [`atomic`] and [`unwritten`] are for files that are
//! written. [`video`] is what crosses the pipe to `andond-video`, and how a frame becomes a picture.
#![forbid(unsafe_code)]

pub mod atomic;
pub mod cli;
pub mod config;
pub mod exit;
pub mod log;
pub mod role;
pub mod taken;
pub mod unwritten;
pub mod video;
