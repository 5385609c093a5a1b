//! Where single messages lie in a recording: found by their times without reading the rest, and read one by one.
//!
//! What [`crate::RecordingReader`] reads whole and checks, this skips. So a picture of a long recording costs its own bytes, and no more memory.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufReader, Read as _};
use std::ops::RangeInclusive;
use std::os::unix::fs::FileExt as _;
use std::path::Path;

use mcap::MAGIC;
use mcap::records::op;

use crate::reader::{ReadError, RecordingReader};
use crate::topic::Topic;

/// The kind of a record and its length.
const HEAD: u64 = 1 + 8;
/// The channel of a message, its number and its two times.
const MESSAGE_HEAD: u64 = 2 + 4 + 8 + 8;
/// A channel is described in fewer bytes.
const LONGEST_CHANNEL: u64 = 1 << 16;
/// The head of a chunk that is not compressed: its first and last time, its size and checksum, an empty word, and its size again.
const CHUNK_HEAD: u64 = 8 + 8 + 8 + 4 + 4 + 8;
/// A message with a picture has fewer bytes. One that says it has more is damaged, and must not claim the memory.
pub const LONGEST: u64 = 16 << 20;

/// Where a message lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// What it is.
    pub topic: Topic,
    /// Its time as in [`crate::Entry`], nanoseconds since 1970 UTC.
    pub time_ns: u64,
    offset: u64,
    length: u64,
}

impl Place {
    /// Reads its bytes.
    ///
    /// # Errors
    /// What the system says; the file may have become another one.
    pub fn read(&self, recording: &File) -> io::Result<Vec<u8>> {
        // At most `LONGEST`.
        let mut bytes = vec![0; self.length as usize];
        recording.read_exact_at(&mut bytes, self.offset)?;
        Ok(bytes)
    }
}

/// The messages on these topics whose times are within these, in the order in which they were received, and at most so many. Of a recording that is cut
/// or damaged, those before that place.
///
/// # Errors
/// Why it cannot be used, as [`RecordingReader::open`].
pub fn places(
    recording: &Path,
    topics: &[Topic],
    times: &RangeInclusive<u64>,
    most: usize,
) -> Result<Vec<Place>, ReadError> {
    // It says what the matter is with a file that is none of ours.
    RecordingReader::open(recording)?;
    let failed = |source| ReadError::Open { path: recording.into(), source };
    let mut walk = Walk::open(recording).map_err(failed)?;
    let mut found = Vec::new();
    while found.len() < most
        && let Some(place) = walk.next(topics, times).map_err(failed)?
    {
        found.push(place);
    }
    Ok(found)
}

/// A recording from head to head.
struct Walk {
    input: BufReader<File>,
    at: u64,
    end: u64,
    /// Where the open chunk ends.
    chunk_end: u64,
    channels: HashMap<u16, Topic>,
}

impl Walk {
    fn open(recording: &Path) -> io::Result<Self> {
        let file = File::open(recording)?;
        let end = file.metadata()?.len();
        let mut walk =
            Self { input: BufReader::new(file), at: 0, end, chunk_end: 0, channels: HashMap::new() };
        walk.skip(MAGIC.len() as u64)?;
        Ok(walk)
    }

    /// The next message that is wanted; `None` at the end, or where what follows cannot be a record.
    fn next(&mut self, topics: &[Topic], times: &RangeInclusive<u64>) -> io::Result<Option<Place>> {
        while let Some((kind, length)) = self.head()? {
            let body = self.at;
            let end = body + length;
            match kind {
                op::DATA_END => return Ok(None),
                op::CHUNK if length >= CHUNK_HEAD => {
                    let [first, last] = [self.number()?, self.number()?];
                    // Channels are described in the first chunk.
                    let is_wanted = first <= *times.end() && last >= *times.start();
                    if is_wanted || self.channels.is_empty() {
                        self.skip(body + CHUNK_HEAD - self.at)?;
                        self.chunk_end = end;
                        continue;
                    }
                }
                op::CHANNEL if length <= LONGEST_CHANNEL => self.channel(length)?,
                op::MESSAGE if (MESSAGE_HEAD..=LONGEST).contains(&length) => {
                    let head: [u8; MESSAGE_HEAD as usize] = self.bytes()?;
                    let channel = u16::from_le_bytes([head[0], head[1]]);
                    let time_ns = u64::from_le_bytes(head[6..14].try_into().unwrap_or_default());
                    let topic = self.channels.get(&channel).filter(|topic| topics.contains(topic)).copied();
                    let (offset, length) = (self.at, length - MESSAGE_HEAD);
                    self.skip(end - self.at)?;
                    if let Some(topic) = topic.filter(|_| times.contains(&time_ns)) {
                        return Ok(Some(Place { topic, time_ns, offset, length }));
                    }
                    continue;
                }
                _ => (),
            }
            self.skip(end - self.at)?;
        }
        Ok(None)
    }

    /// The kind and the length of the next record, if all of it is there.
    fn head(&mut self) -> io::Result<Option<(u8, u64)>> {
        let limit = if self.at < self.chunk_end { self.chunk_end } else { self.end };
        if limit - self.at < HEAD {
            return Ok(None);
        }
        let [kind] = self.bytes()?;
        let length = self.number()?;
        Ok((length <= limit - self.at).then_some((kind, length)))
    }

    fn channel(&mut self, length: u64) -> io::Result<()> {
        let mut body = vec![0; length as usize];
        self.input.read_exact(&mut body)?;
        self.at += length;
        if let Some((id, topic)) = channel_of(&body) {
            self.channels.insert(id, topic);
        }
        Ok(())
    }

    fn number(&mut self) -> io::Result<u64> {
        Ok(u64::from_le_bytes(self.bytes()?))
    }

    fn bytes<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.input.read_exact(&mut bytes)?;
        self.at += N as u64;
        Ok(bytes)
    }

    fn skip(&mut self, bytes: u64) -> io::Result<()> {
        // A file is shorter than what its offsets can say.
        self.input.seek_relative(bytes as i64)?;
        self.at += bytes;
        Ok(())
    }
}

/// The number of a channel and its topic: both follow one another, with the number of its schema between them.
fn channel_of(body: &[u8]) -> Option<(u16, Topic)> {
    let (id, rest) = body.split_first_chunk()?;
    let (length, rest) = rest.get(2..)?.split_first_chunk()?;
    let name = rest.get(..u32::from_le_bytes(*length) as usize)?;
    Some((u16::from_le_bytes(*id), Topic::of_name(std::str::from_utf8(name).ok()?)?))
}
