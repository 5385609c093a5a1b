//! What an engineer orders and sees: tasks go to the role `executor`, what it prints comes back, and files are read in a thread.
//!
//! The board writes nothing here either. Which jobs, recordings and files there are, a thread looks up while somebody looks at the pages.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use andon_board::{Board, Fetch, Job, Known, KnownJob, MadeFile, Measured, Order, Ordered, Step, Version};
use andon_core::bounds::{Bounds, Range};
use andon_host::config::Config;
use andon_host::role::{Cycle, Output};
use andon_http::Response;
use andon_ipc::{MonotonicTime, Node, Port, Reader, Writer};
use andon_learn::file;
use andon_learn::job_file::{JobFile, TaughtIu};
use shm_schemas::{FilmPiece, Printed, PrintedState, Showing, TASK_LATE_NS, Task, TaskKind, VerdictMeasure};

use super::super::{RoleError, jobs};
use super::is_due;
use crate::made::{Made, hash_of, is_hash, is_name};
use crate::mark::Mark;

/// An executor that runs answers within one turn. It is longer than until it does nothing any more: what is said to be undone must not be done after
/// that. It is less than a browser waits for.
const PATIENCE: Duration = Duration::from_nanos(TASK_LATE_NS + 1_000_000_000);

/// How often it is looked which files there are, while somebody looks at them.
const LOOK: Duration = Duration::from_secs(1);

/// Browsers that wait for the thread.
const WAITING: usize = 16;

/// No file that the commands make is larger.
const LARGEST: u64 = 32 << 20;

/// Two reversals are a stroke.
const PER_STROKE: f32 = 2.0;

/// Between a style of a report and the rest of it.
const STYLE: [&str; 2] = ["<style>", "</style>"];

/// All that somebody has ordered and not been answered.
pub(super) struct Engineer {
    made: Made,
    is_enabled: bool,
    tasks: Output<Writer<Task>>,
    pieces: Output<Writer<FilmPiece>>,
    printed: Reader<Printed>,
    waiting: Vec<(Order, u64, Instant)>,
    looked: Option<Instant>,
    /// The files that the board knows of, as they were then.
    marks: Vec<(PathBuf, Mark)>,
    search: Option<JoinHandle<Search>>,
    fetches: Option<SyncSender<Fetch>>,
}

impl Engineer {
    pub(super) fn open(node: &Node, config: &Config) -> Result<Self, andon_ipc::Error> {
        Ok(Self {
            made: Made::new(config),
            is_enabled: config.executor.enable,
            tasks: Output::beside(node.writer()?),
            pieces: Output::beside(node.writer()?),
            printed: node.reader()?,
            waiting: Vec::new(),
            looked: None,
            marks: Vec::new(),
            search: None,
            fetches: None,
        })
    }

    pub(super) fn ports(&mut self) -> [&mut dyn Port; 3] {
        [self.tasks.port(), self.pieces.port(), &mut self.printed]
    }

    /// Sends what was ordered, and gives the board what has come. True where the steps of a job may have other names now.
    pub(super) fn turn(&mut self, cycle: &mut Cycle<'_>, board: &mut Board) -> Result<bool, RoleError> {
        for order in board.take_orders() {
            self.order(cycle, board, order)?;
        }
        let mut is_renamed = false;
        while let Some(printed) = self.printed.take()? {
            self.hear(board, &printed);
            let is = |kind: TaskKind, state: PrintedState| (kind.code(), state.code());
            is_renamed |= (printed.kind, printed.state) == is(TaskKind::Name, PrintedState::Done);
            board.printed(&printed);
        }
        self.give_up(board);
        for fetch in board.take_fetches() {
            self.fetch(fetch);
        }
        self.look(board);
        Ok(is_renamed)
    }

