//! The codes of inputs that no simulated worker gives. Each test takes the place of one role and feeds those after it by hand.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_core::bounds::Bounds;
use andon_core::job::MeasureBounds;
use andon_ipc::{UtcTime, Wake};
use andon_learn::job_file::JobFile;
use andon_tests::line::{Line, Modbus, PATIENCE, Sender, Settings, Watcher, stand_in, status};
use rustix::process::Signal;
use shm_schemas::{
    ColourFormat, Couples, DepthFormat, Detections, FrameHeader, HandCouple, Health, Intrinsics, RoleId,
    RoleState, Verdict, VerdictLevel, VerdictOutcome,
};
use std::fs::File;
use std::path::Path;
use std::time::{Duration, Instant};

/// From one frame to the next.
const INTERVAL_NS: u64 = 33_333_333;

/// Makes it the verdict on a job that was done right.
fn job_done(verdict: &mut Verdict) {
    verdict.level = VerdictLevel::Job.code();
    verdict.outcome = VerdictOutcome::Ok.code();
    verdict.decided_utc_ns = UtcTime::now().nanoseconds();
}

#[test]
fn a_frame_that_is_older_than_the_one_before_it_is_refused_and_reported() {
    let mut line = Line::new(Settings::default());
    line.start("steward");
    line.start("encode");
    let mut perceive = Sender::<Detections>::new(&line, RoleId::Perceive, &[RoleId::Encode]);
    for frame in [10, 9] {
        perceive.send(|message| message.source_ns = frame * INTERVAL_NS);
    }
    line.wait_for_log("encode", "AND-312", "look at the camera's driver");
}

#[test]
fn a_step_that_lasts_longer_than_can_be_compared_is_reported_and_not_judged() {
    let mut line = Line::new(Settings::default());
    // Any length and any motion of the step is right, so that nothing but its length can end the comparison.
    let mut job = JobFile::parse("job", &std::fs::read(line.path("job.toml")).unwrap()).unwrap();
    for iu in job.activities.iter_mut().flat_map(|activity| &mut activity.ius) {
        let any = Bounds { min: 0, max: u32::MAX };
        (iu.frames, iu.reversals, iu.threshold) = (any, any, f32::MAX);
        iu.measures = MeasureBounds::ANY;
    }
    std::fs::write(line.path("job.toml"), job.to_toml()).unwrap();
    let (x_c, model_hash) = (job.activities[0].ius[0].context.0, job.model_hash());
    line.start("steward");
    let mut watcher = Watcher::join(&line.station);
    line.start("judge");
    let mut encode = Sender::<Couples>::new(&line, RoleId::Encode, &[RoleId::Judge]);
    let mut frame = 0;
    while watcher.verdicts.is_empty() {
        assert!(frame < 10_000, "nothing is judged:\n{}", line.log("judge"));
        encode.send(|message| {
            (message.described_ns, message.known_ns) = (frame * INTERVAL_NS, frame * INTERVAL_NS);
            message.model_hash = model_hash;
            message.hands = [HandCouple { is_measured: 1, ..HandCouple::default() }; 2];
            message.hands[usize::from(x_c[0]) - 1].x_c = x_c;
        });
        frame += 1;
        watcher.listen(Duration::ZERO);
    }
    assert_eq!(watcher.verdicts[0].outcome(), Ok(VerdictOutcome::NotJudged));
    line.wait_for_log("judge", "AND-308", "shorter activities");
}

#[test]
fn verdicts_that_a_journal_misses_are_reported_and_leave_a_gap() {
    let mut line = Line::new(Settings::default());
    line.start("steward");
    let mut watcher = Watcher::join(&line.station);
    line.start("journal");
    let mut judge = Sender::<Verdict>::new(&line, RoleId::Judge, &[RoleId::Journal]);
    judge.send(job_done);
    // What was sent before a reader was there is no loss to it.
    watcher.until("the first verdict", |watcher| {
        watcher.health(RoleId::Journal).is_some_and(|health| health.received == 1)
    });
    line.role("journal").signal(Signal::STOP);
    // More than wait on the channel, and without waiting for the reader.
    judge.writer.follow(&[]);
    (0..1100).for_each(|_| judge.send(job_done));
    line.role("journal").signal(Signal::CONT);
    line.wait_for_log("journal", "AND-609", "andond status");
    line.wait_for_log("journal", "AND-405", "Look at the messages before this one");
    line.stop();
    assert_eq!(line.journal().gaps(), 1);
}

#[test]
fn verdicts_that_are_older_than_the_journal_keeps_are_removed_and_that_is_reported() {
    let mut line = Line::new(Settings::default());
    line.reconfigure("[journal]\n", "[journal]\nkeep_days = 1\n");
    line.start("steward");
    line.start("journal");
    let mut judge = Sender::<Verdict>::new(&line, RoleId::Judge, &[RoleId::Journal]);
    let two_days_ns = 2 * 24 * 3600 * 1_000_000_000;
    judge.send(|verdict| {
        job_done(verdict);
        verdict.decided_utc_ns -= two_days_ns;
    });
    judge.send(job_done);
    // It writes what has come before it ends, and removes at its next start.
    line.role("journal").signal(Signal::TERM);
    assert!(line.role("journal").wait().success());
    line.start("journal");
    line.wait_for_log("journal", "AND-406", "1 verdicts were removed");
}

