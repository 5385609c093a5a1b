//! The C example, compiled against the header and the library of this build, reads what a Rust writer writes.
#![allow(clippy::unwrap_used)]

mod station;

use andon_ipc::{Node, Stop, Writer};
use andon_plc::c_abi::*;
use shm_schemas::{Health, JudgePhase, Judging, RoleId, RoleState, VerdictLevel, VerdictOutcome};
use station::{TestStation, start_reader};
use std::ffi::{CStr, CString};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::time::Duration;

/// Where cargo puts `libandon_plc.so` of this build: beside this test.
fn library_dir() -> PathBuf {
    std::env::current_exe().unwrap().parent().unwrap().to_path_buf()
}

fn compiled(out: &Path) -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = out.join("soft_plc");
    // Programs ask for the library by the name that it was given when it was linked.
    std::os::unix::fs::symlink(library_dir().join("libandon_plc.so"), out.join("libandon_plc.so.0")).unwrap();
    let status = Command::new("cc")
        .args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O2"])
        .arg(format!("-I{}", here.join("include").display()))
        .arg(here.join("examples/soft_plc.c"))
        .arg(out.join("libandon_plc.so.0"))
        .arg(format!("-Wl,-rpath,{}", out.display()))
        .arg("-o")
        .arg(&program)
        .status()
        .unwrap();
    assert!(status.success(), "the example does not compile");
    program
}

fn started(program: &Path, station: &TestStation, count: &str) -> (Child, impl Iterator<Item = String>) {
    start_reader(Command::new(program).args(["plctest", count]).arg(station.station.root()))
}

#[test]
fn a_c_program_reads_every_verdict_as_it_was_written_and_hears_that_the_judge_has_gone() {
    let dir = tempfile::tempdir().unwrap();
    let program = compiled(dir.path());
    let station = TestStation::new();
    let mut judge = station.judge();
    let (mut child, mut lines) = started(&program, &station, "1000");
    for number in 1..=500 {
        judge.send(number);
        judge.idle(Duration::from_millis(1));
    }
    drop(judge);
    let first: Vec<String> = lines.by_ref().take(501).collect();
    assert_eq!(first[0], "verdict 1 ok reason 0 distance 0.5 station plctest part A-1");
    assert_eq!(first[2], "verdict 3 nok reason 3 distance 1.5 station plctest part A-3");
    assert_eq!(first[500], "judge gone");
    let mut judge = station.judge();
    for number in 1..=500 {
        judge.send(number);
        judge.idle(Duration::from_millis(1));
    }
    let rest: Vec<String> = lines.collect();
    assert_eq!(rest[0], "verdict 1 ok reason 0 distance 0.5 station plctest part A-1");
    assert_eq!(rest[500], "received 1000 lost 0");
    println!("C reader: {}", rest[501]);
    assert!(child.wait().unwrap().success());
}

#[test]
fn a_program_in_cpp_can_include_the_header() {
    let dir = tempfile::tempdir().unwrap();
    let source = dir.path().join("a.cpp");
    std::fs::write(
        &source,
        "#include \"andon.h\"\nint main() { AndonReader *r = 0; andon_close(r); return ANDON_OUTCOME_OK; }\n",
    )
    .unwrap();
    let include = format!("-I{}/include", env!("CARGO_MANIFEST_DIR"));
    let status =
        Command::new("c++").args(["-Wall", "-Werror", "-fsyntax-only", &include]).arg(&source).status();
    assert!(status.unwrap().success());
}

fn last_error() -> String {
    // SAFETY: the text lives until the next failing call of this thread, and it is copied before that.
    unsafe { CStr::from_ptr(andon_last_error()) }.to_str().unwrap().to_owned()
}