    fn order(&mut self, cycle: &mut Cycle<'_>, board: &mut Board, order: Order) -> Result<(), RoleError> {
        // A clock that counts nanoseconds gives no two orders of a person the same number.
        let number = MonotonicTime::now().nanoseconds();
        let mut task = Task { number, kind: order.kind.code(), flags: order.flags, ..Task::default() };
        task.showing = order.showing.map_or(0, Showing::code);
        if !task.say(&order.login, &order.name, &order.text) {
            board.answer_order(order, &Ordered::Refused("a name or a text is too long".to_owned()));
            return Ok(());
        }
        match &order.piece {
            None => self.tasks.send(cycle, |message| *message = Task { stamp: message.stamp, ..task })?,
            Some(piece) => self.pieces.send(cycle, |message| {
                (message.task, message.film) = (number, piece.film);
                (message.at, message.size) = (piece.at, piece.size);
                // The task has just said them, and no piece of the board is larger than a message.
                let _ = message.say(task.who(), task.name()) && message.carry(&piece.bytes);
            })?,
        }
        self.waiting.push((order, number, Instant::now()));
        Ok(())
    }

    fn hear(&mut self, board: &mut Board, printed: &Printed) {
        let Some(place) = self.waiting.iter().position(|(_, number, _)| *number == printed.task) else {
            return;
        };
        let (order, ..) = self.waiting.remove(place);
        let ordered = match PrintedState::try_from(printed.state) {
            Ok(PrintedState::Refused) => Ordered::Refused(printed.text().to_owned()),
            _ => Ordered::Taken,
        };
        board.answer_order(order, &ordered);
    }

    fn give_up(&mut self, board: &mut Board) {
        let is_over = |(_, _, since): &mut (Order, u64, Instant)| since.elapsed() > PATIENCE;
        for (order, ..) in self.waiting.extract_if(.., is_over) {
            board.answer_order(order, &Ordered::Unheard);
        }
    }

    /// Begins to look which files there are where somebody looks at them, and takes what was found.
    fn look(&mut self, board: &mut Board) {
        let found = self.search.take_if(|search| search.is_finished()).map(JoinHandle::join);
        if let Some(Ok(Some((marks, known)))) = found {
            self.marks = marks;
            board.known(known);
        }
        if self.is_enabled && self.search.is_none() && board.is_engineered() && is_due(&mut self.looked, LOOK)
        {
            let (made, before) = (self.made.clone(), self.marks.clone());
            // Without a thread it is looked the next time.
            self.search = Builder::new().name("desk".into()).spawn(move || search(&made, &before)).ok();
        }
    }

    fn fetch(&mut self, fetch: Fetch) {
        if self.fetches.is_none() {
            let (send, fetches) = sync_channel(WAITING);
            let made = self.made.clone();
            let started = Builder::new().name("made".into()).spawn(move || serve(&made, &fetches));
            self.fetches = started.is_ok().then_some(send);
        }
        if let Some(fetches) = &self.fetches {
            // Who finds no place is told by the server that nobody answers.
            let _ = fetches.try_send(fetch);
        }
    }
}

/// The files, and what is in them; `None` where they are those from before.
type Search = Option<(Vec<(PathBuf, Mark)>, Known)>;

fn search(made: &Made, before: &[(PathBuf, Mark)]) -> Search {
    let marks = made.marks();
    // What is written from now on is another one the next time.
    (marks != before).then(|| (marks, known(made)))
}

