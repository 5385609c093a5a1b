//! `andond`: one binary, one role per process, one file per command.
#![forbid(unsafe_code)]

use std::process::ExitCode;

use andon_host::exit::{self, Code, is_reader_gone};
use andond::cli::{self, Cli, Command};
use andond::role;
use andond::tool::{self, ToolError};
use clap::FromArgMatches as _;

fn main() -> ExitCode {
    exit::exit_on_panic();
    let parsed = cli::command().try_get_matches().and_then(|matches| Cli::from_arg_matches(&matches));
    let cli = match parsed {
        Ok(cli) => cli,
        Err(usage) => {
            // Help and version are asked for; all else is a wrong command line.
            let asked = !usage.use_stderr();
            return match usage.print() {
                Err(error) if asked => end(&ToolError::Print(error)),
                _ if asked => ExitCode::SUCCESS,
                _ => Code::Usage.into(),
            };
        }
    };
    match run(cli.command) {
        Ok(code) => code,
        Err(failure) => end(&failure),
    }
}

fn end(failure: &ToolError) -> ExitCode {
    // The reader has seen enough, as `head` does.
    if is_reader_gone(failure) {
        return Code::Unread.into();
    }
    eprintln!("{failure}");
    failure.code().into()
}

/// The error is boxed: it names whatever a tool may meet, and is large.
fn run(command: Command) -> Result<ExitCode, Box<ToolError>> {
    let code = match command {
        Command::Demo(arguments) => tool::demo::run(&arguments)?.into(),
        Command::New(arguments) => tool::new::run(&arguments)?.into(),
        Command::Install(arguments) => tool::install::run(&arguments)?.into(),
        Command::Markers(arguments) => tool::markers::run(&arguments)?.into(),
        Command::Look(arguments) => tool::look::run(&arguments)?.into(),
        Command::Teach(arguments) => tool::teach::run(&arguments)?.into(),
        Command::Replay(arguments) => tool::replay::run(&arguments)?.into(),
        Command::Segment(arguments) => tool::segment::run(&arguments)?.into(),
        Command::Run(arguments) => {
            role::run(arguments.role, &arguments.take_config().map_err(ToolError::from)?).into()
        }
        Command::Calibrate(arguments) => tool::calibrate::run(&arguments)?.into(),
        Command::Record(arguments) => tool::record::run(&arguments)?.into(),
        Command::Tracks(arguments) => tool::tracks::run(&arguments)?.into(),
        Command::Jobs(arguments) => tool::jobs::run(&arguments)?.into(),
        Command::Use(arguments) => tool::use_job::run(&arguments)?.into(),
        Command::Name(arguments) => tool::name::run(&arguments)?.into(),
        Command::Check(arguments) => tool::check::run(&arguments)?.into(),
        Command::Config(arguments) => tool::config::run(&arguments)?.into(),
        Command::Tail(arguments) => tool::tail::run(&arguments)?.into(),
        Command::Status(arguments) => tool::status::run(&arguments)?.into(),
        Command::History(arguments) => tool::history::run(&arguments)?.into(),
        Command::Explain(arguments) => tool::explain::run(&arguments)?.into(),
        Command::Clip(arguments) => tool::clip::run(&arguments)?.into(),
        Command::Confirm(arguments) => tool::confirm::run(&arguments)?.into(),
        Command::Whatif(arguments) => tool::whatif::run(&arguments)?.into(),
        Command::Forget(arguments) => tool::forget::run(&arguments)?.into(),
        Command::Backup(arguments) => tool::backup::run(&arguments)?.into(),
        Command::Restore(arguments) => tool::restore::run(&arguments)?.into(),
        Command::Idle(arguments) => tool::idle::run(&arguments)?.into(),
        Command::Part(arguments) => tool::part::run(&arguments)?.into(),
        Command::Board(arguments) => tool::board::run(&arguments.action)?.into(),
        Command::Analyze(arguments) => {
            tool::working("analyze", || tool::analyze::run(&arguments).map_err(Box::new))?.into()
        }
        Command::Experiment(arguments) => {
            tool::working("experiment", || tool::experiment::run(&arguments).map_err(Box::new))?.into()
        }
        Command::Completions(arguments) => tool::pages::completions(&arguments)?.into(),
        Command::ExitCodes => tool::pages::exit_codes()?.into(),
        Command::Man(arguments) => tool::pages::man(&arguments)?.into(),
    };
    Ok(code)
}
