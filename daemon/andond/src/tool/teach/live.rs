//! `andond teach --live`: the job is shown at the bench, run after run. It says what to do and what it has seen, and each run is kept or dropped.
//!
//! It talks over standard input and standard error, one line at a time, so that it works in a terminal and over a pipe. A run that is kept is a
//! track file beside the job file, where `--add` and `--without` find it again.

use std::io::BufRead as _;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use andon_core::config::Method;
use andon_host::atomic::folder_of;
use andon_host::config::Config;
use andon_learn::run::Run;
use andon_learn::run_summary::RunSummary;
use shm_schemas::Showing as Shown;
use tempfile::NamedTempFile;

use super::bench::{Bench, Event};
use crate::cli::Teach;
use crate::recorder::{Recorder, header};
use crate::tool::runs::file_name;
use crate::tool::{ToolError, cannot_write};

/// What can be answered when a run was shown.
const QUESTION: &str = "  Enter keeps it; d drops it; t keeps it and teaches now; q gives up";

/// What is asked for before each run.
const ASKED: &str = "show the whole job once; press Enter when the bench is as at the start";

/// Lets the job be shown. Returns the track files of the runs that were kept; `None` where nothing is to be taught.
///
/// # Errors
/// A station or a camera that does not come up, and a file that cannot be written.
pub(super) fn show(arguments: &Teach, config: &Config) -> Result<Option<Vec<PathBuf>>, ToolError> {
    let mut bench = Bench::open(config)?;
    say(&bench.first_look(config)?);
    let mut showing = Showing { config, out: &arguments.out, kept: Vec::new(), input: Input::open() };
    let end = showing.runs(&mut bench, arguments.count)?;
    // What comes now takes a while, and can be interrupted as any program.
    bench.close();
    let kept = showing.kept;
    match (end, kept.is_empty()) {
        (End::Teach, false) => return Ok(Some(kept)),
        (End::Teach, true) => say("no run was kept: nothing is taught"),
        (End::GivenUp, true) => say("given up: nothing is taught"),
        (End::GivenUp, false) => say(&format!(
            "given up: nothing is taught. The runs that were kept are there: andond teach {} --out {}",
            kept.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(" "),
            arguments.out.display()
        )),
    }
    Ok(None)
}

fn say(line: &str) {
    eprintln!("{line}");
}

/// How far the showing is after this line of it, for a program that answers in the place of a person.
pub(crate) fn showing_after(line: &str, before: Option<Shown>) -> Option<Shown> {
    match line {
        QUESTION => Some(Shown::Keep),
        line if line.starts_with("run ") && line.ends_with(ASKED) => Some(Shown::Run),
        _ => before,
    }
}

/// How the showing ends.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    Teach,
    GivenUp,
}

/// What comes after a run.
enum Next {
    /// Another one, if some are still wanted.
    Run,
    End(End),
}

struct Showing<'a> {
    config: &'a Config,
    out: &'a Path,
    kept: Vec<PathBuf>,
    input: Input,
}