#[test]
fn results_that_a_plc_does_not_acknowledge_wait_in_the_journal_and_none_is_lost() {
    let mut line = Line::new(Settings { writes: true, ..Settings::default() });
    let (mut judge, mut plc) = judge_and_plc(&mut line);
    plc.enable();
    (1..=50).for_each(|_| judge.send(job_done));
    for number in 1..=50 {
        if number == 25 {
            line.role("plc").kill();
            line.start("plc");
            plc = Modbus::connect_when_up(line.port);
            plc.enable();
        }
        plc.wait_for(status::DONE);
        assert_eq!(plc.sequence(), number);
        plc.acknowledge();
    }
    assert_eq!(plc.lost(), 0);
}

#[test]
fn results_that_come_faster_than_a_plc_that_only_reads_is_shown_them_are_lost_to_it_and_that_is_reported() {
    let mut line = Line::new(Settings::default());
    let (mut judge, _plc) = judge_and_plc(&mut line);
    (0..200).for_each(|_| judge.send(job_done));
    line.wait_for_log("plc", "AND-507", "waits until it is acknowledged");
}

/// A judge that sends what it is told, and a PLC that has its account and has been told of nothing.
fn judge_and_plc(line: &mut Line) -> (Sender<Verdict>, Modbus) {
    ["steward", "journal", "plc"].into_iter().for_each(|role| {
        line.start(role);
    });
    let judge = Sender::<Verdict>::new(line, RoleId::Judge, &[RoleId::Journal]);
    let mut plc = Modbus::connect_when_up(line.port);
    let until = Instant::now() + PATIENCE;
    while plc.boot() == 0 {
        assert!(Instant::now() < until, "the journal does not keep that plc has started");
        std::thread::sleep(Duration::from_millis(10));
    }
    (judge, plc)
}

/// A station in metric mode without a calibration, so that the bench must be found in the depth pictures.
fn metric(folder: &Path) -> String {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let models = repository.join("target/runtime").canonicalize().unwrap();
    format!(
        "[station]\nname = \"line\"\nroot = {folder:?}\n\n[camera]\nsource = \"realsense\"\nwidth = 640\nheight = 480\n\n\
         [bench]\nspace = \"metric\"\n\n[perception]\nmodels = {models:?}\n\n\
         [[objects]]\nid = 1\nname = \"cup\"\nmarker_side_m = 0.03\ninteraction_points = [[0.0, 0.0, 0.0]]\n"
    )
}

/// A camera that looks into the dark, and lost three frames before this one.
fn dark(header: &mut FrameHeader) {
    let optics = Intrinsics { fx: 600.0, fy: 600.0, cx: 320.0, cy: 240.0, ..Intrinsics::default() };
    (header.width, header.height, header.stride) = (640, 480, 1920);
    header.colour_format = ColourFormat::Rgb8.code();
    (header.depth_width, header.depth_height, header.depth_stride) = (640, 480, 1280);
    header.depth_format = DepthFormat::Z16.code();
    header.depth_unit_m = 0.001;
    (header.colour, header.depth) = (optics, optics);
    header.colour_from_depth.rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    header.dropped = 3;
}

#[test]
fn a_bench_that_the_depth_does_not_show_and_frames_that_the_camera_lost_are_reported() {
    let mut line = Line::configured(|folder, _| metric(folder));
    line.start("steward");
    let mut watcher = Watcher::join(&line.station);
    line.start("perceive");
    let node = stand_in(&line, RoleId::Capture);
    let mut capture = node.frame_writer().unwrap();
    capture.follow(&[RoleId::Perceive]);
    assert_eq!(node.wait_for_room(&mut capture, PATIENCE).unwrap(), Wake::Room);
    let mut frame = capture.loan(640 * 480 * (3 + 2)).unwrap();
    frame.bytes_mut().fill(0);
    dark(frame.header_mut());
    capture.send(frame).unwrap();
    line.wait_for_log("perceive", "AND-211", "clear the bench");
    line.wait_for_log("perceive", "AND-609", "3 messages were lost");
    watcher.until("the losses", |watcher| {
        watcher.health(RoleId::Perceive).is_some_and(|health| health.losses == 3)
    });
}

