//! The folder of the recordings: what is in it, what may stay, and what goes.

use std::collections::{BTreeMap, HashMap};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use andon_host::atomic::remove_file;
use andon_ipc::UtcTime;
use jiff::Timestamp;
use jiff::civil::DateTime;
use jiff::tz::TimeZone;
use rustix::fs::{FlockOperation, flock, statvfs};
use shm_schemas::MessageId;

use crate::index::Index;

/// The ending of a recording.
const ENDING: &str = "mcap";

/// The form of what its name begins with: its number in the folder and its time, see [`stamp`].
const FORM: &[u8] = b"00000000-00000000T000000.000Z";

/// Digits of the number: enough for a recording every ten seconds over thirty years.
const DIGITS: usize = 8;

/// A recording in the folder.
#[derive(Clone, Debug)]
pub struct Recording {
    /// The file.
    pub path: PathBuf,
    /// What it shows; of one that is not complete yet, what it showed a moment ago.
    pub index: Index,
}

/// What recordings may take.
#[derive(Clone, Debug)]
pub struct Budget {
    /// All of them together, bytes.
    pub bytes: u64,
    /// How old one may be.
    pub age: Duration,
    /// The journal, which may still grow to this many bytes on the same disk.
    pub journal: Option<(PathBuf, u64)>,
}

/// On a disk that has no more left, programs fail that have nothing to do with recordings.
const SPARE: u64 = 64 << 20;

/// The recordings of a folder, the oldest first: their names begin with their numbers, which no clock sets back. One that has no index yet is read for
/// it. A folder that is not there has none.
///
/// # Errors
/// That the folder cannot be read.
pub fn recordings(folder: &Path) -> io::Result<Vec<Recording>> {
    let with_index = |path: PathBuf| {
        let index = Index::beside(&path).or_else(|| Index::of(&path).ok());
        let index = index.unwrap_or_else(|| of_unread(&path));
        Recording { path, index }
    };
    Ok(files(folder)?.into_iter().map(with_index).collect())
}

/// The recordings of a folder that have an index beside them, the oldest first. None is read for its index, as [`recordings`] does, which takes long
/// for a long one.
///
/// # Errors
/// As [`recordings`].
pub fn indexed(folder: &Path) -> io::Result<Vec<Recording>> {
    let with_index = |path: PathBuf| Index::beside(&path).map(|index| Recording { path, index });
    Ok(files(folder)?.into_iter().filter_map(with_index).collect())
}

/// What cannot be read shows nothing, and was made when its name says. Who opens it by its name is told why it cannot be.
fn of_unread(recording: &Path) -> Index {
    let utc_ns = made_utc_ns(recording).unwrap_or_default();
    Index { began_utc_ns: utc_ns, ended_utc_ns: utc_ns, verdicts: Vec::new() }
}

/// The files of the recordings of a folder, the oldest first.
///
/// # Errors
/// As [`recordings`].
pub(crate) fn files(folder: &Path) -> io::Result<Vec<PathBuf>> {
    Ok(groups(folder)?.into_values().filter_map(|group| group.recording).collect())
}

/// A recording with what lies beside it: its index and its stills.
#[derive(Default)]
struct Group {
    /// None where only the rest is left.
    recording: Option<PathBuf>,
    beside: Vec<PathBuf>,
}

/// What is ours in a folder, by what the names of a group begin with, the oldest first. A folder that is not there has nothing.
fn groups(folder: &Path) -> io::Result<BTreeMap<String, Group>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(BTreeMap::new()),
        entries => entries?,
    };
    let mut groups: BTreeMap<String, Group> = BTreeMap::new();
    for entry in entries {
        let path = entry?.path();
        let Some(stem) = stem(&path).filter(|_| is_ours(&path)) else { continue };
        match path.extension().and_then(|ending| ending.to_str()) {
            Some(ENDING) => groups.entry(stem).or_default().recording = Some(path),
            Some("json" | "jpg") => groups.entry(stem).or_default().beside.push(path),
            _ => (),
        }
    }
    Ok(groups)
}

/// Whether a file has the name of a recording, or of what lies beside one: number and time. Other files in the folder are somebody else's.
fn is_ours(path: &Path) -> bool {
    let Some(name) = path.file_name().map(|name| name.as_encoded_bytes()) else { return false };
    let is_like = |(byte, form): (&u8, &u8)| if *form == b'0' { byte.is_ascii_digit() } else { byte == form };
    name.len() > FORM.len() && name.iter().zip(FORM).all(is_like)
}

