//! A recording that an engineer sends by the board, piece by piece. It has its name only once it is whole and on disk.
//!
//! Until then it is a file whose name nobody looks for, and it goes with whatever ends the sending: a button, silence, an error, the end of this role.
//! What a role that was killed has left of it, the next one removes.

use std::fs::{self, Permissions};
use std::io::Write as _;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use andon_host::atomic;
use andon_learn::digest::hex;
use rustix::fs::statvfs;
use sha2::{Digest as _, Sha256};
use shm_schemas::{FILM_BYTES, FilmPiece};
use tempfile::NamedTempFile;

use crate::made::is_name;

/// What the disk keeps free beside a recording: the journal and the black box come first.
const SPARE: u64 = 1 << 30;

/// A browser that sends nothing for so long has gone.
const SILENT: Duration = Duration::from_secs(30);

/// So much is brought to the disk at once, so that the end of a large recording does not keep this role waiting.
const AT_ONCE: u64 = 1 << 20;

/// The recording that is being sent: one at a time.
pub(super) struct Films {
    folder: PathBuf,
    prefix: String,
    open: Option<Upload>,
    /// The number of the last one that is whole: its last piece may come again where nobody heard the answer.
    whole: Option<u64>,
}

struct Upload {
    film: u64,
    who: String,
    name: String,
    size: u64,
    written: u64,
    part: NamedTempFile,
    digest: Sha256,
    heard: Instant,
}

/// What became of a piece.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Taken {
    /// It was kept, or was there already.
    Kept,
    /// It was the last one: the digest of the whole, SHA-256 in hexadecimal digits.
    Whole(String),
    /// The recording was broken off as it was asked for.
    BrokenOff,
}

impl Films {
    /// Recordings for this folder. What a role of this station has left there is removed.
    pub(super) fn new(folder: &Path, station: &str) -> Self {
        let prefix = format!(".film-{station}.");
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            if entry.file_name().as_encoded_bytes().starts_with(prefix.as_bytes()) {
                // What cannot be removed is tried again by the next start.
                let _ = fs::remove_file(entry.path());
            }
        }
        Self { folder: folder.into(), prefix, open: None, whole: None }
    }

    pub(super) fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Who has sent which recording and has gone.
    pub(super) fn give_up(&mut self, now: Instant) -> Option<(String, String)> {
        let gone = self.open.take_if(|open| now.saturating_duration_since(open.heard) > SILENT)?;
        Some((gone.who, gone.name))
    }

    /// Takes the next piece.
    ///
    /// # Errors
    /// Why it is not kept, in words for whoever sends it. What was sent of the recording before is gone then, except where it is another one's.
    pub(super) fn take(&mut self, piece: &FilmPiece, now: Instant) -> Result<Taken, String> {
        let is_open = self.open.as_ref().is_some_and(|open| open.is_of(piece));
        if piece.size == 0 && piece.length == 0 {
            self.open.take_if(|_| is_open).ok_or("this recording is not being sent")?;
            return Ok(Taken::BrokenOff);
        }
        if !is_open {
            if self.whole == Some(piece.film) {
                return Ok(Taken::Kept);
            }
            self.begin(piece, now)?;
        }
        // Where it fails, it is dropped, and its file with it.
        let mut open = self.open.take().ok_or("this recording is not being sent")?;
        open.append(piece, &self.folder)?;
        open.heard = now;
        if open.written < open.size {
            self.open = Some(open);
            return Ok(Taken::Kept);
        }
        let film = open.film;
        let digest = open.end(&self.folder)?;
        self.whole = Some(film);
        Ok(Taken::Whole(digest))
    }

    fn begin(&mut self, piece: &FilmPiece, now: Instant) -> Result<(), String> {
        if let Some(open) = &self.open {
            return Err(format!("{} is just sending {}: wait until it is there", open.who, open.name));
        }
        let (name, size) = (piece.name(), piece.size);
        let has_ending = Path::new(name).extension().is_some_and(|ending| !ending.is_empty());
        if !is_name(name) || !has_ending {
            return Err("a recording has a name of letters, digits, dots, dashes and underscores, and an ending as in run1.mp4".into());
        }
        if size > FILM_BYTES {
            return Err(format!("a recording has {} MB at most", FILM_BYTES >> 20));
        }
        if piece.at != 0 {
            return Err("the recording is not being sent any more: send it again".into());
        }
        let path = self.folder.join(name);
        // Also a link that leads nowhere is in the way.
        if fs::symlink_metadata(&path).is_ok() {
            return Err(format!("there is a recording {name} already: give this one another name"));
        }
        let failed = |error: &dyn std::fmt::Display| format!("{}: {error}", self.folder.display());
        let disk = statvfs(&self.folder).map_err(|error| failed(&error))?;
        let free = disk.f_bavail.saturating_mul(disk.f_frsize);
        if free < size.saturating_add(SPARE) {
            let missing = (size.saturating_add(SPARE) - free).div_ceil(1 << 20);
            return Err(failed(&format!("the disk lacks {missing} MB: remove recordings that nobody needs")));
        }
        // As readable as a file that somebody copies there: the user's mask applies.
        let part = tempfile::Builder::new()
            .prefix(&self.prefix)
            .permissions(Permissions::from_mode(0o666))
            .tempfile_in(&self.folder)
            .map_err(|error| failed(&error))?;
        let (film, who, name) = (piece.film, piece.who().to_owned(), name.to_owned());
        self.open =
            Some(Upload { film, who, name, size, written: 0, part, digest: Sha256::new(), heard: now });
        Ok(())
    }
}

