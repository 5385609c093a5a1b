//! What ports promise to each other, shown in one process.
#![allow(clippy::unwrap_used, clippy::panic)]

mod ipc_support;

use andon_ipc::{Channel, ChannelMessage, Error, Heartbeat, Limits, Node, Steward, Stop, Wake, Writer};
use ipc_support::{Bench, PATIENCE, SMALL};
use shm_schemas::{
    Command, Health, Layout, Message, MessageId, RoleId, RoleState, Stamp, Verdict, VerdictLevel, flag,
};
use std::time::Duration;

const NOW: Duration = Duration::ZERO;

fn send(writer: &mut Writer<Verdict>, activity: u16) {
    let mut verdict = writer.loan().unwrap();
    verdict.level = VerdictLevel::Activity.code();
    verdict.activity = activity;
    writer.send(verdict).unwrap();
}

/// A verdict of another build: the name and the size are the same, the fields are not.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
struct OtherVerdict {
    stamp: Stamp,
    x_c: [u64; 19],
}

// SAFETY: integers only, 40 + 152 bytes without padding.
unsafe impl Layout for OtherVerdict {
    const HASH: u64 = 0x1234;
}
// SAFETY: as above. The name is wrong, which is what the test is about.
unsafe impl iceoryx2_bb_elementary_traits::zero_copy_send::ZeroCopySend for OtherVerdict {
    unsafe fn type_name() -> &'static str {
        "andon.Verdict"
    }
}
impl Message for OtherVerdict {
    fn stamp(&self) -> &Stamp {
        &self.stamp
    }
    fn stamp_mut(&mut self) -> &mut Stamp {
        &mut self.stamp
    }
}
impl ChannelMessage for OtherVerdict {
    const CHANNEL: Channel = Channel::Verdict;
}

#[test]
fn a_message_comes_out_as_it_went_in() {
    let bench = Bench::new("plain");
    let _steward = bench.steward();
    let node = bench.node(RoleId::Tool);
    let mut reader = node.reader::<Verdict>().unwrap();
    let mut writer = node.writer::<Verdict>().unwrap();

    let mut verdict = writer.loan().unwrap();
    verdict.follow(&Stamp { frame_seq: 41, captured_ns: 42, ..Stamp::default() });
    verdict.threshold = 1.5;
    writer.send(verdict).unwrap();

    assert_eq!(node.wait(&mut [&mut reader], PATIENCE).unwrap(), Wake::Sample);
    let verdict = reader.take().unwrap().unwrap();
    assert_eq!((verdict.stamp.seq, verdict.stamp.frame_seq, verdict.stamp.captured_ns), (1, 41, 42));
    assert_eq!(verdict.threshold, 1.5);
    assert!(
        verdict.stamp.sent_ns <= andon_ipc::MonotonicTime::now().nanoseconds() && verdict.stamp.sent_ns > 0
    );
    drop(verdict);
    assert!(reader.take().unwrap().is_none());
    assert_eq!(node.wait(&mut [&mut reader], NOW).unwrap(), Wake::DeadlineMissed);
}

#[test]
fn another_layout_under_the_same_name_and_size_is_refused() {
    assert_eq!(size_of::<OtherVerdict>(), size_of::<Verdict>());
    let bench = Bench::new("layout");
    let _steward = bench.steward();
    let node = bench.node(RoleId::Journal);
    let refused = node.reader::<OtherVerdict>().unwrap_err();
    let Error::LayoutMismatch { channel: Channel::Verdict, ours, theirs, members } = &refused else {
        panic!("{refused}");
    };
    assert!(ours.starts_with("0000000000001234"), "{ours}");
    assert!(theirs.starts_with(&format!("{:016x}", Verdict::HASH)), "{theirs}");
    assert!(members.contains("journal"), "the text names who must stop: {members}");
}

#[test]
fn a_steward_of_other_limits_is_refused_while_members_hold_the_old_ones() {
    let bench = Bench::new("limits");
    let first = bench.steward();
    let node = bench.node(RoleId::Perceive);
    let _reader = node.frame_reader().unwrap();
    drop(first);
    let refused = bench.try_steward(Limits { frame_bytes: 100 }).unwrap_err();
    assert!(matches!(refused, Error::LayoutMismatch { channel: Channel::Frame, .. }), "{refused}");
    assert!(refused.to_string().contains("perceive"), "{refused}");
}

