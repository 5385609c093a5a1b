//! `andond teach`: from recordings of correct runs to a job file. The same recordings give the same bytes, whether they were given at once
//! or one after the other (`--add`, `--without`).

mod bench;
mod history;
mod live;
mod missing_parts;
mod next;
mod number;
mod pictures;
mod sources;

pub(crate) use live::showing_after;
pub use sources::SourceError;

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use andon_core::config::Method;
use andon_host::atomic::folder_of;
use andon_host::config::Config;
use andon_host::exit::Code;
use andon_learn::job_file::JobFile;
use andon_learn::rule::ThresholdRule;
use andon_learn::strictness::Strictness;
use andon_learn::teach::{TeachOptions, TeachReport, page, teach};
use andon_study::analysis::draw_order;

use super::runs::{common_space, read_runs};
use super::{
    ToolError, cannot_write, check_writable, job, load_config_for, load_config_to_learn, running_config,
    working, write_together,
};
use crate::cli::{self, Teach};
use crate::compatibility::Misfit;
use crate::step_pictures::StepPicture;
use crate::{role, step_pictures};
use history::Confirmed;
use sources::Wanted;

/// What is said where the job had pictures of its steps.
const WITHOUT_PICTURES: &str =
    "pictures: none; those of the job before were removed, and --pictures keeps some of this one\n";

/// Share of correct executions that may be accused under the rule `conformal`.
const FALSE_ALARMS: f64 = 0.01;

/// Runs the command.
///
/// # Errors
/// What is missing or damaged, an existing file, or why nothing can be learned.
pub fn run(arguments: &Teach) -> Result<Code, ToolError> {
    if let Some(name) =
        arguments.name.as_ref().filter(|name| name.trim().is_empty() || name.contains(char::is_control))
    {
        let expected = "a name has a letter, and stands on one line";
        return Err(ToolError::Option { option: "--name", given: name.clone(), expected });
    }
    // With runs of its history a job that is there is taught again.
    let is_taught_again = arguments.from_history && arguments.recordings.is_empty() && arguments.out.exists();
    let is_changed = !(arguments.add.is_empty() && arguments.without.is_empty()) || is_taught_again;
    let before = is_changed.then(|| job::load(&arguments.out)).transpose()?;
    make_folder(&arguments.out)?;
    for file in
        [Some(&arguments.out), arguments.plot.as_ref(), arguments.report.as_ref()].into_iter().flatten()
    {
        if file.exists() && !is_changed && !arguments.force {
            return Err(ToolError::Exists(file.clone()));
        }
        check_writable(file)?;
    }
    let confirmed = match arguments.from_history {
        true => history::of(&running_config(&arguments.config)?.config, &arguments.out, before.as_ref())?,
        false => Confirmed::default(),
    };
    let mut recordings = recordings(arguments, before.as_ref(), &confirmed.withdrawn)?;
    for run in confirmed.runs {
        if !recordings.iter().any(|known| known.file_name() == run.file_name()) {
            recordings.push(run);
        }
    }
    let config = match arguments.live {
        true => load_config_to_learn(&arguments.config)?,
        false => load_config_for(&arguments.config, &recordings)?,
    };
    if arguments.live {
        let Some(shown) = live::show(arguments, &config)? else { return Ok(Code::Declined) };
        recordings.extend(shown);
    }
    working("teach", || learn(arguments, before.as_ref(), &recordings, &config))
}

