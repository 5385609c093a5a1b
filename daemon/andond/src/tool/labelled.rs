//! A folder of recordings of which it is said who did what, for the commands that compare people and repetitions.

use std::path::{Path, PathBuf};

use andon_core::config::Method;
use andon_host::cli::ConfigArgs;
use andon_study::folder::{self, Labelled, Naming, Pattern, Table};

use super::experiment::percent_bar;
use super::runs::{common_space, read_runs};
use super::{ToolError, load_config_for};
use crate::cli::Names;

/// Reads the recordings of a folder, in the order of person, what was done and repetition, and the constants that they were encoded with.
/// All but the space of the recordings are the defaults, so that no station's settings change the figures of the paper's experiments.
///
/// # Errors
/// A folder without recordings, names that say nothing, a film without a station, and what is damaged.
pub(super) fn read(
    folder: &Path,
    names: &Names,
    config: &ConfigArgs,
) -> Result<(Method, Vec<Labelled>), ToolError> {
    let recordings = folder::recordings(folder, &naming(names)?)?;
    for (number, name) in &recordings.people {
        eprintln!("person {number} is {name}");
    }
    let paths: Vec<PathBuf> = recordings.files.iter().map(|(path, _)| path.clone()).collect();
    let config = load_config_for(config, &paths)?;
    let method = Method { space: common_space(&paths, &config)?, ..Method::default() };
    let bar = percent_bar("reading");
    bar.set_length(paths.len() as u64);
    let runs = read_runs(&paths, &config, &method, &|| bar.inc(1))?;
    bar.finish_and_clear();
    let labels = recordings.files.into_iter().map(|(_, label)| label);
    let labelled = labels
        .zip(runs)
        .map(|((person, what, repetition), run)| Labelled { person, what, repetition, run })
        .collect();
    Ok((method, labelled))
}

fn naming(names: &Names) -> Result<Naming, ToolError> {
    Ok(match (&names.runs, &names.names) {
        (Some(table), _) => Naming::Table(Table::read(table).map_err(folder::FolderError::from)?),
        (None, Some(pattern)) => Naming::Pattern(Pattern::new(pattern).map_err(ToolError::Names)?),
        (None, None) => Naming::Standard,
    })
}