/// The recording that shows each verdict; the oldest, where several do. A later clip repeats the last verdicts of the one before it, without what came
/// before them.
#[must_use]
pub fn by_verdict(recordings: &[Recording]) -> HashMap<MessageId, &Recording> {
    let newest_first = recordings.iter().rev();
    let verdicts = newest_first
        .flat_map(|recording| recording.index.verdicts.iter().map(move |verdict| (verdict.id(), recording)));
    verdicts.collect()
}

/// Removes what a recorder that was killed has left of a repair or of an index. Only where no recorder runs: one that does may be writing such a file.
pub fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with(".andon-") && [ENDING, "json"].iter().any(|ending| name.ends_with(ending)) {
            // What cannot be removed now is no recording and does no harm.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// A name that comes after those of all recordings in the folder, also where the clock was set back since.
///
/// # Errors
/// As [`recordings`].
pub(crate) fn new_file(folder: &Path, utc_ns: u64) -> io::Result<PathBuf> {
    let newest = files(folder)?.last().map_or(0, |path| number(path));
    Ok(folder.join(format!("{:0DIGITS$}-{}.{ENDING}", newest + 1, stamp(utc_ns))))
}

/// The number with which the name of a recording begins.
fn number(recording: &Path) -> u32 {
    let name = recording.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    name.get(..DIGITS).and_then(|digits| digits.parse().ok()).unwrap_or_default()
}

/// The form of the time in a name, to the millisecond.
const TIME: &str = "%Y%m%dT%H%M%S.%3fZ";

/// A time as a part of a name.
fn stamp(utc_ns: u64) -> String {
    Timestamp::from_nanosecond(i128::from(utc_ns))
        .map_or_else(|_| utc_ns.to_string(), |time| time.strftime(TIME).to_string())
}

/// The time in the name of a recording: when it began.
fn named_utc_ns(recording: &Path) -> Option<u64> {
    let name = recording.file_name()?.to_str()?;
    let time = DateTime::strptime(TIME, name.get(DIGITS + 1..FORM.len())?).ok()?;
    let utc = time.to_zoned(TimeZone::UTC).ok()?.timestamp();
    u64::try_from(utc.as_nanosecond()).ok()
}

/// When what a recording shows was recorded: what its index says, or its name. A copy, or a backup that was put back, may have a file that is newer.
/// Its time counts only where nothing else is known. The recording itself is not read for it.
fn made_utc_ns(recording: &Path) -> io::Result<u64> {
    let ended = Index::beside(recording).map(|index| index.ended_utc_ns).filter(|ended| *ended > 0);
    if let Some(utc_ns) = ended.or_else(|| named_utc_ns(recording)) {
        return Ok(utc_ns);
    }
    let since_1970 = fs::metadata(recording)?.modified()?.duration_since(SystemTime::UNIX_EPOCH);
    // 2^64 ns are 584 years.
    Ok(since_1970.unwrap_or_default().as_nanos() as u64)
}

/// What has become of a recording that was to be removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Removed {
    /// It is not there any more, whoever has removed it.
    Gone,
    /// A recorder writes it: it stays.
    InUse,
}

/// Removes a recording with everything beside it, unless a recorder writes it. The file itself goes last: what is left after a kill is removed by the
/// next try.
///
/// # Errors
/// What the system says.
pub fn remove(recording: &Path) -> io::Result<Removed> {
    let file = match fs::File::open(recording) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Removed::Gone),
        file => file?,
    };
    if !lock(&file) {
        return Ok(Removed::InUse);
    }
    for path in beside(recording)? {
        remove_file(&path)?;
    }
    remove_file(recording)?;
    Ok(Removed::Gone)
}

/// What lies beside no recording, as where one was removed by hand or by an older program: an index or stills. Nobody can say whom it shows.
///
/// # Errors
/// What the system says.
pub fn orphans(folder: &Path) -> io::Result<Vec<PathBuf>> {
    // A recording that has begun meanwhile is there before what lies beside it.
    let is_alone = |stem: &str| !folder.join(format!("{stem}.{ENDING}")).exists();
    let left =
        groups(folder)?.into_iter().filter(|(stem, group)| group.recording.is_none() && is_alone(stem));
    let mut found: Vec<PathBuf> = left.flat_map(|(_, group)| group.beside).collect();
    found.sort();
    Ok(found)
}

