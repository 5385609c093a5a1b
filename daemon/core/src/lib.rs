//! The method: from hands and objects on a bench to verdicts.
//!
//! The data path, in the order of the modules:
//!
//! [`input`] what was seen in one frame → [`couple`] its feature couple `X = (x_m, x_c)` →
//! [`segment`] ERU, IU, activity, job → [`dtw`] distance to the taught references →
//! [`anomaly`] verdicts against the nominal activities of a [`job`].
//!
//! No clock, no allocation, no IO: time, configuration and memory are arguments.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod anomaly;
pub mod capacity;
pub mod config;
pub mod couple;
pub mod dtw;
pub mod input;
pub mod job;
pub mod segment;
pub mod verdict;
