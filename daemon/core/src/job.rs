//! A taught job: the list `J` of nominal activities with their references and thresholds (paper III-D).
//!
//! Core borrows all of it: who loads the job file owns the memory.

use crate::couple::{Context, Motion};

/// How two motion features are compared (DESIGN 4, "DTW").
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocalCost {
    /// The paper's: every feature is a number on an ordered range, squared Euclidean.
    Ordinal,
    /// Directions are points on the unit circle and rest is its centre; the other features as in `Ordinal`.
    Circular {
        /// N, the number of direction bins around the circle.
        bins: u8,
    },
}

/// An inclusive range of counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// Least that is right.
    pub least: u32,
    /// Most that is right.
    pub most: u32,
}

/// One IU of a nominal activity.
#[derive(Clone, Copy, Debug)]
pub struct NominalIu<'a> {
    /// The context that it is in.
    pub context: Context,
    /// The barycentre of its demonstrations, one motion a frame of the grid.
    pub reference: &'a [Motion],
    /// Greatest DTW distance that is right, in the units of `dtw_ndim.distance`, of an execution that is no longer than the
    /// reference; a slower one has [`Job::slowness`].
    pub threshold: f32,
    /// How long it may last, in frames of the grid.
    pub frames: Bounds,
    /// How often the motion may turn back (see `segment`): tells a repeated motion that was cut short.
    pub reversals: Bounds,
}

/// One nominal activity, the sequence of IUs that makes it.
#[derive(Clone, Copy, Debug)]
pub struct NominalActivity<'a> {
    /// Which activity of the job this sequence fulfils. Several sequences may fulfil the same one.
    pub activity: u16,
    /// Its IUs in order.
    pub ius: &'a [NominalIu<'a>],
}

/// A job as it was taught.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// The list `J`.
    pub activities: &'a [NominalActivity<'a>],
    /// Whether the activities must come in the order of their numbers.
    pub order_matters: bool,
    /// How motions are compared.
    pub cost: LocalCost,
    /// Up to how many times longer than its reference an IU may be for its threshold to grow with it, from 1. A DTW distance grows with the
    /// number of frames, and what is slower also has less acceleration and more rest, so each frame is farther as well.
    /// 1 leaves the thresholds as they are, as in the paper.
    pub slowness: f32,
}

/// The factor by which the threshold grows for an IU of so many frames: how many times longer than its reference it is, at most
/// `slowness` times.
pub fn allowance(frames: u32, reference: usize, slowness: f32) -> f32 {
    (frames as f32 / reference.max(1) as f32).clamp(1.0, slowness.max(1.0))
}
