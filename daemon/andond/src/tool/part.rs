//! `andond part`: tells the judge which part comes next, for a scanner or a person.

use andon_host::exit::Code;
use shm_schemas::{BadPart, CommandKind, PartId, Refusal};

use super::join::join;
use super::tell::tell;
use super::{ToolError, load_config};
use crate::cli::Part;

/// Runs the command; it ends when the judge has the id.
///
/// # Errors
/// An invalid id, a station that cannot be joined, and a judge that refuses or does not answer.
pub fn run(arguments: &Part) -> Result<Code, ToolError> {
    let part = part_id("ID", &arguments.id)?;
    let node = join(&load_config(&arguments.config)?)?;
    let answer = tell(&node, |message| (message.kind, message.part) = (CommandKind::SetPart.code(), part))?;
    match answer.map(|(refusal, _)| refusal) {
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
