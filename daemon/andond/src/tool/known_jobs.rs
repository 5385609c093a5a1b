//! The job files that a station has, for what they call the parts and the steps.

use andon_host::config::Config;
use andon_learn::job_file::JobFile;

use super::jobs::{self, FoundJob};
use crate::report::Names;

/// The names in the job files of a station, and those of its configuration.
pub(super) struct KnownJobs {
    jobs: Vec<KnownJob>,
    objects: Names,
}

/// A job that the station has a file of.
pub(super) struct KnownJob {
    pub(super) hash: u64,
    pub(super) file: JobFile,
    names: Names,
}

impl KnownJobs {
    /// Reads the job that the station begins with, and its folder of jobs. What cannot be read has no names here, and is reported by the judge
    /// and by `andond check`.
    pub(super) fn of(config: &Config) -> Self {
        let found = jobs::of_station(config).unwrap_or_default().jobs;
        let objects = config.objects.iter().map(|object| (object.id, object.name.clone()));
        Self { jobs: found.into_iter().map(KnownJob::new).collect(), objects: Names::new(objects) }
    }

    /// The job with this hash.
    pub(super) fn of_hash(&self, hash: u64) -> Option<&KnownJob> {
        self.jobs.iter().find(|job| job.hash == hash)
    }

    /// The names in the job with this hash. Where there is no file of it, those of the parts, and the numbers of the steps.
    pub(super) fn names(&self, hash: u64) -> &Names {
        self.of_hash(hash).map_or(&self.objects, |job| &job.names)
    }

    /// What a job is called, also one of which only another version is there.
    pub(super) fn name(&self, id: u32, hash: u64) -> String {
        let same_number = || self.jobs.iter().find(|job| job.file.id == id);
        let job = self.of_hash(hash).or_else(same_number);
        job.map_or_else(|| format!("number {id}"), |job| job.file.name.clone())
    }
}

impl KnownJob {
    fn new(FoundJob { file, hash, .. }: FoundJob) -> Self {
        Self { hash, names: Names::of_job(&file), file }
    }
}
