//! What an engineer has before them: the jobs and recordings that there are, and the task that runs or has run last.

use std::collections::VecDeque;

use andon_http::{Later, Response};
use shm_schemas::{Printed, PrintedState, Showing, TaskKind, VerdictMeasure};

use crate::address::Page;
use crate::audited::Audited;
use crate::board::Board;
use crate::job::Job;
use crate::order::Order;

/// Lines of a task that are kept: a report has some hundred.
const LINES: usize = 400;

/// Files that browsers wait for at once.
const FETCHES: usize = 16;

/// A browser without scripts asks this often while it looks, at least.
const LOOKED_NS: u64 = 60_000_000_000;

/// What there is on disk.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Known {
    /// The jobs of the station, in the order of their names.
    pub jobs: Vec<KnownJob>,
    /// The names of the recordings that can be taught from.
    pub films: Vec<String>,
    /// The names of the stations of which a file was written here.
    pub stations: Vec<String>,
    /// Whether there are markers to print.
    pub has_markers: bool,
    /// Whether there is a picture of what was seen when somebody looked last.
    pub has_seen: bool,
    /// Whether there is a picture of the last calibration.
    pub has_calibrated: bool,
}

/// A job of the station.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KnownJob {
    /// The name of its file, without the ending.
    pub name: String,
    /// Why it cannot be read, where it cannot.
    pub fault: String,
    /// Its number.
    pub number: u32,
    /// Its name.
    pub title: String,
    /// The version that its file has.
    pub version: Version,
    /// What people call its steps and parts. It has no pictures.
    pub names: Job,
    /// The names of the recordings that it was taught from.
    pub runs: Vec<String>,
    /// What these measured, in the order of the steps.
    pub measured: Vec<Measured>,
    /// Its other versions.
    pub earlier: Vec<Version>,
    /// Whether there is a report of its last teaching.
    pub has_report: bool,
}

/// What the runs of a job measured in one of its IUs, in the unit of the verdicts.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The step, from 0.
    pub step: u16,
    /// The IU in the step, from 0.
    pub iu: u16,
    /// Which measure.
    pub measure: VerdictMeasure,
    /// What each run measured, sorted.
    pub values: Vec<f32>,
    /// The minimum and the maximum that are right; infinite where there is none.
    pub right: [f32; 2],
}

/// A version of a job.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Version {
    /// Its hash, 16 hexadecimal digits.
    pub hash: String,
    /// When it was taught.
    pub date: String,
    /// From how many runs.
    pub runs: usize,
    /// How many steps it has.
    pub steps: usize,
    /// Whether there is the report of the teaching that made it.
    pub has_report: bool,
}

/// A file that a command has made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MadeFile {
    /// The report of the last teaching of this job, or with a dot and its hash of one of its versions, as a page with its style apart.
    Report(String),
    /// The style of that page.
    Style(String),
    /// The file of this new station.
    Station(String),
    /// The markers to print, as PDF.
    Markers,
    /// What was seen when somebody looked last, as JPEG.
    Seen,
    /// The last calibration, as JPEG.
    Calibrated,
}

impl MadeFile {
    /// Whether it shows the bench.
    pub(crate) const fn is_picture(&self) -> bool {
        matches!(self, Self::Seen | Self::Calibrated)
    }

    /// The file of this name; `of` is the job or the station that the address names.
    pub(crate) fn named(name: &str, of: String) -> Option<Self> {
        Some(match name {
            "report.html" => Self::Report(of),
            "report.css" => Self::Style(of),
            "station.toml" => Self::Station(of),
            "markers.pdf" => Self::Markers,
            "seen.jpg" => Self::Seen,
            "calibrated.jpg" => Self::Calibrated,
            _ => return None,
        })
    }
}

/// A browser that waits for a file.
#[derive(Debug)]
pub struct Fetch {
    /// Which one.
    pub file: MadeFile,
    later: Later,
}

impl Fetch {
    /// Answers it.
    pub fn answer(self, response: Response) {
        self.later.send(response);
    }
}

/// A task and what it has printed.
#[derive(Clone, Debug)]
pub(crate) struct Shown {
    number: u64,
    pub(crate) kind: TaskKind,
    pub(crate) name: String,
    pub(crate) who: String,
    pub(crate) state: PrintedState,
    pub(crate) showing: Option<Showing>,
    pub(crate) lines: VecDeque<String>,
}

impl Shown {
    pub(crate) fn is_running(&self) -> bool {
        matches!(self.state, PrintedState::Begun | PrintedState::Line)
    }
}

/// All of it.
#[derive(Debug, Default)]
pub(crate) struct Desk {
    pub(crate) known: Known,
    pub(crate) shown: Option<Shown>,
    /// What was done last, newest first.
    pub(crate) audited: Vec<Audited>,
    pub(crate) orders: Vec<Order>,
    fetches: Vec<Fetch>,
    asked_ns: Option<u64>,
}

impl Desk {
    /// Somebody has asked for a page of it.
    pub(crate) fn ask(&mut self, now_ns: u64) {
        self.asked_ns = Some(now_ns);
    }

    pub(crate) fn job(&self, name: &str) -> Option<&KnownJob> {
        self.known.jobs.iter().find(|job| job.name == name)
    }

