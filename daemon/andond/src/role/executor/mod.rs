//! `executor`: runs the commands of `andond` that an engineer orders on the board, one after the other.
//!
//! The board writes nothing, and knows no way to do what a command does. It sends a task. This role makes of it the command line that a person would
//! type, runs it as a child, and sends on what it prints. So there is one way to do each thing, and the board has what the shell has.
//!
//! What comes from the network is a word for the kind of the task, names and texts. Each kind has a fixed list of arguments ([`plan`]). Names are those
//! of files that there are, or are made of few characters, and no shell reads them. The journal keeps each task with the name of the login, and what
//! became of it.
//!
//! One task runs at a time: two that teach would write the same job. A second one is refused, and the board says so.

mod change;
mod child;
mod films;
mod plan;

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use andon_host::atomic;
use andon_host::config::Config;
use andon_host::log::{code, log};
use andon_host::role::{Cycle, Output, Role, Turn, WAIT};
use andon_ipc::{MonotonicTime, Node, Port, Reader, Writer};
use shm_schemas::{
    AuditKind, FilmPiece, PRINTED_TEXT_BYTES, Printed, PrintedState, Showing, Stamp, TASK_LATE_NS, Task,
    TaskKind, task_flag,
};

use super::audit::Auditor;
use super::{RoleError, disabled, jobs};
use crate::made::{Made, hash_of};
use crate::tool::teach::showing_after;
use change::Before;
use child::Child;
use films::{Films, Taken};
use plan::{Plan, Step};

/// How often it looks at what a task has printed.
const TURN: Duration = Duration::from_millis(50);

/// Lines that are sent in a turn. The board takes as many, and the child waits meanwhile.
const AT_ONCE: usize = 64;

/// Runs until it is asked to stop.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    let mut cycle = Cycle::new(node)?;
    if !config.executor.enable {
        log!(code::EXECUTOR_OFF, "executor.enable is false");
        return disabled::run(&mut cycle);
    }
    let began = Instant::now();
    let made = Made::new(config);
    let mut role = Executor {
        config,
        tasks: node.reader()?,
        pieces: node.reader()?,
        films: Films::new(made.films_folder(), &config.station.name),
        printed: Output::beside(node.writer()?),
        auditor: Auditor::open(node)?,
        running: None,
    };
    if let Some(said) = change::put_back_noted(made.unfinished()) {
        log!(code::TASK_ENDED, "{said}");
        role.auditor.record(&mut cycle, AuditKind::Task, "role executor", &said)?;
    }
    make_folders(&made);
    cycle.stepped(began);
    cycle.run(&mut role)
}

/// Where a folder cannot be written, the commands say so as well, and what needs no file is done all the same.
fn make_folders(made: &Made) {
    // A folder that somebody has named may be on a disk that is only read.
    let _ = std::fs::create_dir_all(made.films_folder());
    let mut unwritable = made.folders().into_iter().filter_map(|folder| {
        let tried = std::fs::create_dir_all(&folder).and_then(|()| tempfile::tempfile_in(&folder));
        tried.err().map(|error| format!("{}: {error}", folder.display()))
    });
    match unwritable.next() {
        Some(fault) => log!(code::EXECUTOR_CANNOT_WRITE, "{fault}"),
        None => log!(code::EXECUTOR_READY, "orders of engineers are carried out"),
    }
}

struct Executor<'c> {
    config: &'c Config,
    tasks: Reader<Task>,
    pieces: Reader<FilmPiece>,
    films: Films,
    printed: Output<Writer<Printed>>,
    auditor: Auditor,
    running: Option<Running>,
}

/// The task that runs.
struct Running {
    task: Task,
    child: Child,
    step: Step,
    /// What comes after it.
    rest: VecDeque<Step>,
    showing: Option<Showing>,
    is_stopped: bool,
    /// What it has changed by itself.
    before: Before,
}

/// Begins a step.
fn start(step: &Step, config: &Config) -> std::io::Result<Child> {
    // A job that is taught again finds there what it was taught from.
    Child::start(&step.arguments, &config.films())
}