/// Teaches the job from these recordings, or teaches the one `before` again, and writes it.
fn learn(
    arguments: &Teach,
    before: Option<&JobFile>,
    recordings: &[PathBuf],
    config: &Config,
) -> Result<Code, ToolError> {
    let options = options(arguments, before, recordings, config)?;
    // In the order of their names, whichever way they were given, so that the same recordings teach the same job.
    let mut runs = read_runs(recordings, config, &options.method, &|| ())?;
    runs.sort_by(|one, other| (&one.name, &one.sha256).cmp(&(&other.name, &other.sha256)));
    for run in runs.iter().filter(|run| !run.shows_hands()) {
        eprintln!(
            "note: {} shows no hand, so it shows no work: is it the right recording, is the hand in view and lit, and is it named in \
             perception.hands?",
            run.name
        );
    }
    let missing = missing_parts::of(&runs);
    let (job, report) =
        teach(&runs, &options).map_err(|nothing| missing_parts::explain(&missing, recordings, nothing))?;
    // Before the report is printed: who reads its first line only, as with `head`, ends the process.
    let written = write(arguments, &job, &report).and_then(|said| {
        let is_written = report.is_trusted() || arguments.force;
        let pictures =
            if is_written { step_pictures(arguments, &job, recordings, config)? } else { String::new() };
        Ok(said + &pictures)
    });
    println!("{report}");
    if !missing.is_empty() {
        eprintln!(
            "note: the job was learned without all parts: {}",
            missing_parts::words(&missing, recordings)
        );
    }
    print!("{}", written?);
    if !(report.is_trusted() || arguments.force) {
        return Ok(Code::Declined);
    }
    for other in number::others_with(job.id, &arguments.out, config) {
        eprintln!(
            "note: {} has the number {} as well: only their hashes tell them apart",
            other.display(),
            job.id
        );
    }
    if before.is_none() {
        print!("{}", next::steps(arguments, &job, config));
    }
    Ok(Code::Stopped)
}

/// The first job of a station makes the folder of its jobs.
fn make_folder(out: &Path) -> Result<(), ToolError> {
    match std::fs::create_dir(folder_of(out)) {
        Err(error) if error.kind() != ErrorKind::AlreadyExists => Err(cannot_write(out)(error)),
        _ => Ok(()),
    }
}

/// Writes what was asked for, and says what was written. What cannot be trusted is only drawn and described.
fn write(arguments: &Teach, job: &JobFile, report: &TeachReport) -> Result<String, ToolError> {
    let (mut said, mut files) = (String::new(), Vec::new());
    if let Some(plot) = &arguments.plot {
        files.push((plot.as_path(), draw_order(job, report.rejected.as_deref())));
        said += &format!("drawn: {}\n", plot.display());
    }
    if let Some(path) = &arguments.report {
        files.push((path, page(report, &draw_order(job, report.rejected.as_deref()))));
        said += &format!("report: {}\n", path.display());
    }
    let out = arguments.out.display();
    if report.is_trusted() || arguments.force {
        files.push((&arguments.out, job.to_toml()));
        said += &format!("written: {out}, job {} {:?} of hash {:016x}\n", job.id, job.name, job.model_hash());
    } else {
        said += &format!("not written: {out}; --force writes it all the same\n");
    }
    write_together(files.iter().map(|(path, text)| (*path, text.as_bytes())))?;
    Ok(said)
}

/// Keeps a picture of each step where that is asked for, and none of the job that the file held before. Says how many there are.
fn step_pictures(
    arguments: &Teach,
    job: &JobFile,
    recordings: &[PathBuf],
    config: &Config,
) -> Result<String, ToolError> {
    let unwritten = |(path, error): (PathBuf, std::io::Error)| cannot_write(&path)(error);
    let found = arguments.pictures.then(|| pictures::of_steps(job, recordings, config));
    // Nobody would look for them again, and they show people at work.
    let before = step_pictures::beside(&arguments.out);
    before.iter().try_for_each(StepPicture::remove).map_err(unwritten)?;
    let Some(found) = found.transpose()? else {
        return Ok(String::from(if before.is_empty() { "" } else { WITHOUT_PICTURES }));
    };
    step_pictures::write(&arguments.out, job, &found).map_err(unwritten)?;
    let (count, all) = (found.iter().flatten().count(), found.len());
    let why = if count < all { "; they come only from films that the job is taught from" } else { "" };
    Ok(format!("pictures: of {count} of {all} steps, beside the job{why}\n"))
}

/// What to teach from: what was given, or what an existing job was taught from, with the changes that are asked for.
fn recordings(
    arguments: &Teach,
    before: Option<&JobFile>,
    withdrawn: &[String],
) -> Result<Vec<PathBuf>, ToolError> {
    let Teach { out, recordings, add, .. } = arguments;
    let without = &[arguments.without.as_slice(), withdrawn].concat();
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
    // A job that is taught again is still the same one to people and to the PLC.
    let there = role::read_job(&arguments.out).ok();
    options.id = arguments.id.unwrap_or_else(|| match &there {
        Some(job) => job.id,
        None => number::number_for(&arguments.out, config),
    });
    if let Some(job) = there {
        options.name = job.name;
    }
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
