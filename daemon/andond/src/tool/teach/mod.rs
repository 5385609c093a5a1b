//! `andond teach`: from recordings of correct runs to a job file. The same recordings give the same bytes, whether they were given at once
//! or one after the other (`--add`, `--without`).

mod sources;

pub use sources::SourceError;

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{SystemTime, UNIX_EPOCH};

use andon_core::config::Method;
use andon_core::input::Space;
use andon_learn::analysis::draw_order;
use andon_learn::digest::sha256_hex;
use andon_learn::job_file::JobFile;
use andon_learn::recording as learn;
use andon_learn::rule::ThresholdRule;
use andon_learn::run::Run;
use andon_learn::strictness::Strictness;
use andon_learn::teach::{TeachOptions, teach};

use super::{ToolError, cannot_write, check_writable, each_frame, job, load_config_for};
use crate::atomic;
use crate::cli::{self, Teach};
use crate::compatibility::Misfit;
use crate::config::Config;
use crate::exit::Code;
use crate::recording::Recording;
use sources::{Wanted, file_name};

/// Share of correct executions that may be accused under the rule `conformal`.
const FALSE_ALARMS: f64 = 0.01;

/// Runs the command.
///
/// # Errors
/// What is missing or damaged, an existing file, or why nothing can be learned.
pub fn run(arguments: &Teach) -> Result<Code, ToolError> {
    let is_changed = !(arguments.add.is_empty() && arguments.without.is_empty());
    if arguments.out.exists() && !is_changed && !arguments.force {
        return Err(ToolError::Exists(arguments.out.clone()));
    }
    let before = is_changed.then(|| job::load(&arguments.out)).transpose()?;
    for file in [Some(&arguments.out), arguments.plot.as_ref()].into_iter().flatten() {
        check_writable(file)?;
    }
    let recordings = recordings(arguments, before.as_ref())?;
    let config = load_config_for(&arguments.config, &recordings, Config::load_to_learn)?;
    let options = options(arguments, before.as_ref(), &recordings, &config)?;
    let runs = read_runs(&recordings, &config, &options.method)?;
    let (job, report) = teach(&runs, &options)?;
    println!("{report}");
    if let Some(plot) = &arguments.plot {
        let picture = draw_order(&job, report.rejected.as_deref());
        std::fs::write(plot, picture).map_err(cannot_write(plot))?;
        println!("drawn: {}", plot.display());
    }
    if !report.is_trusted() && !arguments.force {
        println!("not written: {}; --force writes it all the same", arguments.out.display());
        return Ok(Code::Declined);
    }
    atomic::write(&arguments.out, job.to_toml().as_bytes()).map_err(cannot_write(&arguments.out))?;
    println!("written: {}", arguments.out.display());
    Ok(Code::Stopped)
}

/// What to teach from: what was given, or what an existing job was taught from, with the changes that are asked for.
fn recordings(arguments: &Teach, before: Option<&JobFile>) -> Result<Vec<PathBuf>, ToolError> {
    let Teach { out, recordings, add, without, .. } = arguments;
    Ok(match before {
        Some(job) => Wanted { path: out, job, recordings, add, without }.find()?,
        None => recordings.clone(),
    })
}

