//! The role `record`: what a line does can be looked at and judged again, with the same verdicts bit for bit, whatever happened meanwhile.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::Channel;
use andon_record::{Entry, Item, Losses, RecordingReader, Topic, store};
use andon_tests::environment;
use andon_tests::line::{
    Line, Modbus, PATIENCE, ROLES, Settings, UNSEEN, Watcher, andond, control, detections_in, role_id, status,
};
use andon_tests::python::all_output;
use andon_tests::shim;
use andon_tests::simulator::Flaw;
use rustix::process::Signal;
use shm_schemas::{Health, JudgePhase, RoleId, RoleState, VerdictOutcome, from_bytes};
use std::collections::HashSet;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

fn stop(line: &mut Line) {
    let failures = line.stop_recorded();
    assert!(failures.is_empty(), "{failures:?}");
}

fn only_recording(line: &Line) -> PathBuf {
    let found = line.recordings();
    let [only] = found.as_slice() else { panic!("{found:?}\n{}", line.log("record")) };
    only.clone()
}

/// How many verdicts of a recording were equal to those that were sent, and how many were sent, as `andond replay` says.
fn equal(line: &Line, recording: &Path) -> (usize, usize, String) {
    let output = line.command("replay", &[recording.to_str().unwrap()]);
    assert!(output.status.code().is_some_and(|code| code < 3), "{}", all_output(&output));
    let text = all_output(&output);
    let figures =
        text.lines().find_map(|row| row.strip_prefix("as recorded: ")).unwrap_or_else(|| panic!("{text}"));
    let mut numbers = figures.split(' ').filter_map(|word| word.parse().ok());
    (numbers.next().unwrap(), numbers.next().unwrap(), text)
}

fn all_are_equal(line: &Line, recording: &Path, at_least: usize) {
    are_all_equal(line, at_least, equal(line, recording));
}

fn are_all_equal(line: &Line, at_least: usize, (equal, sent, text): (usize, usize, String)) {
    assert!(equal == sent && sent >= at_least, "{text}\n{}", line.log("record"));
    assert!(!text.contains("differ"), "{text}");
}

#[test]
fn a_line_that_is_recorded_is_judged_again_with_the_same_verdicts_to_the_bit() {
    let settings = Settings { at_full_speed: false, flaw: Flaw::WrongOrder, ..Settings::default() };
    let mut line = Line::new(settings);
    line.record("always");
    let mut watcher = line.launch_recorded();
    let sent = watcher.until_judged();
    stop(&mut line);
    let recording = only_recording(&line);
    all_are_equal(&line, &recording, usize::try_from(sent).unwrap());
    // Another job, or the same by its file, is a matter of what was detected alone.
    let job = line.path("job.toml");
    let output = line.command("replay", &["--job", job.to_str().unwrap(), recording.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1), "{}", all_output(&output));
}

/// Aborts the piece in progress and begins the next one.
fn abort_and_start(plc: &mut Modbus, watcher: &mut Watcher) {
    plc.control(control::ENABLE | control::ABORT).unwrap();
    watcher.until("the end of the piece", |watcher| watcher.phase() == Some(JudgePhase::Waiting));
    plc.control(control::ENABLE).unwrap();
    plc.control(control::ENABLE | control::START).unwrap();
    watcher.until("a piece", |watcher| watcher.phase() == Some(JudgePhase::Running));
}

#[test]
fn commands_in_the_middle_of_a_job_come_at_the_same_place_again() {
    let mut line = Line::with_second_job(Settings { writes: true, ..Settings::live() });
    line.record("always");
    let mut watcher = line.launch_recorded();
    let mut plc = Modbus::connect_when_up(line.port);
    plc.enable();
    watcher.until("a piece", |watcher| watcher.phase() == Some(JudgePhase::Running));
    watcher.until("verdicts", |watcher| watcher.verdicts.len() >= 2);
    // Abort, then start again, then nobody watches for a while, then another job.
    abort_and_start(&mut plc, &mut watcher);
    plc.control(control::ENABLE).unwrap();
    let before = watcher.verdicts.len();
    watcher.until("more verdicts", |watcher| watcher.verdicts.len() >= before + 2);
    plc.control(0).unwrap();
    watcher.until("nobody watches", |watcher| watcher.watches().is_some_and(|(_, watches)| !watches));
    plc.enable();
    let before = watcher.verdicts.len();
    watcher.until("more verdicts", |watcher| watcher.verdicts.len() >= before + 2);
    plc.abort_and_load_job(2);
    let before = watcher.verdicts.len();
    watcher.until("verdicts of the other job", |watcher| watcher.verdicts.len() >= before + 3);
    stop(&mut line);
    all_are_equal(&line, &only_recording(&line), 9);
}

