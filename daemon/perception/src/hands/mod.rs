//! Hands by the MediaPipe models, in pixels.
//!
//! [`palm`] finds palms anywhere in the picture, and [`models`] finds 21 landmarks in a [`region`] of it. A hand that was
//! found is followed: the landmarks of one frame give the region of the next ([`tracker`]), and palm detection pauses.

mod crop;
mod empty_bench;
mod landmarker;
mod light;
mod models;
mod palm;
mod region;
mod runtime;
mod side;
mod tracker;

#[cfg(test)]
mod tests;

pub(crate) use models::{OnnxLandmarks, OnnxPalms};
pub(crate) use tracker::{Found, Tracker};
