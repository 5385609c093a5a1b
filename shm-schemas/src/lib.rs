//! What lies in shared memory: `repr(C)` data only, integers and `f32` only, no padding that the compiler chose.
//!
//! | channel | message |
//! |---|---|
//! | `frame` | [`FrameHeader`], the user header of a `[u8]` slice |
//! | `detections` | [`Detections`] |
//! | `couple` | [`Couples`] |
//! | `verdict` | [`Verdict`] |
//! | `confirmed` | [`Confirmed`] |
//! | `health` | [`Health`] |
//! | `command` | [`Command`] |
//!
//! Every message begins with a [`Stamp`]. Every type has a [`Layout`]: a hash of its fields' names, types and places,
//! which is an attribute of the service, so that two builds that disagree never talk past each other.
//!
//! # Two clocks
//!
//! [`Stamp::captured_ns`] and [`Stamp::sent_ns`] are CLOCK_MONOTONIC, to compute latencies. Everything that the method
//! reckons with (`source_ns`, `began_ns`, ...) is *source time*: for a live camera CLOCK_MONOTONIC as well, for a
//! recording the time since its first frame, so that a replay at any speed gives the same verdicts.
#![no_std]

mod code;
mod command;
mod confirmed;
mod couples;
mod detections;
mod frame;
mod health;
mod layout;
mod stamp;
mod verdict;

pub use code::UnknownCode;
pub use command::{Command, CommandKind, CommandSource};
pub use confirmed::Confirmed;
pub use couples::{Couples, HandCouple};
pub use detections::{Detections, HandDetection, LANDMARKS, ObjectDetection};
pub use frame::{ColourFormat, DepthFormat, Distortion, Extrinsics, FrameHeader, Intrinsics};
pub use health::{Health, RoleId, RoleState};
pub use layout::{Layout, Message};
pub use stamp::Stamp;
pub use verdict::{HandCode, NO_INDEX, STATION_BYTES, Verdict, VerdictKind, VerdictReason};

/// Hands in one message: one worker.
pub const HANDS: usize = 2;

/// Objects in one message.
pub const OBJECTS: usize = 32;

/// Bits of the `flags` of a message.
pub mod flag {
    /// Nothing follows from this source: the recording has ended. The message may carry no data.
    pub const END_OF_STREAM: u32 = 1;
    /// Coordinates are metric (depth was used); otherwise they lie in the plane of the bench.
    pub const METRIC: u32 = 1 << 1;
    /// The source waits for its readers so that nothing is lost; so does whoever sends what follows from it.
    pub const PACED: u32 = 1 << 2;
    /// The hand was seen, or is held over a gap that is shorter than `blind_ms`.
    pub const SIGHTED: u8 = 1;
    /// The hand itself was seen in this frame: what tells a job that has ended from one that rests.
    pub const HAND_SEEN: u8 = 1 << 1;
    /// The object was seen in this frame.
    pub const SEEN: u16 = 1;
    /// The object was hidden and its pose is held from the hand that carries it.
    pub const HELD: u16 = 1 << 1;
}
