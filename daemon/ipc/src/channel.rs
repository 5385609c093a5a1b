//! The channels of a station and their quality of service.

use shm_schemas::{
    AccountKept, AccountUpdate, Audit, Command, Couples, Detections, FilmPiece, FrameHeader, Health,
    Journalled, Judging, Layout, Message, Printed, Task, Verdict,
};
use std::fmt;

/// A channel: one kind of message, on its way from one role to others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Channel {
    /// From capture to perceive.
    Frame,
    /// From perceive to encode.
    Detections,
    /// From encode to judge.
    Couple,
    /// From judge to plc, journal and the tools.
    Verdict,
    /// From the consumers of the journal to it: what each has been told, to be kept.
    Account,
    /// From journal to its consumers: which accounts are on disk.
    Kept,
    /// From journal to its consumers: the verdicts that are on disk, row by row.
    Journalled,
    /// From every role to plc and the tools.
    Health,
    /// From plc to judge.
    Command,
    /// From judge to plc and the tools: what it is doing, and what became of the last command.
    Judging,
    /// From the roles to journal: who has changed what.
    Audit,
    /// From board to executor: which command of `andond` is to run.
    Task,
    /// From executor to board: what it prints.
    Printed,
    /// From board to executor: recordings that engineers send, piece by piece.
    Film,
}

impl Channel {
    /// Every channel.
    pub const ALL: [Self; 14] = [
        Self::Frame,
        Self::Detections,
        Self::Couple,
        Self::Verdict,
        Self::Account,
        Self::Kept,
        Self::Journalled,
        Self::Health,
        Self::Command,
        Self::Judging,
        Self::Audit,
        Self::Task,
        Self::Printed,
        Self::Film,
    ];

    /// The name in service names and logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Frame => "frame",
            Self::Detections => "detections",
            Self::Couple => "couple",
            Self::Verdict => "verdict",
            Self::Account => "account",
            Self::Kept => "kept",
            Self::Journalled => "journalled",
            Self::Health => "health",
            Self::Command => "command",
            Self::Judging => "judging",
            Self::Audit => "audit",
            Self::Task => "task",
            Self::Printed => "printed",
            Self::Film => "film",
        }
    }

    /// The hash of the layout of its messages; of frames that of their header.
    pub const fn layout(self) -> u64 {
        match self {
            Self::Frame => FrameHeader::HASH,
            Self::Detections => Detections::HASH,
            Self::Couple => Couples::HASH,
            Self::Verdict => Verdict::HASH,
            Self::Account => AccountUpdate::HASH,
            Self::Kept => AccountKept::HASH,
            Self::Journalled => Journalled::HASH,
            Self::Health => Health::HASH,
            Self::Command => Command::HASH,
            Self::Judging => Judging::HASH,
            Self::Audit => Audit::HASH,
            Self::Task => Task::HASH,
            Self::Printed => Printed::HASH,
            Self::Film => FilmPiece::HASH,
        }
    }

    /// The quality of service of this channel.
    pub const fn qos(self) -> Qos {
        match self {
            // 5 frames wait: twice the 2 of a paced burst, and one more. 2 are borrowed: the one being read and the one before it.
            // 4 readers: perceive, record, and two of the tools and the board while somebody looks. Each further reader would cost 7 frames of memory.
            Self::Frame => {
                Qos { buffer: 5, history: 0, borrowed: 2, readers: 4, writers: 1, loans: 8, burst: 2 }
            }
            // 2 s at 30 Hz: a stall of the scheduler must not cost encode a contact that it is confirming.
            Self::Detections => {
                Qos { buffer: 64, history: 1, borrowed: 2, readers: 8, writers: 1, loans: 2, burst: 31 }
            }
            // 8 s at 30 Hz: a lost couple is a hole in a motion, so longer stalls are bridged.
            Self::Couple => {
                Qos { buffer: 256, history: 1, borrowed: 2, readers: 8, writers: 1, loans: 2, burst: 127 }
            }
            // Some minutes of a busy bench: longer than any restart of the journal.
            Self::Verdict => {
                Qos { buffer: 1024, history: 256, borrowed: 2, readers: 8, writers: 1, loans: 2, burst: 511 }
            }
            // Only the newest of each consumer counts, because it includes all before it. A history of 1, for a journal that starts later.
            // 8 writers: the consumers, and those that are dead and not yet removed.
            Self::Account => {
                Qos { buffer: 16, history: 1, borrowed: 2, readers: 4, writers: 8, loans: 2, burst: 1 }
            }
            // Only the newest of each consumer counts. No history: what is older would be taken for what is kept, so who starts later asks.
            Self::Kept => {
                Qos { buffer: 16, history: 0, borrowed: 2, readers: 8, writers: 1, loans: 2, burst: 1 }
            }
            // What is lost is asked for again. So this only has to hold what the journal sends between two looks of a consumer: 32 rows for each.
            Self::Journalled => {
                Qos { buffer: 128, history: 0, borrowed: 2, readers: 8, writers: 1, loans: 2, burst: 31 }
            }
            // Only the newest counts. 4 per writer, so that a reader that looks once per second misses none at 2 Hz. 16 writers: 11 roles, and those
            // that are dead and not yet removed. 16 readers: plc, journal, programs in C, and each `andond status` that was left stopped in a
            // terminal.
            Self::Health => {
                Qos { buffer: 4, history: 1, borrowed: 2, readers: 16, writers: 16, loans: 2, burst: 1 }
            }
            // To all but the recorder only the newest counts. It needs each: what became of a command, and where. 64: in 20 s of a busy machine the judge
            // repeats its state 40 times, and a PLC can give more than ten commands. A history of 1, for a reader that starts later. 16 readers: five
            // roles, those that are dead and not yet removed, the tools and programs in C.
            Self::Judging => {
                Qos { buffer: 64, history: 1, borrowed: 2, readers: 16, writers: 1, loans: 2, burst: 1 }
            }
            // Each writer keeps what was done while the journal was away. A person does less than that in such a time. 6 readers: journal, record,
            // board, and those that are dead and not yet removed.
            Self::Audit => {
                Qos { buffer: 64, history: 32, borrowed: 2, readers: 6, writers: 8, loans: 2, burst: 31 }
            }
            // No history: a judge that starts must not obey a command from before its start. 4 readers: judge, record, and those that are dead and
            // not yet removed. So a judge that starts again waits for nobody.
            Self::Command => {
                Qos { buffer: 16, history: 0, borrowed: 2, readers: 4, writers: 4, loans: 2, burst: 7 }
            }
            // No history: an executor that starts must not do what was asked of the one before it. 4 readers: executor, record, and those that are
            // dead and not yet removed.
            Self::Task => {
                Qos { buffer: 16, history: 0, borrowed: 2, readers: 4, writers: 4, loans: 2, burst: 7 }
            }
            // A page shows the last lines of a task, also that of a board that starts later. 4 readers: board, record, and those that are dead and not
            // yet removed.
            Self::Printed => {
                Qos { buffer: 256, history: 128, borrowed: 2, readers: 4, writers: 1, loans: 2, burst: 127 }
            }
            // A browser sends the next piece once the one before it was kept, and one recording is sent at a time. 4 wait, because several may try.
            // 2 readers: executor, and one that is dead and not yet removed.
            Self::Film => {
                Qos { buffer: 4, history: 0, borrowed: 2, readers: 2, writers: 4, loans: 2, burst: 1 }
            }
        }
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Quality of service. Overflow is on everywhere: without it, one stuck reader would stop the line. A reader counts what it did not
/// get in time by the gaps in `seq`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Qos {
    /// Messages that can wait for one reader; when there is one more, the oldest is lost.
    pub buffer: usize,
    /// Newest messages that a reader gets which comes up later.
    pub history: usize,
    /// Messages that one reader may hold at the same time.
    pub borrowed: usize,
    /// Maximum number of readers.
    pub readers: usize,
    /// Maximum number of writers.
    pub writers: usize,
    /// Messages that a writer may fill at the same time. For `frame` it is as many as one reader keeps in use (5 waiting, 2 borrowed, 1 being
    /// filled). [`crate::FrameWriter::warm_up`] touches them all before the first frame.
    pub loans: usize,
    /// Messages that a paced writer sends before it waits for its readers: at most half of `buffer`, for the reason in `pace`.
    pub burst: usize,
}

