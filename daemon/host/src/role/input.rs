//! What a role takes its messages from: a reader of a data channel, in one shape.

use andon_ipc::{Channel, FrameReader, FrameSample, Reader, Sample};
use shm_schemas::{Couples, Detections, Journalled, Stamp, Verdict};

/// A data channel that a role takes its messages from.
pub trait Input {
    /// A message where its writer filled it.
    type Sample;

    /// The next message. Where the source does not wait, an input may give up old messages for the newest.
    ///
    /// # Errors
    /// The station's shared memory.
    fn take(&mut self, is_paced: bool) -> Result<Option<Self::Sample>, andon_ipc::Error>;

    /// What a message depends on, and its flags.
    fn head(sample: &Self::Sample) -> (&Stamp, u32);

    /// Messages that were lost, here or at the source, or given up; and restarts of the writer.
    fn losses(&self) -> (u64, u32);

    /// The newest number of this epoch of the writer that has come; 0 where none has.
    fn newest_of(&self, epoch: u64) -> u64;

    /// Whether a reader that is new gets the newest message that was sent before it was there.
    fn has_history(&self) -> bool;

    /// Connects again with the next look.
    fn reconnect(&mut self);
}

impl<T: Flagged> Input for Reader<T> {
    type Sample = Sample<T>;

    fn take(&mut self, _is_paced: bool) -> Result<Option<Sample<T>>, andon_ipc::Error> {
        Reader::take(self)
    }

    fn head(sample: &Sample<T>) -> (&Stamp, u32) {
        (sample.stamp(), sample.flags())
    }

    fn losses(&self) -> (u64, u32) {
        (self.lost(), self.restarts())
    }

    fn newest_of(&self, epoch: u64) -> u64 {
        Reader::newest_of(self, epoch)
    }

    fn has_history(&self) -> bool {
        T::CHANNEL.qos().history > 0
    }

    fn reconnect(&mut self) {
        Reader::reconnect(self);
    }
}

impl Input for FrameReader {
    type Sample = FrameSample;

    /// Every frame of a source that waits; of a live one the newest, because a late frame is worth less than the next.
    fn take(&mut self, is_paced: bool) -> Result<Option<FrameSample>, andon_ipc::Error> {
        if is_paced { FrameReader::take(self) } else { self.take_newest() }
    }

    fn head(sample: &FrameSample) -> (&Stamp, u32) {
        (&sample.header().stamp, sample.header().flags)
    }

    fn losses(&self) -> (u64, u32) {
        (self.lost() + self.skipped() + self.lost_by_source(), self.restarts())
    }

    fn newest_of(&self, epoch: u64) -> u64 {
        FrameReader::newest_of(self, epoch)
    }

    fn has_history(&self) -> bool {
        Channel::Frame.qos().history > 0
    }

    fn reconnect(&mut self) {
        FrameReader::reconnect(self);
    }
}

/// A message that says of which kind its source is.
pub trait Flagged: andon_ipc::ChannelMessage {
    /// [`shm_schemas::flag`]s of what travels along the data path; 0 of everything else.
    fn flags(&self) -> u32 {
        0
    }
}

impl Flagged for Detections {
    fn flags(&self) -> u32 {
        self.flags
    }
}

impl Flagged for Couples {
    fn flags(&self) -> u32 {
        self.flags
    }
}

impl Flagged for Verdict {}
impl Flagged for Journalled {}