#[test]
fn a_recorder_that_stands_still_while_commands_come_has_what_became_of_each() {
    let mut line = Line::with_second_job(Settings { writes: true, ..Settings::live() });
    line.record("always");
    let mut watcher = line.launch_recorded();
    let mut plc = Modbus::connect_when_up(line.port);
    plc.enable();
    watcher.until("a piece", |watcher| watcher.phase() == Some(JudgePhase::Running));
    line.role("record").signal(Signal::STOP);
    let stopped = Instant::now();
    for _ in 0..4 {
        abort_and_start(&mut plc, &mut watcher);
    }
    line.role("record").signal(Signal::CONT);
    // 64 messages of the judge wait for the recorder: some 12 of these commands, and two of its heartbeats a second.
    let may_wait = stopped.elapsed() < Duration::from_secs(20);
    plc.control(control::ENABLE).unwrap();
    let before = watcher.verdicts.len();
    watcher.until("verdicts", |watcher| watcher.verdicts.len() >= before + 2);
    stop(&mut line);
    let of_replay = equal(&line, &only_recording(&line));
    let lacks = |what: &str| of_replay.2.contains(&format!("{what} did not reach the recorder"));
    if lacks("messages of detections") {
        // A busy machine takes longer over the commands than frames wait for anyone.
        assert!(!(may_wait && lacks("messages of judging")), "{}", of_replay.2);
    } else {
        are_all_equal(&line, before + 2, of_replay);
    }
}

#[test]
fn a_recording_that_begins_before_a_job_is_loaded_is_judged_again_with_the_same_verdicts() {
    let mut line = Line::with_second_job(Settings { writes: true, ..Settings::live() });
    line.reconfigure("job = \"job.toml\"\n", "");
    line.record("always");
    // Without a job the line never becomes ready, and works all the same.
    let mut watcher = line.launch();
    line.wait_for_log("judge", "AND-311", "");
    watcher.until("couples", |watcher| watcher.health(RoleId::Encode).is_some_and(|health| health.sent > 30));
    line.start("record");
    line.wait_for_log("record", "AND-601", "");
    let mut plc = Modbus::connect_when_up(line.port);
    plc.enable();
    assert_eq!(plc.load_job(2), None);
    watcher.until("verdicts", |watcher| watcher.verdicts.len() >= 3);
    stop(&mut line);
    let (equal, sent, text) = equal(&line, &only_recording(&line));
    assert!(equal == sent && sent >= 3, "{text}");
}

#[test]
fn after_kills_of_roles_it_is_still_judged_again_with_the_same_verdicts() {
    let mut line = Line::new(Settings::live());
    line.record("always");
    let mut watcher = line.launch_recorded();
    for role in ["judge", "encode", "perceive", "judge"] {
        let before = watcher.verdicts.len();
        watcher.until("verdicts", |watcher| watcher.verdicts.len() >= before + 2);
        line.role(role).kill();
        start(&mut line, role, &mut watcher);
    }
    let before = watcher.verdicts.len();
    watcher.until("verdicts", |watcher| watcher.verdicts.len() >= before + 3);
    stop(&mut line);
    let (equal, sent, text) = equal(&line, &only_recording(&line));
    assert!(equal == sent && sent >= 11, "{text}");
}

