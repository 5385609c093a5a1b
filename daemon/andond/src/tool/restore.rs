//! `andond restore`: puts back what `andond backup` wrote.

use std::path::{Path, PathBuf};

use andon_host::atomic::{self, folder_of};
use andon_host::exit::Code;
use andon_ipc::{Station, UtcTime};
use andon_journal::{Journal, Retention};
use shm_schemas::AuditKind;

use super::{ToolError, cannot_write};
use crate::backup::{Archive, ArchiveError, Entry, Kind};
use crate::cli::Restore;
use crate::{identity, role, step_pictures};

/// Runs the command. Nothing is written before the whole archive was checked and the station was found at rest.
///
/// # Errors
/// What is wrong with the archive, that the station runs, or which files are in the way.
pub fn run(arguments: &Restore) -> Result<Code, ToolError> {
    let archive = Archive::read(&arguments.archive)?;
    let place = |entry: &Entry| target(arguments.into.as_deref(), &entry.path);
    println!("station {} of {}", archive.manifest.station, archive.manifest.written);
    for (entry, _) in archive.files() {
        println!("{}  {}", entry.sha256, place(entry).display());
    }
    if arguments.list {
        return Ok(Code::Stopped);
    }
    refuse_while_it_runs(&archive)?;
    let differs = |(entry, bytes): (&Entry, &[u8])| {
        let path = place(entry);
        let is_same = andon_learn::file::read(&path).is_ok_and(|there| there == bytes);
        (path.exists() && !is_same).then_some(path)
    };
    let in_the_way: Vec<PathBuf> = archive.files().filter_map(differs).collect();
    if !arguments.replace && !in_the_way.is_empty() {
        return Err(ArchiveError::InTheWay(in_the_way).into());
    }
    put_all(&archive, place)?;
    archive
        .files()
        .filter(|(entry, _)| entry.kind == Kind::Job)
        .try_for_each(|(entry, _)| tidy(&place(entry)))?;
    note(&archive, arguments)?;
    println!("restored; check it with `andond check` before the station starts");
    Ok(Code::Stopped)
}

/// Where a file goes.
fn target(into: Option<&Path>, path: &Path) -> PathBuf {
    // It is absolute: the archive was refused otherwise.
    into.map_or_else(|| path.to_owned(), |folder| folder.join(path.strip_prefix("/").unwrap_or(path)))
}

/// Under another folder as well: a journal that is replaced under its writer would lose what is written meanwhile.
fn refuse_while_it_runs(archive: &Archive) -> Result<(), ToolError> {
    let name = &archive.manifest.station;
    match Station::under(name, &archive.manifest.root) {
        Ok(station) if station.is_in_use() => Err(ArchiveError::Running(name.clone()).into()),
        _ => Ok(()),
    }
}

/// Puts all files in their places, or none if one cannot be written: half a station is of no use.
fn put_all(archive: &Archive, place: impl Fn(&Entry) -> PathBuf) -> Result<(), ToolError> {
    let (mut parts, mut made) = (Vec::new(), Folders::default());
    for (entry, bytes) in archive.files() {
        let path = place(entry);
        let staged = made.make(folder_of(&path)).and_then(|()| atomic::staged(&path, bytes));
        parts.push((entry.kind, staged.map_err(cannot_write(&path))?, path));
    }
    // From here on nothing more has to be written: they only get their names.
    made.keep();
    parts.into_iter().try_for_each(|(kind, part, path)| {
        let named = if kind == Kind::Journal { forget_companions(&path) } else { Ok(()) };
        named.and_then(|()| atomic::put(part.into_temp_path(), &path)).map_err(cannot_write(&path))
    })
}

/// Removes the pictures of the steps of another job than the one that the file holds now: nobody looks for them, and they show people.
fn tidy(job: &Path) -> Result<(), ToolError> {
    // What is no job has none.
    let Ok(hash) = role::read_job(job).map(|job| job.model_hash()) else { return Ok(()) };
    let others = step_pictures::beside(job).into_iter().filter(|picture| picture.model_hash != hash);
    for picture in others {
        picture.remove().map_err(|(path, source)| ToolError::Remove { path, source })?;
        println!("removed, it belonged to another job: {}", picture.path.display());
    }
    Ok(())
}

/// What lies beside an old database is not part of the one that takes its place.
fn forget_companions(path: &Path) -> std::io::Result<()> {
    for ending in ["-wal", "-shm"] {
        let mut beside = path.as_os_str().to_owned();
        beside.push(ending);
        atomic::remove_file(Path::new(&beside))?;
    }
    Ok(())
}

/// Folders that were made. They are removed again where they are not kept.
#[derive(Default)]
struct Folders(Vec<PathBuf>);

impl Folders {
    /// Makes a folder, and those that it lies in.
    fn make(&mut self, folder: &Path) -> std::io::Result<()> {
        let missing: Vec<PathBuf> =
            folder.ancestors().take_while(|folder| !folder.exists()).map(Path::to_path_buf).collect();
        std::fs::create_dir_all(folder)?;
        self.0.extend(missing.into_iter().rev());
        Ok(())
    }

    fn keep(mut self) {
        self.0.clear();
    }
}

impl Drop for Folders {
    fn drop(&mut self) {
        // A folder that something else was put in meanwhile stays.
        self.0.iter().rev().for_each(|folder| drop(std::fs::remove_dir(folder)));
    }
}

/// The journal itself says that it was restored, and by whom.
fn note(archive: &Archive, arguments: &Restore) -> Result<(), ToolError> {
    let journals = archive.files().filter(|(entry, _)| entry.kind == Kind::Journal);
    for (entry, _) in journals {
        let path = target(arguments.into.as_deref(), &entry.path);
        // Nothing is removed here: the role applies what the configuration says, and these are the most that it may say.
        let mut journal =
            Journal::open(&path, Retention { keep_days: 36_500, keep_mb: 1_000_000, without: &[] })?;
        let what = format!("restored from {}, of {}", arguments.archive.display(), archive.manifest.written);
        journal.note(UtcTime::now().nanoseconds(), AuditKind::Journal, &identity::own_user(), &what)?;
    }
    Ok(())
}
