//! `andond part`: tells the judge which part comes next, for a scanner or a person.

use std::time::{Duration, Instant};

use andon_ipc::{MonotonicTime, Node, Reader, Wake, Writer};
use shm_schemas::{BadPart, Command, CommandKind, CommandSource, Judging, PartId, Refusal};

use super::join::join;
use super::{ToolError, load_config};
use crate::cli::Part;
use crate::exit::Code;

/// A judge that runs answers within one couple.
const PATIENCE: Duration = Duration::from_secs(5);
/// A judge that was just starting has not heard the first one.
const AGAIN: Duration = Duration::from_millis(250);

/// Runs the command; it ends when the judge has the id.
///
/// # Errors
/// An id that is none, a station that cannot be joined, and a judge that refuses or does not answer.
pub fn run(arguments: &Part) -> Result<Code, ToolError> {
    let part = part_id("ID", &arguments.id)?;
    let node = join(&load_config(&arguments.config)?)?;
    match tell(&node, part)? {
        Some(Refusal::None) => Ok(Code::Stopped),
        Some(refusal) => Err(ToolError::PartRefused(refusal.meaning())),
        None => Err(ToolError::PartRefused("The judge does not answer: see `andond status`.")),
    }
}

/// The part id that was given for this option.
pub(super) fn part_id(option: &'static str, given: &str) -> Result<PartId, ToolError> {
    PartId::new(given.as_bytes()).map_err(|bad| {
        let expected = match bad {
            BadPart::TooLong => "give at most 32 characters",
            BadPart::NotPrintable(_) => "give ASCII letters, digits and punctuation",
        };
        ToolError::Option { option, given: given.to_owned(), expected }
    })
}

/// Sends the command until it is answered; `None` where it is not.
fn tell(node: &Node, part: PartId) -> Result<Option<Refusal>, ToolError> {
    let mut judging: Reader<Judging> = node.reader()?;
    let mut commands: Writer<Command> = node.writer()?;
    // Those of the PLC count from its starts: they have other numbers in the upper half for thousands of years.
    let number = MonotonicTime::now().nanoseconds() | 1 << 63;
    let (began, mut sent) = (Instant::now(), None::<Instant>);
    while began.elapsed() < PATIENCE {
        if sent.is_none_or(|at| at.elapsed() >= AGAIN) {
            let mut message = commands.loan()?;
            (message.number, message.kind) = (number, CommandKind::SetPart.code());
            (message.source, message.part) = (CommandSource::Tool.code(), part);
            commands.send(message)?;
            sent = Some(Instant::now());
        }
        if node.wait(&mut [&mut commands, &mut judging], AGAIN)? == Wake::Stop {
            break;
        }
        while let Some(state) = judging.take()? {
            if state.command == number {
                return Ok(Refusal::try_from(state.refusal).ok());
            }
        }
    }
    Ok(None)
}
