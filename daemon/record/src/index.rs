//! What lies beside a recording: which verdicts it shows, so that a row of the journal finds its clip without reading the recordings.

use std::io;
use std::path::{Path, PathBuf};

use andon_host::atomic;
use andon_ipc::Channel;
use serde::{Deserialize, Serialize};
use shm_schemas::{MessageId, Verdict, from_bytes};

use crate::reader::{Item, ReadError, RecordingReader};
use crate::topic::Topic;

/// What a recording shows.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Index {
    /// When its first message was sent, nanoseconds since 1970 UTC.
    pub began_utc_ns: u64,
    /// When its newest was sent.
    pub ended_utc_ns: u64,
    /// The verdicts in it, in their order.
    pub verdicts: Vec<IndexedVerdict>,
}

/// A verdict that a recording shows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct IndexedVerdict {
    /// The start of the judge.
    pub epoch: u64,
    /// Its number in this epoch.
    pub seq: u64,
    /// The level, as [`shm_schemas::VerdictLevel`] counts.
    pub level: u8,
    /// The outcome, as [`shm_schemas::VerdictOutcome`] counts.
    pub outcome: u8,
    /// The part that was worked on; empty where nobody has said it.
    pub part: String,
    /// When it was decided, nanoseconds since 1970 UTC.
    pub decided_utc_ns: u64,
}

impl IndexedVerdict {
    /// Which message it is.
    #[must_use]
    pub fn id(&self) -> MessageId {
        MessageId { epoch: self.epoch, seq: self.seq }
    }
}

impl From<&Verdict> for IndexedVerdict {
    fn from(verdict: &Verdict) -> Self {
        Self {
            epoch: verdict.stamp.epoch,
            seq: verdict.stamp.seq,
            level: verdict.level,
            outcome: verdict.outcome,
            part: if verdict.part.is_none() { String::new() } else { verdict.part.text().to_owned() },
            decided_utc_ns: verdict.decided_utc_ns,
        }
    }
}

impl Index {
    /// A message was sent at this time.
    pub(crate) fn sent(&mut self, utc_ns: u64) {
        if self.began_utc_ns == 0 {
            self.began_utc_ns = utc_ns;
        }
        self.began_utc_ns = self.began_utc_ns.min(utc_ns);
        self.ended_utc_ns = self.ended_utc_ns.max(utc_ns);
    }

    /// Reads the one beside a recording; `None` where there is none that can be read.
    #[must_use]
    pub fn beside(recording: &Path) -> Option<Self> {
        serde_json::from_slice(&std::fs::read(path_of(recording)).ok()?).ok()
    }

    /// Makes it from the recording itself.
    ///
    /// # Errors
    /// Why the recording cannot be used.
    pub fn of(recording: &Path) -> Result<Self, ReadError> {
        let mut index = Self::default();
        let mut reader = RecordingReader::open(recording)?;
        while let Some(item) = reader.next_item()? {
            let Item::Entry(entry) = item else { continue };
            index.sent(entry.sent_ns);
            if entry.topic == Topic::Raw(Channel::Verdict)
                && let Some(verdict) = from_bytes::<Verdict>(&entry.data)
            {
                index.verdicts.push((&verdict).into());
            }
        }
        Ok(index)
    }

    /// Writes it beside a recording, in place of the one before.
    ///
    /// # Errors
    /// What the system says.
    pub fn write_beside(&self, recording: &Path) -> io::Result<()> {
        let text = serde_json::to_vec(self)?;
        atomic::write(&path_of(recording), &text)
    }
}

/// Where the index of a recording lies.
pub(crate) fn path_of(recording: &Path) -> PathBuf {
    recording.with_extension("json")
}

/// Where the still of a verdict lies.
#[must_use]
pub fn still_of(recording: &Path, verdict: MessageId) -> PathBuf {
    recording.with_extension(format!("{verdict}.jpg"))
}
