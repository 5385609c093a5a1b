//! Processes that are killed at work and while they start.
#![allow(clippy::unwrap_used, clippy::panic)]

mod ipc_support;

use andon_ipc::{Channel, Death, Departure, Error, Member, Node, Reader, Steward, Wake};
use ipc_support::{Bench, PATIENCE, SMALL};
use shm_schemas::{RoleId, Verdict};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Takes messages until one is wanted.
fn read_until(node: &Node, reader: &mut Reader<Verdict>, mut wanted: impl FnMut(&Verdict) -> bool) {
    loop {
        while let Some(verdict) = reader.take().unwrap() {
            if wanted(&verdict) {
                return;
            }
        }
        let wake = node.wait(&mut [reader], PATIENCE).unwrap();
        assert_ne!(wake, Wake::DeadlineMissed, "no message came");
    }
}

/// Drains the reader until it hears that its writer has left.
fn departure(node: &Node, reader: &mut Reader<Verdict>) -> Departure {
    loop {
        match node.wait(&mut [reader], PATIENCE).unwrap() {
            Wake::Sample => while reader.take().unwrap().is_some() {},
            Wake::WriterGone { channel: Channel::Verdict, departure } => return departure,
            other => panic!("waiting for the writer's departure ended with {other:?}"),
        }
    }
}

#[test]
fn a_killed_writer_is_noticed_and_its_successor_takes_over() {
    let bench = Bench::new("killed");
    let mut steward = bench.start("steward", &[SMALL.frame_bytes as u64]);
    let node = bench.node(RoleId::Journal);
    let mut reader = node.reader::<Verdict>().unwrap();

    let mut epochs = Vec::new();
    for _ in 0..3 {
        let judge = bench.start("write-verdicts", &[0, 200]);
        read_until(&node, &mut reader, |verdict| {
            let new = epochs.last() != Some(&verdict.stamp.epoch);
            if new {
                epochs.push(verdict.stamp.epoch);
            }
            new
        });
        let pid = judge.kill();
        assert_eq!(departure(&node, &mut reader), Departure::Died);
        assert_eq!(steward.until("died="), format!("judge {pid}"));
    }
    assert_eq!(reader.restarts(), 2);

    let judge = bench.start("write-verdicts", &[0, 200]);
    read_until(&node, &mut reader, |verdict| !epochs.contains(&verdict.stamp.epoch));
    judge.stop();
    assert_eq!(departure(&node, &mut reader), Departure::Stopped);

    drop((reader, node));
    steward.stop();
    assert_eq!(bench.shared_files(), Vec::<String>::new());
}