#[test]
fn bad_arguments_are_answered_with_a_number_and_a_text() {
    let (mut reader, null) = (std::ptr::null_mut(), std::ptr::null());
    let station = CString::new("Not A Name").unwrap();
    let nowhere = CString::new("/nonexistent/andon").unwrap();
    let bench = CString::new("bench").unwrap();
    // SAFETY: every pointer is null or lives to the end of this function.
    unsafe {
        assert_eq!(andon_open(null, null, 0, &mut reader), AndonResult::Argument);
        assert!(last_error().contains("station is null"));
        assert_eq!(andon_open(null, bench.as_ptr(), 0, std::ptr::null_mut()), AndonResult::Argument);
        assert_eq!(andon_open(null, station.as_ptr(), 0, &mut reader), AndonResult::Station);
        assert!(last_error().contains("Not A Name"), "{}", last_error());
        assert_eq!(andon_open(nowhere.as_ptr(), bench.as_ptr(), 0, &mut reader), AndonResult::NoSteward);
        assert!(reader.is_null());
        assert_eq!(andon_next(reader, 0, std::ptr::null_mut()), AndonResult::Argument);
        assert_eq!(andon_status(reader, std::ptr::null_mut()), AndonResult::Argument);
        andon_close(reader);
    }
}

/// As a soft PLC does that opens the reader when it starts and reads in its cyclic task.
#[test]
fn a_reader_that_was_opened_in_one_thread_reads_in_another() {
    struct Handed(*mut AndonReader);
    // SAFETY: the header allows it; no two threads use the reader at the same time here.
    unsafe impl Send for Handed {}

    let station = TestStation::new();
    let mut judge = station.judge();
    let root = CString::new(station.station.root().to_str().unwrap()).unwrap();
    let name = CString::new("plctest").unwrap();
    let opened = std::thread::spawn(move || {
        let mut reader = std::ptr::null_mut();
        // SAFETY: the texts and `reader` live to the end of this closure.
        let result = unsafe { andon_open(root.as_ptr(), name.as_ptr(), 5000, &mut reader) };
        assert_eq!(result, AndonResult::Nothing);
        Handed(reader)
    });
    let Handed(reader) = opened.join().unwrap();
    judge.send(1);
    let mut verdict = std::mem::MaybeUninit::<AndonVerdict>::uninit();
    // SAFETY: the reader is open, the thread that opened it has ended, and it is closed once.
    unsafe {
        assert_eq!(andon_next(reader, 5_000_000, verdict.as_mut_ptr()), AndonResult::Verdict);
        assert_eq!(verdict.assume_init().seq, 1);
        andon_close(reader);
    }
}

/// What the roles of a line say of themselves.
struct Roles {
    judging: Writer<Judging>,
    health: Writer<Health>,
}

impl Roles {
    fn of(station: &TestStation) -> Self {
        let patience = Duration::from_secs(20);
        let node = Node::open(&station.station, RoleId::Tool, patience, &Stop::new().unwrap()).unwrap();
        Self { judging: node.writer().unwrap(), health: node.writer().unwrap() }
    }

    /// The judge watches a job, and every role runs.
    fn say_ready(&mut self) {
        let mut judging = self.judging.loan().unwrap();
        (judging.is_enabled, judging.phase) = (1, JudgePhase::Waiting.code());
        self.judging.send(judging).unwrap();
        for role in [RoleId::Perceive, RoleId::Encode, RoleId::Judge, RoleId::Journal] {
            let mut health = self.health.loan().unwrap();
            (health.role, health.state) = (role.code(), RoleState::Running.code());
            self.health.send(health).unwrap();
        }
    }
}

