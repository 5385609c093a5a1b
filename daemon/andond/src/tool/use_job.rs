//! `andond use`: loads a job into a running station. The judge does it, or says why not.

use std::time::{Duration, Instant};

use andon_host::atomic;
use andon_host::exit::Code;
use shm_schemas::{CommandKind, Refusal};

use super::idle::until_idle;
use super::join::join;
use super::tell::tell;
use super::{ToolError, job, running_config};
use crate::cli::Use;
use crate::compatibility;

/// How soon a job is asked for again where another one has begun in the meantime.
const AGAIN: Duration = Duration::from_millis(200);

/// Runs the command; it ends when the judge has the job.
///
/// # Errors
/// A job that is not there or does not fit, a station that cannot be joined, and a judge that does not answer.
pub fn run(arguments: &Use) -> Result<Code, ToolError> {
    let config = running_config(&arguments.config)?.config;
    let job = job::one(&arguments.job, &config)?;
    compatibility::station(&job.file, &config)
        .map_err(|misfit| ToolError::Misfit { path: job.path.clone(), misfit })?;
    let node = join(&config)?;
    let (id, name, hash) = (job.file.id, &job.file.name, job.hash);
    let began = Instant::now();
    let patience = Duration::from_secs(arguments.when_idle.unwrap_or(0).into());
    let answer = loop {
        // Each refusal is kept in the journal, so it is asked for once no job is running.
        let left = patience.saturating_sub(began.elapsed());
        if !left.is_zero() {
            until_idle(&node, left)?;
        }
        let answer = tell(&node, |message| {
            message.kind = CommandKind::LoadJob.code();
            (message.job_id, message.model_hash) = (id, hash);
        })?;
        let is_busy = matches!(answer, Some((Refusal::Busy, _)));
        if !is_busy || began.elapsed() >= patience || node.stop().wait(AGAIN) {
            break answer;
        }
    };
    match answer {
        Some((Refusal::None, judging)) => {
            // What is said to be in force stays, whatever becomes of the role that has ordered it.
            if let Some(note) = &arguments.forget
                && let Err(error) = atomic::remove(note)
            {
                eprintln!("{}: {error}", note.display());
            }
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
        Refusal::Busy => " Wait for its end: andond use --when-idle 300 ...",
        Refusal::JobOfPlc => " Let it load this one.",
        Refusal::Ambiguous => " `andond jobs` lists them.",
        _ => "",
    }
}
