//! Writes a recording: messages in the order in which they were received, in chunks that are whole on the disk one after the other.

use std::collections::BTreeMap;
use std::io::{Seek, Write};
use std::sync::Arc;

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions};

use crate::topic::{Description, Topic};

/// What the profile of a recording says: of Andon, and in which version. Another arrangement of the topics gets another number.
pub(crate) const PROFILE: &str = "andon-1";

/// Bytes after which a chunk is complete: at 30 pictures per second it is so several times a second.
const CHUNK: u64 = 1 << 20;

/// A message of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// What it is.
    pub topic: Topic,
    /// The time of the picture that it comes from or depends on, else that of its sending. CLOCK_MONOTONIC in a recorder, UTC in a file;
    /// nanoseconds.
    pub time_ns: u64,
    /// When it was sent, on the same clock.
    pub sent_ns: u64,
    /// Its bytes; the memory before a verdict and the disk share them.
    pub data: Arc<[u8]>,
}

/// A file that a recording carries: what its verdicts depend on beside the messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// Its name, as `configuration.toml`.
    pub name: String,
    /// Its bytes.
    pub data: Arc<[u8]>,
}

/// A recording that grows.
pub struct RecordingWriter<W: Write + Seek> {
    mcap: mcap::Writer<W>,
    /// The channel of each topic in the file, and how many messages it has.
    channels: Vec<(Topic, u16, u32)>,
    /// What is added to the time of a message.
    offset_ns: i128,
}

impl<W: Write + Seek> RecordingWriter<W> {
    /// Begins a recording. `offset_ns` is what UTC is ahead of the clock of its messages.
    ///
    /// # Errors
    /// What the system says.
    pub fn new(out: W, offset_ns: i128) -> Result<Self, McapError> {
        let options = WriteOptions::new()
            .profile(PROFILE)
            .library(concat!("andon-record ", env!("CARGO_PKG_VERSION")))
            .compression(None)
            .chunk_size(Some(CHUNK))
            // A chunk is written at once and whole. A writer that seeks would leave the head of one that says nothing yet.
            .disable_seeking(true);
        let mut mcap = options.create(out)?;
        let mut channels = Vec::new();
        for topic in Topic::all() {
            let Description { schema, schema_encoding, schema_data, message_encoding } = topic.description();
            let schema = mcap.add_schema(&schema, schema_encoding, &schema_data)?;
            let channel = mcap.add_channel(schema, &topic.name(), message_encoding, &BTreeMap::new())?;
            channels.push((topic, channel, 0));
        }
        Ok(Self { mcap, channels, offset_ns })
    }

    /// Adds a message.
    ///
    /// # Errors
    /// What the system says.
    pub fn write(&mut self, entry: &Entry) -> Result<(), McapError> {
        // Every topic has a channel: the constructor has made it.
        let Some((_, channel, count)) = self.channels.iter_mut().find(|(topic, ..)| *topic == entry.topic)
        else {
            return Ok(());
        };
        *count += 1;
        let header = MessageHeader {
            channel_id: *channel,
            sequence: *count,
            log_time: shifted(entry.time_ns, self.offset_ns),
            publish_time: shifted(entry.sent_ns, self.offset_ns),
        };
        self.mcap.write_to_known_channel(&header, &entry.data)
    }

    /// Adds a file.
    ///
    /// # Errors
    /// What the system says.
    pub fn attach(&mut self, attachment: &Attachment, utc_ns: u64) -> Result<(), McapError> {
        self.mcap.attach(&mcap::Attachment {
            log_time: utc_ns,
            create_time: utc_ns,
            name: attachment.name.clone(),
            media_type: "application/octet-stream".into(),
            data: attachment.data.as_ref().into(),
        })
    }

    /// Completes the chunk: what was written so far is there, whatever happens to the process.
    ///
    /// # Errors
    /// What the system says.
    pub fn flush(&mut self) -> Result<(), McapError> {
        self.mcap.flush()
    }

    /// Completes the recording, with its index.
    ///
    /// # Errors
    /// What the system says.
    pub fn finish(mut self) -> Result<W, McapError> {
        self.mcap.finish()?;
        Ok(self.mcap.into_inner())
    }
}

/// A time on another clock; at the ends of its range where it would be beyond them.
pub(crate) fn shifted(time_ns: u64, offset_ns: i128) -> u64 {
    let time_ns = i128::from(time_ns) + offset_ns;
    u64::try_from(time_ns.max(0)).unwrap_or(u64::MAX)
}
