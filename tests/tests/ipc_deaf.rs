//! A connection that cannot be made, on every channel and at both of its ends, leaves nobody deaf.
//!
//! The failure is that of a process that has no file descriptor left for a moment: every `shm_open` fails with EMFILE. The limit
//! belongs to the process, so this program has one test.
#![allow(clippy::unwrap_used, clippy::panic)]

mod ipc_support;

use andon_ipc::{ChannelMessage, Node, Reader, Writer};
use ipc_support::{Bench, PATIENCE, SMALL};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use shm_schemas::{
    AccountKept, AccountUpdate, Audit, Command, Couples, Detections, Health, Journalled, Judging, Printed,
    RoleId, Task, Verdict,
};
use std::fs::File;
use std::os::fd::AsRawFd;
use std::time::{Duration, Instant};

/// As many descriptors as a wait looks at, and some: all of them are in use.
const LOW: u64 = 16;

/// Uses up the descriptors under [`LOW`].
fn fill_up() -> Vec<File> {
    let mut files = Vec::new();
    while files.last().is_none_or(|file: &File| (file.as_raw_fd() as u64) < LOW) {
        files.push(File::open("/dev/null").unwrap());
    }
    files
}

/// Does something while no file can be opened.
fn starved<R>(act: impl FnOnce() -> R) -> R {
    let before = getrlimit(Resource::Nofile);
    setrlimit(Resource::Nofile, Rlimit { current: Some(LOW), maximum: before.maximum }).unwrap();
    assert!(File::open("/dev/null").is_err());
    let done = act();
    setrlimit(Resource::Nofile, before).unwrap();
    done
}

const A_MOMENT: Duration = Duration::from_millis(20);

/// Sends until three messages have come. Every message that was sent has then come, or it is counted as lost.
fn exchange<T: ChannelMessage>(what: &str, node: &Node, writer: &mut Writer<T>, reader: &mut Reader<T>) {
    let until = Instant::now() + PATIENCE;
    while reader.received() < 3 {
        assert!(Instant::now() < until, "{}: {what} stayed deaf", T::CHANNEL);
        let message = writer.loan().unwrap();
        writer.send(message).unwrap();
        node.wait(&mut [writer], Duration::ZERO).unwrap();
        node.wait(&mut [reader], A_MOMENT).unwrap();
        while reader.take().unwrap().is_some() {}
    }
    let sent = writer.newest().seq;
    let history = T::CHANNEL.qos().history as u64;
    if sent <= history {
        assert_eq!((reader.received(), reader.lost()), (sent, 0), "{}: {what}, with history", T::CHANNEL);
    }
    assert!(reader.received() + reader.lost() <= sent, "{}: {what}", T::CHANNEL);
}

fn hears_again<T: ChannelMessage>(bench: &Bench) {
    let node = bench.node(RoleId::Tool);
    {
        let mut reader = node.reader::<T>().unwrap();
        let mut writer = node.writer::<T>().unwrap();
        assert!(starved(|| reader.take().unwrap()).is_none());
        exchange("a reader", &node, &mut writer, &mut reader);
    }
    let mut writer = node.writer::<T>().unwrap();
    let mut reader = node.reader::<T>().unwrap();
    starved(|| node.wait(&mut [&mut writer], Duration::ZERO)).unwrap();
    exchange("a writer", &node, &mut writer, &mut reader);
}

fn frames_come_again(bench: &Bench) {
    let node = bench.node(RoleId::Tool);
    for is_reader in [true, false] {
        let (mut reader, mut writer);
        if is_reader {
            reader = node.frame_reader().unwrap();
            writer = node.frame_writer().unwrap();
            assert!(starved(|| reader.take().unwrap()).is_none());
        } else {
            writer = node.frame_writer().unwrap();
            reader = node.frame_reader().unwrap();
            starved(|| node.wait(&mut [&mut writer], Duration::ZERO)).unwrap();
        }
        let until = Instant::now() + PATIENCE;
        while reader.received() < 3 {
            assert!(Instant::now() < until, "frame: reader {is_reader} stayed deaf");
            let frame = writer.loan(SMALL.frame_bytes).unwrap();
            writer.send(frame).unwrap();
            node.wait(&mut [&mut writer], Duration::ZERO).unwrap();
            node.wait(&mut [&mut reader], A_MOMENT).unwrap();
            while reader.take().unwrap().is_some() {}
        }
    }
}

#[test]
fn a_connection_that_could_not_be_made_is_made_again_on_every_channel_from_both_ends() {
    let _files = fill_up();
    let bench = Bench::new("deaf");
    let _steward = bench.steward();
    frames_come_again(&bench);
    hears_again::<Detections>(&bench);
    hears_again::<Couples>(&bench);
    hears_again::<Verdict>(&bench);
    hears_again::<AccountUpdate>(&bench);
    hears_again::<AccountKept>(&bench);
    hears_again::<Journalled>(&bench);
    hears_again::<Health>(&bench);
    hears_again::<Command>(&bench);
    hears_again::<Judging>(&bench);
    hears_again::<Audit>(&bench);
    hears_again::<Task>(&bench);
    hears_again::<Printed>(&bench);
}