/// This is what a process leaves that is killed just after it has named the shared memory of a connection.
#[test]
fn a_connection_that_has_no_size_yet_is_removed_with_the_dead() {
    let bench = Bench::new("unsized");
    let mut steward = bench.steward();
    let node = bench.node(RoleId::Journal);
    let mut reader = node.reader::<Verdict>().unwrap();
    let judge = bench.start("write-verdicts", &[0, 200]);
    read_until(&node, &mut reader, |_| true);
    let files = bench.shared_files();
    let connection = files.iter().find(|name| name.ends_with(".connection")).unwrap();
    let (ends, _) = connection.rsplit_once('_').unwrap();
    let beside = format!("{ends}_1.connection");
    std::fs::write(format!("/dev/shm/{beside}"), b"").unwrap();
    let pid = judge.kill();
    let member = Some(Member { name: "judge".into(), pid });
    // A steward looks again and again: on a busy machine a process may count as alive for a moment longer.
    let deaths = in_time(move || {
        loop {
            let deaths = steward.poll().unwrap();
            if !deaths.is_empty() {
                return deaths;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    });
    assert_eq!(deaths, [Death { member, removed: true }]);
    assert!(!bench.shared_files().contains(&beside));
}

/// This is what a steward leaves that is killed just after it has named a shared part. It is that of a service, or that of the whole station.
#[test]
fn shared_memory_that_a_killed_steward_has_not_given_a_size_is_made_anew_while_a_member_stays() {
    let bench = Bench::new("sizeless");
    let steward = bench.start("steward", &[SMALL.frame_bytes as u64]);
    // A member, so that the station is not swept.
    let _member = bench.start("wait", &[]);
    steward.kill();
    let files = bench.shared_files();
    let of_stations: Vec<_> = files.iter().filter(|name| name.ends_with(".global_mgmt")).collect();
    let of_services = files.iter().filter(|name| name.ends_with(".dynamic"));
    for name in of_services.chain(of_stations) {
        let path = Path::new("/dev/shm").join(name);
        std::fs::remove_file(&path).unwrap();
        std::fs::write(&path, b"").unwrap();
    }
    let limits = SMALL;
    let station = bench.station.clone();
    let _steward = in_time(move || Steward::create(&station, limits).unwrap());
    bench.node(RoleId::Judge).reader::<Verdict>().unwrap();
}

/// Does something in which iceoryx2 might hang, which must not hang the test.
fn in_time<T: Send + 'static>(act: impl FnOnce() -> T + Send + 'static) -> T {
    let (sender, done) = std::sync::mpsc::channel();
    std::thread::spawn(move || sender.send(act()));
    done.recv_timeout(PATIENCE).unwrap()
}

/// The kills sweep over a start, from before its first system call to after its first message.
#[test]
fn writers_that_are_killed_while_starting_leave_nothing_in_their_successors_way() {
    let bench = Bench::new("startup");
    let steward = bench.start("steward", &[SMALL.frame_bytes as u64]);
    let node = bench.node(RoleId::Journal);
    let mut reader = node.reader::<Verdict>().unwrap();
    for round in 0..40 {
        let judge = bench.spawn("write-verdicts", &[0, 200], "");
        std::thread::sleep(Duration::from_micros(500 * round));
        judge.kill();
        while reader.take().unwrap().is_some() {}
    }
    let judge = bench.start("write-verdicts", &[0, 200]);
    // A message of the successor, not of one that was killed.
    let begun = andon_ipc::MonotonicTime::now().nanoseconds();
    read_until(&node, &mut reader, |verdict| verdict.stamp.sent_ns > begun);
    judge.stop();
    drop((reader, node));
    steward.stop();
    assert_eq!(bench.shared_files(), Vec::<String>::new());
}

#[test]
fn stewards_that_are_killed_while_starting_leave_nothing_in_their_successors_way() {
    let bench = Bench::new("steward");
    for round in 0..40 {
        let steward = bench.spawn("steward", &[SMALL.frame_bytes as u64], "");
        std::thread::sleep(Duration::from_micros(500 * round));
        steward.kill();
    }
    let steward = bench.start("steward", &[SMALL.frame_bytes as u64]);
    let journal = bench.start("read-verdicts", &[10, 0]);
    let judge = bench.start("write-verdicts", &[10, 0]);
    journal.finish();
    judge.stop();
    steward.stop();
    assert_eq!(bench.shared_files(), Vec::<String>::new());
}

/// While members stay, the next steward cannot sweep the station: it must take over what is complete and replace what is not.
#[test]
fn stewards_that_are_killed_while_starting_are_replaced_while_the_members_stay() {
    let bench = Bench::new("healed");
    let first = bench.start("steward", &[SMALL.frame_bytes as u64]);
    let judge = bench.start("write-verdicts", &[0, 1_000]);
    first.kill();
    for round in 0..20 {
        let steward = bench.spawn("steward", &[SMALL.frame_bytes as u64], "");
        std::thread::sleep(Duration::from_micros(1_000 * round));
        steward.kill();
    }
    let steward = bench.start("steward", &[SMALL.frame_bytes as u64]);
    let node = bench.node(RoleId::Journal);
    let mut reader = node.reader::<Verdict>().unwrap();
    let begun = andon_ipc::MonotonicTime::now().nanoseconds();
    read_until(&node, &mut reader, |verdict| verdict.stamp.sent_ns > begun);
    // Every channel must be there, including those that no member kept.
    node.frame_reader().unwrap();
    node.reader::<shm_schemas::Detections>().unwrap();
    node.reader::<shm_schemas::Couples>().unwrap();
    node.reader::<shm_schemas::Health>().unwrap();
    node.reader::<shm_schemas::Command>().unwrap();
    judge.stop();
    assert_eq!(departure(&node, &mut reader), Departure::Stopped);
    drop((reader, node));
    steward.stop();
}

/// The files below a directory whose paths contain `part`.
fn files(directory: &Path, part: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let below = folders.iter().flat_map(|folder| self::files(folder, part));
    files.into_iter().filter(|path| path.to_string_lossy().contains(part)).chain(below).collect()
}

/// This is what a steward leaves that is killed after it has removed the shared part of a service, before the rest.
#[test]
fn services_whose_removal_was_cut_short_are_removed_by_the_next_steward() {
    let bench = Bench::new("cutshort");
    let steward = bench.steward();
    // A member, so that the station is not swept.
    let _member = bench.node(RoleId::Journal);
    let descriptions = files(bench.station.root(), "/services/");
    let kept: Vec<_> = descriptions.iter().map(|path| std::fs::read(path).unwrap()).collect();
    assert!(kept.len() >= 3 * Channel::ALL.len(), "{descriptions:?}");
    drop(steward);
    for (path, bytes) in descriptions.iter().zip(kept) {
        assert!(!path.exists(), "{} is still in use", path.display());
        std::fs::write(path, bytes).unwrap();
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o400)).unwrap();
    }
    let _steward = bench.steward();
    let node = bench.node(RoleId::Judge);
    node.frame_reader().unwrap();
    node.reader::<Verdict>().unwrap();
}

