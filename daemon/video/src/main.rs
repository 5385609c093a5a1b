//! `andond-video`: the role `capture` and the films of the tools.
//!
//! `andond-video check` opens the camera or the recording of a configuration once, for `andond check`.
//! `andond-video run capture` is the role, into which `andond run capture` turns itself. `andond-video decode FILE RATE_HZ` (the rate is that of
//! a folder of pictures), `andond-video watch --config FILE...`, `andond-video encode FILE` and `andond-video stills ENDING` serve the tools over
//! a pipe, see [`andon_host::video::pipe`].
//!
//! It is a second binary because OpenCV's `videoio` loads 248 libraries, 65 MB. Only the process that decodes pays for them, and systemd
//! sees one process.
#![forbid(unsafe_code)]

use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

use andon_host::cli::{ConfigArgs, Role, Run};
use andon_host::exit::{self, Code};
use andon_host::role;
use andon_video::{capture, film, open};
use clap::Parser;
use shm_schemas::RoleId;

/// What `andond` and the units call with the options of a person; everything else comes from a tool of `andond`.
#[derive(Parser)]
#[command(name = "andond-video", version)]
enum Call {
    /// Run the role capture
    Run(Run),
    /// Open the source of the configuration once
    Check(ConfigArgs),
}

fn main() -> ExitCode {
    exit::exit_on_panic();
    if let Err(error) = opencv::core::set_num_threads(1) {
        eprintln!("OpenCV keeps threads of its own, which wait busily: {error}");
    }
    match Call::try_parse() {
        Ok(Call::Run(run)) => return run_capture(&run),
        Ok(Call::Check(config)) => return check_source(&config),
        Err(_) => (),
    }
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let outcome = match arguments.as_slice() {
        [verb, file, rate_hz] if verb == "decode" => film::decode(Path::new(file), rate_hz),
        [verb, files @ ..] if verb == "watch" => watch(files),
        [verb, file] if verb == "encode" => film::encode(Path::new(file)),
        [verb, ending] if verb == "stills" => film::stills(ending),
        _ => Err("usage: andond-video decode FILE RATE_HZ | watch --config FILE... | encode FILE | stills ENDING; people want `andond`".into()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            Code::Usage.into()
        }
    }
}

/// Writes what the camera of a configuration sees to standard output.
fn watch(files: &[OsString]) -> Result<(), String> {
    let files = files.iter().filter(|file| *file != "--config").map(Into::into).collect();
    let config = ConfigArgs { files }.load().map_err(|failure| failure.to_string())?;
    film::watch(open(&config).map_err(|error| error.to_string())?.as_mut())
}

/// Opens what the configuration names, and closes it again.
fn check_source(arguments: &ConfigArgs) -> ExitCode {
    let config = match arguments.load() {
        Ok(config) => config,
        Err(failure) => {
            eprintln!("{failure}");
            return Code::Configuration.into();
        }
    };
    match open(&config) {
        Ok(_) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            Code::Configuration.into()
        }
    }
}

fn run_capture(run: &Run) -> ExitCode {
    match run.take_config() {
        Ok(taken) if run.role == Role::Capture => {
            role::start_log(RoleId::Capture, &taken);
            let config = &taken.config;
            role::run_with(config, RoleId::Capture, |node| capture::run(node, config, open)).into()
        }
        Ok(_) => Code::Usage.into(),
        Err(failure) => {
            eprintln!("{failure}");
            Code::Configuration.into()
        }
    }
}
