//! The job files that a station has, for what they call the parts and the steps.

use super::ToolError;
use super::jobs::{self, FoundJob};
use crate::config::Config;
use crate::report::Names;

/// The names in the job files of a station, and those of its configuration.
pub(super) struct KnownJobs {
    jobs: Vec<KnownJob>,
    objects: Names,
}

/// A job that the station has a file of.
pub(super) struct KnownJob {
    pub(super) id: u32,
    pub(super) hash: u64,
    pub(super) name: String,
    names: Names,
}

impl KnownJobs {
    /// Reads the job that the station begins with, and its folder of jobs. What cannot be read has no names here, and is reported by the judge
    /// and by `andond check`.
    pub(super) fn of(config: &Config) -> Self {
        let found = jobs::of_station(config).unwrap_or_default().jobs;
        let objects = config.objects.iter().map(|object| (object.id, object.name.clone()));
        Self { jobs: found.iter().map(KnownJob::new).collect(), objects: Names::new(objects) }
    }

    /// The job with this hash.
    pub(super) fn of_hash(&self, hash: u64) -> Option<&KnownJob> {
        self.jobs.iter().find(|job| job.hash == hash)
    }

    /// The names in the job with this hash; where there is no file of it, those of the parts, and the numbers of the steps.
    pub(super) fn names(&self, hash: u64) -> &Names {
        self.of_hash(hash).map_or(&self.objects, |job| &job.names)
    }

    /// What a job is called, also one of which only another version is there.
    pub(super) fn name(&self, id: u32, hash: u64) -> String {
        let same_number = || self.jobs.iter().find(|job| job.id == id);
        let job = self.of_hash(hash).or_else(same_number);
        job.map_or_else(|| format!("number {id}"), |job| job.name.clone())
    }

    /// The number of the job that somebody means by its name or its number.
    ///
    /// # Errors
    /// That no job has this name, with the names that there are.
    pub(super) fn number(&self, wanted: &str) -> Result<u32, ToolError> {
        if let Ok(number) = wanted.parse() {
            return Ok(number);
        }
        let is_meant = |job: &&KnownJob| job.name.to_lowercase() == wanted.to_lowercase();
        if let Some(job) = self.jobs.iter().find(is_meant) {
            return Ok(job.id);
        }
        let mut names: Vec<String> =
            self.jobs.iter().map(|job| format!("{:?} ({})", job.name, job.id)).collect();
        names.sort();
        names.dedup();
        let there = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        Err(ToolError::UnknownJobName { wanted: wanted.to_owned(), there })
    }
}

impl KnownJob {
    fn new(FoundJob { file, hash, .. }: &FoundJob) -> Self {
        Self { id: file.id, hash: *hash, name: file.name.clone(), names: Names::of_job(file) }
    }
}
