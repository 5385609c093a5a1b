//! `andond install`: puts the file of a station where the units of the package look for it, makes the login of an engineer, and starts it.
//!
//! A station's file decides which devices, folders and ports its units use. So an administrator puts it there, and no page of a board does.

use std::ffi::{OsStr, OsString};
use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::Command;

use andon_host::atomic;
use andon_host::config::Config;
use andon_host::exit::Code;
use andon_learn::file;

use super::board::address;
use super::check::unit::{self, PACKAGED};
use super::check::{Unusable, neighbours};
use super::{ToolError, cannot_write};
use crate::cli::Install;

/// Runs the command.
///
/// # Errors
/// What is wrong with the file, that there is such a station already, and what a program of the system could not do.
pub fn run(arguments: &Install) -> Result<Code, ToolError> {
    if !rustix::process::geteuid().is_root() {
        return Err(ToolError::NotRoot);
    }
    let config = install(arguments, Path::new(PACKAGED), &mut call)?;
    for unseen in unit::unseen(&config, false) {
        println!("{unseen}");
    }
    println!("the station {} starts", config.station.name);
    if config.board.enable {
        println!("its board: {}/engineer", address(&config));
    }
    Ok(Code::Stopped)
}

fn install(
    arguments: &Install,
    packaged: &Path,
    call: &mut dyn FnMut(&[OsString]) -> Result<(), ToolError>,
) -> Result<Config, ToolError> {
    let base = packaged.join("andon.toml");
    let remedy = "`andond new --board` writes one";
    let unread = |source| ToolError::Read { path: arguments.file.clone(), source, remedy };
    let bytes = file::read(&arguments.file).map_err(unread)?;
    let mut config = Config::load(&[&base, &arguments.file])?;
    let name = config.station.name.clone();
    let own = packaged.join("stations").join(format!("{name}.toml"));
    if own.exists() {
        return Err(ToolError::Installed(own));
    }
    if let Some(engineer) = arguments.engineer.clone().filter(|_| !config.board.enable) {
        return Err(ToolError::Option {
            option: "--engineer",
            given: engineer,
            expected: "the file gives the station no board, as `andond new --board` does",
        });
    }
    let files = [base.clone(), own.clone()];
    config.files = files.to_vec();
    let shared = neighbours::faults(&config);
    if !shared.is_empty() {
        return Err(ToolError::Unusable(Unusable::of_files(shared)));
    }
    atomic::write(&own, &bytes).map_err(cannot_write(&own))?;
    // The user of the units reads it, whatever the mask of the administrator.
    fs::set_permissions(&own, Permissions::from_mode(0o644)).map_err(cannot_write(&own))?;
    if let Some(engineer) = &arguments.engineer
        && let Err(error) = call(&login(engineer, &base, &own))
    {
        // A station that nobody can teach is not left behind.
        let _ = fs::remove_file(&own);
        return Err(error);
    }
    // Whoever waits for the start waits for its camera as well.
    let start = ["systemctl", "enable", "--now", "--no-block"].map(OsString::from);
    call(&[start.as_slice(), &[format!("andon@{name}.target").into()]].concat())?;
    // What it names beside it lies beside the new place.
    Ok(Config::load(&files)?)
}

/// The command line that makes a login, as the user of the units: the file belongs to them.
fn login(engineer: &str, base: &Path, own: &Path) -> Vec<OsString> {
    let program = std::env::current_exe().unwrap_or_else(|_| "andond".into());
    let words: [&OsStr; 14] = [
        "runuser".as_ref(),
        "-u".as_ref(),
        "andon".as_ref(),
        "--".as_ref(),
        program.as_ref(),
        "board".as_ref(),
        "login".as_ref(),
        "--role=engineer".as_ref(),
        "-c".as_ref(),
        base.as_ref(),
        "-c".as_ref(),
        own.as_ref(),
        // A name may begin like an option.
        "--".as_ref(),
        engineer.as_ref(),
    ];
    words.map(OsStr::to_owned).into()
}