#[test]
fn a_late_reader_gets_the_newest_256_verdicts() {
    let bench = Bench::new("history");
    let _steward = bench.steward();
    let judge = bench.node(RoleId::Judge);
    let mut writer = judge.writer::<Verdict>().unwrap();
    (0..300).for_each(|activity| send(&mut writer, activity));

    let journal = bench.node(RoleId::Journal);
    let mut reader = journal.reader::<Verdict>().unwrap();
    // The writer hears of it at its next wait, and then wakes the reader.
    assert_eq!(judge.wait(&mut [&mut writer], NOW).unwrap(), Wake::DeadlineMissed);
    assert_eq!(journal.wait(&mut [&mut reader], PATIENCE).unwrap(), Wake::Sample);
    let mut activities = Vec::new();
    while let Some(verdict) = reader.take().unwrap() {
        activities.push(verdict.activity);
    }
    assert_eq!(activities, (44..300).collect::<Vec<u16>>());
    assert_eq!(reader.lost(), 0, "what was sent before it came is no loss");
}

#[test]
fn what_does_not_fit_the_buffer_is_counted() {
    let bench = Bench::new("loss");
    let _steward = bench.steward();
    let node = bench.node(RoleId::Tool);
    let mut reader = node.reader::<Verdict>().unwrap();
    let mut writer = node.writer::<Verdict>().unwrap();
    send(&mut writer, 0);
    assert!(reader.take().unwrap().is_some());
    (1..=1030).for_each(|activity| send(&mut writer, activity));
    let mut received = 0;
    while reader.take().unwrap().is_some() {
        received += 1;
    }
    assert_eq!((received, reader.lost()), (1024, 6));
}

#[test]
fn a_loss_before_the_first_message_that_is_taken_is_counted_too() {
    let bench = Bench::new("first");
    let _steward = bench.steward();
    let node = bench.node(RoleId::Tool);
    let mut reader = node.reader::<Verdict>().unwrap();
    let mut writer = node.writer::<Verdict>().unwrap();
    (1..=1030).for_each(|activity| send(&mut writer, activity));
    while reader.take().unwrap().is_some() {}
    assert_eq!((reader.received(), reader.lost()), (1024, 6));
}

#[test]
fn the_newest_frame_is_taken_and_older_ones_are_counted_as_skipped() {
    let bench = Bench::new("newest");
    let _steward = bench.steward();
    let node = bench.node(RoleId::Perceive);
    let mut reader = node.frame_reader().unwrap();
    let mut writer = node.frame_writer().unwrap();
    for value in 1..=3 {
        let mut loan = writer.loan(12).unwrap();
        loan.bytes_mut().fill(value);
        (loan.header_mut().height, loan.header_mut().stride) = (3, 4);
        writer.send(loan).unwrap();
    }
    let frame = reader.take_newest().unwrap().unwrap();
    assert_eq!(frame.colour().unwrap(), [3; 12]);
    assert_eq!((frame.header().stamp.seq, reader.skipped(), reader.lost()), (3, 2, 0));
}

#[test]
fn no_frame_of_a_source_that_waits_is_skipped_for_a_newer_one() {
    let bench = Bench::new("waits");
    let _steward = bench.steward();
    let node = bench.node(RoleId::Perceive);
    let mut reader = node.frame_reader().unwrap();
    let mut writer = node.frame_writer().unwrap();
    for _ in 1..=2 {
        let mut loan = writer.loan(0).unwrap();
        loan.header_mut().flags = flag::PACED;
        writer.send(loan).unwrap();
    }
    for seq in 1..=2 {
        assert_eq!(reader.take_newest().unwrap().unwrap().header().stamp.seq, seq);
    }
    assert_eq!(reader.skipped(), 0);
}

#[test]
fn a_frame_whose_header_promises_too_much_is_an_error() {
    let bench = Bench::new("torn");
    let _steward = bench.steward();
    let node = bench.node(RoleId::Perceive);
    let mut reader = node.frame_reader().unwrap();
    let mut writer = node.frame_writer().unwrap();
    let mut loan = writer.loan(12).unwrap();
    (loan.header_mut().height, loan.header_mut().stride) = (u32::MAX, u32::MAX);
    writer.send(loan).unwrap();
    let frame = reader.take().unwrap().unwrap();
    assert!(matches!(frame.colour(), Err(Error::FrameTorn { bytes: 12, .. })));
    assert!(matches!(frame.depth(), Err(Error::FrameTorn { .. })));
    assert!(matches!(writer.loan(SMALL.frame_bytes + 1), Err(Error::FrameTooLarge { .. })));
}

