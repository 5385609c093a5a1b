//! The order of the steps of the job that a folder of recordings shows.

use crate::folder::{CORRECT, Labelled};
use andon_core::config::Method;
use andon_core::job::LocalCost;
use andon_learn::job_file::JobFile;
use andon_learn::run::Run;
use andon_learn::teach::{TeachOptions, teach};

/// A job with the runs that its others would have rejected.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// The job that the correct runs of the folder teach.
    pub job: JobFile,
    /// The names of the runs that a job taught with the others would have rejected.
    pub rejected: Vec<String>,
}

impl Order {
    /// The order that the correct runs of a folder show, where hands and objects meet as the runs are encoded. `None` where no run is called correct,
    /// so that each name is an activity of its own. It is also `None` where nothing can be taught, or there is one step only.
    pub fn of(all: &[Labelled], name: &str, method: &Method, cost: LocalCost) -> Option<Self> {
        let correct = all.iter().filter(|one| one.what == CORRECT);
        let runs: Vec<Run> = correct.map(|one| one.run.clone()).collect();
        let options = TeachOptions {
            cost,
            measure_rate: false,
            examine_runs: false,
            find_contact_regions: false,
            ..TeachOptions::new(name, "", *method)
        };
        let (job, report) = teach(&runs, &options).ok()?;
        (job.steps.len() > 1).then(|| Self { job, rejected: report.rejected.unwrap_or_default() })
    }
}