impl Showing<'_> {
    fn runs(&mut self, bench: &mut Bench, count: u16) -> Result<End, ToolError> {
        while self.kept.len() < usize::from(count) {
            let number = self.kept.len() + 1;
            bench.forget()?;
            say(&format!("run {number} of {count}: {ASKED}"));
            if let Next::End(end) = self.one_run(bench, number)? {
                return Ok(end);
            }
        }
        Ok(End::Teach)
    }

    fn one_run(&mut self, bench: &mut Bench, number: usize) -> Result<Next, ToolError> {
        let part = self.new_part()?;
        let mut recorder =
            Recorder::new(part.reopen().map_err(cannot_write(self.out))?, self.out, header(self.config))?;
        let lost_before = bench.lost();
        // A film that has come to its end has nothing more to show.
        let mut is_last = false;
        loop {
            match bench.next_event()? {
                Event::Frame(frame) => {
                    if !recorder.write(*frame)? {
                        // The film of the station begins again.
                        break;
                    }
                }
                Event::End => {
                    is_last = true;
                    break;
                }
                Event::Stop => return Ok(Next::End(End::GivenUp)),
                Event::Nothing => {}
            }
            match self.input.line() {
                None => {}
                Some(Typed::Text(text)) if text == "q" => return Ok(Next::End(End::GivenUp)),
                Some(Typed::Text(text)) if text == "d" => return Ok(Next::Run),
                Some(Typed::Text(_)) => {
                    // What came before the answer belongs to the run.
                    while let Some(Event::Frame(frame)) = bench.waiting()? {
                        recorder.write(*frame)?;
                    }
                    break;
                }
                // A run that nobody has ended does not count.
                Some(Typed::End) => return Ok(Next::End(End::Teach)),
            }
        }
        recorder.finish()?;
        let lost = bench.lost() - lost_before;
        let next = if self.describe(part.path(), number, lost)? { self.ask(bench, part)? } else { Next::Run };
        Ok(if is_last && matches!(next, Next::Run) { Next::End(End::Teach) } else { next })
    }

    /// A file that becomes a track file if the run is kept, and is gone otherwise.
    fn new_part(&self) -> Result<NamedTempFile, ToolError> {
        tempfile::Builder::new()
            .prefix(".andon-")
            .permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666))
            .tempfile_in(folder_of(self.out))
            .map_err(cannot_write(self.out))
    }

    /// Says in one line what was seen in a run. False where there is nothing to learn from.
    fn describe(&self, part: &Path, number: usize, lost: u64) -> Result<bool, ToolError> {
        let unread =
            |source| ToolError::Read { path: part.into(), source, remedy: "make room in this folder" };
        let bytes = std::fs::read(part).map_err(unread)?;
        let method = Method { space: self.config.method.space, ..self.config.method() };
        let name = format!("run {number}");
        let run = Run::read(&name, &bytes, &method)
            .map_err(|source| ToolError::Run { path: name.clone().into(), source })?;
        let summary = RunSummary::of(&run, &method);
        let lost = if lost > 0 {
            format!("; {lost} frames were lost, because the machine is too busy")
        } else {
            String::new()
        };
        say(&format!("  {name}: {summary}{lost}"));
        if summary.steps.is_empty() {
            say("  not kept: there is nothing to learn from it");
        }
        Ok(!summary.steps.is_empty())
    }

    /// Asks whether a run is kept.
    fn ask(&mut self, bench: &mut Bench, part: NamedTempFile) -> Result<Next, ToolError> {
        say(QUESTION);
        loop {
            if matches!(bench.next_event()?, Event::Stop) {
                return Ok(Next::End(End::GivenUp));
            }
            let Some(line) = self.input.line() else { continue };
            match line {
                Typed::Text(text) => match text.as_str() {
                    "" | "k" => self.keep(part)?,
                    "d" => say("  dropped"),
                    "t" => {
                        self.keep(part)?;
                        return Ok(Next::End(End::Teach));
                    }
                    "q" => return Ok(Next::End(End::GivenUp)),
                    _ => {
                        say(QUESTION);
                        continue;
                    }
                },
                Typed::End => {
                    say("  dropped, because nobody has kept it");
                    return Ok(Next::End(End::Teach));
                }
            }
            return Ok(Next::Run);
        }
    }

    /// Gives a run the first name beside the job file that is free.
    fn keep(&mut self, mut part: NamedTempFile) -> Result<(), ToolError> {
        let stem = self.out.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        for number in 1_u32.. {
            let path = self.out.with_file_name(format!("{stem}-run{number}.tracks.jsonl"));
            match part.persist_noclobber(&path) {
                Ok(_) => {
                    say(&format!("  kept as {}", file_name(&path)));
                    self.kept.push(path);
                    break;
                }
                Err(failed) if failed.error.kind() == std::io::ErrorKind::AlreadyExists => part = failed.file,
                Err(failed) => return Err(cannot_write(&path)(failed.error)),
            }
        }
        Ok(())
    }
}

/// What a person answers.
enum Typed {
    Text(String),
    /// Nobody answers any more.
    End,
}

/// The lines of standard input, read by a thread of their own: the bench goes on meanwhile.
struct Input(Receiver<String>);

impl Input {
    fn open() -> Self {
        let (sender, receiver) = channel();
        // It ends with the process, or when nobody listens any more.
        std::thread::spawn(move || {
            let lines = std::io::stdin().lock().lines().map_while(Result::ok);
            lines.map(|line| line.trim().to_lowercase()).try_for_each(|line| sender.send(line))
        });
        Self(receiver)
    }

    /// The next line, if there is one.
    fn line(&self) -> Option<Typed> {
        match self.0.recv_timeout(Duration::ZERO) {
            Ok(text) => Some(Typed::Text(text)),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => Some(Typed::End),
        }
    }
}