impl Upload {
    fn is_of(&self, piece: &FilmPiece) -> bool {
        let is_same = self.film == piece.film && self.who == piece.who() && self.name == piece.name();
        is_same && [self.size, 0].contains(&piece.size)
    }

    fn append(&mut self, piece: &FilmPiece, folder: &Path) -> Result<(), String> {
        let bytes = piece.bytes();
        let end = piece.at.saturating_add(bytes.len() as u64);
        if end <= self.written && !bytes.is_empty() {
            // Nobody heard the answer, and it came again.
            return Ok(());
        }
        if piece.at != self.written || bytes.is_empty() {
            return Err("a piece of the recording is missing: send it again".into());
        }
        if end > self.size {
            return Err("the recording is longer than was said: send it again".into());
        }
        let is_due = end / AT_ONCE != self.written / AT_ONCE;
        let kept = self.part.write_all(bytes);
        let kept = kept.and_then(|()| if is_due { self.part.as_file().sync_data() } else { Ok(()) });
        kept.map_err(|error| format!("{}: {error}", folder.display()))?;
        self.digest.update(bytes);
        self.written = end;
        Ok(())
    }

    /// Gives it its name, and returns its digest.
    fn end(self, folder: &Path) -> Result<String, String> {
        let path = folder.join(&self.name);
        let failed = |error: std::io::Error| format!("{}: {error}", path.display());
        self.part.as_file().sync_all().map_err(failed)?;
        atomic::put_new(self.part.into_temp_path(), &path).map_err(failed)?;
        Ok(hex(&self.digest.finalize()))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use andon_learn::digest::sha256_hex;
    use tempfile::TempDir;

    fn piece(film: u64, name: &str, (at, size): (u64, u64), bytes: &[u8]) -> FilmPiece {
        let mut piece = FilmPiece { film, at, size, ..FilmPiece::default() };
        assert!(piece.say("maria", name) && piece.carry(bytes));
        piece
    }

    fn films() -> (TempDir, Films) {
        let folder = tempfile::tempdir().unwrap();
        let films = Films::new(folder.path(), "bench1");
        (folder, films)
    }

    fn names(folder: &TempDir) -> Vec<String> {
        let entries = fs::read_dir(folder.path()).unwrap().flatten();
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_recording_has_its_name_once_it_is_whole_and_a_piece_that_comes_again_is_kept_once() {
        let (folder, mut films) = films();
        let now = Instant::now();
        let first = piece(7, "run1.mp4", (0, 5), b"fil");
        assert_eq!(films.take(&first, now), Ok(Taken::Kept));
        assert_eq!(films.take(&first, now), Ok(Taken::Kept));
        assert!(films.is_open() && !folder.path().join("run1.mp4").exists());
        let last = piece(7, "run1.mp4", (3, 5), b"ms");
        assert_eq!(films.take(&last, now), Ok(Taken::Whole(sha256_hex(b"films"))));
        assert_eq!(films.take(&last, now), Ok(Taken::Kept));
        assert_eq!(fs::read(folder.path().join("run1.mp4")).unwrap(), b"films");
        assert_eq!(names(&folder), ["run1.mp4"]);
        let again = films.take(&piece(8, "run1.mp4", (0, 1), b"x"), now).unwrap_err();
        assert!(again.contains("already"), "{again}");
        assert_eq!(fs::read(folder.path().join("run1.mp4")).unwrap(), b"films");
    }

    #[test]
    fn what_is_broken_off_goes_silent_or_is_killed_leaves_nothing_behind() {
        let (folder, mut films) = films();
        let now = Instant::now();
        let first = piece(7, "run1.mp4", (0, 5), b"fil");
        films.take(&first, now).unwrap();
        assert_eq!(films.take(&piece(7, "run1.mp4", (0, 0), b""), now), Ok(Taken::BrokenOff));
        assert_eq!(names(&folder), [""; 0]);
        films.take(&first, now).unwrap();
        assert_eq!(films.give_up(now + SILENT), None);
        let gone = films.give_up(now + 2 * SILENT);
        assert_eq!((gone, names(&folder).len()), (Some(("maria".into(), "run1.mp4".into())), 0));
        films.take(&first, now).unwrap();
        // A role that is killed removes nothing by itself.
        let (_, part) = films.open.take().unwrap().part.keep().unwrap();
        assert!(part.exists());
        fs::write(folder.path().join(".film-bench2.x"), "another station").unwrap();
        Films::new(folder.path(), "bench1");
        assert_eq!(names(&folder), [".film-bench2.x"]);
    }

    #[test]
    fn what_is_no_piece_of_the_recording_is_refused_and_ends_it_and_that_of_another_one_does_not() {
        let (folder, mut films) = films();
        let now = Instant::now();
        for name in ["", "..", "../run1.mp4", "a/b.mp4", "run 1.mp4", ".run1.mp4", "-rf.mp4", "run1", "run1."]
        {
            let refused = films.take(&piece(7, name, (0, 5), b"fil"), now).unwrap_err();
            assert!(refused.contains("a recording has a name"), "{name}: {refused}");
        }
        for (place, size, bytes, why) in [
            (0, FILM_BYTES + 1, &b"fil"[..], "512 MB at most"),
            (0, u64::MAX, b"fil", "512 MB at most"),
            (3, 5, b"ms", "not being sent"),
            (0, 2, b"fil", "longer than was said"),
            (0, 5, b"", "a piece of the recording is missing"),
            (0, 0, b"", "not being sent"),
            (0, 0, b"x", "longer than was said"),
        ] {
            let refused = films.take(&piece(7, "run1.mp4", (place, size), bytes), now).unwrap_err();
            assert!(refused.contains(why) && !films.is_open(), "{refused}");
        }
        assert_eq!(names(&folder), [""; 0]);
        for wrong in [
            piece(7, "run1.mp4", (4, 5), b"s"),
            piece(7, "run1.mp4", (3, 5), b"mss"),
            piece(7, "run1.mp4", (u64::MAX, 5), b"ms"),
        ] {
            films.take(&piece(7, "run1.mp4", (0, 5), b"fil"), now).unwrap();
            films.take(&wrong, now).unwrap_err();
            assert!(!films.is_open() && names(&folder).is_empty());
        }
        films.take(&piece(7, "run1.mp4", (0, 5), b"fil"), now).unwrap();
        let mut foreign = piece(7, "run1.mp4", (3, 5), b"ms");
        assert!(foreign.say("eva", "run1.mp4"));
        for other in [
            foreign,
            piece(8, "run2.mp4", (0, 5), b"fil"),
            piece(7, "run2.mp4", (3, 5), b"ms"),
            piece(7, "run1.mp4", (3, 6), b"ms"),
        ] {
            let refused = films.take(&other, now).unwrap_err();
            assert!(refused.contains("maria is just sending run1.mp4"), "{refused}");
        }
        assert!(films.take(&piece(8, "run1.mp4", (0, 0), b""), now).is_err(), "nobody else breaks it off");
        films.take(&piece(7, "run1.mp4", (3, 5), b"ms"), now).unwrap();
        assert_eq!(fs::read(folder.path().join("run1.mp4")).unwrap(), b"films");
    }

    #[test]
    fn what_the_disk_has_no_room_for_or_cannot_be_written_is_refused_with_what_helps() {
        let (folder, mut films) = films();
        fs::remove_dir(folder.path()).unwrap();
        let refused = films.take(&piece(7, "run1.mp4", (0, 5), b"fil"), Instant::now()).unwrap_err();
        assert!(refused.starts_with(&folder.path().display().to_string()), "{refused}");
        // The system has no room for files there.
        let mut films = Films::new(Path::new("/proc"), "bench1");
        let refused = films.take(&piece(7, "run1.mp4", (0, 5), b"fil"), Instant::now()).unwrap_err();
        assert!(refused.contains("the disk lacks 1025 MB"), "{refused}");
    }
}
