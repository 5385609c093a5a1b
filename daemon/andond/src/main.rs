//! `andond`: one binary, one role a process, one file a command.
#![forbid(unsafe_code)]

use std::process::ExitCode;

use andond::cli::{Cli, Command};
use andond::exit::{self, Code};
use andond::role;
use andond::tool::{self, Failure};
use clap::Parser;

fn main() -> ExitCode {
    exit::exit_on_panic();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(usage) => {
            // Help and version are asked for; all else is a wrong command line.
            let asked = !usage.use_stderr();
            let _ = usage.print();
            return if asked { ExitCode::SUCCESS } else { Code::Usage.into() };
        }
    };
    match run(cli.command) {
        Ok(code) => code,
        Err(failure) => {
            eprintln!("{failure}");
            failure.code().into()
        }
    }
}

fn run(command: Command) -> Result<ExitCode, Failure> {
    match command {
        Command::Demo(arguments) => tool::demo::run(&arguments).map(ExitCode::from),
        Command::Teach(arguments) => tool::teach::run(&arguments).map(ExitCode::from),
        Command::Replay(arguments) => tool::replay::run(&arguments).map(ExitCode::from),
        Command::Segment(arguments) => tool::segment::run(&arguments).map(ExitCode::from),
        Command::Run(arguments) => {
            Ok(role::run(arguments.role, &tool::load_config(&arguments.config)?).into())
        }
        Command::Calibrate(arguments) => tool::calibrate::run(&arguments).map(ExitCode::from),
        Command::Record(arguments) => tool::record::run(&arguments).map(ExitCode::from),
        Command::Check(arguments) => tool::check::run(&arguments).map(ExitCode::from),
        Command::Config(arguments) => tool::config::run(&arguments).map(ExitCode::from),
        Command::Tail(arguments) => tool::tail::run(&arguments).map(ExitCode::from),
        Command::Status(arguments) => tool::status::run(&arguments).map(ExitCode::from),
        Command::History(arguments) => tool::history::run(&arguments).map(ExitCode::from),
        Command::Analyze(arguments) => tool::analyze::run(&arguments).map(ExitCode::from),
        Command::Experiment(arguments) => tool::experiment::run(&arguments).map(ExitCode::from),
    }
}