/// Runs a program to its end, on this terminal.
fn call(words: &[OsString]) -> Result<(), ToolError> {
    let Some((program, arguments)) = words.split_first() else { return Ok(()) };
    let status = Command::new(program).args(arguments).status();
    let failed =
        |what: String| ToolError::System { command: words.join(" ".as_ref()).display().to_string(), what };
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(failed(format!("it ended with {status}"))),
        Err(error) => Err(failed(error.to_string())),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::path::PathBuf;
    use tempfile::TempDir;

    /// A machine with the base of all stations and the file of a new one.
    fn machine() -> (TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("stations")).unwrap();
        fs::write(folder.path().join("andon.toml"), "").unwrap();
        let file = folder.path().join("new.toml");
        let text = "[station]\nname = \"bench2\"\n[camera]\nsource = \"v4l2\"\n[[objects]]\nid = 1\nname = \"brick\"\nmarker_side_m = 0.04\n[board]\nenable = true\n";
        fs::write(&file, text).unwrap();
        (folder, file)
    }

    type Called = Result<(Config, Vec<String>), ToolError>;

    /// Installs the file; calls that have this word fail.
    fn installed(folder: &TempDir, file: &Path, engineer: Option<&str>, fails: &str) -> Called {
        let mut called = Vec::new();
        let arguments = Install { file: file.to_owned(), engineer: engineer.map(str::to_owned) };
        let config = install(&arguments, folder.path(), &mut |words| {
            let line = words.join(" ".as_ref()).into_string().unwrap();
            let has_failed = !fails.is_empty() && line.contains(fails);
            called.push(line);
            match has_failed {
                true => Err(ToolError::System { command: fails.into(), what: "failed".into() }),
                false => Ok(()),
            }
        })?;
        Ok((config, called))
    }

    #[test]
    fn a_station_has_its_file_its_engineer_and_its_start_by_one_command() {
        let (folder, file) = machine();
        let (config, called) = installed(&folder, &file, Some("eva"), "").unwrap();
        let own = folder.path().join("stations/bench2.toml");
        assert_eq!(fs::read(&own).unwrap(), fs::read(&file).unwrap());
        assert_eq!(fs::metadata(&own).unwrap().permissions().mode() & 0o777, 0o644);
        assert!(
            called[0].starts_with("runuser -u andon -- ") && called[0].ends_with(" -- eva"),
            "{called:?}"
        );
        assert_eq!(called[1..], ["systemctl enable --now --no-block andon@bench2.target"]);
        assert_eq!(format!("{}/engineer", address(&config)), "http://localhost:9465/engineer");
    }

    #[test]
    fn what_is_there_shares_a_port_or_has_no_login_is_refused_and_nothing_is_changed() {
        let (folder, file) = machine();
        let refused = |engineer, fails| installed(&folder, &file, engineer, fails).unwrap_err().to_string();
        let stations = || fs::read_dir(folder.path().join("stations")).unwrap().count();
        assert!(refused(Some("eva"), "runuser").contains("failed"));
        assert_eq!(stations(), 0, "nobody could teach it");

        let other = folder.path().join("stations/bench1.toml");
        let text = fs::read_to_string(&file).unwrap();
        fs::write(&other, text.replace("bench2", "bench1").replace("v4l2", "realsense")).unwrap();
        let said = refused(None, "");
        assert!(said.contains("board.port: the board of this station listens on port 9465"), "{said}");
        fs::remove_file(&other).unwrap();

        let own = folder.path().join("stations/bench2.toml");
        fs::write(&own, "as it was").unwrap();
        assert!(refused(None, "").contains("a station of this name is installed"));
        assert_eq!(fs::read_to_string(&own).unwrap(), "as it was");
        fs::remove_file(&own).unwrap();

        fs::write(&file, text.replace("enable = true", "enable = false")).unwrap();
        assert!(refused(Some("eva"), "").contains("no board"));
        fs::write(&file, text.replace("brick", "")).unwrap();
        assert!(installed(&folder, &file, None, "").is_err() && stations() == 0);
    }
}
