//! `andond idle`: waits until no job is running, so that an upgrade or a restart disturbs nobody.

use std::time::{Duration, Instant};

use andon_ipc::{Heartbeat, Node, Reader, Wake};
use shm_schemas::{JudgePhase, Judging};

use super::join::join;
use super::{ToolError, running_config};
use crate::cli::Idle;

/// Exit code: a job is still running.
const BUSY: u8 = 1;

/// A judge that has said nothing for this long judges nothing.
const SILENCE: Duration = Duration::from_millis(4 * Heartbeat::PERIOD.as_millis() as u64);

/// Runs the command.
///
/// # Errors
/// That the station cannot be joined.
pub fn run(arguments: &Idle) -> Result<u8, ToolError> {
    let node = join(&running_config(&arguments.config)?.config)?;
    let is_idle = until_idle(&node, Duration::from_secs(arguments.timeout.into()))?;
    Ok(if is_idle { 0 } else { BUSY })
}

/// Waits until no job is running, for as long as that. Returns whether none is.
///
/// # Errors
/// The station's shared memory.
pub(super) fn until_idle(node: &Node, patience: Duration) -> Result<bool, ToolError> {
    let mut judge: Reader<Judging> = node.reader()?;
    let began = Instant::now();
    let mut heard = Instant::now();
    let mut is_running = true;
    loop {
        let wake = node.wait(&mut [&mut judge], Heartbeat::PERIOD)?;
        while let Some(judging) = judge.take()? {
            heard = Instant::now();
            is_running = judging.phase == JudgePhase::Running.code();
        }
        if !is_running || heard.elapsed() >= SILENCE {
            return Ok(true);
        }
        if wake == Wake::Stop || began.elapsed() >= patience {
            return Ok(false);
        }
    }
}
