//! The channels of a station and their quality of service (DESIGN 2).

use shm_schemas::{Command, Confirmed, Couples, Detections, FrameHeader, Health, Layout, Message, Verdict};
use std::fmt;

/// An arrow of DESIGN 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Channel {
    /// capture to perceive.
    Frame,
    /// perceive to encode.
    Detections,
    /// encode to judge.
    Couple,
    /// judge to plc, journal, board, tail.
    Verdict,
    /// journal to plc: what is on disk.
    Confirmed,
    /// every role to steward and board.
    Health,
    /// plc and tool to judge.
    Command,
}

impl Channel {
    /// Every channel.
    pub const ALL: [Self; 7] = [
        Self::Frame,
        Self::Detections,
        Self::Couple,
        Self::Verdict,
        Self::Confirmed,
        Self::Health,
        Self::Command,
    ];

    /// As in service names and logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Frame => "frame",
            Self::Detections => "detections",
            Self::Couple => "couple",
            Self::Verdict => "verdict",
            Self::Confirmed => "confirmed",
            Self::Health => "health",
            Self::Command => "command",
        }
    }

    /// Its quality of service.
    pub const fn qos(self) -> Qos {
        match self {
            // 5 frames: twice the 2 of a paced burst, and one. 2 borrowed: the one being read and the one before it.
            // 4 readers: perceive, board, the one that draws, a tool. More would cost 7 frames of memory each.
            Self::Frame => {
                Qos { buffer: 5, history: 0, borrowed: 2, readers: 4, writers: 1, loans: 8, burst: 2 }
            }
            // 2 s at 30 Hz: encode must hold a debounced contact through a stall of the scheduler.
            Self::Detections => {
                Qos { buffer: 64, history: 1, borrowed: 2, readers: 8, writers: 1, loans: 2, burst: 31 }
            }
            // 8 s at 30 Hz: a lost couple is a hole in a motion, so stalls are bridged for longer.
            Self::Couple => {
                Qos { buffer: 256, history: 1, borrowed: 2, readers: 8, writers: 1, loans: 2, burst: 127 }
            }
            // Some minutes of a busy bench, through any restart of the journal.
            Self::Verdict => {
                Qos { buffer: 1024, history: 256, borrowed: 2, readers: 8, writers: 1, loans: 2, burst: 511 }
            }
            // Only the newest counts: it stands for all before it. 1 in the history, for a plc that starts later.
            Self::Confirmed => {
                Qos { buffer: 4, history: 1, borrowed: 2, readers: 4, writers: 1, loans: 2, burst: 1 }
            }
            // Only the newest counts; 4 a writer so that a reader that looks once a second misses none at 2 Hz.
            // 16 writers: 8 roles and as many tools.
            Self::Health => {
                Qos { buffer: 4, history: 1, borrowed: 2, readers: 4, writers: 16, loans: 2, burst: 1 }
            }
            // No history: a judge that starts must not obey what was said before it was there.
            Self::Command => {
                Qos { buffer: 16, history: 0, borrowed: 2, readers: 2, writers: 4, loans: 2, burst: 7 }
            }
        }
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Quality of service. Overflow is on everywhere: with it off, one stuck reader stops the line. What a reader did not
/// get in time is counted by it, through `seq`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Qos {
    /// Messages that wait for one reader; the oldest gives way.
    pub buffer: usize,
    /// Newest messages that a late reader gets.
    pub history: usize,
    /// Messages that a reader may hold at the same time.
    pub borrowed: usize,
    /// Readers at the same time.
    pub readers: usize,
    /// Writers at the same time.
    pub writers: usize,
    /// Messages that a writer may fill at the same time. For `frame` as many as one reader keeps in use: 5 waiting,
    /// 2 borrowed, 1 being filled; they are touched before the first frame.
    pub loans: usize,
    /// Messages that a paced writer sends before it waits for its readers; see `pace` for why under half of `buffer`.
    pub burst: usize,
}

impl Qos {
    /// Messages that one writer's memory must hold so that a loan never fails (iceoryx2's own formula).
    pub(crate) const fn chunks(&self) -> usize {
        self.readers * (self.buffer + self.borrowed) + self.history + self.loans
    }
}

/// A message of fixed size and the channel that carries it. Frames have ports of their own.
pub trait Carried: Message {
    /// The channel.
    const CHANNEL: Channel;
}

impl Carried for Detections {
    const CHANNEL: Channel = Channel::Detections;
}
impl Carried for Couples {
    const CHANNEL: Channel = Channel::Couple;
}
impl Carried for Verdict {
    const CHANNEL: Channel = Channel::Verdict;
}
impl Carried for Confirmed {
    const CHANNEL: Channel = Channel::Confirmed;
}
impl Carried for Health {
    const CHANNEL: Channel = Channel::Health;
}
impl Carried for Command {
    const CHANNEL: Channel = Channel::Command;
}

/// Bytes of one message of each channel; frames by their limit.
pub(crate) fn message_bytes(channel: Channel, frame_bytes: usize) -> usize {
    match channel {
        Channel::Frame => frame_bytes + size_of::<FrameHeader>(),
        Channel::Detections => size_of::<Detections>(),
        Channel::Couple => size_of::<Couples>(),
        Channel::Verdict => size_of::<Verdict>(),
        Channel::Confirmed => size_of::<Confirmed>(),
        Channel::Health => size_of::<Health>(),
        Channel::Command => size_of::<Command>(),
    }
}

/// The layout of a message as it stands in the service's attribute.
pub(crate) fn layout_text<T: Layout>() -> String {
    format!("{:016x}/{}", T::HASH, crate::PROTOCOL)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_bursts_and_the_history_fit_every_buffer() {
        for channel in Channel::ALL {
            let qos = channel.qos();
            assert!(2 * qos.burst <= qos.buffer, "{channel}: {qos:?}");
            assert!(qos.history <= qos.buffer, "{channel}: {qos:?}");
        }
    }
}
