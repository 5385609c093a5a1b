//! `andond use`: loads a job into a running station. The judge does it, or says why not.

use std::path::Path;

use shm_schemas::{CommandKind, Refusal};

use super::jobs::{FoundJob, of_station};
use super::join::join;
use super::tell::tell;
use super::{ToolError, job, running_config};
use crate::cli::Use;
use crate::compatibility;
use crate::config::Config;
use crate::exit::Code;

/// Runs the command; it ends when the judge has the job.
///
/// # Errors
/// A job that is not there or does not fit, a station that cannot be joined, and a judge that does not answer.
pub fn run(arguments: &Use) -> Result<Code, ToolError> {
    let config = running_config(&arguments.config)?.config;
    let job = find(&arguments.job, &config)?;
    compatibility::station(&job.file, &config)
        .map_err(|misfit| ToolError::Misfit { path: job.path.clone(), misfit })?;
    let node = join(&config)?;
    let (id, name, hash) = (job.file.id, &job.file.name, job.hash);
    let answer = tell(&node, |message| {
        message.kind = CommandKind::LoadJob.code();
        (message.job_id, message.model_hash) = (id, hash);
    })?;
    match answer {
        Some((Refusal::None, judging)) => {
            println!(
                "job {id} {name:?} of hash {hash:016x} is in force until another is loaded or the station ends"
            );
            if judging.is_enabled == 0 {
                println!("the PLC has not enabled the line: nothing is judged until it does");
            }
            Ok(Code::Stopped)
        }
        Some((refusal, _)) => {
            eprintln!("job {id} {name:?} was not loaded: {}{}", refusal.meaning(), remedy(refusal));
            Ok(Code::Declined)
        }
        None => Err(ToolError::NoAnswer),
    }
}

/// What to do about a refusal, where there is something.
fn remedy(refusal: Refusal) -> &'static str {
    match refusal {
        Refusal::Busy => " Wait for its end: andond idle && andond use ...",
        Refusal::JobOfPlc => " Let it load this one.",
        Refusal::Ambiguous => " `andond jobs` lists them.",
        _ => "",
    }
}

/// The job that was meant: a file, or else the one job of this number or name.
fn find(wanted: &str, config: &Config) -> Result<FoundJob, ToolError> {
    let found = of_station(config)?;
    let path = Path::new(wanted);
    let is_file = path.is_file();
    let given = is_file.then(|| job::load(path)).transpose()?.map(|file| (file.id, file.model_hash()));
    let is_meant = |job: &FoundJob| match given {
        Some(given) => given == (job.file.id, job.hash),
        None => job.file.name == wanted || wanted.parse() == Ok(job.file.id),
    };
    let (mut meant, others): (Vec<FoundJob>, Vec<FoundJob>) = found.jobs.into_iter().partition(is_meant);
    // Copies of one job are as good as each other.
    meant.dedup_by_key(|job| job.hash);
    if meant.len() > 1 {
        let files = meant.iter().map(|job| job.path.display().to_string()).collect();
        return Err(ToolError::SeveralJobs { wanted: wanted.to_owned(), files });
    }
    meant.pop().ok_or_else(|| match is_file {
        true => ToolError::ForeignJob { path: path.to_owned(), folder: config.station.jobs.clone() },
        false => ToolError::UnknownJob {
            wanted: wanted.to_owned(),
            folder: config.station.jobs.clone(),
            names: others.iter().map(|job| format!("{} {:?}", job.file.id, job.file.name)).collect(),
        },
    })
}
