//! Parts of the station that no recording shows: what the hand does with them cannot be learned.

use std::path::{Path, PathBuf};

use andon_learn::run::Run;
use andon_learn::teach::TeachError;

use crate::recording::Recording;
use crate::tool::ToolError;

/// The id and the name of each part that is in no frame of any run.
pub(super) fn of(runs: &[Run]) -> Vec<(u16, String)> {
    let objects = runs.first().map_or(&[][..], |run| &run.objects);
    let unseen = objects.iter().filter(|object| !runs.iter().any(|run| run.shows(object.shape.id)));
    unseen.map(|object| (object.shape.id, object.name.clone())).collect()
}

/// Which they are, and what to do. `recordings` has at least one.
pub(super) fn words(parts: &[(u16, String)], recordings: &[PathBuf]) -> String {
    let named: Vec<String> = parts.iter().map(|(id, name)| format!("marker {id} ({name})")).collect();
    let film = recordings.iter().map(PathBuf::as_path).find(|path| !Recording::knows_its_station(path));
    let look =
        film.map(Path::display).map(|film| format!(" `andond look {film}` says which markers it shows"));
    format!(
        "{} {} in no frame of {}: do the ids in [[objects]] agree with the markers on the parts, and are these in view, \
         flat and whole?{}",
        named.join(", "),
        if parts.len() == 1 { "is" } else { "are" },
        match recordings {
            [only] => only.display().to_string(),
            several => format!("the {} recordings", several.len()),
        },
        look.unwrap_or_default()
    )
}

/// Why nothing was learned, with the parts that were not seen before what follows from it.
pub(super) fn explain(parts: &[(u16, String)], recordings: &[PathBuf], nothing: TeachError) -> ToolError {
    if parts.is_empty() || !nothing.is_of_runs() {
        return nothing.into();
    }
    ToolError::NotShown { unseen: words(parts, recordings), nothing }
}
