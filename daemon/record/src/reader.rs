//! Reads a recording from start to end. One that is cut is read up to its last whole chunk.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use andon_ipc::Channel;
use mcap::records::{ChunkHeader, Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{MAGIC, McapError, parse_record};

use crate::topic::{Topic, layout};
use crate::writer::{Attachment, Entry, PROFILE};

/// The maximum length of a record. A chunk ends after a megabyte and one message, and no picture or job file is that large. A longer one is damaged,
/// and must not claim the memory.
const LONGEST: usize = 64 << 20;

/// Why a recording cannot be used. Its message ends with the remedy.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// It cannot be opened or read.
    #[error("{}: {source}; give a recording (.mcap), and let this user read it", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// There is nothing in it.
    #[error("{}: the file is empty; its recorder was killed before it had written anything: remove it", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// It is shorter than what every recording begins with.
    #[error(
        "{}: the file has {bytes} of the {} bytes with which every recording begins: its recorder was killed at once, or it is none; remove it",
        path.display(), MAGIC.len()
    )]
    Short {
        /// The file.
        path: PathBuf,
        /// What is there.
        bytes: usize,
    },
    /// It is something else.
    #[error("{}: this is no MCAP file; `andond` reads those of its role `record`", path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
    },
    /// Another program wrote it.
    #[error("{}: an MCAP file of {library:?}, not of Andon; `andond` reads those of its role `record`", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What it says wrote it.
        library: String,
    },
    /// Another version of Andon wrote it.
    #[error(
        "{}: a recording in the arrangement {profile:?} of {library:?}, and this program reads {PROFILE:?}; \
         use the version that wrote it",
        path.display()
    )]
    OtherVersion {
        /// The file.
        path: PathBuf,
        /// The arrangement.
        profile: String,
        /// What wrote it.
        library: String,
    },
    /// The messages of a channel have another layout.
    #[error(
        "{}: its messages of the channel {channel} have the layout {found}, and this program has {}; use the version that wrote it",
        path.display(), layout(*channel)
    )]
    OtherLayout {
        /// The file.
        path: PathBuf,
        /// The channel.
        channel: Channel,
        /// The layout hash in the file.
        found: String,
    },
    /// It ends before anything of it is whole.
    #[error("{}: the file is cut before its first whole record; copy it again, or remove it", path.display())]
    Cut {
        /// The file.
        path: PathBuf,
    },
}

/// What a recording consists of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Item {
    /// A message; its times are UTC.
    Entry(Entry),
    /// A file.
    Attachment(Attachment),
}

/// How a recording ended for its reader.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// It was written to its end.
    Complete,
    /// What follows is missing or damaged: why, in words.
    Cut(String),
}

/// A recording that is being read.
pub struct RecordingReader<R> {
    input: R,
    path: PathBuf,
    reader: LinearReader,
    topics: HashMap<u16, Topic>,
    /// The layouts of the schemas.
    schemas: HashMap<u16, Vec<u8>>,
    end: Option<End>,
    /// The bytes that have come.
    received: usize,
    /// The chunk that is being unpacked, and how many bytes of it have been.
    chunk: Arc<Vec<u8>>,
    unpacked: usize,
}

impl RecordingReader<BufReader<File>> {
    /// Opens a file.
    ///
    /// # Errors
    /// Why it cannot be used.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let failed = |source| ReadError::Open { path: path.into(), source };
        let file = File::open(path).map_err(failed)?;
        if !file.metadata().map_err(failed)?.is_file() {
            return Err(failed(io::Error::other("it is no file")));
        }
        Self::new(BufReader::new(file), path)
    }
}

impl<R: Read> RecordingReader<R> {
    /// Begins to read; `path` is what messages call it.
    ///
    /// # Errors
    /// That it is empty, no recording, or of another version.
    pub fn new(input: R, path: &Path) -> Result<Self, ReadError> {
        let options = LinearReaderOptions::default().with_emit_chunks(true).with_record_length_limit(LONGEST);
        let reader = LinearReader::new_with_options(options);
        let mut reading = Self {
            input,
            path: path.into(),
            reader,
            topics: HashMap::new(),
            schemas: HashMap::new(),
            end: None,
            received: 0,
            chunk: Arc::default(),
            unpacked: 0,
        };
        reading.read_header()?;
        Ok(reading)
    }

    fn read_header(&mut self) -> Result<(), ReadError> {
        let path = self.path.clone();
        let Some(record) = self.next_record()? else {
            return Err(match (self.received, &self.end) {
                (0, _) => ReadError::Empty { path },
                (bytes, _) if bytes < MAGIC.len() => ReadError::Short { path, bytes },
                (_, Some(End::Cut(why))) if why == NO_MAGIC => ReadError::NotMcap { path },
                _ => ReadError::Cut { path },
            });
        };
        let Record::Header(header) = record else { return Err(ReadError::NotMcap { path }) };
        if header.profile == PROFILE {
            return Ok(());
        }
        let (profile, library) = (header.profile, header.library);
        Err(match profile.starts_with("andon-") {
            true => ReadError::OtherVersion { path, profile, library },
            false => ReadError::Foreign { path, library },
        })
    }

    /// The next message or file; `None` at the end, or where nothing whole follows.
    ///
    /// # Errors
    /// [`ReadError::OtherLayout`], and what the system says.
    pub fn next_item(&mut self) -> Result<Option<Item>, ReadError> {
        while self.end.is_none() {
            // Of what is in a chunk, only what is given on is copied.
            let chunk = Arc::clone(&self.chunk);
            let record = match self.next_in_chunk(&chunk) {
                // A chunk holds no other one.
                Some(Ok(Record::Chunk { .. })) => continue,
                Some(Ok(record)) => Some(record),
                Some(Err(error)) => self.ends(&error),
                None => self.next_record()?,
            };
            let item = record.map(|record| self.take(record)).transpose()?;
            if let Some(item) = item.flatten() {
                return Ok(Some(item));
            }
        }
        Ok(None)
    }

