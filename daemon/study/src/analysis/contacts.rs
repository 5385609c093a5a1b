//! Where hands and objects meet in a folder of recordings whose station does not say it.

use super::AnalysisError;
use crate::folder::{CORRECT, Labelled};
use andon_core::config::Method;
use andon_learn::recording::NamedObject;
use andon_learn::run::Run;
use andon_learn::teach::{self, TeachOptions};

/// The recordings where hands and objects meet as those called correct show it, as a job is taught. As all of them show it where none is called so.
///
/// # Errors
/// If the objects of all recordings are too many for one job.
pub fn with_learned_contacts(all: &[Labelled], method: &Method) -> Result<Vec<Labelled>, AnalysisError> {
    let correct: Vec<Run> = runs(all, |one| one.what == CORRECT);
    let shown = if correct.is_empty() { runs(all, |_| true) } else { correct };
    let options = TeachOptions { measure_rate: false, ..TeachOptions::new("", "", *method) };
    let met = teach::with_learned_contacts(&shown, &options)?;
    let objects: &[NamedObject] = met.first().map_or(&[], |run| &run.objects);
    all.iter().map(|one| Ok(Labelled { run: with(&one.run, objects)?, ..one.clone() })).collect()
}

fn runs(all: &[Labelled], is_wanted: impl Fn(&Labelled) -> bool) -> Vec<Run> {
    all.iter().filter(|one| is_wanted(one)).map(|one| one.run.clone()).collect()
}

/// A run with these objects, and with its own that are not among them.
fn with(run: &Run, objects: &[NamedObject]) -> Result<Run, AnalysisError> {
    let is_new = |own: &&NamedObject| objects.iter().all(|object| object.shape.id != own.shape.id);
    let objects: Vec<NamedObject> =
        objects.iter().chain(run.objects.iter().filter(is_new)).cloned().collect();
    Ok(run.encoded_with_objects(&objects)?)
}