impl Role for Executor<'_> {
    type Error = RoleError;
    const INPUT_IS_STEADY: bool = false;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        vec![self.printed.port(), self.auditor.port(), &mut self.tasks, &mut self.pieces]
    }

    fn patience(&self) -> Duration {
        if self.running.is_some() || self.films.is_open() { TURN } else { WAIT }
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        while let Some(task) = self.tasks.take()? {
            self.take(cycle, &task)?;
        }
        while let Some(piece) = self.pieces.take()? {
            self.take_piece(cycle, &piece)?;
        }
        if let Some((who, name)) = self.films.give_up(Instant::now()) {
            let mut task = Task { kind: TaskKind::Film.code(), ..Task::default() };
            // They were in a message.
            let _ = task.say(&who, &name, "");
            self.pass_over(cycle, &task, "nothing came any more")?;
        }
        self.go_on(cycle)?;
        Ok(Turn::Idle)
    }

    fn stop(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        let Some(mut running) = self.running.take() else { return Ok(()) };
        running.child.end();
        let is_done = running.child.ended().is_some_and(|status| running.step.is_done(status));
        running.before.put_back(is_done);
        self.end(cycle, &running.task, PrintedState::Stopped, "the role executor was stopped")
    }
}

impl Executor<'_> {
    fn take(&mut self, cycle: &mut Cycle<'_>, task: &Task) -> Result<(), RoleError> {
        let kind = TaskKind::try_from(task.kind);
        // To stop is right at any time.
        if kind != Ok(TaskKind::Stop) && is_late(&task.stamp, MonotonicTime::now()) {
            // Nobody waits for an answer. Whoever has ordered it was told that nobody does it.
            return self.pass_over(cycle, task, "it came too late");
        }
        match kind {
            Ok(TaskKind::Answer) => self.answer(cycle, task),
            Ok(TaskKind::Stop) => self.end_running(cycle, task),
            Ok(kind) if self.running.is_none() => match plan::of(kind, task, self.config) {
                Ok(plan) => self.begin(cycle, task, plan),
                Err(why) => self.refuse(cycle, task, &why),
            },
            Ok(_) => self.refuse(cycle, task, "another task is running: wait for its end, or stop it"),
            Err(_) => self.refuse(cycle, task, "the board is of another version"),
        }
    }

    /// Keeps a piece of a recording, and says so.
    fn take_piece(&mut self, cycle: &mut Cycle<'_>, piece: &FilmPiece) -> Result<(), RoleError> {
        if is_late(&piece.stamp, MonotonicTime::now()) {
            // Whoever has sent it was told that nobody keeps it, and sends it again.
            return Ok(());
        }
        let mut task = Task { number: piece.task, kind: TaskKind::Film.code(), ..Task::default() };
        // They were in a message.
        let _ = task.say(piece.who(), piece.name(), "");
        match self.films.take(piece, Instant::now()) {
            Ok(Taken::Kept) => self.print(cycle, &task, PrintedState::Done, None, ""),
            Ok(Taken::Whole(digest)) => {
                let became = format!("done, {} bytes with the SHA-256 {digest}", piece.size);
                log!(code::TASK_ENDED, "{}", said(&task, &became));
                self.audit(cycle, &task, &became)?;
                self.print(cycle, &task, PrintedState::Done, None, "")
            }
            Ok(Taken::BrokenOff) => self.end(cycle, &task, PrintedState::Stopped, ""),
            Err(why) => self.refuse(cycle, &task, &why),
        }
    }

    fn begin(&mut self, cycle: &mut Cycle<'_>, task: &Task, plan: Plan) -> Result<(), RoleError> {
        let Plan { changes, steps: mut rest } = plan;
        let Some(step) = rest.pop_front() else { return self.refuse(cycle, task, "this is no command") };
        let note = Made::new(self.config).unfinished();
        match change::and_begin(changes, note, || start(&step, self.config)) {
            Ok((child, before)) => {
                let task = *task;
                self.running =
                    Some(Running { task, child, step, rest, showing: None, is_stopped: false, before });
            }
            Err(why) => return self.refuse(cycle, task, &why),
        }
        log!(code::TASK_BEGUN, "{}", said(task, PrintedState::Begun.name()));
        self.audit(cycle, task, PrintedState::Begun.name())?;
        self.print(cycle, task, PrintedState::Begun, None, "")
    }

    /// Passes on what was printed, and begins the next step or ends the task where its child has ended.
    fn go_on(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        let Some(mut running) = self.running.take() else { return Ok(()) };
        for line in running.child.lines(AT_ONCE) {
            running.showing = showing_after(&line, running.showing);
            for part in parts(&line) {
                self.print(cycle, &running.task, PrintedState::Line, running.showing, part)?;
            }
        }
        let Some(status) = running.child.ended() else {
            self.running = Some(running);
            return Ok(());
        };
        let is_done = running.step.is_done(status);
        let (state, why) = match running.rest.pop_front() {
            _ if running.is_stopped => (PrintedState::Stopped, String::new()),
            None if is_done => (PrintedState::Done, String::new()),
            Some(next) if is_done => match start(&next, self.config) {
                Ok(child) => {
                    self.running = Some(Running { child, step: next, showing: None, ..running });
                    return Ok(());
                }
                Err(error) => (PrintedState::Failed, format!("andond cannot be started: {error}")),
            },
            _ => (PrintedState::Failed, String::new()),
        };
        if state == PrintedState::Done && teaches(&running.task) {
            keep_report(&Made::new(self.config), running.task.name());
        }
        if state == PrintedState::Done && loads(&running.task) && self.config.station.job.is_none() {
            let said = keep_loaded(&Made::new(self.config), running.task.name());
            self.print(cycle, &running.task, PrintedState::Line, None, &said)?;
        }
        match state {
            PrintedState::Done => running.before.keep(),
            _ => running.before.put_back(is_done),
        }
        self.end(cycle, &running.task, state, &why)
    }

    fn answer(&mut self, cycle: &mut Cycle<'_>, task: &Task) -> Result<(), RoleError> {
        let asked = self.running.as_ref().and_then(|running| running.showing);
        let Some(running) = self.running.as_mut().filter(|_| asked.is_some()) else {
            return self.refuse(cycle, task, "nothing is asked now");
        };
        if asked.map(Showing::code) != Some(task.showing) {
            return self.refuse(cycle, task, "this was answered already");
        }
        let known: &[&str] = match asked {
            Some(Showing::Keep) => &["k", "d", "t", "q"],
            _ => &["", "d", "q"],
        };
        if !known.contains(&task.text()) {
            return self.refuse(cycle, task, "this is no answer");
        }
        // Until it asks again, there is nothing to answer.
        running.showing = None;
        match running.child.tell(task.text()) {
            Ok(()) => {
                self.audit(cycle, task, "taken")?;
                self.print(cycle, task, PrintedState::Done, None, "")
            }
            Err(_) => self.refuse(cycle, task, "the task has just ended"),
        }
    }

    fn end_running(&mut self, cycle: &mut Cycle<'_>, task: &Task) -> Result<(), RoleError> {
        let Some(running) = &mut self.running else {
            return self.refuse(cycle, task, "nothing is running");
        };
        running.is_stopped = true;
        running.child.ask_to_end();
        self.audit(cycle, task, "taken")?;
        self.print(cycle, task, PrintedState::Done, None, "")
    }

    fn end(
        &mut self,
        cycle: &mut Cycle<'_>,
        task: &Task,
        state: PrintedState,
        why: &str,
    ) -> Result<(), RoleError> {
        log!(code::TASK_ENDED, "{}", said(task, state.name()));
        self.audit(cycle, task, state.name())?;
        self.print(cycle, task, state, None, why)
    }

    fn refuse(&mut self, cycle: &mut Cycle<'_>, task: &Task, why: &str) -> Result<(), RoleError> {
        self.pass_over(cycle, task, why)?;
        self.print(cycle, task, PrintedState::Refused, None, why)
    }

    /// Keeps that a task is not done.
    fn pass_over(&mut self, cycle: &mut Cycle<'_>, task: &Task, why: &str) -> Result<(), RoleError> {
        log!(code::TASK_REFUSED, "{}", said(task, why));
        self.audit(cycle, task, &format!("refused, because {why}"))
    }

    fn audit(&mut self, cycle: &mut Cycle<'_>, task: &Task, became: &str) -> Result<(), RoleError> {
        let who = format!("login {}", task.who());
        Ok(self.auditor.record(cycle, AuditKind::Task, &who, &said(task, became))?)
    }

    fn print(
        &mut self,
        cycle: &mut Cycle<'_>,
        task: &Task,
        state: PrintedState,
        showing: Option<Showing>,
        text: &str,
    ) -> Result<(), RoleError> {
        Ok(self.printed.send(cycle, |message| {
            message.of(task);
            message.state = state.code();
            message.showing = showing.map_or(0, Showing::code);
            message.say(text);
        })?)
    }
}