    /// A browser wants a file.
    pub(crate) fn fetch(&mut self, file: MadeFile) -> Response {
        self.fetches.retain(|fetch| !fetch.later.is_over());
        if self.fetches.len() >= FETCHES {
            return Response::text(503, "too many files are asked for at once\n");
        }
        let (response, later) = Response::later();
        self.fetches.push(Fetch { file, later });
        response
    }

    fn take(&mut self, printed: &Printed) {
        let (Ok(kind), Ok(state)) = (TaskKind::try_from(printed.kind), PrintedState::try_from(printed.state))
        else {
            return;
        };
        // A role that has been killed says nothing of its task, and a new one knows of none.
        if kind == TaskKind::Stop && state == PrintedState::Refused {
            let running = self.shown.as_mut().filter(|shown| shown.is_running());
            running.into_iter().for_each(|shown| shown.state = PrintedState::Failed);
        }
        // Whoever has ordered these is told so.
        if matches!(kind, TaskKind::Answer | TaskKind::Stop | TaskKind::Film)
            || state == PrintedState::Refused
        {
            return;
        }
        let is_known = self.shown.as_ref().is_some_and(|shown| shown.number == printed.task);
        if !is_known {
            self.shown = Some(Shown {
                number: printed.task,
                kind,
                name: printed.name().to_owned(),
                who: printed.who().to_owned(),
                state,
                showing: None,
                lines: VecDeque::new(),
            });
        }
        let Some(shown) = &mut self.shown else { return };
        shown.state = state;
        let before = shown.showing;
        shown.showing = Showing::try_from(printed.showing).ok();
        // The line that asks it names keys of a shell. The page asks by its buttons.
        let asks = shown.showing == Some(Showing::Keep) && before != shown.showing;
        if !asks && (state == PrintedState::Line || !printed.text().is_empty()) {
            if shown.lines.len() == LINES {
                shown.lines.pop_front();
            }
            shown.lines.push_back(printed.text().to_owned());
        }
    }
}

impl Board {
    /// What there is on disk.
    pub fn known(&mut self, known: Known) {
        self.version += u64::from(self.desk.known != known);
        self.desk.known = known;
    }

    /// What a task has printed.
    pub fn printed(&mut self, printed: &Printed) {
        self.desk.take(printed);
        self.version += 1;
    }

    /// Whether somebody looks at an engineer's page, or did so a moment ago.
    #[must_use]
    pub fn is_engineered(&self) -> bool {
        let asked =
            self.desk.asked_ns.is_some_and(|asked_ns| self.now_ns.saturating_sub(asked_ns) < LOOKED_NS);
        asked || self.watchers.look_at(Page::Engineer) || self.watchers.look_at(Page::Job)
    }

    /// The files that browsers have asked for since this was called last. Each waits some seconds for its answer.
    #[must_use]
    pub fn take_fetches(&mut self) -> Vec<Fetch> {
        std::mem::take(&mut self.desk.fetches)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use shm_schemas::Task;

    #[test]
    fn a_task_whose_role_knows_nothing_of_it_runs_no_more() {
        let mut desk = Desk::default();
        desk.take(&printed(1, TaskKind::TeachLive, PrintedState::Line, "run 1 of 3"));
        desk.take(&printed(2, TaskKind::Load, PrintedState::Refused, "another task is running"));
        assert!(desk.shown.as_ref().unwrap().is_running());
        desk.take(&printed(3, TaskKind::Stop, PrintedState::Refused, "nothing is running"));
        assert_eq!(desk.shown.as_ref().unwrap().state, PrintedState::Failed);
    }

    fn printed(number: u64, kind: TaskKind, state: PrintedState, text: &str) -> Printed {
        let mut task = Task { number, kind: kind.code(), ..Task::default() };
        assert!(task.say("maria", "polish", ""));
        let mut printed = Printed { state: state.code(), ..Printed::default() };
        printed.of(&task);
        printed.say(text);
        printed
    }

    #[test]
    fn what_a_task_prints_is_kept_until_the_next_one_begins_and_answers_are_none() {
        let mut desk = Desk::default();
        desk.take(&printed(1, TaskKind::TeachLive, PrintedState::Begun, ""));
        desk.take(&printed(1, TaskKind::TeachLive, PrintedState::Line, "run 1"));
        desk.take(&printed(2, TaskKind::Answer, PrintedState::Done, ""));
        desk.take(&printed(3, TaskKind::Load, PrintedState::Refused, "another one runs"));
        let shown = desk.shown.clone().unwrap();
        assert!(shown.is_running() && shown.who == "maria" && shown.lines == ["run 1"]);
        let question = printed(1, TaskKind::TeachLive, PrintedState::Line, "Enter keeps it; d drops it");
        desk.take(&Printed { showing: Showing::Keep.code(), ..question });
        assert_eq!(desk.shown.clone().unwrap().lines, ["run 1"], "buttons ask it");
        desk.take(&printed(1, TaskKind::TeachLive, PrintedState::Failed, "why"));
        assert!(!desk.shown.clone().unwrap().is_running());
        assert_eq!(desk.shown.clone().unwrap().lines, ["run 1", "why"]);
        for line in 0..2 * LINES {
            desk.take(&printed(4, TaskKind::Load, PrintedState::Line, &line.to_string()));
        }
        let shown = desk.shown.unwrap();
        assert_eq!((shown.lines.len(), shown.lines.back().unwrap().as_str()), (LINES, "799"));
    }
}
