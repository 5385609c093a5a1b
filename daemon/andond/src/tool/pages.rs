//! `andond completions` and the hidden `andond man`: what clap makes of the command line for shells and for the package.

use std::fs;
use std::io::{self, Write as _};
use std::path::Path;

use clap::Command;
use clap::builder::{Resettable, StyledStr};
use clap_mangen::Man;
use clap_mangen::roff::{Roff, bold, roman};

use super::{ToolError, cannot_write};
use crate::cli::{self, Completions, ManPages};
use crate::exit::Code;

/// Prints the completions for a shell.
///
/// # Errors
/// That standard output is closed.
pub fn completions(arguments: &Completions) -> Result<Code, ToolError> {
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut cli::command(), "andond", &mut text);
    io::stdout().lock().write_all(&text).map_err(ToolError::Print)?;
    Ok(Code::Stopped)
}

/// Writes a man page for andond and for each of its commands into a folder.
///
/// # Errors
/// That it cannot be written.
pub fn man(arguments: &ManPages) -> Result<Code, ToolError> {
    let folder = arguments.folder.as_path();
    fs::create_dir_all(folder).map_err(cannot_write(folder))?;
    let mut command = cli::command().disable_help_subcommand(true);
    command.build();
    write(&command, None, folder)?;
    for subcommand in command.get_subcommands().filter(|command| !command.is_hide_set()) {
        write(subcommand, Some(subcommand.get_name()), folder)?;
    }
    Ok(Code::Stopped)
}

/// Writes the page of andond, or of one of its commands.
fn write(command: &Command, name: Option<&str>, folder: &Path) -> Result<(), ToolError> {
    // Examples and exit codes have sections of their own.
    let none = || Resettable::<StyledStr>::Reset;
    let bare = command.clone().after_help(none()).after_long_help(none());
    let man = Man::new(bare).manual("Andon").source(concat!("andond ", env!("CARGO_PKG_VERSION")));
    let path = folder.join(man.get_filename());
    let mut page = Vec::new();
    man.render(&mut page).map_err(cannot_write(&path))?;
    match name {
        Some(name) => examples(name),
        None => exit_codes(),
    }
    .to_writer(&mut page)
    .map_err(cannot_write(&path))?;
    fs::write(&path, page).map_err(cannot_write(&path))
}

fn examples(name: &str) -> Roff {
    let mut roff = Roff::new();
    roff.control("SH", ["EXAMPLES"]);
    for (what, line) in cli::examples(name) {
        if !what.is_empty() {
            roff.control("PP", []).text([roman(*what)]);
        }
        roff.control("PP", []).control("RS", ["4"]).control("nf", []);
        roff.text([bold(*line)]).control("fi", []).control("RE", []);
    }
    roff
}

fn exit_codes() -> Roff {
    let mut roff = Roff::new();
    roff.control("SH", ["EXIT STATUS"]);
    for (code, meaning) in cli::exit_codes() {
        roff.control("TP", []).text([bold(*code)]).text([roman(*meaning)]);
    }
    roff
}