#[test]
fn kills_between_commands_are_judged_again_with_the_same_verdicts() {
    let mut line = Line::with_second_job(Settings { writes: true, ..Settings::live() });
    line.record("always");
    let mut watcher = line.launch_recorded();
    let mut plc = Modbus::connect_when_up(line.port);
    for (round, role) in ["judge", "encode", "judge", "perceive"].into_iter().enumerate() {
        plc.enable();
        watcher.until("a piece", |watcher| watcher.phase() == Some(JudgePhase::Running));
        let before = watcher.verdicts.len();
        watcher.until("verdicts", |watcher| watcher.verdicts.len() >= before + 2);
        if round == 1 {
            plc.abort_and_load_job(2);
        }
        line.role(role).kill();
        start(&mut line, role, &mut watcher);
        // What the PLC wants still holds: it need not write it again. Then it wants something else.
        plc.control(control::ENABLE | control::RESET_ERROR).unwrap();
        plc.enable();
        let before = watcher.verdicts.len();
        watcher.until("verdicts after it", |watcher| watcher.verdicts.len() >= before + 2);
        plc.control(0).unwrap();
        watcher.until("nobody watches", |watcher| watcher.watches().is_some_and(|(_, watches)| !watches));
    }
    stop(&mut line);
    let (equal, sent, text) = equal(&line, &only_recording(&line));
    assert!(equal == sent && sent >= 16, "{text}");
}

/// A film takes as long as it lasts: each draw tries one of them, and `ANDON_EVERY=1` all.
#[test]
fn what_the_line_does_not_see_is_judged_again_with_the_same_verdicts() {
    for (shown, filter) in environment::one_in(UNSEEN.len() as u64, UNSEEN.to_vec()) {
        println!("{shown}");
        let ffmpeg = ["-i", "p1_none_r1.mp4", "-vf", filter, "-fps_mode", "passthrough"];
        let mut line = Line::with_film("speed = \"file\"", "", &ffmpeg);
        line.reconfigure("loop = true", "loop = false");
        line.record("always");
        let mut watcher = line.launch_recorded();
        line.start("capture");
        let sent = watcher.until_judged();
        let is_not_judged = watcher
            .verdicts
            .iter()
            .any(|verdict| verdict.outcome().is_ok_and(|outcome| outcome == VerdictOutcome::NotJudged));
        assert!(is_not_judged, "{:?}", watcher.verdicts);
        // It has ended with its film.
        line.roles.retain(|role| role.role != "capture");
        stop(&mut line);
        all_are_equal(&line, &only_recording(&line), usize::try_from(sent).unwrap());
    }
}

/// Asks a role to end, and waits for it.
fn end(line: &mut Line, role: &str) {
    line.role(role).signal(Signal::TERM);
    let status = line.role(role).wait();
    assert!(status.success(), "{role}: {status}");
}

/// Starts a role, and waits until it runs.
fn start(line: &mut Line, role: &'static str, watcher: &mut Watcher) -> u32 {
    line.start(role);
    let (pid, id) = (line.role(role).pid(), role_id(role));
    watcher.until(role, |watcher| watcher.runs(id, pid));
    pid
}

fn items(recording: &Path) -> Vec<Item> {
    let mut reader = RecordingReader::open(recording).unwrap();
    std::iter::from_fn(|| reader.next_item().unwrap()).collect()
}

/// The messages of a topic in a recording.
fn messages(recording: &Path, topic: Topic) -> Vec<Entry> {
    let entries = items(recording).into_iter().filter_map(|item| match item {
        Item::Entry(entry) => Some(entry),
        Item::Attachment(_) => None,
    });
    entries.filter(|entry| entry.topic == topic).collect()
}

/// What a recording says that its recorder did not get.
fn losses(recording: &Path) -> Vec<Losses> {
    let said = messages(recording, Topic::Losses).into_iter();
    said.map(|entry| serde_json::from_slice(&entry.data).unwrap()).collect()
}

