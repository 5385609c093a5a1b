//! Completes a recording whose recorder was killed: what is whole in it stays, with an index.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use andon_host::atomic;
use andon_ipc::UtcTime;
use mcap::{MAGIC, McapError};

use crate::index::Index;
use crate::reader::{Item, ReadError, RecordingReader};
use crate::store;
use crate::writer::RecordingWriter;

/// What was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repaired {
    /// It was complete.
    Whole,
    /// A recorder is writing it.
    InUse,
    /// It was cut, and is complete now.
    Completed,
    /// Nothing in it was whole, as where its recorder was killed at once: it is gone.
    Removed,
}

/// Why a recording could not be repaired.
#[derive(Debug, thiserror::Error)]
pub enum RepairError {
    /// There is nothing to be saved.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// What is whole in it cannot be written.
    #[error("{}: it was not written to its end, and cannot be repaired: {source}; let this user write in its folder", path.display())]
    Write {
        /// The recording.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

/// Completes a recording that was not written to its end, in its place, and writes its index.
///
/// # Errors
/// That nothing in it is whole, or that it cannot be written.
pub fn repair(path: &Path) -> Result<Repaired, RepairError> {
    let failed = |source| RepairError::Write { path: path.into(), source };
    let opened = |source| ReadError::Open { path: path.into(), source };
    let mut file = File::open(path).map_err(opened)?;
    if !store::lock(&file) {
        return Ok(Repaired::InUse);
    }
    if ends_with_magic(&mut file).map_err(opened)? {
        return Ok(Repaired::Whole);
    }
    if file.metadata().map_err(opened)?.len() < MAGIC.len() as u64 {
        std::fs::remove_file(path).map_err(failed)?;
        return Ok(Repaired::Removed);
    }
    let changed = file.metadata().and_then(|file| file.modified()).map_err(opened)?;
    file.seek(SeekFrom::Start(0)).map_err(opened)?;
    let reader = RecordingReader::new(BufReader::new(file), path)?;
    let part = atomic::beside(path).map_err(failed)?;
    // The lock is held until the whole one is in its place.
    let (_file, has_any) = copy(reader, part.as_file()).map_err(|error| match error {
        CopyError::Read(error) => RepairError::Read(error),
        CopyError::Write(McapError::Io(source)) => failed(source),
        CopyError::Write(error) => failed(io::Error::other(error)),
    })?;
    if !has_any {
        std::fs::remove_file(path).map_err(failed)?;
        return Ok(Repaired::Removed);
    }
    // It is as old as it was: a repair must not keep pictures for longer.
    part.as_file().set_modified(changed).map_err(failed)?;
    atomic::put(part.into_temp_path(), path).map_err(failed)?;
    Index::of(path)?.write_beside(path).map_err(failed)?;
    Ok(Repaired::Completed)
}

/// Whether it was not written to its end, and nobody writes it.
pub(crate) fn is_cut(path: &Path) -> bool {
    File::open(path).is_ok_and(|mut file| store::lock(&file) && !ends_with_magic(&mut file).unwrap_or(true))
}

enum CopyError {
    Read(ReadError),
    Write(McapError),
}

/// The reader, which holds the lock, and whether there was any message.
fn copy(
    mut reader: RecordingReader<BufReader<File>>,
    out: &File,
) -> Result<(RecordingReader<BufReader<File>>, bool), CopyError> {
    let mut has_any = false;
    // The times in a file are UTC already.
    let mut writer = RecordingWriter::new(BufWriter::new(out), 0).map_err(CopyError::Write)?;
    let now = UtcTime::now().nanoseconds();
    while let Some(item) = reader.next_item().map_err(CopyError::Read)? {
        has_any |= matches!(item, Item::Entry(_));
        let written = match item {
            Item::Entry(entry) => writer.write(&entry),
            Item::Attachment(attachment) => writer.attach(&attachment, now),
        };
        written.map_err(CopyError::Write)?;
    }
    let out = writer.finish().map_err(CopyError::Write)?;
    let out = out.into_inner().map_err(|error| CopyError::Write(error.into_error().into()))?;
    out.sync_all().map_err(|error| CopyError::Write(error.into()))?;
    Ok((reader, has_any))
}

fn ends_with_magic(file: &mut File) -> io::Result<bool> {
    let bytes = file.metadata()?.len();
    // A file that consists of the magic alone has only begun.
    if bytes < 2 * MAGIC.len() as u64 {
        return Ok(false);
    }
    file.seek(SeekFrom::End(-(MAGIC.len() as i64)))?;
    let mut end = [0; 8];
    file.read_exact(&mut end)?;
    Ok(end == *MAGIC)
}
