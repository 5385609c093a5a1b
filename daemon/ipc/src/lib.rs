//! The only crate that calls iceoryx2: channels, ports, waiting, health.
//!
//! [`Steward`] creates every service of a [`Station`] and cleans up after the dead. Every other process opens a
//! [`Node`] and from it the ports it needs; it blocks in [`Node::wait`], never polls, and the answer says why it ended:
//!
//! ```no_run
//! use andon_ipc::{Node, Station, Stop, Wake};
//! use shm_schemas::{Couples, RoleId, Verdict, VerdictKind};
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
//!                 verdict.kind = VerdictKind::NotJudged.code();
//!                 verdicts.send(verdict)?;
//!             }
//!         }
//!         Wake::DeadlineMissed | Wake::WriterGone { .. } => (), // drop ready, say so
//!         Wake::Room => (),
//!         Wake::Stop => return Ok(()),
//!     }
//! }
//! # }
//! ```
//!
//! The data path of one message: [`Writer::loan`] gives a place in shared memory, the caller fills it there,
//! [`Writer::send`] numbers it and wakes the readers, [`Reader::take`] lends the same place to each of them.
//!
//! What can go wrong with the peers and how it is noticed:
//!
//! | what | who notices | how |
//! |---|---|---|
//! | a writer stops or is killed | its readers | [`Wake::WriterGone`], within [`TEND_PERIOD`] |
//! | a writer hangs | its readers | [`Wake::DeadlineMissed`] |
//! | a reader hangs | itself, when it goes on | [`Reader::lost`]; nobody waits for it, unless the writer is paced |
//! | two builds meet | whoever opens | [`Error::LayoutMismatch`] |
//! | the root directory vanishes | the steward | [`Error::RootVanished`] |
#![deny(unsafe_code)]

mod channel;
mod clock;
mod error;
mod event;
mod frame;
mod health;
mod leftovers;
mod loss;
mod node;
mod pace;
mod reader;
mod service;
mod station;
mod steward;
mod stop;
mod wait;
mod writer;

pub use channel::{Carried, Channel, Qos};
pub use clock::{monotonic_ns, utc_ns};
pub use error::Error;
pub use frame::{FrameLoan, FrameReader, FrameSample, FrameWriter};
pub use health::Heartbeat;
pub use node::Node;
pub use reader::{Reader, Sample};
pub use station::{Limits, Member, Station, is_station_name};
pub use steward::{Death, Steward, TEND_PERIOD};
pub use stop::Stop;
pub use wait::{Departure, Paced, Port, Wake};
pub use writer::{Loan, Writer};

/// Version of what the ports say to each other by events; part of what must match when a service is opened.
const PROTOCOL: u32 = 1;
