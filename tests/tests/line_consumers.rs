//! Consumers of the journal beside the PLC. The example, [`Copier`], is all that a new one has to write by itself.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_host::config::Config;
use andon_host::role::{Consumer, Cycle, CycleError, Role, Turn, run_with};
use andon_ipc::{Node, Port, UtcTime};
use andon_tests::line::{Line, Modbus, PATIENCE, Sender, Settings, status};
use andon_tests::python::all_output;
use rustix::process::Signal;
use shm_schemas::{RoleId, Verdict, VerdictLevel, VerdictOutcome};
use std::fs::{self, File, OpenOptions};
use std::io::Write as _;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Names the configuration in the process that is the consumer.
const INSIDE: &str = "ANDON_TEST_CONSUMER";
/// How many rows it acknowledges; after them it takes no more.
const LIMIT: &str = "ANDON_TEST_LIMIT";

/// The example: copies every row into a file, and acknowledges what is in it.
struct Copier {
    journal: Consumer,
    copy: File,
    left: u32,
}

fn copy(node: &Node, copy: File, limit: u32) -> Result<(), CycleError> {
    let mut cycle = Cycle::new(node)?;
    let mut role = Copier { journal: Consumer::open(&cycle)?, copy, left: limit };
    cycle.run(&mut role)
}

impl Role for Copier {
    type Error = CycleError;
    const INPUT_IS_STEADY: bool = false;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        self.journal.ports().into()
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, CycleError> {
        if self.left == 0 {
            return Ok(Turn::Idle);
        }
        let Some(row) = self.journal.take(cycle)? else { return Ok(Turn::Idle) };
        writeln!(self.copy, "{} {} {}", row.row, row.missing, row.verdict.stamp.seq).unwrap();
        self.journal.acknowledge(row.row);
        self.left -= 1;
        Ok(Turn::Stepped)
    }
}

/// In the process that is the consumer: runs it and does not return. Elsewhere it does nothing.
fn run_copier() {
    let Some(path) = std::env::var_os(INSIDE) else { return };
    let config = Config::load(&[&path]).unwrap();
    let file = fs::canonicalize(path).unwrap().with_file_name("copy");
    let file = OpenOptions::new().create(true).append(true).open(file).unwrap();
    let limit = std::env::var(LIMIT).unwrap().parse().unwrap();
    let code = run_with(&config, RoleId::Tool, |node| copy(node, file, limit));
    std::process::exit(code as i32);
}

/// The consumer as a process, which runs the current test once more.
struct Process(Child);