/// How to teach: as the existing job was taught, and as the arguments say otherwise.
fn options(
    arguments: &Teach,
    before: Option<&JobFile>,
    recordings: &[PathBuf],
    config: &Config,
) -> Result<TeachOptions, ToolError> {
    let space = common_space(recordings, config)?;
    let mut options = match before {
        Some(job) => TeachOptions::of_job(job, &today()),
        None => TeachOptions::new(&stem(&arguments.out), &today(), Method { space, ..config.method() }),
    };
    if options.method.space != space {
        let (job, recording) = (options.method.space, space);
        return Err(ToolError::Misfit {
            path: arguments.out.clone(),
            misfit: Misfit::Space { job, recording },
        });
    }
    options.try_runs = true;
    options.id = arguments.id.unwrap_or(options.id);
    options.order_matters = arguments.order.or(options.order_matters);
    if let Some(name) = &arguments.name {
        options.name.clone_from(name);
    }
    if let Some(cost) = arguments.cost {
        options.cost = cost.local(options.method.bins);
    }
    if let Some(rule) = arguments.rule {
        options.rule = match rule {
            cli::ThresholdRule::Paper => ThresholdRule::PAPER,
            cli::ThresholdRule::LeaveOneOut => ThresholdRule::default(),
            cli::ThresholdRule::Conformal => ThresholdRule::Conformal { false_alarms: FALSE_ALARMS },
        };
    }
    Ok(match arguments.strictness.and_then(Strictness::new) {
        Some(strictness) => options.with_strictness(strictness),
        None => options,
    })
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_else(|| "job".into())
}

/// The date in UTC, for the provenance of the job.
fn today() -> String {
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    jiff::Timestamp::from_second(since_1970.as_secs() as i64)
        .map(|now| now.strftime("%Y-%m-%d").to_string())
        .unwrap_or_default()
}

/// The space that all recordings share.
fn common_space(recordings: &[PathBuf], config: &Config) -> Result<Space, ToolError> {
    let mut space = None;
    for path in recordings {
        let own = Recording::open(path, config)?.header().space;
        if *space.get_or_insert(own) != own {
            return Err(ToolError::MixedSpaces(path.clone()));
        }
    }
    Ok(space.unwrap_or(config.method.space))
}

/// Reads the recordings, as many at a time as the machine has processors: each is decoded in a process of its own. They come in the order of
/// their names, whichever way they were given, so that the same recordings teach the same job.
fn read_runs(recordings: &[PathBuf], config: &Config, method: &Method) -> Result<Vec<Run>, ToolError> {
    let next = Mutex::new(0..recordings.len());
    let runs: Mutex<Vec<Option<Result<Run, ToolError>>>> =
        Mutex::new((0..recordings.len()).map(|_| None).collect());
    let work = || {
        // A poisoned lock means that another worker panicked, which ends the process anyway.
        while let Some(index) = next.lock().ok().and_then(|mut next| next.next()) {
            let run = read_run(&recordings[index], config, method);
            if let Ok(mut runs) = runs.lock() {
                runs[index] = Some(run);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from).min(recordings.len()) {
            scope.spawn(work);
        }
    });
    let mut runs: Vec<Run> =
        runs.into_inner().unwrap_or_default().into_iter().flatten().collect::<Result<_, _>>()?;
    runs.sort_by(|one, other| (&one.name, &one.sha256).cmp(&(&other.name, &other.sha256)));
    Ok(runs)
}

fn read_run(path: &Path, config: &Config, method: &Method) -> Result<Run, ToolError> {
    let mut recording = Recording::open(path, config)?;
    let mut frames = Vec::new();
    each_frame(&mut recording, path, |frame| {
        frames.push(frame);
        Ok(())
    })?;
    let refused = |source| ToolError::Read { path: path.into(), source, remedy: "let this user read it" };
    let sha256 = sha256_hex(&bytes_of(path).map_err(refused)?);
    let recording = learn::Recording { header: recording.header().clone(), frames, truncation: None };
    Run::new(&file_name(path), &sha256, &recording, method)
        .map_err(|source| ToolError::Run { path: path.into(), source })
}

/// The bytes that the hash of a recording covers: those of a file, or of the pictures of a folder one after the other.
fn bytes_of(path: &Path) -> std::io::Result<Vec<u8>> {
    if !path.is_dir() {
        return std::fs::read(path);
    }
    let mut files: Vec<_> =
        std::fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    files.sort();
    let mut bytes = Vec::new();
    for file in files.iter().filter(|file| file.is_file()) {
        bytes.extend(std::fs::read(file)?);
    }
    Ok(bytes)
}
