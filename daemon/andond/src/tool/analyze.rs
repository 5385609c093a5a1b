//! `andond analyze`: compares and clusters the interactions of a folder of recordings, and writes a report.

use std::path::{Path, PathBuf};

use andon_host::exit::Code;
use andon_learn::teach::TeachOptions;
use andon_study::analysis::{Analysis, Kind, Order, Report, report, selection, with_learned_contacts};
use andon_study::experiment::experiment_1;

use super::experiment::{SEED, is_experiment_1, percent_bar};
use super::{ToolError, cannot_write, labelled, write_together};
use crate::cli::Analyze;

/// Runs the command.
///
/// # Errors
/// A folder without recordings, a damaged one, or a report that cannot be written.
pub fn run(arguments: &Analyze) -> Result<Code, ToolError> {
    let (method, all) = labelled::read(&arguments.recordings, &arguments.names, &arguments.config)?;
    let cost = TeachOptions::new("", "", method).cost;
    let bar = percent_bar("clustering");
    let mut progress = |done: f64| bar.set_position((100.0 * done) as u64);
    let met = with_learned_contacts(&all, &method)?;
    // The first experiment compares six kinds of its own, and has drilling beside them. It is that of the paper, whose station says where its objects
    // are touched.
    let (analysis, drilling) = if is_experiment_1(&all) {
        let one = experiment_1(&all, &method, cost, SEED, &mut progress)?;
        (one.analysis, one.drilling)
    } else {
        let kinds = Kind::of(&met);
        (Analysis::new(&met, kinds, &method, cost, SEED, &mut progress)?, None)
    };
    bar.finish_and_clear();
    let source = arguments.recordings.display().to_string();
    let selection = selection(&met, &method, cost);
    let order = Order::of(&met, &source, &method, cost);
    let report = report(&analysis, drilling.as_ref(), selection.as_ref(), order.as_ref(), &source)?;
    save(&report, &arguments.out)?;
    println!("written: {}", arguments.out.join("index.html").display());
    Ok(Code::Stopped)
}

/// Writes the page as `index.html`, and its pictures and tables next to it.
fn save(report: &Report, folder: &Path) -> Result<(), ToolError> {
    let is_new = !folder.exists();
    std::fs::create_dir_all(folder).map_err(cannot_write(folder))?;
    let page = (folder.join("index.html"), &report.page);
    let others = report.files.iter().map(|(name, text)| (folder.join(name), text));
    let files: Vec<(PathBuf, &String)> = std::iter::once(page).chain(others).collect();
    let written = write_together(files.iter().map(|(path, text)| (path.as_path(), text.as_bytes())));
    if written.is_err() && is_new {
        // An empty folder is a rest as well. One that is not empty by now stays.
        let _ = std::fs::remove_dir(folder);
    }
    written
}