#[test]
fn the_recorder_goes_on_in_its_file_while_every_other_role_is_stopped_and_started_again() {
    let mut line = Line::new(Settings::live());
    line.record("always");
    let mut watcher = line.launch_recorded();
    let recorder = line.role("record").pid();
    watcher.until("verdicts", |watcher| !watcher.verdicts.is_empty());
    let mut started = HashSet::new();
    for role in ROLES {
        end(&mut line, role);
        started.insert((role_id(role).code(), start(&mut line, role, &mut watcher)));
    }
    let before = watcher.verdicts.len();
    watcher.until("verdicts", |watcher| watcher.verdicts.len() >= before + 2);
    assert!(line.role("record").ended().is_none() && watcher.runs(RoleId::Record, recorder));
    stop(&mut line);
    let recording = only_recording(&line);
    let signs = messages(&recording, Topic::Raw(Channel::Health));
    let recorded: HashSet<_> = signs
        .iter()
        .filter_map(|entry| from_bytes::<Health>(&entry.data))
        .map(|health| (health.role, health.pid))
        .collect();
    assert!(started.is_subset(&recorded), "{started:?} {recorded:?}");
    let losses = losses(&recording);
    for channel in [Channel::Detections, Channel::Couple, Channel::Verdict] {
        let is_said = losses.iter().any(|said| said.channel == channel.name() && said.restarts == 1);
        assert!(is_said, "the restart of {}: {losses:?}", channel.name());
    }
}

#[test]
fn each_configuration_of_a_line_has_a_recording_of_its_own() {
    let mut line = Line::new(Settings::live());
    line.record("always");
    for key in ["", "before_s = 7\n"] {
        // A line that runs goes on with the configuration that it began with.
        line.reconfigure("[record]\n", &format!("[record]\n{key}"));
        let mut watcher = line.launch_recorded();
        watcher.until("verdicts", |watcher| !watcher.verdicts.is_empty());
        drop(watcher);
        stop(&mut line);
    }
    let before_s = |recording: &PathBuf| {
        let configuration = items(recording).into_iter().find_map(|item| match item {
            Item::Attachment(file) if file.name == "configuration.toml" => Some(file.data.to_vec()),
            _ => None,
        });
        let text = String::from_utf8(configuration.unwrap()).unwrap();
        text.lines().find_map(|row| row.strip_prefix("before_s = ").map(str::to_owned)).unwrap()
    };
    assert_eq!(line.recordings().iter().map(before_s).collect::<Vec<_>>(), ["10", "7"]);
}

/// How often the recorder is killed; `ANDON_KILLS=1000` is the long form.
const KILLS: u64 = 5;

#[test]
fn a_recorder_that_is_killed_at_any_moment_leaves_files_that_are_completed_and_the_line_loses_nothing() {
    let mut line = Line::new(Settings::live());
    line.record("always");
    let mut watcher = line.launch_recorded();
    let mut draw = oorandom::Rand64::new(environment::seed().into());
    let kills = environment::number("ANDON_KILLS", KILLS);
    let mut journalled = Vec::new();
    for _ in 0..kills {
        let until = Instant::now() + Duration::from_millis(draw.rand_range(0..4000));
        while Instant::now() < until {
            watcher.listen(Duration::from_millis(20));
        }
        line.role("record").kill();
        start(&mut line, "record", &mut watcher);
        journalled.extend(watcher.verdict_keys());
        watcher.forget_all_but_newest();
    }
    let before = watcher.verdicts.len();
    watcher.until("verdicts", |watcher| watcher.verdicts.len() >= before + 2);
    journalled.extend(watcher.verdict_keys());
    journalled.sort_unstable();
    journalled.dedup();
    stop(&mut line);
    let missing = line.journal().unexplained(&journalled);
    assert!(missing.is_empty(), "{missing:?}");
    let found = line.recordings();
    let detections: usize = found.iter().map(|recording| detections_in(recording).unwrap()).sum();
    assert!(detections > 0 && !found.is_empty());
}

#[test]
fn a_recorder_that_is_killed_or_stopped_is_no_fault_of_the_line_to_the_plc() {
    let mut line = Line::new(Settings { writes: true, ..Settings::live() });
    line.record("always");
    let _watcher = line.launch_recorded();
    let mut plc = Modbus::connect_when_up(line.port);
    plc.enable();
    plc.wait_for(status::READY);
    for signal in [Signal::KILL, Signal::TERM] {
        line.role("record").signal(signal);
        line.role("record").wait();
        // The end of a writer is heard within a fraction of this. On a busy machine the line may be unready for other reasons.
        std::thread::sleep(Duration::from_secs(2));
        let log = line.log("plc");
        assert!(!log.contains("a process of the line has gone"), "{log}");
        line.start("record");
        plc.control(control::ENABLE | control::RESET_ERROR).unwrap();
        plc.enable();
        plc.wait_for(status::READY);
    }
}

