//! The role that runs what an engineer orders. The test orders in the place of the board.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::{Node, Reader, Writer};
use andon_learn::digest::sha256_hex;
use andon_learn::job_file::JobFile;
use andon_tests::line::{Line, PATIENCE, Settings, Watcher, save_runs, stand_in};
use rustix::process::{Pid, Signal, kill_process};
use shm_schemas::{
    FilmPiece, PIECE_BYTES, Printed, PrintedState, RoleId, Showing, TASK_LATE_NS, Task, TaskKind, task_flag,
};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A station without a job, with recordings to teach from.
fn station() -> Line {
    let line = Line::new(Settings::live());
    line.reconfigure("job = \"job.toml\"\n", "jobs = \"jobs\"\n");
    line.board("enable = true\n\n[executor]\nenable = true\npath = \"made\"\n");
    fs::create_dir_all(line.path("made/films")).unwrap();
    save_runs(&line.path("made/films"));
    line
}

/// The place of the board.
struct Board {
    node: Node,
    tasks: Writer<Task>,
    printed: Reader<Printed>,
    ordered: u64,
}

impl Board {
    fn new(line: &Line) -> Self {
        let node = stand_in(line, RoleId::Board);
        let (mut tasks, printed) = (node.writer::<Task>().unwrap(), node.reader().unwrap());
        tasks.follow(&[RoleId::Executor]);
        Self { node, tasks, printed, ordered: 0 }
    }

    fn order(&mut self, kind: TaskKind, name: &str, text: &str) -> u64 {
        self.order_with(kind, name, text, 0, 0)
    }

    fn order_with(&mut self, kind: TaskKind, name: &str, text: &str, flags: u8, showing: u8) -> u64 {
        self.node.wait_for_room(&mut self.tasks, PATIENCE).unwrap();
        self.ordered += 1;
        let mut task = self.tasks.loan().unwrap();
        (task.number, task.kind, task.flags, task.showing) = (self.ordered, kind.code(), flags, showing);
        assert!(task.say("eva", name, text));
        self.tasks.send(task).unwrap();
        self.ordered
    }

    /// The next message about a task.
    fn hears(&mut self, task: u64) -> (PrintedState, Option<Showing>, String) {
        let until = Instant::now() + PATIENCE;
        loop {
            while let Some(printed) = self.printed.take().unwrap() {
                if printed.task == task {
                    let state = PrintedState::try_from(printed.state).unwrap();
                    let showing = Showing::try_from(printed.showing).ok();
                    return (state, showing, printed.text().to_owned());
                }
            }
            assert!(Instant::now() < until, "nothing is said of task {task}");
            self.node.wait(&mut [&mut self.tasks, &mut self.printed], Duration::from_millis(50)).unwrap();
        }
    }

    /// What a task has printed until its end, and how it has ended.
    fn ends(&mut self, task: u64) -> (PrintedState, String) {
        let mut said = String::new();
        loop {
            let (state, _, line) = self.hears(task);
            said += &format!("{line}\n");
            if !matches!(state, PrintedState::Begun | PrintedState::Line) {
                return (state, said);
            }
        }
    }

    /// Waits until a task says this.
    fn until(&mut self, task: u64, text: &str) {
        loop {
            let (state, _, line) = self.hears(task);
            if line.contains(text) {
                return;
            }
            assert!(matches!(state, PrintedState::Begun | PrintedState::Line), "{state:?}: {line}");
        }
    }
}

