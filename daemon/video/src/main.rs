//! `andond-video`: the role `capture` and the films of the tools.
//!
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
    if let Ok(Cli { command: Command::Run(run), .. }) = Cli::try_parse() {
        return run_capture(&run);
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

fn run_capture(run: &cli::Run) -> ExitCode {
    match tool::load_config(&run.config) {
        Ok(config) if run.role == Role::Capture => {
            role::start_log(run.role, &config);
            role::run_with(&config, RoleId::Capture, |node| capture::run(node, &config, open)).into()
        }
        Ok(_) => Code::Usage.into(),
        Err(failure) => {
            eprintln!("{failure}");
            failure.code().into()
        }
    }
}