    fn take(&mut self, record: Record<'_>) -> Result<Option<Item>, ReadError> {
        match record {
            Record::Schema { header, data } => drop(self.schemas.insert(header.id, data.into_owned())),
            Record::Channel(channel) => self.take_channel(&channel)?,
            Record::Chunk { header, data } => {
                if let Err(error) = self.begin_chunk(&header, data.into_owned()) {
                    return Ok(self.ends(&error));
                }
            }
            Record::Message { header, data } => {
                let Some(topic) = self.topics.get(&header.channel_id) else { return Ok(None) };
                let (time_ns, sent_ns) = (header.log_time, header.publish_time);
                return Ok(Some(Item::Entry(Entry { topic: *topic, time_ns, sent_ns, data: data.into() })));
            }
            Record::Attachment { header, data, .. } => {
                return Ok(Some(Item::Attachment(Attachment { name: header.name, data: data.into() })));
            }
            _ => (),
        }
        Ok(None)
    }

    /// Topics that this program does not know are left out.
    fn take_channel(&mut self, channel: &mcap::records::Channel) -> Result<(), ReadError> {
        let Some(topic) = Topic::of_name(&channel.topic) else { return Ok(()) };
        if let Topic::Raw(raw) = topic {
            let found = self.schemas.get(&channel.schema_id).map(|data| String::from_utf8_lossy(data));
            let found = found.unwrap_or_default();
            if found != layout(raw) {
                let found = found.chars().take(16).collect();
                return Err(ReadError::OtherLayout { path: self.path.clone(), channel: raw, found });
            }
        }
        self.topics.insert(channel.id, topic);
        Ok(())
    }

    /// How it ended; [`End::Complete`] until it has.
    #[must_use]
    pub fn end(&self) -> End {
        self.end.clone().unwrap_or(End::Complete)
    }

    /// The next record that is in no chunk, or the next chunk; `None` at the end, which is noted.
    fn next_record(&mut self) -> Result<Option<Record<'static>>, ReadError> {
        while let Some(event) = self.reader.next_event() {
            match event {
                Ok(LinearReadEvent::ReadRequest(bytes)) => {
                    // A file that ends early asks for what is not there; the limit above bounds what is asked for.
                    let read = self
                        .input
                        .read(self.reader.insert(bytes))
                        .map_err(|source| ReadError::Open { path: self.path.clone(), source })?;
                    self.reader.notify_read(read);
                    self.received += read;
                }
                Ok(LinearReadEvent::Record { data, opcode }) => match parsed(opcode, data) {
                    Ok(record) => return Ok(Some(record.into_owned())),
                    Err(error) => return Ok(self.ends(&error)),
                },
                Err(error) => return Ok(self.ends(&error)),
            }
        }
        self.end = Some(End::Complete);
        Ok(None)
    }

    /// A chunk counts only whole. The role writes none that is compressed.
    fn begin_chunk(&mut self, header: &ChunkHeader, data: Vec<u8>) -> Result<(), McapError> {
        if !header.compression.is_empty() {
            return Err(McapError::UnsupportedCompression(header.compression.clone()));
        }
        let (saved, calculated) = (header.uncompressed_crc, crc32fast::hash(&data));
        // Without a checksum it is 0.
        if ![0, calculated].contains(&saved) {
            return Err(McapError::BadChunkCrc { saved, calculated });
        }
        (self.chunk, self.unpacked) = (data.into(), 0);
        Ok(())
    }

    /// The next record of the open chunk; `None` where it has no more. The library would believe a length in it that is longer than what is there.
    fn next_in_chunk<'c>(&mut self, chunk: &'c [u8]) -> Option<Result<Record<'c>, McapError>> {
        let (opcode, rest) = chunk.get(self.unpacked..)?.split_first()?;
        let body = rest.split_first_chunk().and_then(|(length, rest)| {
            let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
            rest.get(..length)
        });
        let Some(body) = body else { return Some(Err(McapError::UnexpectedEoc)) };
        self.unpacked += 1 + size_of::<u64>() + body.len();
        Some(parsed(*opcode, body))
    }

    fn ends<T>(&mut self, error: &McapError) -> Option<T> {
        let why = match error {
            McapError::BadMagic if self.schemas.is_empty() => NO_MAGIC.to_owned(),
            other => other.to_string(),
        };
        self.end = Some(End::Cut(why));
        None
    }
}

/// A record; the library expects the checksum of an attachment to be there.
fn parsed(opcode: u8, body: &[u8]) -> Result<Record<'_>, McapError> {
    if opcode == op::ATTACHMENT
        && after_attachment_head(body).is_none_or(|rest| rest.len() < size_of::<u32>())
    {
        return Err(McapError::UnexpectedEoc);
    }
    parse_record(opcode, body)
}

/// What follows the head of an attachment: two times, name and kind, each behind its length, and the length of what is attached.
fn after_attachment_head(body: &[u8]) -> Option<&[u8]> {
    let mut rest = body.get(2 * size_of::<u64>()..)?;
    for _ in ["name", "kind"] {
        let (length, text) = rest.split_first_chunk()?;
        rest = text.get(u32::from_le_bytes(*length) as usize..)?;
    }
    rest.get(size_of::<u64>()..)
}

const NO_MAGIC: &str = "the file does not begin as an MCAP file";