/// What the names of a recording and of everything beside it begin with. It ends before the second point; the first is in the time.
fn stem(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_string_lossy().into_owned();
    let end = name.match_indices('.').nth(1)?.0;
    Some(name[..end].to_owned())
}

/// The files that lie beside a recording: its index and its stills.
fn beside(recording: &Path) -> io::Result<Vec<PathBuf>> {
    let Some((folder, stem)) = recording.parent().zip(stem(recording)) else { return Ok(Vec::new()) };
    Ok(groups(folder)?.remove(&stem).unwrap_or_default().beside)
}

/// What was done to stay within a budget.
#[derive(Debug, Default)]
pub struct Enforced {
    /// How many recordings were removed.
    pub removed: u64,
    /// Those that should have gone and could not be removed, each with the reason.
    pub unremoved: Vec<String>,
}

/// Removes the oldest recordings until what is left is within the budget. What a recorder writes stays, whichever it is, and so does what cannot be
/// removed, as somebody else's: then the next ones go. `young` are not too old, whatever their times say.
///
/// # Errors
/// That the folder cannot be read.
pub fn enforce(folder: &Path, budget: &Budget, young: &[&Path]) -> io::Result<Enforced> {
    for path in orphans(folder)? {
        // One that stays is tried again the next time.
        let _ = remove_file(&path);
    }
    let age_ns = u64::try_from(budget.age.as_nanos()).unwrap_or(u64::MAX);
    let oldest_ns = UtcTime::now().nanoseconds().saturating_sub(age_ns);
    let mut kept = Vec::new();
    for Group { recording, beside } in groups(folder)?.into_values() {
        let Some(path) = recording else { continue };
        let Some((bytes, is_too_old)) = size_and_age(&path, &beside, oldest_ns)? else { continue };
        let is_too_old = is_too_old && !young.contains(&path.as_path());
        kept.push((path, bytes, is_too_old));
    }
    let mut total: u64 = kept.iter().map(|(_, bytes, _)| bytes).sum();
    let mut done = Enforced::default();
    for (path, bytes, is_too_old) in kept {
        if !(is_too_old || total > budget.bytes || lacks_room(folder, budget)) {
            continue;
        }
        match remove(&path) {
            Ok(Removed::Gone) => (total, done.removed) = (total - bytes, done.removed + 1),
            Ok(Removed::InUse) => (),
            Err(error) => done.unremoved.push(format!("{}: {error}", path.display())),
        }
    }
    Ok(done)
}

/// The bytes of a recording and of everything beside it, and whether all of it was recorded before this time. `None` where somebody has removed it
/// meanwhile.
fn size_and_age(recording: &Path, beside: &[PathBuf], oldest_ns: u64) -> io::Result<Option<(u64, bool)>> {
    let size = |path: &PathBuf| fs::metadata(path).map(|file| file.len());
    let found = fs::metadata(recording).and_then(|file| {
        let others: u64 = beside.iter().map(size).sum::<io::Result<_>>()?;
        // It ended after it began, so that only an index of one that began long ago need be read.
        let began_before = named_utc_ns(recording).is_none_or(|began| began < oldest_ns);
        Ok((file.len() + others, began_before && made_utc_ns(recording)? < oldest_ns))
    });
    match found {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        found => found.map(Some),
    }
}

/// Whether the disk has less room left than the journal may still need.
pub(crate) fn lacks_room(folder: &Path, budget: &Budget) -> bool {
    !has_room_for(folder, budget, 0)
}

/// Whether the disk has room for this many bytes, beside what the journal may still need.
pub(crate) fn has_room_for(folder: &Path, budget: &Budget, bytes: u64) -> bool {
    let Ok(disk) = statvfs(folder) else { return true };
    let free = disk.f_bavail.saturating_mul(disk.f_frsize);
    let owed = budget.journal.as_ref().map_or(0, |journal| owed(folder, journal));
    free >= bytes.saturating_add(SPARE).saturating_add(owed)
}

/// The bytes by which the journal may still grow on the same disk.
fn owed(folder: &Path, (path, limit): &(PathBuf, u64)) -> u64 {
    use std::os::unix::fs::MetadataExt as _;
    let device = |path: &Path| fs::metadata(path).map(|file| file.dev()).ok();
    let home = path.parent().unwrap_or(path);
    if device(home) != device(folder) {
        return 0;
    }
    limit.saturating_sub(fs::metadata(path).map_or(0, |file| file.len()))
}

