//! A command to the judge of a running station, and its answer.

use std::time::{Duration, Instant};

use andon_ipc::{MonotonicTime, Node, Reader, Wake, Writer};
use shm_schemas::{Command, CommandSource, Judging, Refusal};

use super::ToolError;

/// A judge that runs answers within one couple.
const PATIENCE: Duration = Duration::from_secs(5);
/// A judge that was just starting has not heard the first one.
const AGAIN: Duration = Duration::from_millis(250);

/// What the judge answers, and how it is then; `None` where it does not answer. The command is what `fill` makes of an empty one; it is sent
/// until it is answered.
///
/// # Errors
/// The station's shared memory.
pub(super) fn tell(
    node: &Node,
    fill: impl Fn(&mut Command),
) -> Result<Option<(Refusal, Judging)>, ToolError> {
    let mut judging: Reader<Judging> = node.reader()?;
    let mut commands: Writer<Command> = node.writer()?;
    // Those of the PLC count from its starts: they have other numbers in the upper half for thousands of years.
    let number = MonotonicTime::now().nanoseconds() | 1 << 63;
    let (began, mut sent) = (Instant::now(), None::<Instant>);
    while began.elapsed() < PATIENCE {
        if sent.is_none_or(|at| at.elapsed() >= AGAIN) {
            let mut message = commands.loan()?;
            fill(&mut message);
            (message.number, message.source) = (number, CommandSource::Tool.code());
            commands.send(message)?;
            sent = Some(Instant::now());
        }
        if node.wait(&mut [&mut commands, &mut judging], AGAIN)? == Wake::Stop {
            break;
        }
        while let Some(state) = judging.take()? {
            if state.command == number {
                return Ok(Refusal::try_from(state.refusal).ok().map(|refusal| (refusal, *state)));
            }
        }
    }
    Ok(None)
}