impl Qos {
    /// Messages that one writer's memory must hold so that a loan never fails, by iceoryx2's own formula.
    pub(crate) const fn chunks(&self) -> usize {
        self.readers * (self.buffer + self.borrowed) + self.history + self.loans
    }
}

/// A message of fixed size and the channel that carries it. Frames have ports of their own.
pub trait ChannelMessage: Message {
    /// The channel that carries it.
    const CHANNEL: Channel;
}

impl ChannelMessage for Detections {
    const CHANNEL: Channel = Channel::Detections;
}
impl ChannelMessage for Couples {
    const CHANNEL: Channel = Channel::Couple;
}
impl ChannelMessage for Verdict {
    const CHANNEL: Channel = Channel::Verdict;
}
impl ChannelMessage for AccountUpdate {
    const CHANNEL: Channel = Channel::Account;
}
impl ChannelMessage for AccountKept {
    const CHANNEL: Channel = Channel::Kept;
}
impl ChannelMessage for Journalled {
    const CHANNEL: Channel = Channel::Journalled;
}
impl ChannelMessage for Health {
    const CHANNEL: Channel = Channel::Health;
}
impl ChannelMessage for Judging {
    const CHANNEL: Channel = Channel::Judging;
}
impl ChannelMessage for Command {
    const CHANNEL: Channel = Channel::Command;
}

impl ChannelMessage for Audit {
    const CHANNEL: Channel = Channel::Audit;
}
impl ChannelMessage for Task {
    const CHANNEL: Channel = Channel::Task;
}
impl ChannelMessage for Printed {
    const CHANNEL: Channel = Channel::Printed;
}
impl ChannelMessage for FilmPiece {
    const CHANNEL: Channel = Channel::Film;
}

/// Bytes of one message of a channel; for frames the maximum.
pub(crate) fn message_bytes(channel: Channel, frame_bytes: usize) -> usize {
    match channel {
        Channel::Frame => frame_bytes + size_of::<FrameHeader>(),
        Channel::Detections => size_of::<Detections>(),
        Channel::Couple => size_of::<Couples>(),
        Channel::Verdict => size_of::<Verdict>(),
        Channel::Account => size_of::<AccountUpdate>(),
        Channel::Kept => size_of::<AccountKept>(),
        Channel::Journalled => size_of::<Journalled>(),
        Channel::Health => size_of::<Health>(),
        Channel::Command => size_of::<Command>(),
        Channel::Judging => size_of::<Judging>(),
        Channel::Audit => size_of::<Audit>(),
        Channel::Task => size_of::<Task>(),
        Channel::Printed => size_of::<Printed>(),
        Channel::Film => size_of::<FilmPiece>(),
    }
}

/// Version of what the ports tell each other by events. It must match as the layout must.
const PROTOCOL: u32 = 2;

/// The layout of a message, as the attribute of its service says it.
pub(crate) fn layout_text<T: Layout>() -> String {
    format!("{:016x}/{}", T::HASH, PROTOCOL)
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