/// Takes the lock of a recording, for as long as the file is open. False where a recorder writes it.
pub(crate) fn lock(file: &fs::File) -> bool {
    flock(file, FlockOperation::NonBlockingLockExclusive).is_ok()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::index::IndexedVerdict;

    const GENEROUS: Budget = Budget { bytes: u64::MAX, age: Duration::MAX, journal: None };

    fn folder(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            fs::write(folder.path().join(name), [0; 1000]).unwrap();
        }
        folder
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_time_as_a_name_is_that_of_the_calendar() {
        for (seconds, name) in [
            (0, "19700101T000000.000Z"),
            (951_782_400, "20000229T000000.000Z"),
            (1_795_850_914, "20261128T072834.000Z"),
        ] {
            assert_eq!(stamp(seconds * 1_000_000_000), name);
        }
    }

    /// The names of what begins with the number and the time of this day.
    fn of_day<const N: usize>(names: [(u8, &str); N]) -> [String; N] {
        names.map(|(day, ending)| format!("{day:08}-202611{day:02}T072834.000Z.{ending}"))
    }

    fn folder_of<const N: usize>(named: [(u8, &str); N], others: &[&str]) -> tempfile::TempDir {
        let named = of_day(named);
        let all: Vec<&str> = named.iter().map(String::as_str).chain(others.iter().copied()).collect();
        folder(&all)
    }

    #[test]
    fn the_oldest_go_first_with_what_lies_beside_them_and_the_one_being_written_stays() {
        let all = [(1, "mcap"), (1, "json"), (1, "7-1.jpg"), (2, "mcap"), (3, "mcap")];
        let folder = folder_of(all, &["journal.sqlite"]);
        let written = fs::File::open(folder.path().join(&of_day([(3, "mcap")])[0])).unwrap();
        assert!(lock(&written));
        let budget = Budget { bytes: 2500, ..GENEROUS };
        assert_eq!(enforce(folder.path(), &budget, &[]).unwrap().removed, 1);
        let [second, third] = of_day([(2, "mcap"), (3, "mcap")]);
        assert_eq!(names(folder.path()), [second.as_str(), &third, "journal.sqlite"]);
        let budget = Budget { bytes: 0, ..GENEROUS };
        assert_eq!(enforce(folder.path(), &budget, &[]).unwrap().removed, 1);
        assert_eq!(names(folder.path()), [third.as_str(), "journal.sqlite"]);
        assert_eq!(remove(&folder.path().join(&third)).unwrap(), Removed::InUse);
        drop(written);
        assert_eq!(remove(&folder.path().join(&third)).unwrap(), Removed::Gone);
        assert_eq!(remove(&folder.path().join(&third)).unwrap(), Removed::Gone);
    }

    #[test]
    fn a_clock_that_is_set_back_makes_no_recording_older_than_those_before_it() {
        const DAY: u64 = 86_400_000_000_000;
        let folder = folder(&[]);
        let made = [20_000, 20_001, 19_000].map(|day| {
            let path = new_file(folder.path(), day * DAY).unwrap();
            fs::write(&path, [0; 1000]).unwrap();
            path
        });
        assert_eq!(files(folder.path()).unwrap(), made);
        assert_eq!(enforce(folder.path(), &Budget { bytes: 1500, ..GENEROUS }, &[]).unwrap().removed, 2);
        assert_eq!(files(folder.path()).unwrap(), made[2..]);
    }

    #[test]
    fn what_lies_beside_no_recording_goes_and_what_is_somebody_elses_stays() {
        let theirs = ["notes.json", "run.mcap", "run.mp4", "run.tracks.jsonl"];
        let folder = folder_of([(1, "json"), (1, "7-1.jpg"), (2, "mcap"), (2, "json")], &theirs);
        assert_eq!(enforce(folder.path(), &Budget { bytes: 0, ..GENEROUS }, &[]).unwrap().removed, 1);
        assert_eq!(names(folder.path()), theirs);
    }

    #[test]
    fn a_folder_that_is_not_there_yet_has_nothing_to_be_removed() {
        let home = tempfile::tempdir().unwrap();
        let done = enforce(&home.path().join("recordings"), &GENEROUS, &[]).unwrap();
        assert!(done.removed == 0 && done.unremoved.is_empty(), "{done:?}");
        assert!(orphans(&home.path().join("recordings")).unwrap().is_empty());
    }

    #[test]
    fn what_cannot_be_removed_stays_and_the_next_ones_go() {
        let folder = folder_of([(2, "mcap"), (3, "mcap")], &[]);
        // As little as the file of another user is a folder of this name one that can be removed.
        let [first] = of_day([(1, "mcap")]);
        fs::create_dir(folder.path().join(&first)).unwrap();
        let done = enforce(folder.path(), &Budget { bytes: 0, ..GENEROUS }, &[]).unwrap();
        assert!(
            done.removed == 2 && done.unremoved.len() == 1 && done.unremoved[0].contains(&first),
            "{done:?}"
        );
        assert_eq!(names(folder.path()), [first]);
    }

    /// Makes the file of a recording look as if it had been written at another time, as a copy or a repair does.
    fn write_at(path: &Path, seconds: u64) {
        let written = SystemTime::UNIX_EPOCH + Duration::from_secs(seconds);
        fs::File::options().write(true).open(path).unwrap().set_modified(written).unwrap();
    }

    #[test]
    fn what_cannot_be_read_was_made_when_its_name_says_or_else_when_its_file_was_written() {
        const WRITTEN: u64 = 1_800_000_000;
        let no_day = "00000002-20261340T072834.000Z.mcap";
        let folder = folder(&["00000001-20261128T072834.125Z.mcap", no_day]);
        files(folder.path()).unwrap().iter().for_each(|path| write_at(path, WRITTEN));
        let found = recordings(folder.path()).unwrap();
        let made: Vec<u64> = found.iter().map(|recording| recording.index.ended_utc_ns).collect();
        assert_eq!(made, [1_795_850_914_125_000_000, WRITTEN * 1_000_000_000]);
        assert!(found[0].index.verdicts.is_empty());
    }

    #[test]
    fn what_a_recorder_that_was_killed_has_left_goes_and_nothing_else_does() {
        let folder =
            folder_of([(1, "mcap"), (1, "json")], &[".andon-a1.mcap", ".andon-b2.json", ".andon-c3.toml"]);
        sweep(folder.path());
        let [recording, index] = of_day([(1, "mcap"), (1, "json")]);
        assert_eq!(names(folder.path()), [".andon-c3.toml".to_owned(), index, recording]);
    }

    #[test]
    fn what_was_recorded_too_long_ago_goes_whenever_its_file_was_written() {
        const DAY: u64 = 86_400;
        let now = UtcTime::now().nanoseconds() / 1_000_000_000;
        let folder = folder(&[]);
        // The first was copied, the second lasted until now, and the third has the time of another machine.
        let made = [(5, 0), (5, 0), (0, 5)].map(|(began, written)| {
            let path = new_file(folder.path(), (now - began * DAY) * 1_000_000_000).unwrap();
            fs::write(&path, [0; 1000]).unwrap();
            write_at(&path, now - written * DAY);
            path
        });
        let index = Index { ended_utc_ns: now * 1_000_000_000, ..Index::default() };
        index.write_beside(&made[1]).unwrap();
        let budget = Budget { age: Duration::from_secs(3 * DAY), ..GENEROUS };
        assert_eq!(enforce(folder.path(), &budget, &[]).unwrap().removed, 1);
        assert_eq!(files(folder.path()).unwrap(), made[1..]);
    }

    #[test]
    fn the_room_that_the_journal_may_need_is_not_used() {
        let folder = folder_of([(1, "mcap")], &["journal.sqlite"]);
        let journal = folder.path().join("journal.sqlite");
        // A journal that may grow beyond every disk.
        let budget = Budget { journal: Some((journal, u64::MAX / 2)), ..GENEROUS };
        assert!(lacks_room(folder.path(), &budget));
        assert_eq!(enforce(folder.path(), &budget, &[]).unwrap().removed, 1);
        assert_eq!(names(folder.path()), ["journal.sqlite"]);
    }

    #[test]
    fn a_verdict_is_shown_by_the_clip_that_was_made_of_it() {
        let verdict =
            IndexedVerdict { epoch: 1, seq: 7, level: 0, outcome: 0, part: String::new(), decided_utc_ns: 0 };
        let of = |path: &str| Recording {
            path: path.into(),
            index: Index { verdicts: vec![verdict.clone()], ..Index::default() },
        };
        let recordings = [of("first"), of("second")];
        assert_eq!(by_verdict(&recordings)[&verdict.id()].path, Path::new("first"));
    }

    #[test]
    fn a_folder_that_is_not_there_has_no_recordings() {
        assert!(recordings(Path::new("/nonexistent/recordings")).unwrap().is_empty());
    }
}
