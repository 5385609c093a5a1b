//! The number of a job that is given by itself: none that another job has, so that a PLC can select each.

use std::path::{Path, PathBuf};

use andon_host::atomic::folder_of;
use andon_host::config::Config;

use crate::role;
use crate::tool::jobs::is_same;

/// The number of a new job that is written to `out`. The smallest that no job in the same folder and no job of the station has.
pub(super) fn number_for(out: &Path, config: &Config) -> u32 {
    let taken: Vec<u32> = neighbours(out, config).into_iter().map(|(_, id)| id).collect();
    (1..).find(|id| !taken.contains(id)).unwrap_or(u32::MAX)
}

/// The other jobs that have this number.
pub(super) fn others_with(id: u32, out: &Path, config: &Config) -> Vec<PathBuf> {
    neighbours(out, config).into_iter().filter(|(_, other)| *other == id).map(|(path, _)| path).collect()
}

/// The jobs in the folder of `out` and those of the station, without `out` itself.
fn neighbours(out: &Path, config: &Config) -> Vec<(PathBuf, u32)> {
    let (beside, station) = (folder_of(out), config.station.jobs.as_path());
    let mut folders = vec![beside];
    if !is_same(beside, station) {
        folders.push(station);
    }
    // A folder that cannot be read has no job that this one could be taken for, and neither has a file of another kind.
    let files = folders.into_iter().flat_map(|folder| role::job_files(folder).unwrap_or_default());
    let files = files.chain(config.station.job.clone()).filter(|path| !is_same(path, out));
    files.filter_map(|path| role::read_job(&path).ok().map(|job| (path, job.id))).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const JOB: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/jobs/polish-and-measure.toml");

    /// Two folders of jobs with these numbers: that of the job to be written, and that of the station.
    fn folders(beside: &[u32], station: &[u32]) -> (tempfile::TempDir, PathBuf, Config) {
        let root = tempfile::tempdir().unwrap();
        let mut job = role::read_job(Path::new(JOB)).unwrap();
        for (folder, numbers) in [("beside", beside), ("station", station)] {
            let folder = root.path().join(folder);
            std::fs::create_dir(&folder).unwrap();
            for id in numbers {
                job.id = *id;
                std::fs::write(folder.join(format!("{id}.toml")), job.to_toml()).unwrap();
            }
        }
        let mut config = Config::default();
        config.station.jobs = root.path().join("station");
        let out = root.path().join("beside/new.toml");
        (root, out, config)
    }

    #[test]
    fn a_new_job_gets_the_smallest_number_that_no_job_beside_it_or_of_the_station_has() {
        for (beside, station, number) in [(&[][..], &[][..], 1), (&[1, 3], &[2], 4), (&[2], &[], 1)] {
            let (_root, out, config) = folders(beside, station);
            assert_eq!(number_for(&out, &config), number, "{beside:?} {station:?}");
        }
    }

    #[test]
    fn the_other_jobs_of_a_number_are_named() {
        let (root, out, config) = folders(&[1, 7], &[7]);
        let names = [root.path().join("beside/7.toml"), root.path().join("station/7.toml")];
        assert_eq!(others_with(7, &out, &config), names);
        assert!(others_with(7, &names[0], &config).contains(&names[1]));
        assert_eq!(others_with(2, &out, &config), Vec::<PathBuf>::new());
    }
}