impl Process {
    fn start(line: &Line, limit: u32) -> Self {
        let child = Command::new(std::env::current_exe().unwrap())
            .args([std::thread::current().name().unwrap(), "--exact", "--nocapture"])
            .env(INSIDE, line.config())
            .env(LIMIT, limit.to_string())
            .stdout(Stdio::null())
            .spawn();
        Self(child.unwrap())
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// What the consumer has copied: rows, how many were missing before each, and the numbers of the verdicts.
fn copied(line: &Line) -> Vec<[u64; 3]> {
    let text = fs::read_to_string(line.path("copy")).unwrap_or_default();
    // The line that is being written is not counted.
    let lines = text.rsplit_once('\n').map_or("", |(whole, _)| whole).lines();
    lines
        .map(|line| {
            let words: Vec<u64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
            words.try_into().unwrap()
        })
        .collect()
}

fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let until = Instant::now() + PATIENCE;
    while !holds() {
        assert!(Instant::now() < until, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn job_done(verdict: &mut Verdict) {
    verdict.level = VerdictLevel::Job.code();
    verdict.outcome = VerdictOutcome::Ok.code();
    verdict.decided_utc_ns = UtcTime::now().nanoseconds();
}

/// A PLC takes the results with these numbers, one after the other.
fn acknowledge(plc: &mut Modbus, numbers: impl IntoIterator<Item = u32>) {
    for number in numbers {
        plc.wait_for(status::DONE);
        assert_eq!(plc.sequence(), number);
        plc.acknowledge();
    }
}

/// A line with a judge that is a stand-in, a PLC that has its account, and a consumer that is known to the journal.
fn line_with_consumer(limit: u32) -> (Line, Sender<Verdict>, Modbus, Process) {
    let mut line = Line::new(Settings { writes: true, ..Settings::default() });
    line.reconfigure("[journal]\n", "[journal]\nkeep_mb = 10\n");
    ["steward", "journal", "plc"].into_iter().for_each(|role| {
        line.start(role);
    });
    let judge = Sender::<Verdict>::new(&line, RoleId::Judge, &[RoleId::Journal]);
    let mut plc = Modbus::connect_when_up(line.port);
    until("the start of plc to be kept", || plc.boot() != 0);
    plc.enable();
    let consumer = Process::start(&line, limit);
    until("the account of the consumer", || accounts(&line).iter().any(|name| name == "tool"));
    (line, judge, plc, consumer)
}

/// The consumers that have an account in the journal.
fn accounts(line: &Line) -> Vec<String> {
    let read = "import sqlite3, sys\n\
                db = sqlite3.connect(f'file:{sys.argv[1]}?mode=ro', uri=True, timeout=60)\n\
                print(*(name for name, in db.execute('SELECT consumer FROM account')))";
    let output =
        Command::new("python3").args(["-c", read]).arg(line.path("journal.sqlite")).output().unwrap();
    assert!(output.status.success(), "{}", all_output(&output));
    String::from_utf8(output.stdout).unwrap().split_whitespace().map(str::to_owned).collect()
}

#[test]
fn a_consumer_that_lags_and_is_killed_goes_on_where_it_ended_while_the_plc_is_served() {
    run_copier();
    let (mut line, mut judge, mut plc, consumer) = line_with_consumer(5);
    (1..=60).for_each(|_| judge.send(job_done));
    // The consumer stops after five rows; the PLC gets all of its results.
    acknowledge(&mut plc, 1..=60);
    until("five rows", || copied(&line).len() == 5);
    drop(consumer);

    (61..=80).for_each(|_| judge.send(job_done));
    acknowledge(&mut plc, 61..=70);
    let _consumer = Process::start(&line, u32::MAX);
    until("the rows that it missed", || copied(&line).last().is_some_and(|[row, ..]| *row == 80));
    // A journal that starts again owes both what it owed before.
    line.role("journal").kill();
    line.start("journal");
    // The judge is a stand-in, which hands nothing on to a reader that comes after it has sent.
    until("the new journal", || line.log("journal").matches("AND-401").count() == 2);
    (81..=90).for_each(|_| judge.send(job_done));
    acknowledge(&mut plc, 71..=90);
    assert_eq!(plc.lost(), 0);
    until("the rows of the journal that has started again", || {
        copied(&line).last().is_some_and(|[row, ..]| *row == 90)
    });
    let mut rows: Vec<u64> = copied(&line).iter().map(|[row, ..]| *row).collect();
    // What was copied and not yet known to be acknowledged comes twice.
    rows.sort_unstable();
    rows.dedup();
    assert_eq!(rows, (1..=90).collect::<Vec<u64>>());
    assert!(copied(&line).iter().all(|[_, missing, _]| *missing == 0), "{:?}", copied(&line));
}

/// Makes the journal larger than it may be.
const FATTEN: &str = "import sqlite3, sys\n\
                      db = sqlite3.connect(sys.argv[1], timeout=60)\n\
                      db.execute('CREATE TABLE filler AS SELECT randomblob(12000000) AS bytes')\n\
                      db.commit()";

#[test]
fn what_a_consumer_has_not_acknowledged_goes_when_the_journal_is_too_large_and_it_is_told_how_much() {
    run_copier();
    let (mut line, mut judge, mut plc, consumer) = line_with_consumer(5);
    (1..=20).for_each(|_| judge.send(job_done));
    acknowledge(&mut plc, 1..=20);
    until("five rows", || copied(&line).len() == 5);
    drop(consumer);
    line.role("journal").signal(Signal::TERM);
    assert!(line.role("journal").wait().success());
    let fattened =
        Command::new("python3").args(["-c", FATTEN]).arg(line.path("journal.sqlite")).output().unwrap();
    assert!(fattened.status.success(), "{}", all_output(&fattened));
    line.start("journal");
    line.wait_for_log("journal", "AND-406", "19 verdicts were removed");
    line.wait_for_log("journal", "AND-409", "raise journal.keep_mb");
    let _consumer = Process::start(&line, u32::MAX);
    until("the row that is left", || copied(&line).len() >= 6);
    // It may have died between the copy of its fifth row and the account of it.
    let [row, missing, _] = *copied(&line).last().unwrap();
    assert!(row == 20 && (14..=19).contains(&missing), "{:?}", copied(&line));
}
