//! `andond experiment`: the paper's experiments on a folder of recordings.

use std::path::{Path, PathBuf};

use andon_host::exit::Code;
use andon_learn::teach::TeachOptions;
use andon_study::experiment::{Ladder, Outcome, Split, Table, Variation, experiment_1, experiment_2};
use andon_study::folder::Labelled;
use indicatif::{ProgressBar, ProgressStyle};

use super::{ToolError, labelled};
use crate::cli::Experiment;

/// Seed of k-means++ and of the random splits: any will do, and the same folder must give the same figures.
pub(super) const SEED: u64 = 1;

/// Runs the command.
///
/// # Errors
/// A folder without the recordings that the experiment needs, a damaged one, or more folders than are used.
pub fn run(arguments: &Experiment) -> Result<Code, ToolError> {
    let text = match (arguments.number, arguments.ladder, arguments.recordings.as_slice()) {
        (1, false, [folder]) => first(folder, arguments)?,
        (2, false, [folder]) => {
            let splits = [Split::Random, Split::LeavePersonOut];
            let rules = |bins, all: &[Labelled]| Variation::for_recordings(Variation::ladder(bins), all);
            Table(second(folder, arguments, rules, &splits)?).to_string()
        }
        (2, true, folders) => ladder(folders, arguments)?,
        (_, ladder, _) => {
            let expected =
                "it is for experiment 2, and only it takes several folders: experiment 2 --ladder A B";
            return Err(ToolError::Option { option: "--ladder", given: ladder.to_string(), expected });
        }
    };
    println!("{text}");
    Ok(Code::Stopped)
}

fn first(folder: &Path, arguments: &Experiment) -> Result<String, ToolError> {
    let (method, all) = labelled::read(folder, &arguments.names, &arguments.config)?;
    let cost = arguments.cost.map_or(TeachOptions::new("", "", method).cost, |cost| cost.local(method.bins));
    let bar = percent_bar("computing");
    let mut progress = |done: f64| bar.set_position((100.0 * done) as u64);
    let result = experiment_1(&all, &method, cost, SEED, &mut progress)?;
    bar.finish_and_clear();
    Ok(result.to_string())
}

fn second(
    folder: &Path,
    arguments: &Experiment,
    variations: fn(u8, &[Labelled]) -> Vec<Variation>,
    splits: &[Split],
) -> Result<Vec<Outcome>, ToolError> {
    let (method, all) = labelled::read(folder, &arguments.names, &arguments.config)?;
    let mut variations = variations(method.bins, &all);
    if let Some(cost) = arguments.cost {
        variations = Variation::with_cost(variations, cost.local(method.bins));
    }
    let bar = percent_bar("computing");
    let mut progress = |done: f64| bar.set_position((100.0 * done) as u64);
    let outcomes = experiment_2(&all, &method, &variations, splits, SEED, &mut progress)?;
    bar.finish_and_clear();
    Ok(outcomes)
}

fn ladder(folders: &[PathBuf], arguments: &Experiment) -> Result<String, ToolError> {
    let outcomes = |folder: &PathBuf| {
        let name = folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy().into_owned();
        let rules = |bins, _: &[Labelled]| Variation::ladder_with_contact_regions(bins);
        Ok((name, second(folder, arguments, rules, &[Split::Random])?))
    };
    let folders = folders.iter().map(outcomes).collect::<Result<_, ToolError>>()?;
    Ok(Ladder(folders).to_string())
}

/// Whether the folder has the activities of the first experiment.
pub(super) fn is_experiment_1(all: &[Labelled]) -> bool {
    andon_study::analysis::Kind::of(all) == andon_study::analysis::Kind::of_paper()
}

/// A progress bar on standard error that counts to 100 %. It shows nothing where standard error is not a terminal.
pub(super) fn percent_bar(what: &'static str) -> ProgressBar {
    // The template is a constant that is well formed.
    let style = ProgressStyle::with_template("{msg:12} [{bar:32}] {pos} %, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(100).with_style(style.progress_chars("=> ")).with_message(what)
}
