//! What lies in shared memory: `repr(C)` structs of integers and `f32`, without padding by the compiler.
//!
//! | channel | message |
//! |---|---|
//! | `frame` | [`FrameHeader`], the user header of a `[u8]` slice |
//! | `detections` | [`Detections`] |
//! | `couple` | [`Couples`] |
//! | `verdict` | [`Verdict`] |
//! | `account` | [`AccountUpdate`] |
//! | `kept` | [`AccountKept`] |
//! | `journalled` | [`Journalled`] |
//! | `health` | [`Health`] |
//! | `command` | [`Command`] |
//! | `judging` | [`Judging`] |
//! | `audit` | [`Audit`] |
//! | `task` | [`Task`] |
//! | `printed` | [`Printed`] |
//! | `film` | [`FilmPiece`] |
//!
//! Every message begins with a [`Stamp`]. Every type has a [`Layout`]: a hash of the names, types and offsets of its fields.
//! It is an attribute of the service, so that two builds which disagree never exchange messages.
//!
//! # Two clocks
//!
//! [`Stamp::captured_ns`] and [`Stamp::sent_ns`] are CLOCK_MONOTONIC, for latencies. The method computes with *source time* (`source_ns`, `began_ns`,
//! ...). Of a live camera that is CLOCK_MONOTONIC as well, of a recording the time since its first frame. So a replay at any speed gives the same
//! verdicts.
#![no_std]

mod account;
mod audit;
mod code;
mod columns;
mod command;
mod couples;
mod detections;
mod film;
mod frame;
mod health;
mod judging;
mod layout;
mod measured;
mod part;
mod stamp;
mod task;
mod text;
mod verdict;

pub use account::{Account, AccountKept, AccountUpdate, CONSUMERS, Journalled, WAITING_RESULTS};
pub use audit::{Audit, AuditKind};
pub use code::UnknownCode;
pub use columns::{COLUMNS, Column, Value};
pub use command::{Command, CommandKind, CommandSource};
pub use couples::{Couples, HandCouple};
pub use detections::{Detections, HandDetection, LANDMARKS, ObjectDetection};
pub use film::{FILM_BYTES, FilmPiece, PIECE_BYTES};
pub use frame::{ColourFormat, DepthFormat, Distortion, Extrinsics, FrameHeader, Intrinsics};
pub use health::{Health, RoleId, RoleState, Sight};
pub use judging::{JudgePhase, Judging, Refusal};
pub use layout::{Layout, bytes_of, from_bytes};
pub use measured::{MeasuredWords, decimals};
pub use part::{BadPart, PART_BYTES, PartId};
pub use stamp::{Message, MessageId, Stamp};
pub use task::{
    PRINTED_TEXT_BYTES, Printed, PrintedState, Showing, TASK_LATE_NS, TASK_NAME_BYTES, TASK_TEXT_BYTES, Task,
    TaskKind, task_flag,
};
pub use verdict::{
    HandCode, NO_INDEX, NO_PERCENT, OrderFault, STATION_BYTES, Verdict, VerdictLevel, VerdictMeasure,
    VerdictNote, VerdictOutcome, VerdictReason, verdict_kind,
};

/// Maximum number of hands in one message: those of one worker.
pub const HANDS: usize = 2;

/// Maximum number of objects in one message.
pub const OBJECTS: usize = 32;

/// Bits of the `flags` of a message.
pub mod flag {
    /// The recording has ended and nothing follows from this source. The message may carry no data.
    /// It travels from the frame to the couples, so that a replay ends on the same frame as the running line.
    pub const END_OF_STREAM: u32 = 1;
    /// The source waits for its readers so that nothing is lost, and so does every role that sends what follows from it.
    pub const PACED: u32 = 1 << 1;
    /// Of detections: the line was not watching when the frame was captured, and what they hold is no observation.
    pub const UNSEEN: u32 = 1 << 6;
    /// The object was seen in this frame.
    pub const SEEN: u16 = 1;
    /// The object's marker is in view twice, so that it was not seen in this frame.
    pub const TWICE: u16 = 1 << 1;
}
