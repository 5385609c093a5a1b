//! The only crate that calls iceoryx2: channels, ports, waiting, health.
//!
//! [`Steward`] creates every service of a [`Station`] and removes what dead processes leave behind. Every other process opens a
//! [`Node`] and with it the ports that it needs. It blocks in [`Node::wait`], which tells why it ended:
//!
//! ```no_run
//! use andon_ipc::{Node, Station, Stop, Wake};
//! use shm_schemas::{Couples, RoleId, Verdict, VerdictLevel, VerdictOutcome};
//! use std::time::Duration;
//!
//! # fn main() -> Result<(), andon_ipc::Error> {
//! let stop = Stop::on_signals()?;
//! let station = Station::new("bench1")?;
//! let node = Node::open(&station, RoleId::Judge, Duration::from_secs(5), &stop)?;
//! let mut couples = node.reader::<Couples>()?;
//! let mut verdicts = node.writer::<Verdict>()?;
//! loop {
//!     match node.wait(&mut [&mut couples, &mut verdicts], Duration::from_millis(500))? {
//!         Wake::Sample => {
//!             while let Some(couple) = couples.take()? {
//!                 let mut verdict = verdicts.loan()?;
//!                 verdict.follow(&couple.stamp);
//!                 verdict.level = VerdictLevel::Iu.code();
//!                 verdict.outcome = VerdictOutcome::NotJudged.code();
//!                 verdicts.send(verdict)?;
//!             }
//!         }
//!         Wake::DeadlineMissed | Wake::WriterGone { .. } => (), // no longer ready
//!         Wake::Room => (),
//!         Wake::Stop => return Ok(()),
//!     }
//! }
//! # }
//! ```
//!
//! The data path of one message. [`Writer::loan`] gives a place in shared memory, and the caller fills it there. [`Writer::send`] numbers it and
//! wakes the readers, and [`Reader::take`] lends the same place to each of them.
//!
//! What can go wrong with other processes, and who notices it how:
//!
//! | what | who notices | how |
//! |---|---|---|
//! | a writer stops or is killed | its readers | [`Wake::WriterGone`], within [`POLL_PERIOD`] |
//! | a writer hangs | its readers | [`Wake::DeadlineMissed`] |
//! | a reader hangs | the reader, when it goes on | [`Reader::lost`]; nobody waits for it, unless the writer is paced |
//! | a connection cannot be made | the port at its end | it is recreated with its history, until that works |
//! | two builds meet | the process that opens a port | [`Error::LayoutMismatch`] |
//! | the root directory vanishes | the steward, and everybody who asks | [`Error::RootVanished`], [`Node::check_root`] |
//! | /dev/shm fills up | the process that makes a port | [`Error::NoRoom`]: what a port may use is reserved when it is made |
#![deny(unsafe_code)]

mod channel;
mod clock;
mod connection;
mod error;
mod event;
mod frame;
mod health;
mod leftovers;
mod loss;
mod node;
mod pace;
mod publication;
mod reader;
mod service;
mod station;
mod steward;
mod stop;
mod subscription;
mod wait;
mod writer;

pub use channel::{Channel, ChannelMessage, Qos};
pub use clock::{MonotonicTime, SourceTime, UtcTime};
pub use error::Error;
pub use frame::{FrameLoan, FrameReader, FrameSample, FrameWriter};
pub use health::Heartbeat;
pub use leftovers::Death;
pub use node::Node;
pub use reader::{Reader, Sample};
pub use station::{Limits, Member, Station, is_station_name};
pub use steward::{POLL_PERIOD, Steward};
pub use stop::Stop;
pub use wait::{Departure, Paced, Port, Wake};
pub use writer::{Loan, Writer};
