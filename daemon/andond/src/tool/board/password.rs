//! A password, from a person or from a program. It is never an argument: every user of the machine can read those.

use std::io::{self, BufRead as _, IsTerminal as _, Write as _};

use rustix::termios::{LocalModes, OptionalActions, tcgetattr, tcsetattr};

use super::super::ToolError;

/// Asks a person twice, without showing what they type; else reads a line of the standard input.
///
/// # Errors
/// That nothing can be read, or that the two are not the same.
pub(super) fn read(name: &str) -> Result<String, ToolError> {
    let failed = ToolError::Password;
    if !io::stdin().is_terminal() {
        return line().map_err(failed);
    }
    let first = unseen(&format!("password of {name}: ")).map_err(failed)?;
    let second = unseen("the same again: ").map_err(failed)?;
    match first == second {
        true => Ok(first),
        false => Err(failed(io::Error::other("the two are not the same"))),
    }
}

fn unseen(question: &str) -> io::Result<String> {
    eprint!("{question}");
    io::stderr().flush()?;
    let stdin = io::stdin();
    let shown = tcgetattr(&stdin)?;
    let mut hidden = shown.clone();
    hidden.local_modes -= LocalModes::ECHO;
    tcsetattr(&stdin, OptionalActions::Flush, &hidden)?;
    let read = line();
    tcsetattr(&stdin, OptionalActions::Flush, &shown)?;
    eprintln!();
    read
}

fn line() -> io::Result<String> {
    let mut line = String::new();
    io::stdin().lock().read_line(&mut line)?;
    Ok(line.trim_end_matches(['\r', '\n']).to_owned())
}
