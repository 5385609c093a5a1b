//! `andond teach`: from recordings of correct runs to a job file.

use std::path::Path;
use std::sync::Mutex;
use std::time::{SystemTime, UNIX_EPOCH};

use andon_core::config::Method;
use andon_learn::digest::sha256_hex;
use andon_learn::recording as learn;
use andon_learn::rule::ThresholdRule;
use andon_learn::run::Run;
use andon_learn::teach::{TeachOptions, teach};

use super::{ToolError, cannot_write, check_writable, each_frame, load_config_to_learn};
use crate::atomic;
use crate::cli::{self, Teach};
use crate::config::Config;
use crate::exit::Code;
use crate::recording::Recording;

/// Share of correct executions that may be accused under the rule `conformal`.
const FALSE_ALARMS: f64 = 0.01;

/// Runs the command.
///
/// # Errors
/// What is missing or damaged, a file that is there already, or why nothing can be learned.
pub fn run(arguments: &Teach) -> Result<Code, ToolError> {
    let config = load_config_to_learn(&arguments.config)?;
    if arguments.out.exists() && !arguments.force {
        return Err(ToolError::Exists(arguments.out.clone()));
    }
    check_writable(&arguments.out)?;
    let method = common_method(&arguments.recordings, &config)?;
    let runs = read_runs(&arguments.recordings, &config, &method)?;
    let name = arguments.name.clone().unwrap_or_else(|| stem(&arguments.out));
    let mut options = TeachOptions::new(&name, &today(), method);
    options.id = arguments.id;
    options.order_matters = arguments.order;
    options.try_runs = true;
    if let Some(cost) = arguments.cost {
        options.cost = cost.local(method.bins);
    }
    if let Some(rule) = arguments.rule {
        options.rule = match rule {
            cli::ThresholdRule::Paper => ThresholdRule::PAPER,
            cli::ThresholdRule::LeaveOneOut => TeachOptions::new(&name, "", method).rule,
            cli::ThresholdRule::Conformal => ThresholdRule::Conformal { false_alarms: FALSE_ALARMS },
        };
    }
    let (job, report) = teach(&runs, &options)?;
    println!("{report}");
    if !report.is_trusted() && !arguments.force {
        println!("not written: {}; --force writes it all the same", arguments.out.display());
        return Ok(Code::Declined);
    }
    atomic::write(&arguments.out, job.to_toml().as_bytes()).map_err(cannot_write(&arguments.out))?;
    println!("written: {}", arguments.out.display());
    Ok(Code::Stopped)
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

/// The constants of the method in the space that all recordings share.
fn common_method(recordings: &[impl AsRef<Path>], config: &Config) -> Result<Method, ToolError> {
    let mut space = None;
    for path in recordings {
        let recording = Recording::open(path.as_ref(), config)?;
        let own = recording.header().space;
        if *space.get_or_insert(own) != own {
            return Err(ToolError::MixedSpaces(path.as_ref().into()));
        }
    }
    Ok(Method { space: space.unwrap_or(config.method.space), ..config.method() })
}

/// Reads the recordings, as many at a time as the machine has processors: each is decoded in a process of its own.
fn read_runs(
    recordings: &[std::path::PathBuf],
    config: &Config,
    method: &Method,
) -> Result<Vec<Run>, ToolError> {
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
    runs.into_inner().unwrap_or_default().into_iter().flatten().collect()
}

fn read_run(path: &Path, config: &Config, method: &Method) -> Result<Run, ToolError> {
    let mut recording = Recording::open(path, config)?;
    let mut frames = Vec::new();
    each_frame(&mut recording, path, |frame| {
        frames.push(frame);
        Ok(())
    })?;
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let refused = |source| ToolError::Read { path: path.into(), source, remedy: "let this user read it" };
    let sha256 = sha256_hex(&bytes_of(path).map_err(refused)?);
    let recording = learn::Recording { header: recording.header().clone(), frames, truncation: None };
    Run::new(&name, &sha256, &recording, method)
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