fn teaches(task: &Task) -> bool {
    use TaskKind::{TeachAgain, TeachFilms, TeachLive, Without};
    matches!(TaskKind::try_from(task.kind), Ok(TeachLive | TeachFilms | TeachAgain | Without))
}

fn loads(task: &Task) -> bool {
    matches!(TaskKind::try_from(task.kind), Ok(TaskKind::Load | TaskKind::RollBack))
}

/// Keeps which job was loaded, for a station whose file names none, and says so.
fn keep_loaded(made: &Made, job: &str) -> String {
    let kept = jobs::read(&made.job(job)).map_err(|error| error.to_string()).and_then(|file| {
        let text = format!("{} {}", file.id, hash_of(&file));
        atomic::write(&made.loaded(), text.as_bytes()).map_err(|error| error.to_string())
    });
    match kept {
        Ok(()) => "the station begins with it when it starts again".to_owned(),
        Err(why) => format!("it must be loaded again when the station has started again: {why}"),
    }
}

/// Keeps the report of a teaching with the version of the job that it has made: the next teaching writes another one.
fn keep_report(made: &Made, job: &str) {
    // Where a job was written, it can be read.
    let Ok(file) = jobs::read(&made.job(job)) else { return };
    let copy = made.report_of(job, &hash_of(&file));
    let kept = std::fs::read(made.report(job)).and_then(|report| atomic::write(&copy, &report));
    if let Err(error) = kept {
        log!(code::EXECUTOR_CANNOT_WRITE, "{}: {error}", copy.display());
    }
}