fn known(made: &Made) -> Known {
    let paths = jobs::job_files(made.jobs()).unwrap_or_default();
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Known {
        jobs: paths.iter().map(|path| job(made, path)).collect(),
        films: made.films().iter().map(|path| name(path)).collect(),
        stations: made.stations().iter().map(|path| stem(path)).collect(),
        has_markers: made.markers_pdf().is_file(),
        has_seen: made.seen().is_file(),
        has_calibrated: made.calibrated().is_file(),
    }
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn job(made: &Made, path: &Path) -> KnownJob {
    let name = stem(path);
    let versions = made.versions(&name).into_iter().filter_map(|path| jobs::read(&path).ok());
    let version = |file: &JobFile| version(made, &name, file);
    let mut earlier: Vec<Version> = versions.map(|file| version(&file)).collect();
    earlier.sort_by(|one, other| other.date.cmp(&one.date));
    let has_report = made.report(&name).is_file();
    let file = match jobs::read(path) {
        Ok(file) => file,
        Err(fault) => {
            let put_back = if earlier.is_empty() { "" } else { "put back an earlier version, or " };
            let fault = format!("{fault}; {put_back}teach a job of this name in its place");
            return KnownJob { name, fault, earlier, has_report, ..KnownJob::default() };
        }
    };
    let own = version(&file);
    earlier.retain(|version| version.hash != own.hash);
    KnownJob {
        fault: String::new(),
        number: file.id,
        title: file.name.clone(),
        version: own,
        names: names(&file),
        runs: file.provenance.sources.iter().map(|source| source.name.clone()).collect(),
        measured: measured(&file),
        earlier,
        has_report,
        name,
    }
}

/// What people call the parts and the steps of a job. A name that was only proposed is none: the board says it in the language of each reader.
pub(super) fn names(file: &JobFile) -> Job {
    let step = |number| Step {
        name: file.given_name(number).unwrap_or_default().to_owned(),
        contexts: file.step_contexts(number).into_iter().map(|context| context.0).collect(),
        picture: None,
    };
    Job {
        hash: file.model_hash(),
        name: file.name.clone(),
        parts: file.objects.iter().map(|object| (object.shape.id, object.name.clone())).collect(),
        steps: (0..file.steps.len()).map(step).collect(),
    }
}

/// What the runs measured, step by step: how long, how many strokes and how far, in the unit of the verdicts.
fn measured(file: &JobFile) -> Vec<Measured> {
    let rate_hz = file.method.rate_hz;
    let of_iu = |step: u16, number: u16, iu: &TaughtIu| {
        let Some(shown) = iu.shown.clone() else { return Vec::new() };
        let counted = |Bounds { min, max }: Bounds, per: f32| {
            [min as f32 / per, if max == u32::MAX { f32::INFINITY } else { max as f32 / per }]
        };
        let each = |values: Vec<f32>, per: f32| values.iter().map(|value| value / per).collect();
        let Range { min, max } = iu.measures.path_m;
        [
            (VerdictMeasure::Duration, each(shown.frames, rate_hz), counted(iu.frames, rate_hz)),
            (VerdictMeasure::Strokes, each(shown.reversals, PER_STROKE), counted(iu.reversals, PER_STROKE)),
            (VerdictMeasure::Path, shown.path_m, [min, max]),
        ]
        .map(|(measure, values, right)| Measured { step, iu: number, measure, values, right })
        .into()
    };
    let of_step = |step, ius: &[TaughtIu]| {
        (0..).zip(ius).flat_map(|(number, iu)| of_iu(step, number, iu)).collect::<Vec<_>>()
    };
    let of_all = file.activities.iter().flat_map(|taught| of_step(taught.activity, &taught.ius));
    // Where nobody moves to and fro there are no strokes.
    of_all.filter(|measured| measured.values.last().is_some_and(|most| *most > 0.0)).collect()
}

fn version(made: &Made, job: &str, file: &JobFile) -> Version {
    let hash = hash_of(file);
    Version {
        has_report: made.report_of(job, &hash).is_file(),
        hash,
        date: file.provenance.date.clone(),
        runs: file.provenance.sources.iter().filter(|source| !source.left_out).count(),
        steps: file.steps.len(),
    }
}

/// Answers until the role has ended.
fn serve(made: &Made, fetches: &Receiver<Fetch>) {
    for fetch in fetches {
        let response = response(made, &fetch.file);
        fetch.answer(response.unwrap_or_else(|| Response::text(404, "there is no such file, or not yet\n")));
    }
}

/// What a browser gets; `None` where there is no such file.
fn response(made: &Made, file: &MadeFile) -> Option<Response> {
    Some(match file {
        MadeFile::Report(job) => {
            let style = format!("<link rel=\"stylesheet\" href=\"/engineer/made/report.css?at={job}\">");
            let (page, _) = report(made, job)?;
            Response::ok("text/html; charset=utf-8", page.replacen("<body>", &(style + "<body>"), 1))
        }
        MadeFile::Style(job) => {
            let (_, style) = report(made, job)?;
            Response::ok("text/css; charset=utf-8", style)
        }
        MadeFile::Station(name) => {
            let path = made.stations().into_iter().find(|path| stem(path) == *name)?;
            Response::ok("text/plain; charset=utf-8", read(&path)?)
        }
        MadeFile::Markers => Response::ok("application/pdf", read(&made.markers_pdf())?),
        MadeFile::Seen => Response::ok("image/jpeg", read(&made.seen())?),
        MadeFile::Calibrated => Response::ok("image/jpeg", read(&made.calibrated())?),
    })
}

/// The report of a job, or with a dot and its hash of one of its versions, without its styles, and these. The policy of the board takes no style in a
/// page; the picture in a report has one as well.
fn report(made: &Made, job: &str) -> Option<(String, String)> {
    // A name of another form is that of no job, and would be a path.
    let (name, hash) = job.rsplit_once('.').filter(|(_, hash)| is_hash(hash)).unwrap_or((job, ""));
    let name = Some(name).filter(|name| is_name(name))?;
    let path = if hash.is_empty() { made.report(name) } else { made.report_of(name, hash) };
    let text = String::from_utf8(read(&path)?).ok()?;
    let (mut page, mut styles) = (String::new(), String::new());
    let mut rest = text.as_str();
    while let Some((before, from)) = rest.split_once(STYLE[0]) {
        let (style, after) = from.split_once(STYLE[1])?;
        page += before;
        styles += style;
        rest = after;
    }
    Some((page + rest, styles))
}

fn read(path: &Path) -> Option<Vec<u8>> {
    file::read_up_to(path, LARGEST).ok()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_job_file_with_a_fault_is_shown_with_the_versions_that_can_be_put_back_and_with_what_helps() {
        let folder = tempfile::tempdir().unwrap();
        let mut config = Config::default();
        config.executor.path = Some(folder.path().into());
        config.station.jobs = folder.path().join("jobs");
        let made = Made::new(&config);
        made.folders().iter().for_each(|folder| std::fs::create_dir_all(folder).unwrap());
        std::fs::write(made.job("polish"), "no job").unwrap();
        let known = job(&made, &made.job("polish"));
        assert!(known.fault.ends_with("; teach a job of this name in its place"), "{}", known.fault);
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/jobs/polish-and-measure.toml");
        let hash = hash_of(&jobs::read(&shipped).unwrap());
        std::fs::copy(shipped, made.version("polish", &hash)).unwrap();
        let known = job(&made, &made.job("polish"));
        assert_eq!(known.earlier.iter().map(|version| &version.hash).collect::<Vec<_>>(), [&hash]);
        assert!(known.fault.contains("put back an earlier version, or teach"), "{}", known.fault);
    }

    #[test]
    fn a_report_is_served_with_its_style_apart_and_no_name_leads_out_of_its_folder() {
        let folder = tempfile::tempdir().unwrap();
        let mut config = Config::default();
        config.executor.path = Some(folder.path().into());
        let made = Made::new(&config);
        std::fs::create_dir(folder.path().join("reports")).unwrap();
        let page =
            "<html><style>h1{color:red}</style><body>steps<svg><style>.a{}</style></svg></body></html>";
        std::fs::write(made.report("polish"), page).unwrap();
        std::fs::write(folder.path().join("secret.html"), page).unwrap();
        let (page, style) = report(&made, "polish").unwrap();
        assert_eq!(page, "<html><body>steps<svg></svg></body></html>");
        assert_eq!(style, "h1{color:red}.a{}");
        std::fs::copy(made.report("polish"), made.report_of("polish", "0123456789abcdef")).unwrap();
        assert!(report(&made, "polish.0123456789abcdef").is_some());
        let long = "x".repeat(56);
        std::fs::copy(made.report("polish"), made.report_of(&long, "0123456789abcdef")).unwrap();
        assert!(report(&made, &format!("{long}.0123456789abcdef")).is_some());
        for name in [
            "",
            "other",
            "../secret",
            "..",
            ".0123456789abcdef",
            "polish.0123456789abcdeg",
            "../secret.0123456789abcdef",
        ] {
            assert!(report(&made, name).is_none(), "{name}");
        }
    }
}