/// A cyclic task asks with a timeout of 0 and must hear it all the same.
#[test]
fn a_dead_judge_is_reported_with_a_timeout_of_0_and_ready_is_what_the_line_says() {
    let station = TestStation::new();
    let judge = station.judge();
    let mut roles = Roles::of(&station);
    let root = CString::new(station.station.root().to_str().unwrap()).unwrap();
    let name = CString::new("plctest").unwrap();
    let mut reader = std::ptr::null_mut();
    let mut verdict = std::mem::MaybeUninit::<AndonVerdict>::uninit();
    // SAFETY: every pointer lives to the end of this function; the reader is closed once, at the end.
    unsafe {
        assert_eq!(andon_open(root.as_ptr(), name.as_ptr(), 5000, &mut reader), AndonResult::Nothing);
        let ready = || {
            let mut status = AndonStatus::default();
            assert_eq!(andon_status(reader, &mut status), AndonResult::Nothing);
            status.ready
        };
        assert_eq!(ready(), 0, "nobody has said anything");
        let until = std::time::Instant::now() + Duration::from_secs(60);
        while ready() == 0 {
            assert!(std::time::Instant::now() < until, "never ready");
            // One beat of each role is what the channel holds.
            roles.say_ready();
            std::thread::sleep(Duration::from_millis(20));
        }
        drop(judge);
        loop {
            match andon_next(reader, 0, verdict.as_mut_ptr()) {
                AndonResult::WriterGone => break,
                other => assert_eq!(other, AndonResult::Nothing),
            }
            assert!(std::time::Instant::now() < until, "the judge has gone and nobody says so");
            std::thread::sleep(Duration::from_millis(5));
        }
        assert_eq!(ready(), 0);
        andon_close(reader);
    }
}

/// More than the verdict channel allows.
const MANY: usize = 64;

#[test]
fn one_reader_too_many_is_refused() {
    let station = TestStation::new();
    let root = CString::new(station.station.root().to_str().unwrap()).unwrap();
    let name = CString::new("plctest").unwrap();
    let mut readers = [std::ptr::null_mut(); MANY];
    // SAFETY: every pointer lives to the end of this function; each reader is closed once, and null is allowed.
    unsafe {
        let refused = readers.iter_mut().find_map(|reader| {
            let result = andon_open(root.as_ptr(), name.as_ptr(), 5000, reader);
            (result != AndonResult::Nothing).then_some(result)
        });
        assert_eq!(refused, Some(AndonResult::TooManyReaders), "{}", last_error());
        readers.into_iter().for_each(|reader| andon_close(reader));
    }
}

#[test]
fn a_timeout_of_0_does_not_wait_and_the_status_follows_the_judge() {
    let station = TestStation::new();
    let mut judge = station.judge();
    let root = CString::new(station.station.root().to_str().unwrap()).unwrap();
    let name = CString::new("plctest").unwrap();
    let mut reader = std::ptr::null_mut();
    let mut verdict = std::mem::MaybeUninit::<AndonVerdict>::uninit();
    let mut status = AndonStatus::default();
    // SAFETY: every pointer lives to the end of this function; the reader is closed once, at the end.
    unsafe {
        assert_eq!(andon_open(root.as_ptr(), name.as_ptr(), 5000, &mut reader), AndonResult::Nothing);
        assert_eq!(andon_next(reader, 0, verdict.as_mut_ptr()), AndonResult::Nothing);
        judge.send(3);
        assert_eq!(andon_next(reader, 5_000_000, verdict.as_mut_ptr()), AndonResult::Verdict);
        let first = verdict.assume_init_ref();
        assert_eq!((first.seq, first.distance), (1, 1.5));
        assert_eq!((first.level, first.outcome), (VerdictLevel::Iu.code(), VerdictOutcome::Anomaly.code()));
        assert_eq!(andon_status(reader, &mut status), AndonResult::Nothing);
        assert_eq!((status.received, status.lost, status.restarts, status.writer_gone), (1, 0, 0, 0));

        drop(judge);
        let mut next = || andon_next(reader, 5_000_000, verdict.as_mut_ptr());
        assert_eq!(next(), AndonResult::WriterGone);
        assert_eq!(andon_status(reader, &mut status), AndonResult::Nothing);
        assert_eq!((status.restarts, status.writer_gone), (0, 1));
        let mut judge = station.judge();
        judge.send(3);
        assert_eq!(next(), AndonResult::Verdict);
        assert_eq!(andon_status(reader, &mut status), AndonResult::Nothing);
        assert_eq!((status.received, status.restarts, status.writer_gone), (2, 1, 0));
        andon_close(reader);
    }
}
