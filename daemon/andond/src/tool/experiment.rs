//! `andond experiment`: the paper's experiments on a folder of recordings.

use std::fmt::Display;
use std::path::Path;

use andon_core::config::Method;
use andon_learn::experiment::{Split, Table, Variation, experiment_1, experiment_2};
use andon_learn::folder::{self, Labelled};
use andon_learn::teach::TeachOptions;
use indicatif::{ProgressBar, ProgressStyle};

use super::Failure;
use crate::cli::Experiment;
use crate::exit::Code;

/// Seed of k-means++ and of the random splits: any will do, and the same folder must give the same figures.
pub(super) const SEED: u64 = 1;

/// Runs the command.
///
/// # Errors
/// A folder without the recordings that the experiment needs, or a damaged one.
pub fn run(arguments: &Experiment) -> Result<Code, Failure> {
    let method = method(&arguments.recordings)?;
    let all = read(&arguments.recordings, &method)?;
    let bar = share("computing");
    let mut progress = |done: f64| bar.set_position((100.0 * done) as u64);
    let text = if arguments.number == 1 {
        let cost = TeachOptions::new("", "", method).cost;
        experiment_1(&all, &method, cost, SEED, &mut progress).map_err(failure)?.to_string()
    } else {
        let splits = [Split::Random, Split::LeavePersonOut];
        let outcomes = experiment_2(&all, &method, &Variation::ladder(), &splits, SEED, &mut progress)
            .map_err(failure)?;
        Table::new(&outcomes).to_string()
    };
    bar.finish_and_clear();
    println!("{text}");
    Ok(Code::Stopped)
}

/// The constants of the method, in the space of the folder's recordings. The paper's experiments are repeated with the defaults, so that
/// no station's settings change their figures.
pub(super) fn method(recordings: &Path) -> Result<Method, Failure> {
    Ok(Method { space: folder::space(recordings).map_err(failure)?, ..Method::default() })
}

/// Reads the recordings whose names say who did what.
pub(super) fn read(recordings: &Path, method: &Method) -> Result<Vec<Labelled>, Failure> {
    let bar = share("reading");
    let all = folder::read(recordings, method, &mut |done| bar.set_position((100.0 * done) as u64));
    bar.finish_and_clear();
    all.map_err(failure)
}

/// Whether the folder has the activities of the first experiment.
pub(super) fn is_experiment_1(all: &[Labelled]) -> bool {
    andon_learn::analysis::Kind::of(all) == andon_learn::analysis::Kind::of_paper()
}

pub(super) fn failure(error: impl Display) -> Failure {
    Failure::new(Code::Usage, error)
}

/// A bar on standard error that counts to 100 %, which shows nothing where that is no terminal.
pub(super) fn share(what: &'static str) -> ProgressBar {
    // The template is a constant that is well formed.
    let style = ProgressStyle::with_template("{msg:12} [{bar:32}] {pos} %, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(100).with_style(style.progress_chars("=> ")).with_message(what)
}
