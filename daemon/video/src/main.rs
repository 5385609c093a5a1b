//! `andond-video`: the role `capture` and the films of the tools.
//!
//! `andond-video check` opens the camera or the recording of a configuration once, for `andond check`.
//! `andond-video run capture` is the role, into which `andond run capture` turns itself. `andond-video decode FILE RATE_HZ` (the rate is that of
//! a folder of pictures) and `andond-video encode FILE` serve the tools over a pipe, see [`andond::video`].
#![forbid(unsafe_code)]

use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

use andon_video::{capture, film, open};
use andond::cli::{self, Cli, Command, Role};
use andond::exit::{self, Code};
use andond::{role, tool};
use clap::Parser as _;
use shm_schemas::RoleId;

fn main() -> ExitCode {
    exit::exit_on_panic();
    match Cli::try_parse() {
        Ok(Cli { command: Command::Run(run), .. }) => return run_capture(&run),
        Ok(Cli { command: Command::Check(check), .. }) => return check_source(&check),
        _ => (),
    }
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let outcome = match arguments.as_slice() {
        [verb, file, rate_hz] if verb == "decode" => film::decode(Path::new(file), rate_hz),
        [verb, file] if verb == "encode" => film::encode(Path::new(file)),
        _ => Err("usage: andond-video decode FILE RATE_HZ | encode FILE; people want `andond`".into()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            Code::Usage.into()
        }
    }
}

/// Opens what the configuration names, and closes it again.
fn check_source(check: &cli::Check) -> ExitCode {
    let config = match tool::load_config(&check.config) {
        Ok(config) => config,
        Err(failure) => {
            eprintln!("{failure}");
            return failure.code().into();
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

fn run_capture(run: &cli::Run) -> ExitCode {
    match tool::take_config(run) {
        Ok(taken) if run.role == Role::Capture => {
            role::start_log(run.role, &taken);
            let config = &taken.config;
            role::run_with(config, RoleId::Capture, |node| capture::run(node, config, open)).into()
        }
        Ok(_) => Code::Usage.into(),
        Err(failure) => {
            eprintln!("{failure}");
            failure.code().into()
        }
    }
}