/// Every file under a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

#[test]
fn with_record_off_no_picture_is_stored_and_the_role_is_healthy() {
    // As fast as it can be looked at: a fault is one however busy the machine is.
    let mut line = Line::with_film("speed = \"max\"", "", &["-i", "p1_order_r1.mp4"]);
    line.record("off");
    let mut watcher = line.launch_recorded();
    line.wait_for_log("record", "AND-416", "");
    line.start("capture");
    // With a recorder this is what a clip with a picture is made of.
    watcher.until("a fault", |watcher| {
        watcher.verdicts.iter().any(|verdict| verdict.outcome == VerdictOutcome::Anomaly.code())
    });
    assert!(watcher.is(RoleId::Record, RoleState::Running));
    watcher.listen(Duration::from_secs(4));
    let is_stored = |path: &PathBuf| {
        let ending = path.extension().unwrap_or_default();
        ["mcap", "jpg", "jpeg", "png"].iter().any(|kept| ending == *kept)
    };
    let stored: Vec<PathBuf> = files(&line.path("")).into_iter().filter(is_stored).collect();
    assert!(stored.is_empty() && !line.path("recordings").exists(), "{stored:?}");
}

#[test]
fn a_clip_is_made_of_an_anomaly_and_of_nothing_else() {
    // At full speed no frame is left out, so that nothing is unjudged on a busy machine.
    let mut line = Line::new(Settings { flaw: Flaw::WrongOrder, ..Settings::default() });
    line.record("fault");
    let mut watcher = line.launch_recorded();
    watcher.until_judged();
    line.wait_for_log("record", "AND-410", "");
    stop(&mut line);
    let found = store::recordings(&line.path("recordings")).unwrap();
    let verdicts: Vec<_> = found.iter().flat_map(|recording| &recording.index.verdicts).collect();
    assert!(verdicts.iter().any(|verdict| verdict.outcome == VerdictOutcome::Anomaly.code()));

    let mut line = Line::new(Settings::default());
    line.record("fault");
    let mut watcher = line.launch_recorded();
    watcher.until_judged();
    stop(&mut line);
    assert!(line.recordings().is_empty(), "{}", line.log("record"));
}

#[test]
fn a_folder_that_cannot_be_written_costs_recordings_and_no_verdicts_and_is_said() {
    let mut line = Line::new(Settings::live());
    line.record("always");
    std::fs::write(line.path("recordings"), "no folder").unwrap();
    let mut watcher = line.launch_recorded();
    line.wait_for_log("record", "AND-412", "");
    watcher.until("the recorder's fault", |watcher| watcher.is(RoleId::Record, RoleState::Fault));
    watcher.until("verdicts all the same", |watcher| watcher.verdicts.len() >= 2);
    // As soon as it can be written, it is.
    std::fs::remove_file(line.path("recordings")).unwrap();
    let until = Instant::now() + PATIENCE;
    while line.recordings().is_empty() {
        assert!(Instant::now() < until, "{}", line.log("record"));
        watcher.listen(Duration::from_millis(100));
    }
    watcher.until("the recorder", |watcher| watcher.is(RoleId::Record, RoleState::Running));
    stop(&mut line);
    assert_eq!(logged(&line, "AND-412"), 1, "{}", line.log("record"));
}

/// How often the recorder has logged this code.
fn logged(line: &Line, code: &str) -> usize {
    line.log("record").lines().filter(|row| row.contains(code)).count()
}

/// Runs a command with a disk of its own at a folder. The disk is full for as long as there is a file `full` beside the folder.
const WITH_OWN_DISK: &str = r#"
disk=$1; shift
mount -t tmpfs -o size=80m none "$disk" || exit 99
lives() { kill -0 $$ 2>/dev/null; }
(
    until [ -e "$disk/../full" ] || ! lives; do sleep 0.1; done
    cat /dev/zero > "$disk/filler" 2>/dev/null
    while [ -e "$disk/../full" ] && lives; do sleep 0.1; done
    rm "$disk/filler"
) &
exec "$@"
"#;

/// A recorder on a disk of its own. It is killed when this is dropped.
struct OnOwnDisk(Child);