/// Unlike an incomplete description, a damaged one does not tell that nobody uses the service.
#[test]
fn a_service_whose_description_cannot_be_read_stays_with_those_who_use_it() {
    let bench = Bench::new("damaged");
    let steward = bench.steward();
    let node = bench.node(RoleId::Journal);
    let mut writer = node.writer::<Verdict>().unwrap();
    let mut reader = node.reader::<Verdict>().unwrap();
    drop(steward);
    let (descriptions, shared) = (files(bench.station.root(), "/services/"), bench.shared_files());
    assert_eq!(descriptions.len(), 3, "the journal keeps the services of one channel: {descriptions:?}");
    for path in &descriptions {
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o600)).unwrap();
        std::fs::write(path, "damaged").unwrap();
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o400)).unwrap();
    }

    let refused = bench.try_steward(SMALL).unwrap_err();
    assert!(matches!(refused, Error::ServiceUnreadable { channel: Channel::Verdict, .. }), "{refused}");
    assert!(refused.to_string().contains("journal (pid"), "who must stop is named: {refused}");
    assert!(descriptions.iter().all(|path| path.exists()));
    let still_shared = bench.shared_files();
    assert!(shared.iter().all(|name| still_shared.contains(name)), "{still_shared:?} of {shared:?}");
    writer.send(writer.loan().unwrap()).unwrap();
    assert!(reader.take().unwrap().is_some());

    // The remedy of the message: once nobody is left, the next steward begins with nothing.
    drop((reader, writer, node));
    let _steward = bench.steward();
    bench.node(RoleId::Journal).reader::<Verdict>().unwrap();
}

/// This is what a steward leaves that is killed while it removes a dead node.
#[test]
fn a_dead_node_that_has_lost_its_name_is_removed_once() {
    let bench = Bench::new("nameless");
    let mut steward = bench.steward();
    let before = files(bench.station.root(), ".details");
    let judge = bench.start("write-verdicts", &[0, 200]);
    let mut details = files(bench.station.root(), ".details");
    details.retain(|path| !before.contains(path));
    judge.kill();
    // The details lie in a directory of the node, together with its tags.
    let [details] = details.as_slice() else { panic!("{details:?}") };
    std::fs::remove_dir_all(details.parent().unwrap()).unwrap();
    assert_eq!(steward.poll().unwrap(), [Death { member: None, removed: true }]);
    assert_eq!(steward.poll().unwrap(), []);
}

#[test]
fn sigterm_ends_a_wait_at_once() {
    let bench = Bench::new("sigterm");
    let steward = bench.start("steward", &[SMALL.frame_bytes as u64]);
    // It would wait for ten minutes.
    let mut waiting = bench.start("wait", &[]);
    waiting.signal(rustix::process::Signal::TERM);
    assert_eq!(waiting.until("woken="), "Stop");
    waiting.finish();
    steward.stop();
}
