//! What a new role takes: one that counts verdicts by their outcome, running on a station of its own.

#![allow(clippy::unwrap_used, clippy::panic)]

use andon_host::config::Config;
use andon_host::exit::Code;
use andon_host::role::{Cycle, CycleError, Role, Turn, run_with};
use andon_ipc::{Limits, Node, Port, Reader, Station, Steward, Stop};
use rustix::process::{Signal, getpid, kill_process};
use shm_schemas::{Health, RoleId, RoleState, Verdict, VerdictLevel, VerdictOutcome};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// For whatever must happen sooner or later; only a test that fails waits for so long.
const PATIENCE: Duration = Duration::from_secs(60);

/// The example: all that a role has to write by itself.
struct Tally {
    verdicts: Reader<Verdict>,
    /// How many are right, wrong and not judged; sent out after each verdict.
    counts: [u32; 3],
    report: Sender<[u32; 3]>,
}

fn tally(node: &Node, report: Sender<[u32; 3]>) -> Result<(), CycleError> {
    let mut role = Tally { verdicts: node.reader()?, counts: [0; 3], report };
    Cycle::new(node)?.run(&mut role)
}

impl Role for Tally {
    type Error = CycleError;
    const INPUT_IS_STEADY: bool = false;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        vec![&mut self.verdicts]
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, CycleError> {
        let Some(verdict) = cycle.take(&mut self.verdicts)? else { return Ok(Turn::Idle) };
        match verdict.outcome() {
            Ok(VerdictOutcome::Ok) => self.counts[0] += 1,
            Ok(VerdictOutcome::Anomaly) => self.counts[1] += 1,
            Ok(VerdictOutcome::NotJudged) => self.counts[2] += 1,
            Err(_) => cycle.liveness().refused(),
        }
        let _ = self.report.send(self.counts);
        Ok(Turn::Stepped)
    }
}

/// A stop is asked of the whole process.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// A station of its own, which lasts for as long as its steward and its folder.
fn station() -> (Config, Station, Steward, tempfile::TempDir) {
    // Under /tmp whatever TMPDIR says: the path must be short.
    let folder = tempfile::Builder::new().prefix("andon-").tempdir_in("/tmp").unwrap();
    let path = folder.path().join("tally.toml");
    let text = format!(
        "[station]\nname = \"tally\"\nroot = {:?}\n[[objects]]\nid = 1\nname = \"cup\"\nmarker_side_m = 0.03\n\
         interaction_points = [[0.0, 0.0, 0.0]]\n",
        folder.path()
    );
    std::fs::write(&path, text).unwrap();
    let config = Config::load(&[path]).unwrap();
    let station = Station::under("tally", &config.root()).unwrap();
    let steward = Steward::create(&station, Limits { frame_bytes: 4096 }).unwrap();
    (config, station, steward, folder)
}

/// A role with a steady input that leaves with its first message. It goes on in a second session, as the judge does with another job.
struct Sessions {
    verdicts: Reader<Verdict>,
    has_left: bool,
    turns: u32,
}

impl Role for Sessions {
    type Error = CycleError;
    const INPUT_IS_STEADY: bool = true;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        vec![&mut self.verdicts]
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, CycleError> {
        let began = Instant::now();
        if cycle.take(&mut self.verdicts)?.is_some() {
            cycle.stepped(began);
            self.has_left = true;
            return Ok(Turn::Left);
        }
        self.turns += u32::from(self.has_left);
        Ok(if self.turns == 2 { Turn::Left } else { Turn::Idle })
    }
}

#[test]
fn a_session_that_begins_while_no_message_waits_is_not_silent() {
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let (config, station, _steward, _folder) = station();
    let node = Node::open(&station, RoleId::Judge, PATIENCE, &Stop::new().unwrap()).unwrap();
    let mut health = node.reader::<Health>().unwrap();
    let mut verdicts = node.writer::<Verdict>().unwrap();
    verdicts.send(verdicts.loan().unwrap()).unwrap();
    let role = std::thread::spawn(move || {
        run_with(&config, RoleId::Tool, |node| {
            let mut cycle = Cycle::new(node)?;
            let mut role = Sessions { verdicts: node.reader()?, has_left: false, turns: 0 };
            cycle.run(&mut role)?;
            cycle.run(&mut role)
        })
    });
    let until = Instant::now() + PATIENCE;
    let mut states = Vec::new();
    while !states.contains(&RoleState::Running.code()) && !states.contains(&RoleState::Waiting.code()) {
        node.wait(&mut [&mut verdicts, &mut health], Duration::from_millis(10)).unwrap();
        states.extend(health.take().unwrap().map(|health| health.state));
        assert!(Instant::now() < until, "{states:?}");
    }
    assert!(!states.contains(&RoleState::Waiting.code()), "{states:?}");
    role.join().unwrap();
}

#[test]
fn a_role_of_a_few_lines_takes_its_messages_gives_signs_of_life_and_stops_on_request() {
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let (config, station, _steward, _folder) = station();
    let node = Node::open(&station, RoleId::Judge, PATIENCE, &Stop::new().unwrap()).unwrap();
    let mut health = node.reader::<Health>().unwrap();
    let mut verdicts = node.writer::<Verdict>().unwrap();

    let (report, counts) = channel();
    let role = std::thread::spawn(move || run_with(&config, RoleId::Tool, |node| tally(node, report)));
    for outcome in
        [VerdictOutcome::Ok, VerdictOutcome::Ok, VerdictOutcome::Anomaly, VerdictOutcome::NotJudged]
    {
        let mut verdict = verdicts.loan().unwrap();
        (verdict.level, verdict.outcome) = (VerdictLevel::Iu.code(), outcome.code());
        verdicts.send(verdict).unwrap();
    }
    // The reader may come up after them: the writer hands the history to it while it waits.
    let mut newest = [0; 3];
    let until = Instant::now() + PATIENCE;
    while newest != [2, 1, 1] {
        node.wait(&mut [&mut verdicts], Duration::from_millis(10)).unwrap();
        assert!(Instant::now() < until, "the verdicts have not all come: {newest:?}");
        newest = counts.try_iter().last().unwrap_or(newest);
    }
    while health.take().unwrap().is_none_or(|health| health.state != RoleState::Running.code()) {
        node.wait(&mut [&mut health], Duration::from_millis(10)).unwrap();
        assert!(Instant::now() < until, "no sign of life");
    }
    kill_process(getpid(), Signal::TERM).unwrap();
    assert_eq!(role.join().unwrap(), Code::Stopped);
}