impl OnOwnDisk {
    fn start(line: &Line) -> Self {
        std::fs::create_dir(line.path("recordings")).unwrap();
        let started = Command::new("unshare")
            .args(["--mount", "--map-root-user", "sh", "-c", WITH_OWN_DISK, "sh"])
            .arg(line.path("recordings"))
            .arg(andond())
            .args(["run", "record", "--config"])
            .arg(line.config())
            .env_remove("JOURNAL_STREAM")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(File::create(line.path("record.log")).unwrap())
            .spawn();
        Self(started.unwrap())
    }
}

impl Drop for OnOwnDisk {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn a_disk_that_fills_up_costs_recordings_and_no_verdicts_and_is_written_again_once_it_has_room() {
    let mut line = Line::new(Settings::live());
    line.record("always");
    line.start("steward");
    let mut watcher = Watcher::join(&line.station);
    let _recorder = OnOwnDisk::start(&line);
    line.start_all_but(&["steward"]);
    line.wait_for_log("record", "AND-410", "");
    watcher.until("the recorder", |watcher| watcher.is(RoleId::Record, RoleState::Running));
    std::fs::write(line.path("full"), "").unwrap();
    line.wait_for_log("record", "AND-412", "Make room on the disk");
    watcher.until("the recorder's fault", |watcher| watcher.is(RoleId::Record, RoleState::Fault));
    let (before, begun) = (watcher.verdicts.len(), logged(&line, "AND-410"));
    watcher.until("verdicts all the same", |watcher| watcher.verdicts.len() >= before + 2);
    std::fs::remove_file(line.path("full")).unwrap();
    watcher.until("the recorder", |watcher| watcher.is(RoleId::Record, RoleState::Running));
    watcher.until("another recording", |_| logged(&line, "AND-410") > begun);
    assert_eq!(logged(&line, "AND-412"), 1, "{}", line.log("record"));
    assert!(line.stop_all_but_steward().is_empty());
}

/// A library with which a disk does nothing: while there is a file at `SHIM_STANDS`, whatever is written to a recording waits.
const STANDING_DISK: &str = r#"
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
ssize_t write(int file, const void *bytes, size_t count) {
    static ssize_t (*real)(int, const void *, size_t);
    if (!real) *(void **)&real = dlsym(RTLD_NEXT, "write");
    const char *stands = getenv("SHIM_STANDS");
    char link[64], path[4096] = "";
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    if (stands && readlink(link, path, sizeof path - 1) > 0 && strstr(path, ".mcap"))
        while (access(stands, F_OK) == 0) usleep(1000);
    return real(file, bytes, count);
}
"#;

#[test]
fn a_disk_that_does_nothing_for_a_while_costs_recordings_and_no_verdicts_and_that_is_said() {
    // At full speed the memory for what waits is full within seconds.
    let mut line = Line::new(Settings { repeat: true, ..Settings::default() });
    line.record("always");
    line.reconfigure("[record]\n", "[record]\nmemory_mb = 4\n");
    line.environment = vec![
        ("LD_PRELOAD", shim::compiled(&line.path(""), STANDING_DISK)),
        ("SHIM_STANDS", line.path("stands").into_os_string()),
    ];
    let mut watcher = line.launch_recorded();
    line.wait_for_log("record", "AND-410", "");
    std::fs::write(line.path("stands"), "").unwrap();
    line.wait_for_log("record", "AND-413", "");
    let before = watcher.verdicts.len();
    watcher.until("verdicts all the same", |watcher| watcher.verdicts.len() >= before + 20);
    assert!(watcher.is(RoleId::Record, RoleState::Running));
    std::fs::remove_file(line.path("stands")).unwrap();
    watcher.listen(Duration::from_secs(2));
    stop(&mut line);
    let lost = |recording: &PathBuf| -> u64 {
        let of_disk = losses(recording).into_iter().filter(|losses| losses.channel == "recording");
        of_disk.map(|losses| losses.lost).sum()
    };
    assert!(line.recordings().iter().map(lost).sum::<u64>() > 0, "{}", line.log("record"));
    for recording in line.recordings() {
        assert!(detections_in(&recording).unwrap() > 0);
    }
}