#[test]
fn a_paced_writer_refuses_to_send_without_room() {
    let bench = Bench::new("room");
    let _steward = bench.steward();
    let node = bench.node(RoleId::Journal);
    let mut writer = node.writer::<Verdict>().unwrap();
    writer.follow(&[RoleId::Journal]);
    assert_eq!(node.wait_for_room(&mut writer, NOW).unwrap(), Wake::DeadlineMissed, "no reader is there");
    assert!(matches!(writer.send(writer.loan().unwrap()), Err(Error::NoRoomYet { .. })));

    let mut reader = node.reader::<Verdict>().unwrap();
    assert_eq!(node.wait(&mut [&mut reader], NOW).unwrap(), Wake::DeadlineMissed);
    for _ in 0..Channel::Verdict.qos().burst {
        assert_eq!(node.wait_for_room(&mut writer, NOW).unwrap(), Wake::Room);
        send(&mut writer, 0);
    }
    assert_eq!(node.wait_for_room(&mut writer, NOW).unwrap(), Wake::DeadlineMissed);
    while reader.take().unwrap().is_some() {}
    assert_eq!(node.wait_for_room(&mut writer, PATIENCE).unwrap(), Wake::Room);
}

#[test]
fn a_second_writer_of_a_channel_is_refused_and_the_first_named() {
    let bench = Bench::new("second");
    let _steward = bench.steward();
    let judge = bench.node(RoleId::Judge);
    let _writer = judge.writer::<Verdict>().unwrap();
    let hasty = Node::open(&bench.station, RoleId::Tool, NOW, &Stop::new().unwrap()).unwrap();
    let refused = hasty.writer::<Verdict>().unwrap_err();
    assert!(matches!(refused, Error::TooManyPorts { port: "writers", .. }), "{refused}");
    assert!(refused.to_string().contains("judge (pid"), "{refused}");
}

#[test]
fn several_writers_of_commands_are_counted_each_for_itself() {
    let bench = Bench::new("commands");
    let _steward = bench.steward();
    let node = bench.node(RoleId::Judge);
    let mut reader = node.reader::<Command>().unwrap();
    let mut plc = node.writer::<Command>().unwrap();
    let mut tool = node.writer::<Command>().unwrap();
    for _ in 0..3 {
        plc.send(plc.loan().unwrap()).unwrap();
        tool.send(tool.loan().unwrap()).unwrap();
    }
    while reader.take().unwrap().is_some() {}
    assert_eq!((reader.received(), reader.lost()), (6, 0));
}

#[test]
fn stations_side_by_side_do_not_see_each_other() {
    let (left, right) = (Bench::new("same"), Bench::new("same"));
    let _stewards = (left.steward(), right.steward());
    let (left, right) = (left.node(RoleId::Judge), right.node(RoleId::Judge));
    let mut left_writer = left.writer::<Verdict>().unwrap();
    let mut right_writer = right.writer::<Verdict>().unwrap();
    let mut left_reader = left.reader::<Verdict>().unwrap();
    let mut right_reader = right.reader::<Verdict>().unwrap();
    send(&mut left_writer, 1);
    send(&mut right_writer, 2);
    send(&mut right_writer, 3);
    assert_eq!(left_reader.take().unwrap().unwrap().activity, 1);
    assert!(left_reader.take().unwrap().is_none());
    assert_eq!(right_reader.take().unwrap().unwrap().activity, 2);
    assert_eq!(right_reader.take().unwrap().unwrap().activity, 3);
    assert_eq!(left.station().members().len(), 2, "a steward and a judge");
}

#[test]
fn without_a_steward_the_error_tells_to_start_one() {
    let bench = Bench::new("alone");
    let refused = Node::open(&bench.station, RoleId::Judge, NOW, &Stop::new().unwrap()).unwrap_err();
    assert!(matches!(refused, Error::NoSteward { .. }), "{refused}");
    assert!(refused.to_string().contains("andond run steward"), "{refused}");

    // Its directory without a steward is not enough.
    drop(bench.steward());
    let node = Node::open(&bench.station, RoleId::Judge, NOW, &Stop::new().unwrap()).unwrap();
    let refused = node.reader::<Verdict>().unwrap_err();
    assert!(matches!(refused, Error::NoSteward { channel: Channel::Verdict, .. }), "{refused}");
}

#[test]
fn a_second_steward_is_refused() {
    let bench = Bench::new("twice");
    let _steward = bench.steward();
    let refused = Steward::create(&bench.station, SMALL).unwrap_err();
    assert!(matches!(refused, Error::StewardRunning { .. }), "{refused}");
}

#[test]
fn a_full_dev_shm_is_refused_before_anything_is_created() {
    let bench = Bench::new("full");
    let refused = Steward::create(&bench.station, Limits { frame_bytes: 1 << 40 }).unwrap_err();
    let Error::NoRoom { needed_mib, .. } = refused else { panic!("{refused}") };
    assert!(needed_mib >= 36 << 20, "36 frames of a TiB");
    assert_eq!(bench.shared_files(), Vec::<String>::new());
}

