//! Processes that are killed, at work and while starting.
#![allow(clippy::unwrap_used, clippy::panic)]

mod ipc_support;

use andon_ipc::{Channel, Death, Departure, Node, Reader, Wake};
use ipc_support::{Bench, PATIENCE, SMALL};
use shm_schemas::{RoleId, Verdict};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Takes messages until one comes that `wanted` likes.
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

/// Drains the reader until it hears that its writer has gone.
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

/// Killed at moments that sweep over a start, from before the first system call to after the first message.
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
    // The successor's, not one that a killed one had sent.
    let begun = andon_ipc::monotonic_ns();
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

/// With members that stay, the next steward cannot sweep the station: it must take over what is whole and heal what is not.
#[test]
fn stewards_that_are_killed_while_starting_are_healed_around_the_members_that_stay() {
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
    let begun = andon_ipc::monotonic_ns();
    read_until(&node, &mut reader, |verdict| verdict.stamp.sent_ns > begun);
    // Every channel must be there, also those that no member held.
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

/// Files below a directory whose path contains this.
fn files(directory: &Path, part: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let below = folders.iter().flat_map(|folder| self::files(folder, part));
    files.into_iter().filter(|path| path.to_string_lossy().contains(part)).chain(below).collect()
}

/// As a steward leaves it that is killed after it removed the shared part of a service and before the rest.
#[test]
fn services_whose_removal_was_cut_short_are_removed_by_the_next_steward() {
    let bench = Bench::new("cutshort");
    let steward = bench.steward();
    // Keeps the station from being swept.
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

/// As a steward leaves it that is killed in the middle of removing a dead node.
#[test]
fn a_dead_node_that_has_lost_its_name_is_removed_once() {
    let bench = Bench::new("nameless");
    let mut steward = bench.steward();
    let before = files(bench.station.root(), ".details");
    let judge = bench.start("write-verdicts", &[0, 200]);
    let mut details = files(bench.station.root(), ".details");
    details.retain(|path| !before.contains(path));
    judge.kill();
    // The details lie in a directory of the node's, with its tags.
    let [details] = details.as_slice() else { panic!("{details:?}") };
    std::fs::remove_dir_all(details.parent().unwrap()).unwrap();
    assert_eq!(steward.tend().unwrap(), [Death { member: None, removed: true }]);
    assert_eq!(steward.tend().unwrap(), []);
}

#[test]
fn sigterm_ends_a_wait_at_once() {
    let bench = Bench::new("sigterm");
    let steward = bench.start("steward", &[SMALL.frame_bytes as u64]);
    // Ten minutes is what it would wait.
    let mut waiting = bench.start("wait", &[]);
    waiting.signal(rustix::process::Signal::TERM);
    assert_eq!(waiting.until("woken="), "Stop");
    waiting.finish();
    steward.stop();
}
