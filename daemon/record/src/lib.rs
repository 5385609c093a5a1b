//! Recordings of a line: everything that its channels carry, so that each verdict can be looked at again, judged again and taught.
//!
//! A recording is an MCAP file. On `/raw/CHANNEL` are the bytes of each message as they were in shared memory, in the order in which the recorder
//! received them. Their schema is the layout hash. On `/losses` are the messages that it did not get. Beside them are topics that viewers understand:
//! `/camera`, `/log`, `/distance_over_threshold` and `/measure` ([`viewer`]). The configuration, the job and the calibration are attached. So it can be
//! judged again on any machine. Also attached is what pictures were looked at with: the program, the hashes of models and libraries, and the features of
//! the processor. Where these are the same, and the camera sends JPEG, its pictures can be looked at again with the same result.
//!
//! The time of a message is that of the picture that it comes from; that of its sending is its publish time. Both are UTC in a file.
//!
//! [`role`] receives, [`recorder`] decides what is recorded, [`disk`] writes it in a thread of its own, and [`store`] keeps the folder within its
//! budget. [`reader`] reads, and [`repair`](repair()) completes a recording that a kill has cut. Beside each recording lies its [`index`]. With
//! `record.mode = "off"`, [`retention`] alone runs.
#![forbid(unsafe_code)]

pub mod disk;
pub mod index;
pub mod picture;
pub mod places;
pub mod reader;
pub mod recorder;
mod repair;
pub mod retention;
pub mod ring;
pub mod role;
pub mod store;
mod topic;
pub mod viewer;
mod writer;

pub use reader::{End, Item, ReadError, RecordingReader};
pub use repair::{RepairError, Repaired, repair};
pub use role::Losses;
pub use topic::Topic;
pub use writer::{Attachment, Entry, RecordingWriter};