/// Who has done what, as the journal has it, once it says this.
fn audit(line: &Line, wanted: &str) -> String {
    let until = Instant::now() + PATIENCE;
    loop {
        let output = line.command("history", &["--audit", "--csv"]);
        let kept = String::from_utf8(output.stdout).unwrap();
        if kept.contains(wanted) {
            return kept;
        }
        assert!(Instant::now() < until, "{wanted} is not in {kept}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// The processes that run this command on a station.
fn running(line: &Line, command: &str) -> Vec<i32> {
    let config = line.config().display().to_string();
    let pids = fs::read_dir("/proc").unwrap().flatten();
    let pids = pids.filter_map(|entry| entry.file_name().to_str()?.parse::<i32>().ok());
    let is_ours = |pid: &i32| {
        let words = fs::read_to_string(format!("/proc/{pid}/cmdline")).unwrap_or_default();
        let words: Vec<&str> = words.split('\0').collect();
        words.get(1) == Some(&command) && words.contains(&config.as_str())
    };
    pids.filter(is_ours).collect()
}

/// Starts the role, and waits until it hears: what is ordered before that is done by nobody.
fn start_again(line: &mut Line, watcher: &mut Watcher) {
    let pid = line.start("executor").pid();
    watcher.until("the executor", |watcher| watcher.runs(RoleId::Executor, pid));
}

/// A station whose executor is ready, who watches it, and who orders.
fn at_work() -> (Line, Watcher, Board) {
    let mut line = station();
    let watcher = line.launch();
    line.start("executor");
    line.wait_for_log("executor", "AND-629", "");
    let board = Board::new(&line);
    (line, watcher, board)
}

/// Keeps a version of a job that is not there: where that job belongs, the version and its hash.
fn with_a_version(line: &Line) -> (PathBuf, JobFile, String) {
    let version = job(&line.path("job.toml"));
    let hash = format!("{:016x}", version.model_hash());
    fs::write(line.path(&format!("made/versions/polish.{hash}.toml")), version.to_toml()).unwrap();
    (line.path("jobs/polish.toml"), version, hash)
}

fn job(path: &Path) -> JobFile {
    JobFile::parse("job.toml", &fs::read(path).unwrap()).unwrap()
}

const FILMS: &str =
    "p1_r1.tracks.jsonl\np2_r1.tracks.jsonl\np3_r1.tracks.jsonl\np4_r1.tracks.jsonl\np9_r2.tracks.jsonl";

#[test]
fn a_job_is_taught_named_loaded_taught_again_and_rolled_back_by_orders_and_the_journal_has_who_ordered_it() {
    let (line, mut watcher, mut board) = at_work();
    let path = line.path("jobs/polish.toml");

    let teach = board.order(TaskKind::TeachFilms, "polish", FILMS);
    let (state, said) = board.ends(teach);
    assert!(state == PrintedState::Done && said.contains("written: "), "{said}");
    assert!(fs::read_to_string(line.path("made/reports/polish.html")).unwrap().contains("Job "));
    let first = job(&path);
    assert_eq!(first.provenance.sources.len(), 5);
    let report = |of: &JobFile| {
        fs::read(line.path(&format!("made/reports/polish.{:016x}.html", of.model_hash()))).unwrap()
    };
    let first_report = report(&first);
    assert_eq!(first_report, fs::read(line.path("made/reports/polish.html")).unwrap());

    let name = board.order(TaskKind::Name, "polish", "Polish the brick\nMeasure $(it)");
    assert_eq!(board.ends(name).0, PrintedState::Done);
    assert_eq!(job(&path).step_names, ["Polish the brick", "Measure $(it)"]);
    assert_eq!(job(&path).model_hash(), first.model_hash());
    let name = board.order(TaskKind::Name, "polish", "one name for two steps");
    let (state, said) = board.ends(name);
    assert!(state == PrintedState::Failed && said.contains("names.steps"), "{said}");

    let load = board.order(TaskKind::Load, "polish", "");
    let (state, said) = board.ends(load);
    assert!(state == PrintedState::Done && said.contains("is in force"), "{said}");
    watcher.until("the job", |watcher| {
        watcher.judging.is_some_and(|judging| judging.model_hash == first.model_hash())
    });
    watcher.until("a right piece", |watcher| {
        watcher.verdicts.iter().any(|verdict| (verdict.level, verdict.outcome) == (3, 1))
    });

    let add = board.order_with(TaskKind::TeachFilms, "polish", "p9_r3.tracks.jsonl", task_flag::ADD, 0);
    // The others lie beside neither the job nor the role.
    let (state, said) = board.ends(add);
    assert_eq!(state, PrintedState::Done, "{said}");
    let second = job(&path);
    assert_ne!(second.model_hash(), first.model_hash());
    assert_ne!(report(&second), first_report);
    assert_eq!(report(&first), first_report, "each version has its own");
    assert_eq!(second.step_names, ["Polish the brick", "Measure $(it)"]);
    let back = board.order(TaskKind::RollBack, "polish", &format!("{:016x}", first.model_hash()));
    let (state, said) = board.ends(back);
    assert_eq!(state, PrintedState::Done, "{said}");
    assert_eq!(job(&path).model_hash(), first.model_hash());
    assert!(line.path(&format!("made/versions/polish.{:016x}.toml", second.model_hash())).is_file());

    let kept = audit(&line, "roll-back polish");
    for what in ["teach-films polish", "name polish", "load polish: begun", "load polish: done"] {
        assert!(kept.lines().any(|row| row.contains("login eva") && row.contains(what)), "{what}: {kept}");
    }
    line.wait_for_log("executor", "AND-631", "");
    line.wait_for_log("executor", "AND-632", "");
}

#[test]
fn a_station_whose_file_names_no_job_begins_with_the_one_that_an_engineer_loaded_last() {
    let (mut line, watcher, mut board) = at_work();
    let path = line.path("jobs/polish.toml");
    fs::copy(line.path("job.toml"), &path).unwrap();
    let load = board.order(TaskKind::Load, "polish", "");
    let (state, said) = board.ends(load);
    assert!(state == PrintedState::Done && said.contains("begins with it when it starts again"), "{said}");
    // The whole station ends, as when its machine is switched off for the night.
    drop((board, watcher));
    let executor = line.role("executor");
    executor.signal(Signal::TERM);
    assert!(executor.wait().success());
    assert_eq!(line.stop(), [""; 0]);
    let (mut watcher, hash) = (line.launch(), job(&path).model_hash());
    watcher.until("the job", |watcher| watcher.judging.is_some_and(|judging| judging.model_hash == hash));
    assert!(audit(&line, "last order of an engineer").contains("loaded"));
}

#[test]
fn one_task_runs_at_a_time_is_answered_and_stopped_with_all_that_it_has_started() {
    let (line, _watcher, mut board) = at_work();
    let teach = board.order_with(TaskKind::TeachLive, "shown", "3", task_flag::FORCE, 0);
    let (mut showing, mut said) = (None, String::new());
    while showing != Some(Showing::Run) {
        let (_, now, line) = board.hears(teach);
        said += &format!("{line}\n");
        showing = now;
    }
    assert!(said.contains("looking through the running station line"), "{said}");
    let second = board.order(TaskKind::Markers, "", "");
    let (state, why) = board.ends(second);
    assert!(state == PrintedState::Refused && why.contains("another task is running"), "{why}");
    line.wait_for_log("executor", "AND-633", "");
    // An answer to what is not asked, and one that is none.
    for (text, showing) in [("k", Showing::Keep), ("rm -rf", Showing::Run)] {
        let answer = board.order_with(TaskKind::Answer, "", text, 0, showing.code());
        assert_eq!(board.ends(answer).0, PrintedState::Refused, "{text}");
    }
    let again = board.order_with(TaskKind::Answer, "", "d", 0, Showing::Run.code());
    assert_eq!(board.ends(again).0, PrintedState::Done);
    board.until(teach, "run 1 of 3");
    assert_eq!(running(&line, "teach").len(), 1);
    let stop = board.order(TaskKind::Stop, "", "");
    assert_eq!(board.ends(stop).0, PrintedState::Done);
    assert_eq!(board.ends(teach).0, PrintedState::Stopped);
    assert_eq!(running(&line, "teach"), [0; 0]);
    let stop = board.order(TaskKind::Stop, "", "");
    let (state, why) = board.ends(stop);
    assert!(state == PrintedState::Refused && why.contains("nothing is running"), "{why}");
    assert!(!line.path("jobs/shown.toml").exists());
    let kept = audit(&line, "teach-live shown: stopped (in spite of doubts, 3)");
    assert!(kept.contains("markers: refused") && kept.contains("answer: taken (d)"), "{kept}");
}

#[test]
fn what_leads_out_of_its_folders_is_refused_and_said_to_be_so() {
    let (line, _watcher, mut board) = at_work();
    for (kind, name, text) in [
        (TaskKind::TeachFilms, "../outside", FILMS),
        (TaskKind::TeachFilms, "polish", "../../work.tracks.jsonl"),
        (TaskKind::TeachFilms, "polish", "/etc/passwd"),
        (TaskKind::TeachLive, "-rf", "3"),
        (TaskKind::TeachLive, "a; touch /tmp/harm", "3"),
        (TaskKind::Load, "../job", ""),
        (TaskKind::RollBack, "polish", "../../../job"),
        (TaskKind::Calibrate, "", "0.04\n--out=/tmp/harm"),
    ] {
        let task = board.order(kind, name, text);
        assert_eq!(board.ends(task).0, PrintedState::Refused, "{kind:?} {name} {text}");
    }
    assert_eq!(fs::read_dir(line.path("jobs")).unwrap().count(), 0);
}

#[test]
fn a_role_that_is_stopped_ends_its_task_and_one_that_starts_again_does_only_what_is_ordered_then() {
    let (mut line, mut watcher, mut board) = at_work();
    let teach = board.order(TaskKind::TeachLive, "shown", "3");
    board.until(teach, "run 1 of 3");
    line.role("executor").signal(Signal::TERM);
    assert!(line.role("executor").wait().success());
    assert_eq!(board.ends(teach).0, PrintedState::Stopped);
    assert_eq!(running(&line, "teach"), [0; 0]);

    start_again(&mut line, &mut watcher);
    let shown = board.order(TaskKind::TeachLive, "shown", "3");
    board.until(shown, "run 1 of 3");
    line.role("executor").kill();
    // Its unit ends what it has started.
    for pid in running(&line, "teach") {
        let _ = kill_process(Pid::from_raw(pid).unwrap(), Signal::KILL);
    }
    start_again(&mut line, &mut watcher);
    let films = board.order(TaskKind::TeachFilms, "polish", FILMS);
    assert_eq!(board.ends(films).0, PrintedState::Done);
    assert!(!line.path("jobs/shown.toml").exists());
}

#[test]
fn a_damaged_job_is_put_back_or_taught_anew_and_a_version_that_cannot_be_loaded_leaves_the_file_as_it_was() {
    let (mut line, _watcher, mut board) = at_work();
    let (path, taught) = (line.path("jobs/polish.toml"), job(&line.path("job.toml")));
    let hash = format!("{:016x}", taught.model_hash());
    fs::write(line.path(&format!("made/versions/polish.{hash}.toml")), taught.to_toml()).unwrap();
    fs::write(&path, "no job").unwrap();
    let back = board.order(TaskKind::RollBack, "polish", &hash);
    let (state, said) = board.ends(back);
    assert_eq!((state, job(&path).model_hash()), (PrintedState::Done, taught.model_hash()), "{said}");

    fs::write(&path, "no job").unwrap();
    let again = board.order_with(TaskKind::TeachFilms, "polish", FILMS, task_flag::FORCE, 0);
    let (state, said) = board.ends(again);
    assert_eq!(state, PrintedState::Done, "{said}");
    let other = job(&path);
    assert_eq!(other.provenance.sources.len(), 5);
    assert_ne!(other.model_hash(), taught.model_hash());
    let versions = fs::read_dir(line.path("made/versions")).unwrap().flatten();
    let mut kept = versions.map(|entry| fs::read_to_string(entry.path()).unwrap());
    assert!(kept.any(|text| text == "no job"));

    // Nobody loads it.
    line.role("judge").kill();
    let back = board.order(TaskKind::RollBack, "polish", &hash);
    let (state, said) = board.ends(back);
    assert_eq!((state, job(&path).model_hash()), (PrintedState::Failed, other.model_hash()), "{said}");
}

/// Kills the role in the middle of putting a version back, as a loss of power would, and what it has started.
fn kill_while_it_puts_back(line: &mut Line, board: &mut Board, hash: &str) {
    let back = board.order(TaskKind::RollBack, "polish", hash);
    assert_eq!(board.hears(back).0, PrintedState::Begun);
    line.role("executor").kill();
    for pid in running(line, "use") {
        let _ = kill_process(Pid::from_raw(pid).unwrap(), Signal::KILL);
    }
    assert_eq!(format!("{:016x}", job(&line.path("jobs/polish.toml")).model_hash()), hash);
}

#[test]
fn what_a_killed_role_has_changed_for_its_task_is_put_back_at_its_next_start_unless_somebody_has_written_there()
 {
    let (mut line, mut watcher, mut board) = at_work();
    let (path, _version, hash) = with_a_version(&line);
    // Nobody loads it, and the task waits.
    line.role("judge").kill();
    fs::write(&path, "as it was").unwrap();
    kill_while_it_puts_back(&mut line, &mut board, &hash);
    start_again(&mut line, &mut watcher);
    line.wait_for_log("executor", "AND-632", "broken off");
    audit(&line, "broken off with its role: put back");
    assert_eq!(fs::read_to_string(&path).unwrap(), "as it was");

    kill_while_it_puts_back(&mut line, &mut board, &hash);
    fs::write(&path, "by somebody else").unwrap();
    start_again(&mut line, &mut watcher);
    assert_eq!(fs::read_to_string(&path).unwrap(), "by somebody else");
    assert!(!line.path("made/unfinished.json").exists());
}

#[test]
fn a_job_that_the_line_has_loaded_stays_although_the_role_is_killed_before_it_hears_of_it() {
    let (mut line, mut watcher, mut board) = at_work();
    let (path, version, hash) = with_a_version(&line);
    fs::write(&path, "as it was").unwrap();
    // The job cannot be loaded before the role hears nothing any more.
    line.role("judge").signal(Signal::STOP);
    let back = board.order(TaskKind::RollBack, "polish", &hash);
    assert_eq!(board.hears(back).0, PrintedState::Begun);
    let until = Instant::now() + PATIENCE;
    while running(&line, "use").is_empty() {
        assert!(Instant::now() < until, "the command does not begin");
        std::thread::sleep(Duration::from_millis(20));
    }
    line.role("executor").signal(Signal::STOP);
    line.role("judge").signal(Signal::CONT);
    watcher.until("the job", |watcher| {
        watcher.judging.is_some_and(|judging| judging.model_hash == version.model_hash())
    });
    let until = Instant::now() + PATIENCE;
    while !running(&line, "use").is_empty() {
        assert!(Instant::now() < until, "the command does not end");
        std::thread::sleep(Duration::from_millis(20));
    }
    line.role("executor").kill();
    start_again(&mut line, &mut watcher);
    assert_eq!(fs::read_to_string(&path).unwrap(), version.to_toml());
}

#[test]
fn a_recording_that_is_sent_has_its_name_once_it_is_whole_and_the_journal_has_who_sent_it_and_its_hash() {
    let (mut line, mut watcher, mut board) = at_work();
    let mut pieces = board.node.writer::<FilmPiece>().unwrap();
    pieces.follow(&[RoleId::Executor]);
    let mut send = |board: &mut Board, name: &str, [film, at, size]: [u64; 3], bytes: &[u8]| {
        board.node.wait_for_room(&mut pieces, PATIENCE).unwrap();
        board.ordered += 1;
        let mut piece = pieces.loan().unwrap();
        (piece.task, piece.film, piece.at, piece.size) = (board.ordered, film, at, size);
        assert!(piece.say("eva", name) && piece.carry(bytes));
        pieces.send(piece).unwrap();
        board.ends(board.ordered)
    };
    let folder = line.path("made/films");
    let films = || {
        let entries = fs::read_dir(&folder).unwrap().flatten();
        let mut names: Vec<_> = entries.map(|entry| entry.file_name().into_string().unwrap()).collect();
        names.retain(|name| !name.ends_with(".tracks.jsonl"));
        names.sort();
        names
    };
    let film: Vec<u8> = (0..100_000_u32).map(|byte| (byte / 3) as u8).collect();
    let size = film.len() as u64;
    for (number, piece) in (0..).zip(film.chunks(PIECE_BYTES)) {
        assert!(!films().contains(&"run1.mp4".to_owned()));
        let (state, why) = send(&mut board, "run1.mp4", [7, number * PIECE_BYTES as u64, size], piece);
        assert_eq!(state, PrintedState::Done, "{why}");
    }
    assert_eq!(fs::read(line.path("made/films/run1.mp4")).unwrap(), film);
    let row = format!("film run1.mp4: done, {size} bytes with the SHA-256 {}", sha256_hex(&film));
    assert!(audit(&line, &row).lines().any(|kept| kept.contains("login eva") && kept.contains(&row)));

    for (name, [film, at, size], why) in [
        ("../jobs/polish.toml", [8, 0, 9], "a recording has a name"),
        ("run1.mp4", [8, 0, 9], "there is a recording run1.mp4 already"),
        ("run2.mp4", [8, 0, u64::MAX], "512 MB at most"),
        ("run2.mp4", [8, 9, 18], "not being sent any more"),
        ("run2.mp4", [8, 0, 3], "longer than was said"),
    ] {
        let (state, said) = send(&mut board, name, [film, at, size], b"recording");
        assert!(state == PrintedState::Refused && said.contains(why), "{said}");
    }
    assert_eq!(films(), ["run1.mp4"]);
    audit(&line, "film ../jobs/polish.toml: refused, because a recording has a name");

    // One at a time; and what is broken off, or was being sent when the role was killed, leaves nothing behind.
    assert_eq!(send(&mut board, "run2.mp4", [9, 0, 18], b"recording").0, PrintedState::Done);
    let (state, why) = send(&mut board, "run3.mp4", [10, 0, 18], b"recording");
    assert!(state == PrintedState::Refused && why.contains("eva is just sending run2.mp4"), "{why}");
    assert_eq!(send(&mut board, "run2.mp4", [9, 0, 0], b"").0, PrintedState::Stopped);
    audit(&line, "film run2.mp4: stopped");
    assert_eq!(films(), ["run1.mp4"]);
    assert_eq!(send(&mut board, "run2.mp4", [11, 0, 18], b"recording").0, PrintedState::Done);
    assert_eq!(films().len(), 2);
    line.role("executor").kill();
    start_again(&mut line, &mut watcher);
    assert_eq!(films(), ["run1.mp4"]);
}

#[test]
fn an_order_that_comes_after_the_page_has_said_that_nobody_does_it_is_not_done() {
    let (mut line, _watcher, mut board) = at_work();
    // It hears.
    let back = board.order(TaskKind::RollBack, "polish", "none");
    assert_eq!(board.ends(back).0, PrintedState::Refused);
    line.role("executor").signal(Signal::STOP);
    board.order(TaskKind::Markers, "", "");
    std::thread::sleep(Duration::from_nanos(TASK_LATE_NS) + Duration::from_millis(100));
    line.role("executor").signal(Signal::CONT);
    audit(&line, "markers: refused, because it came too late");
    // It answers what comes in time.
    let back = board.order(TaskKind::RollBack, "polish", "none");
    assert_eq!(board.ends(back).0, PrintedState::Refused);
    assert_eq!(fs::read_dir(line.path("made/markers")).unwrap().count(), 0);
}

#[test]
fn folders_that_cannot_be_written_are_named_with_what_helps() {
    let mut line = station();
    line.reconfigure("jobs = \"jobs\"", "jobs = \"/proc/jobs\"");
    line.start("steward");
    line.start("executor");
    line.wait_for_log("executor", "AND-630", "Set station.jobs");
}
