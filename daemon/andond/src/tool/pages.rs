//! `andond completions` and the hidden `andond man`: what clap makes of the command line for shells and for the package.

use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use andon_host::exit::Code;
use clap::Command;
use clap::builder::{Resettable, StyledStr};
use clap_mangen::Man;
use clap_mangen::roff::{Roff, bold, roman};

use super::{ToolError, cannot_write, write_together};
use crate::cli::{self, Completions, ManPages};

/// Prints the completions for a shell.
///
/// # Errors
/// That standard output is closed.
pub fn completions(arguments: &Completions) -> Result<Code, ToolError> {
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut shown(), "andond", &mut text);
    io::stdout().lock().write_all(&text).map_err(ToolError::Print)?;
    Ok(Code::Stopped)
}

/// The command line without what its help does not show: the completions would offer that.
fn shown() -> Command {
    let all = cli::command();
    let shown = all.get_subcommands().filter(|command| !command.is_hide_set());
    Command::new("andond").version(env!("CARGO_PKG_VERSION")).propagate_version(true).subcommands(shown)
}

/// Prints the table of exit codes.
///
/// # Errors
/// That standard output is closed.
pub fn exit_codes() -> Result<Code, ToolError> {
    io::stdout().lock().write_all(cli::exit_table().as_bytes()).map_err(ToolError::Print)?;
    Ok(Code::Stopped)
}

/// Writes a man page for andond, for each of its commands and for andond-video into a folder.
///
/// # Errors
/// That it cannot be written.
pub fn man(arguments: &ManPages) -> Result<Code, ToolError> {
    let folder = arguments.folder.as_path();
    fs::create_dir_all(folder).map_err(cannot_write(folder))?;
    let mut command = cli::command().disable_help_subcommand(true);
    command.build();
    let mut pages = vec![page(&command, None, folder)?];
    for subcommand in command.get_subcommands().filter(|command| !command.is_hide_set()) {
        pages.push(page(subcommand, Some(subcommand.get_name()), folder)?);
    }
    pages.push((folder.join("andond-video.1"), video().render().into_bytes()));
    write_together(pages.iter().map(|(path, page)| (path.as_path(), page.as_slice())))?;
    Ok(Code::Stopped)
}

/// The page of andond, or of one of its commands, and where it goes.
fn page(command: &Command, name: Option<&str>, folder: &Path) -> Result<(PathBuf, Vec<u8>), ToolError> {
    // Examples and exit codes have sections of their own.
    let none = || Resettable::<StyledStr>::Reset;
    let bare = command.clone().after_help(none()).after_long_help(none());
    let man = Man::new(bare).manual("Andon").source(concat!("andond ", env!("CARGO_PKG_VERSION")));
    let path = folder.join(man.get_filename());
    let mut page = Vec::new();
    man.render(&mut page).map_err(cannot_write(&path))?;
    match name {
        Some(name) => examples(name),
        None => exit_status(),
    }
    .to_writer(&mut page)
    .map_err(cannot_write(&path))?;
    Ok((path, page))
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

/// The page of the program that andond starts for cameras and films.
fn video() -> Roff {
    let version = concat!("andond ", env!("CARGO_PKG_VERSION"));
    let mut roff = Roff::new();
    roff.control("TH", ["andond-video", "1", "", version, "Andon"]);
    roff.control("SH", ["NAME"])
        .text([roman("andond-video - the part of andond that decodes and encodes pictures")]);
    roff.control("SH", ["SYNOPSIS"]).text([bold("andond-video"), roman(" run capture | check [-c FILE]...")]);
    roff.control("SH", ["DESCRIPTION"]).text([
        bold("andond"),
        roman(
            " starts this program for whatever needs a camera or a film. Nobody needs to start it by hand. \
             It is a program of its own, so that the other roles do not load the libraries for video and cameras.",
        ),
    ]);
    for (line, meaning) in [
        ("run capture", "is the role capture of a station; `andond run capture` turns itself into it."),
        (
            "check",
            "opens the camera or the recording of a configuration once and says what is wrong with it; part of `andond check`.",
        ),
        (
            "decode, watch, encode, stills",
            "serve andond over a pipe. Their form is no interface and may change.",
        ),
    ] {
        roff.control("TP", []).text([bold(line)]).text([roman(meaning)]);
    }
    roff.control("SH", ["EXIT STATUS"]).text([roman("That of andond.")]);
    roff.control("SH", ["SEE ALSO"]).text([
        bold("andond"),
        roman("(1), "),
        bold("andond-check"),
        roman("(1), "),
        bold("andond-look"),
        roman("(1)"),
    ]);
    roff
}

fn exit_status() -> Roff {
    let mut roff = Roff::new();
    roff.control("SH", ["EXIT STATUS"]);
    for (code, meaning) in cli::exit_codes() {
        roff.control("TP", []).text([bold(*code)]).text([roman(*meaning)]);
    }
    roff
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use clap_complete::Shell;

    #[test]
    fn completions_offer_what_the_help_shows_and_nothing_else() {
        for shell in [Shell::Bash, Shell::Fish, Shell::Zsh] {
            let mut text = Vec::new();
            clap_complete::generate(shell, &mut shown(), "andond", &mut text);
            let text = String::from_utf8(text).unwrap();
            for command in cli::command().get_subcommands() {
                let name = command.get_name();
                // As bash, fish and zsh have it.
                let ways = [format!("andond,{name})"), format!("-a \"{name}\""), format!("({name})\n")];
                let is_offered = ways.iter().any(|way| text.contains(way));
                assert_eq!(is_offered, !command.is_hide_set(), "{name} in {shell}");
            }
        }
    }
}
