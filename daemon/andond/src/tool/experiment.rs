//! `andond experiment`: the paper's experiments on a folder of recordings.

use std::path::Path;

use andon_core::config::Method;
use andon_learn::experiment::{Split, Table, Variation, experiment_1, experiment_2};
use andon_learn::folder::{self, Labelled};
use andon_learn::teach::TeachOptions;
use indicatif::{ProgressBar, ProgressStyle};

use super::ToolError;
use crate::cli::Experiment;
use crate::exit::Code;

/// Seed of k-means++ and of the random splits: any will do, and the same folder must give the same figures.
pub(super) const SEED: u64 = 1;

/// Runs the command.
///
/// # Errors
/// A folder without the recordings that the experiment needs, or a damaged one.
pub fn run(arguments: &Experiment) -> Result<Code, ToolError> {
    let method = method(&arguments.recordings)?;
    let all = read(&arguments.recordings, &method)?;
    let bar = percent_bar("computing");
    let mut progress = |done: f64| bar.set_position((100.0 * done) as u64);
    let text = if arguments.number == 1 {
        let cost = TeachOptions::new("", "", method).cost;
        experiment_1(&all, &method, cost, SEED, &mut progress)?.to_string()
    } else {
        let splits = [Split::Random, Split::LeavePersonOut];
        let outcomes = experiment_2(&all, &method, &Variation::ladder(), &splits, SEED, &mut progress)?;
        Table(outcomes).to_string()
    };
    bar.finish_and_clear();
    println!("{text}");
    Ok(Code::Stopped)
}

/// The constants of the method, in the space of the folder's recordings. All others are the defaults, so that no station's
/// settings change the figures of the paper's experiments.
pub(super) fn method(recordings: &Path) -> Result<Method, ToolError> {
    Ok(Method { space: folder::space(recordings)?, ..Method::default() })
}

/// Reads the recordings whose names say who did what.
pub(super) fn read(recordings: &Path, method: &Method) -> Result<Vec<Labelled>, ToolError> {
    let bar = percent_bar("reading");
    let all = folder::read(recordings, method, &mut |done| bar.set_position((100.0 * done) as u64));
    bar.finish_and_clear();
    Ok(all?)
}

/// Whether the folder has the activities of the first experiment.
pub(super) fn is_experiment_1(all: &[Labelled]) -> bool {
    andon_learn::analysis::Kind::of(all) == andon_learn::analysis::Kind::of_paper()
}

/// A progress bar on standard error that counts to 100 %. It shows nothing where standard error is not a terminal.
pub(super) fn percent_bar(what: &'static str) -> ProgressBar {
    // The template is a constant that is well formed.
    let style = ProgressStyle::with_template("{msg:12} [{bar:32}] {pos} %, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(100).with_style(style.progress_chars("=> ")).with_message(what)
}
