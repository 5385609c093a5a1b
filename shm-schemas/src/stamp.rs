//! The stamp with which every message begins.

use core::fmt;

use crate::layout::{Layout, wire};
use iceoryx2_bb_elementary_traits::zero_copy_send::ZeroCopySend;

wire! { "andon.Stamp", 40;
    /// Who sent a message and when, and from which frame it comes: enough for any reader to compute every latency and every loss.
    struct Stamp {
        /// The number of this message among those of its writer, from 1 in every epoch; 0 before it is sent.
        seq: u64,
        /// A number of its own for each start of the writer. When it changes, a reader starts to count again.
        epoch: u64,
        /// `seq` of the newest frame that this message depends on; 0 when it depends on none.
        frame_seq: u64,
        /// When that frame was captured, CLOCK_MONOTONIC in nanoseconds; 0 when it depends on none.
        captured_ns: u64,
        /// When this message was sent, CLOCK_MONOTONIC in nanoseconds.
        sent_ns: u64,
    }
}

/// Which message of a channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MessageId {
    /// The start of the writer that sent it, see [`Stamp::epoch`].
    pub epoch: u64,
    /// Its number in this epoch, from 1; 0 for none.
    pub seq: u64,
}

/// `EPOCH-SEQ`: its name in files, addresses and texts.
impl fmt::Display for MessageId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}", self.epoch, self.seq)
    }
}

impl MessageId {
    /// The message of this name; `None` where it is none.
    pub fn named(name: &str) -> Option<Self> {
        let (epoch, seq) = name.split_once('-')?;
        Some(Self { epoch: epoch.parse().ok()?, seq: seq.parse().ok()? })
    }
}

impl Stamp {
    /// Which message this is.
    pub const fn id(&self) -> MessageId {
        MessageId { epoch: self.epoch, seq: self.seq }
    }
}

/// A wire type that begins with a [`Stamp`] and travels on a channel.
pub trait Message: Layout + ZeroCopySend + Default + core::fmt::Debug {
    /// Who sent it and when, and which frame it depends on.
    fn stamp(&self) -> &Stamp;
    /// The same, for the writer's port, which numbers its messages.
    fn stamp_mut(&mut self) -> &mut Stamp;
}

/// Makes wire structs that begin with `stamp: Stamp` messages.
macro_rules! message {
    ($name:ident) => {
        impl $crate::stamp::Message for $name {
            fn stamp(&self) -> &$crate::stamp::Stamp {
                &self.stamp
            }
            fn stamp_mut(&mut self) -> &mut $crate::stamp::Stamp {
                &mut self.stamp
            }
        }
        const _: () = assert!(core::mem::offset_of!($name, stamp) == 0, "the stamp comes first");
    };
}

pub(crate) use message;
