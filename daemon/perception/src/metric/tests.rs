//! Oracles: librealsense's own numbers, OpenCV's, and scenes whose geometry is written down here.
#![allow(clippy::unwrap_used)]

mod hand;
mod lens;
mod pose;
mod scene;
mod surface;