/// Whether a task has come so late that it is not done: this process, or the machine, has stood still.
fn is_late(stamp: &Stamp, now: MonotonicTime) -> bool {
    now.since(MonotonicTime::sent(stamp)) > Duration::from_nanos(TASK_LATE_NS)
}

/// A task and what became of it in one line, for the log and the journal. What became of it comes before the text, which may be cut off, and no
/// character of what was sent begins another line.
fn said(task: &Task, became: &str) -> String {
    let kind = TaskKind::try_from(task.kind).map_or("unknown task", TaskKind::name);
    let flags = [(task_flag::FORCE, "in spite of doubts"), (task_flag::ADD, "added to it")];
    let flags = flags.into_iter().filter(|(flag, _)| task.flags & flag != 0).map(|(_, words)| words);
    let texts: Vec<&str> = flags.chain(task.text().lines()).filter(|text| !text.is_empty()).collect();
    let name = if task.name().is_empty() { String::new() } else { format!(" {}", task.name()) };
    let texts = if texts.is_empty() { String::new() } else { format!(" ({})", texts.join(", ")) };
    format!("{kind}{name}: {became}{texts}").replace(char::is_control, " ")
}

/// A line in pieces that fit into a message.
fn parts(line: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut rest = line;
    while rest.len() > PRINTED_TEXT_BYTES {
        let (part, more) = rest.split_at(rest.floor_char_boundary(PRINTED_TEXT_BYTES));
        parts.push(part);
        rest = more;
    }
    parts.push(rest);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_is_late_once_the_page_is_about_to_say_that_nobody_does_it() {
        let mut task = Task::default();
        let sent = MonotonicTime::now();
        task.stamp.sent_ns = sent.nanoseconds();
        let after = |ns: u64| is_late(&task.stamp, sent + Duration::from_nanos(ns));
        assert!(!after(0) && !after(TASK_LATE_NS) && after(TASK_LATE_NS + 1));
        // One that is read before it was sent, by a clock of another processor, is new.
        task.stamp.sent_ns += 5;
        assert!(!is_late(&task.stamp, sent));
    }
}