/// Says that a role has sent this many messages, of which its reader must know.
fn claim(line: &Line, role: RoleId, epoch: u64, sent: u64, until: impl Fn() -> bool) {
    let node = stand_in(line, role);
    let mut health = node.writer::<Health>().unwrap();
    let end = std::time::Instant::now() + PATIENCE;
    while !until() {
        assert!(std::time::Instant::now() < end, "nobody notices:\n{}", line.log("judge"));
        let mut message = health.loan().unwrap();
        (message.role, message.state) = (role.code(), RoleState::Running.code());
        (message.sent_epoch, message.sent) = (epoch, sent);
        health.send(message).unwrap();
        node.wait(&mut [&mut health], Duration::from_millis(100)).unwrap();
    }
}

#[test]
fn a_judge_that_does_not_hear_encode_says_so_and_opens_its_channel_again() {
    let mut line = Line::new(Settings::default());
    line.start("steward");
    let mut watcher = Watcher::join(&line.station);
    line.start("judge");
    claim(&line, RoleId::Encode, 7, 40, || line.log("judge").contains("AND-616"));
    line.wait_for_log("judge", "AND-616", "40 messages of encode have not come");
    watcher.until("the judge's state", |watcher| watcher.is(RoleId::Judge, RoleState::Fault));
    // What is sent then comes, through the new connection.
    let mut encode = Sender::<Couples>::new(&line, RoleId::Encode, &[RoleId::Judge]);
    let job = JobFile::parse("job", &std::fs::read(line.path("job.toml")).unwrap()).unwrap();
    encode.send(|message| {
        message.described_ns = INTERVAL_NS;
        message.model_hash = job.model_hash();
    });
    watcher.until("the judge", |watcher| watcher.is(RoleId::Judge, RoleState::Running));
}

#[test]
fn a_journal_that_does_not_hear_the_judge_is_not_healthy_and_hears_it_again() {
    let mut line = Line::new(Settings::default());
    line.start("steward");
    let mut watcher = Watcher::join(&line.station);
    line.start("journal");
    claim(&line, RoleId::Judge, 7, 3, || line.log("journal").contains("AND-616"));
    watcher.until("the journal's fault", |watcher| watcher.is(RoleId::Journal, RoleState::Fault));
    let mut judge = Sender::<Verdict>::new(&line, RoleId::Judge, &[RoleId::Journal]);
    judge.send(job_done);
    watcher.until("the journal", |watcher| watcher.is(RoleId::Journal, RoleState::Running));
    line.stop();
    assert_eq!(line.journal().verdicts().len(), 1);
}

#[test]
fn a_recording_that_was_cut_and_cannot_be_completed_is_said_and_stays_whether_anything_is_recorded_or_not() {
    for mode in ["always", "off"] {
        let mut line = Line::new(Settings::default());
        // By its name it is not too old for a while.
        let path = line.record(mode).join("00000001-20990101T000000.000Z.mcap");
        std::fs::create_dir(path.parent().unwrap()).unwrap();
        std::fs::write(&path, "of another program, and long enough to be one").unwrap();
        line.start("steward");
        line.start("record");
        line.wait_for_log("record", "AND-417", "this is no MCAP file");
        assert!(path.exists());
    }
}

#[test]
fn recordings_grow_too_old_and_go_also_where_nothing_is_recorded_any_more_and_that_is_said() {
    let mut line = Line::new(Settings::default());
    let path = line.record("off").join("00000001-20200101T000000.000Z.mcap");
    std::fs::create_dir(path.parent().unwrap()).unwrap();
    File::create(&path).unwrap();
    line.start("steward");
    line.start("record");
    line.wait_for_log("record", "AND-414", "1 recordings were removed");
    assert!(!path.exists());
}

#[test]
fn an_anomaly_whose_picture_is_not_in_memory_any_more_is_recorded_without_it_and_that_is_reported() {
    let mut line = Line::new(Settings::default());
    line.record("always");
    line.start("steward");
    line.start("record");
    line.wait_for_log("record", "AND-601", "");
    let node = stand_in(&line, RoleId::Capture);
    let mut capture = node.frame_writer().unwrap();
    let mut judge = Sender::<Verdict>::new(&line, RoleId::Judge, &[]);
    let until = Instant::now() + PATIENCE;
    while !line.log("record").contains("AND-418") {
        assert!(Instant::now() < until, "{}", line.log("record"));
        let mut frame = capture.loan(640 * 480 * (3 + 2)).unwrap();
        frame.bytes_mut().fill(0);
        dark(frame.header_mut());
        frame.header_mut().stamp.captured_ns = 2 * INTERVAL_NS;
        capture.send(frame).unwrap();
        judge.send(|verdict| {
            verdict.level = VerdictLevel::Iu.code();
            verdict.outcome = VerdictOutcome::Anomaly.code();
            verdict.stamp.captured_ns = INTERVAL_NS;
        });
        std::thread::sleep(Duration::from_millis(20));
    }
    line.wait_for_log("record", "AND-418", "Raise record.memory_mb");
}

#[test]
fn a_role_whose_first_message_never_comes_says_so() {
    let mut line = Line::new(Settings::default());
    line.start("steward");
    line.start("judge");
    line.wait_for_log("judge", "AND-610", "nothing has come since the start");
}
