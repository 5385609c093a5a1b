//! Which pictures of steps are from before a time. A picture is as old as its job: the work on it was shown before that was taught. A folder that is
//! copied, or restored from a backup, keeps the days of its jobs and not the times of its files.

use andon_host::atomic::folder_of;
use andon_host::config::Config;
use andon_learn::job_file::JobFile;
use jiff::civil::Date;
use jiff::tz::TimeZone;

use crate::role;
use crate::step_pictures::{StepPicture, beside, in_folder};

/// Those of jobs that were taught before this time, nanoseconds since 1970 UTC, and those that belong to no job any more.
pub(super) fn from_before(config: &Config, utc_ns: u64) -> Vec<StepPicture> {
    let folder = &config.station.jobs;
    let mut pictures = in_folder(folder);
    // The job that the station begins with may lie elsewhere, beside jobs of others.
    let elsewhere = config.station.job.iter().filter(|job| folder_of(job) != folder.as_path());
    pictures.extend(elsewhere.flat_map(|job| beside(job)));
    pictures.retain(|picture| {
        let job = role::read_job(&picture.job).ok().filter(|job| job.model_hash() == picture.model_hash);
        job.is_none_or(|job| is_before(&job, utc_ns))
    });
    pictures
}

/// A job says the day on which it was taught. Of that day all counts as before, and so does a job that says none.
fn is_before(job: &JobFile, utc_ns: u64) -> bool {
    let day = job.provenance.date.parse::<Date>().and_then(|day| day.to_zoned(TimeZone::UTC));
    day.map_or(true, |day| day.timestamp().as_nanosecond() < i128::from(utc_ns))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::fs;
    use std::path::Path;

    #[test]
    fn pictures_are_as_old_as_their_jobs_and_those_without_one_are_older() {
        let folder = tempfile::tempdir().unwrap();
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config/jobs/polish-and-measure.toml");
        let mut job = role::read_job(&shipped).unwrap();
        let put = |name: &str, job: &JobFile, hash: u64| {
            fs::write(folder.path().join(format!("{name}.toml")), job.to_toml()).unwrap();
            fs::write(folder.path().join(format!("{name}.{hash:016x}.step-1.jpg")), "jpeg").unwrap();
        };
        for (name, date) in [("one", "2026-03-01"), ("two", "2026-03-02"), ("three", "some day")] {
            job.provenance.date = date.to_owned();
            put(name, &job, job.model_hash());
        }
        put("changed", &job, 7);
        fs::write(folder.path().join("gone.0123456789abcdef.step-2.jpg"), "jpeg").unwrap();
        let mut config = Config::default();
        config.station.jobs = folder.path().into();
        config.station.job = Some(folder.path().join("one.toml"));
        let found = |time: &str| -> Vec<String> {
            let utc_ns = u64::try_from(time.parse::<jiff::Timestamp>().unwrap().as_nanosecond()).unwrap();
            let stem = |picture: StepPicture| picture.job.file_stem().unwrap().to_string_lossy().into_owned();
            from_before(&config, utc_ns).into_iter().map(stem).collect()
        };
        let whatever = ["changed", "gone", "three"];
        assert_eq!(found("2026-03-01T00:00:00Z"), whatever);
        assert_eq!(found("2026-03-01T00:00:01Z"), ["changed", "gone", "one", "three"]);
        assert_eq!(found("2026-03-05T00:00:00Z"), ["changed", "gone", "one", "three", "two"]);
    }
}
