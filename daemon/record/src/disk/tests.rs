//! The thread that writes, on a real folder and on a channel that nobody empties.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::reader::RecordingReader;
use std::os::unix::fs::PermissionsExt as _;

const PATIENCE: Duration = Duration::from_secs(30);

fn budget() -> Budget {
    Budget { bytes: u64::MAX, age: Duration::MAX, journal: None }
}

fn entry(bytes: usize) -> Entry {
    Entry { topic: Topic::Picture, time_ns: 1, sent_ns: 1, data: vec![7; bytes].into() }
}

/// Waits for the thread.
fn until(holds: impl Fn() -> bool) {
    let until = Instant::now() + PATIENCE;
    while !holds() {
        assert!(Instant::now() < until, "waited in vain");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// One whose thread does nothing.
fn idle(orders: Sender<Vec<Order>>, told: Receiver<Told>, limit: usize) -> Disk {
    let (held, state) = (Vec::new(), Arc::default());
    Disk { orders: Some(orders), held, held_since: Instant::now(), told, state, thread: None, limit }
}

#[test]
fn no_more_waits_for_a_disk_that_does_nothing_than_it_may() {
    let (orders, taken) = channel();
    let (_tell, told) = channel();
    let limit = 10 * (HEAD + 1000);
    let mut disk = idle(orders, told, limit);
    let accepted = (0..100).filter(|_| disk.write(entry(1000))).count();
    assert_eq!(accepted, 10);
    assert!(!disk.still(MessageId::default(), vec![0; 1000]), "stills count as well");
    disk.release(false);
    assert_eq!(taken.try_iter().flatten().count(), accepted);
}

#[test]
fn the_thread_is_woken_once_nothing_is_judged_or_after_a_while_and_gets_all_that_came() {
    let (orders, taken) = channel();
    let (_tell, told) = channel();
    let mut disk = idle(orders, told, usize::MAX);
    for is_judging in [true, true, false] {
        assert!(disk.write(entry(1)) && disk.write(entry(2)));
        // However slow this machine is.
        disk.held_since = Instant::now();
        disk.release(is_judging);
    }
    assert_eq!(taken.try_iter().map(|orders| orders.len()).collect::<Vec<_>>(), [6]);
    disk.release(false);
    assert_eq!(taken.try_iter().count(), 0, "nothing wakes it for nothing");
    assert!(disk.write(entry(3)));
    disk.held_since = Instant::now() - LONGEST_HELD;
    disk.release(true);
    assert_eq!(taken.try_iter().map(|orders| orders.len()).collect::<Vec<_>>(), [1]);
}

#[test]
fn a_folder_that_cannot_be_written_is_said_and_tried_again() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path().join("recordings");
    std::fs::write(&folder, "a file where the folder should be").unwrap();
    let mut disk = Disk::start(folder.clone(), budget(), 1 << 20).unwrap();
    until(|| disk.is_failing());
    let told: Vec<Told> = disk.told().collect();
    assert!(told.iter().any(|told| matches!(told, Told::Unwritten(_))), "{told:?}");
    std::fs::remove_file(&folder).unwrap();
    disk.probe();
    disk.release(false);
    until(|| !disk.is_failing());
    disk.begin(1, 0);
    assert!(disk.write(entry(1000)));
    disk.finish();
    let [recording] = store::files(&folder).unwrap().try_into().unwrap();
    assert!(RecordingReader::open(&recording).is_ok());
}

#[test]
fn pictures_of_people_are_readable_by_their_owner_alone() {
    let folder = tempfile::tempdir().unwrap();
    let mut disk = Disk::start(folder.path().into(), budget(), 1 << 20).unwrap();
    disk.begin(1, 0);
    assert!(disk.write(entry(1000)) && disk.still(MessageId { epoch: 7, seq: 1 }, vec![0; 1000]));
    disk.finish();
    let [recording] = store::files(folder.path()).unwrap().try_into().unwrap();
    let still = still_of(&recording, MessageId { epoch: 7, seq: 1 });
    for path in [recording, still] {
        assert_eq!(path.metadata().unwrap().permissions().mode() & 0o777, 0o600, "{}", path.display());
    }
}

#[test]
fn what_was_recorded_before_the_clock_was_set_is_as_old_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let budget = Budget { age: Duration::from_secs(86_400), ..budget() };
    let mut disk = Disk::start(folder.path().into(), budget.clone(), 1 << 20).unwrap();
    for _ in 0..2 {
        // In 1970, as by a machine that has lost its time.
        disk.begin(1, 0);
        assert!(disk.write(entry(1000)));
        disk.end();
    }
    disk.finish();
    assert_eq!(store::files(folder.path()).unwrap().len(), 2);
    // Who did not see it end knows only what it shows.
    Disk::start(folder.path().into(), budget, 0).unwrap().finish();
    assert!(store::files(folder.path()).unwrap().is_empty());
}

/// A recording whose recorder was killed.
fn cut(folder: &Path) -> PathBuf {
    let path = store::new_file(folder, 1).unwrap();
    let mut writer = RecordingWriter::new(File::create(&path).unwrap(), 0).unwrap();
    writer.write(&entry(1000)).unwrap();
    writer.flush().unwrap();
    drop(writer);
    let file = File::options().write(true).open(&path).unwrap();
    file.set_len(file.metadata().unwrap().len() - 4).unwrap();
    path
}

#[test]
fn what_was_cut_is_completed_where_the_disk_has_room_for_it_and_else_that_is_said() {
    for has_room in [true, false] {
        let folder = tempfile::tempdir().unwrap();
        let path = cut(folder.path());
        if !has_room {
            // As large as no disk: nearly all of it is a hole.
            File::options().write(true).open(&path).unwrap().set_len(8 << 40).unwrap();
        }
        let mut disk = Disk::start(folder.path().into(), budget(), 0).unwrap();
        disk.finish();
        let told: Vec<Told> = disk.told().collect();
        let is_repaired = told.iter().any(|told| matches!(told, Told::Repaired(_)));
        let is_said =
            told.iter().any(|told| matches!(told, Told::Unrepaired(why) if why.contains("no room")));
        assert_eq!((is_repaired, is_said), (has_room, !has_room), "{told:?}");
        assert!(path.exists());
    }
}

#[test]
fn what_cannot_be_repaired_is_said_once_however_often_the_disk_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = cut(folder.path());
    std::fs::write(&path, "a file that is no recording any more").unwrap();
    let mut disk = Disk::start(folder.path().into(), budget(), 1 << 20).unwrap();
    for _ in 0..3 {
        disk.state.is_failing.store(true, Ordering::Relaxed);
        disk.probe();
        disk.release(false);
        until(|| !disk.is_probing());
    }
    assert!(!disk.is_failing());
    disk.finish();
    let told: Vec<Told> = disk.told().collect();
    let said = told.iter().filter(|told| matches!(told, Told::Unrepaired(_))).count();
    assert_eq!(said, 1, "{told:?}");
}