#[test]
fn a_root_that_cannot_be_made_is_refused() {
    // Permissions would not do: tests may run as root, who may write anywhere.
    let station = andon_ipc::Station::under("bench", std::path::Path::new("/dev/null/run")).unwrap();
    let refused = Steward::create(&station, SMALL).unwrap_err();
    assert!(matches!(refused, Error::RootNotWritable { .. }), "{refused}");
    assert!(refused.to_string().contains("/dev/null/run"), "{refused}");
}

#[test]
fn a_root_that_vanishes_is_noticed() {
    let bench = Bench::new("vanish");
    let mut steward = bench.steward();
    assert_eq!(steward.poll().unwrap(), []);
    std::fs::rename(bench.station.root(), bench.station.root().with_extension("old")).unwrap();
    assert!(matches!(steward.poll(), Err(Error::RootVanished { .. })));
    std::fs::create_dir(bench.station.root()).unwrap();
    assert!(
        matches!(steward.poll(), Err(Error::RootVanished { .. })),
        "this is another directory of the same name"
    );
    std::fs::remove_dir(bench.station.root()).unwrap();
    std::fs::rename(bench.station.root().with_extension("old"), bench.station.root()).unwrap();
}

#[test]
fn health_is_sent_when_the_state_changes_and_carries_the_counts() {
    let bench = Bench::new("health");
    let _steward = bench.steward();
    let node = bench.node(RoleId::Encode);
    let mut reader = node.reader::<Health>().unwrap();
    let mut heartbeat = Heartbeat::new(&node).unwrap();
    assert!(heartbeat.beat().unwrap());
    heartbeat.received(&Stamp { seq: 1, frame_seq: 9, captured_ns: 8, sent_ns: 7, epoch: 6 });
    heartbeat.sent(MessageId { epoch: 7, seq: 1 });
    heartbeat.refused();
    heartbeat.losses(5, 1);
    (1..=100).for_each(|millis| heartbeat.stepped(Duration::from_millis(millis)));
    heartbeat.state(RoleState::Running);
    assert!(heartbeat.beat().unwrap());

    assert_eq!(reader.take().unwrap().unwrap().state, RoleState::Starting.code());
    let health = reader.take().unwrap().unwrap();
    assert_eq!((health.role, health.state), (RoleId::Encode.code(), RoleState::Running.code()));
    assert_eq!((health.received, health.sent, health.refused, health.losses), (1, 1, 1, 5));
    assert_eq!(health.steps, 100);
    assert_eq!((health.stamp.frame_seq, health.stamp.captured_ns, health.stamp.seq), (9, 8, 2));
    assert_eq!(health.pid, std::process::id());
    // The histogram is accurate to 1 %.
    assert!(health.p50_us.abs_diff(50_000) <= 500, "{}", health.p50_us);
    assert!(health.p99_us.abs_diff(99_000) <= 990, "{}", health.p99_us);
}

#[test]
fn a_member_notices_that_the_root_was_removed_or_replaced() {
    let bench = Bench::new("rootless");
    let _steward = bench.steward();
    let node = bench.node(RoleId::Encode);
    node.check_root().unwrap();
    std::fs::rename(bench.station.root(), bench.station.root().with_extension("old")).unwrap();
    assert!(matches!(node.check_root(), Err(Error::RootVanished { .. })));
    std::fs::create_dir(bench.station.root()).unwrap();
    assert!(matches!(node.check_root(), Err(Error::RootVanished { .. })), "another one of the same name");
    std::fs::remove_dir(bench.station.root()).unwrap();
    std::fs::rename(bench.station.root().with_extension("old"), bench.station.root()).unwrap();
    node.check_root().unwrap();
}

#[test]
fn the_memory_of_every_port_is_there_before_its_first_message() {
    let bench = Bench::new("reserved");
    let _steward = bench.steward();
    let node = bench.node(RoleId::Judge);
    let _reader = node.reader::<Verdict>().unwrap();
    let _writer = node.writer::<Verdict>().unwrap();
    let _frames = node.frame_writer().unwrap();
    for name in bench.shared_files() {
        let meta = std::fs::metadata(format!("/dev/shm/{name}")).unwrap();
        let held = std::os::unix::fs::MetadataExt::blocks(&meta) * 512;
        assert!(held >= meta.len(), "{name}: {held} of {} bytes; the rest may be a SIGBUS", meta.len());
    }
}

#[test]
fn a_station_is_in_use_while_anybody_is_in_it() {
    let bench = Bench::new("in-use");
    assert!(!bench.station.is_in_use());
    let steward = bench.steward();
    assert!(bench.station.is_in_use());
    drop(steward);
    assert!(!bench.station.is_in_use());
}
