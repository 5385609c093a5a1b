//! The job files of a station, and which of them a command means.

use std::ffi::OsString;
use std::os::unix::ffi::OsStringExt as _;
use std::path::{Path, PathBuf};

use andon_host::atomic;
use andon_host::config::Config;
use andon_host::log::{code, log};
use andon_learn::file;
use andon_learn::job_file::JobFile;
use shm_schemas::{Judging, Refusal};

use super::RoleError;
use crate::compatibility;
use crate::made::Made;

/// The job that a command names.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub(super) job_id: u32,
    /// The version; 0 accepts any.
    pub(super) model_hash: u64,
}

/// The file in the station's directory that names the job that a command has loaded: a judge that starts again goes on with it. The next line
/// begins with what its configuration says, or else with what an engineer loaded last.
const CHOICE: &str = "job";

/// Keeps the job that a command has loaded.
pub(super) fn choose(config: &Config, path: &Path) {
    let choice = config.root().join(CHOICE);
    let kept = std::path::absolute(path)
        .and_then(|path| atomic::write(&choice, path.as_os_str().as_encoded_bytes()));
    if let Err(error) = kept {
        log!(code::CONFIGURATION_NOT_KEPT, "{}: {error}", choice.display());
    }
}

/// The job that a command has loaded in this line, if it can still be used.
pub(super) fn chosen(config: &Config) -> Option<PathBuf> {
    let bytes = std::fs::read(config.root().join(CHOICE)).ok()?;
    let path = PathBuf::from(OsString::from_vec(bytes));
    load(&path, config).is_ok().then_some(path)
}

/// The line ends: the next one begins with the job of its configuration.
pub(super) fn forget_choice(config: &Config) {
    // It is not there where no command has loaded a job. What cannot be removed now is swept away by the next steward that is alone.
    let _ = std::fs::remove_file(config.root().join(CHOICE));
}

/// The job that an engineer has loaded last on the board, if its file still has that version.
pub(super) fn ordered(config: &Config) -> Option<PathBuf> {
    let text = std::fs::read_to_string(Made::new(config).loaded()).ok().filter(|_| config.executor.enable)?;
    let (id, hash) = text.split_once(' ')?;
    let wanted = Wanted { job_id: id.parse().ok()?, model_hash: u64::from_str_radix(hash, 16).ok()? };
    Search::new(config, wanted).found.pop().map(|found| found.path)
}

/// Reads a job file that this station can judge by.
pub(crate) fn load(path: &Path, config: &Config) -> Result<JobFile, RoleError> {
    let file = read(path)?;
    compatibility::station(&file, config)
        .map_err(|misfit| RoleError::UnfitJob { path: path.into(), misfit })?;
    Ok(file)
}

/// Reads a job file, whether it fits or not.
pub(crate) fn read(path: &Path) -> Result<JobFile, RoleError> {
    let bytes = file::read(path).map_err(|source| RoleError::UnreadJob { path: path.into(), source })?;
    Ok(JobFile::parse(&path.display().to_string(), &bytes)?)
}

/// The job that the judge says to be in force; `None` where there is none.
pub(super) fn in_force(config: &Config, judging: &Judging) -> Result<Option<JobFile>, RoleError> {
    Ok(file_in_force(config, judging)?.map(|(_, job)| job))
}

/// As [`in_force`], with the file that it is in.
pub(super) fn file_in_force(
    config: &Config,
    judging: &Judging,
) -> Result<Option<(PathBuf, JobFile)>, RoleError> {
    let Judging { job_id, model_hash, .. } = *judging;
    if model_hash == 0 {
        return Ok(None);
    }
    if let Some(path) = config.station.job.as_deref()
        && let Some(job) = load(path, config).ok().filter(|job| job.model_hash() == model_hash)
    {
        return Ok(Some((path.to_owned(), job)));
    }
    match select(config, Wanted { job_id, model_hash }) {
        Ok(found) => load(&found.path, config).map(|job| Some((found.path, job))),
        Err(refusal) => Err(RoleError::LostJob { job_id, refusal }),
    }
}

/// The one file of the job that a command names, and its hash.
pub(super) fn select(config: &Config, wanted: Wanted) -> Result<Found, Refusal> {
    let folder = &config.station.jobs;
    let Wanted { job_id, .. } = wanted;
    let search = Search::new(config, wanted);
    for reason in &search.skipped {
        log!(code::JOB_REFUSED, remedied: "skipped {reason}");
    }
    match search.found.as_slice() {
        [found] => Ok(found.clone()),
        [] => {
            log!(
                code::JOB_REFUSED,
                "no job {job_id} of the wanted version that fits this station in {}",
                folder.display()
            );
            Err(search.refusal.unwrap_or(Refusal::NoSuchJob))
        }
        [first, second, ..] => {
            log!(
                code::JOB_REFUSED,
                remedied: "the job {job_id} is in {} and in {}: remove one of them, or name the version",
                first.path.display(),
                second.path.display()
            );
            Err(Refusal::Ambiguous)
        }
    }
}

/// A job file that a station can use.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Found {
    pub(super) path: PathBuf,
    pub(super) model_hash: u64,
}

/// What the folder of jobs has to offer.
#[derive(Debug, Default)]
struct Search {
    /// Files of the wanted job and version that fit the station.
    found: Vec<Found>,
    /// File and reason of everything else that might have been meant.
    skipped: Vec<String>,
    /// Why a file of the wanted job was skipped.
    refusal: Option<Refusal>,
}

impl Search {
    fn new(config: &Config, wanted: Wanted) -> Self {
        let mut search = Self::default();
        let folder = &config.station.jobs;
        match job_files(folder) {
            Ok(paths) => paths.into_iter().for_each(|path| search.look_at(path, config, wanted)),
            Err(error) => search.skipped.push(format!("{}: {error}", folder.display())),
        }
        // That of the configuration may lie elsewhere.
        if let Some(path) = config.station.job.as_ref().filter(|_| search.found.is_empty()) {
            search.look_at(path.clone(), config, wanted);
        }
        search
    }

    fn look_at(&mut self, path: PathBuf, config: &Config, wanted: Wanted) {
        let Wanted { job_id, model_hash } = wanted;
        match read(&path) {
            Err(error) => self.skipped.push(error.to_string()),
            Ok(file) if file.id != job_id => {}
            Ok(file) if model_hash != 0 && file.model_hash() != model_hash => {
                self.refusal = Some(Refusal::OtherVersion);
                self.skipped.push(format!(
                    "job {}: its version is {:016x}, and {model_hash:016x} is wanted",
                    path.display(),
                    file.model_hash()
                ));
            }
            Ok(file) => match compatibility::station(&file, config) {
                Ok(()) => self.found.push(Found { path, model_hash: file.model_hash() }),
                Err(misfit) => {
                    self.refusal = Some(Refusal::Unfit);
                    self.skipped.push(format!("job {}: {misfit}", path.display()));
                }
            },
        }
    }
}

/// The job files of a folder. It is listed in no order; what is logged should have one.
pub(crate) fn job_files(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let paths = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    let is_toml = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "toml");
    let is_job = |path: &PathBuf| is_toml(path) && atomic::is_named(path);
    let mut paths: Vec<PathBuf> =
        paths.filter(|path| path.as_ref().map_or(true, is_job)).collect::<std::io::Result<_>>()?;
    paths.sort();
    Ok(paths)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const REPOSITORY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

    /// A station with the objects of the job that comes with Andon, and a folder of jobs of its own.
    fn station(folder: &Path) -> Config {
        let mut config = Config::load(&[format!("{REPOSITORY}/config/stations/demo.toml")]).unwrap();
        config.station.jobs = folder.into();
        config
    }

    fn job() -> JobFile {
        read(Path::new(&format!("{REPOSITORY}/config/jobs/polish-and-measure.toml"))).unwrap()
    }

    fn search(files: &[(&str, &str)], wanted: Wanted) -> Search {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        Search::new(&station(folder.path()), wanted)
    }

    #[test]
    fn the_one_file_of_the_wanted_job_is_found() {
        let wanted = Wanted { job_id: job().id, model_hash: job().model_hash() };
        let search = search(&[("one.toml", &job().to_toml()), ("readme.txt", "no job")], wanted);
        assert_eq!((search.found.len(), search.skipped.len()), (1, 0), "{search:?}");
    }

    #[test]
    fn two_files_of_the_same_job_are_both_found_so_that_neither_is_taken_by_chance() {
        let wanted = Wanted { job_id: job().id, model_hash: 0 };
        let search = search(&[("b.toml", &job().to_toml()), ("a.toml", &job().to_toml())], wanted);
        let names: Vec<_> = search.found.iter().filter_map(|found| found.path.file_name()).collect();
        assert_eq!(names, ["a.toml", "b.toml"]);
    }

    #[test]
    fn what_an_engineer_loaded_last_is_begun_with_while_its_file_has_that_version_and_orders_are_taken() {
        let folder = tempfile::tempdir().unwrap();
        let mut config = station(folder.path());
        config.executor.path = Some(folder.path().into());
        let file = folder.path().join("one.toml");
        std::fs::write(&file, job().to_toml()).unwrap();
        let loaded = Made::new(&config).loaded();
        std::fs::write(&loaded, format!("{} {:016x}", job().id, job().model_hash())).unwrap();
        assert_eq!(ordered(&config), None, "nothing is ordered at this station");
        config.executor.enable = true;
        assert_eq!(ordered(&config), Some(file));
        // Taught again and not loaded since: nobody has decided that it is to judge.
        for other in [format!("{} 1", job().id), format!("77 {:016x}", job().model_hash()), "x".into()] {
            std::fs::write(&loaded, &other).unwrap();
            assert_eq!(ordered(&config), None, "{other}");
        }
    }

    #[test]
    fn a_file_that_is_being_written_is_not_a_second_one_of_its_job() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("one.toml");
        std::fs::write(&file, job().to_toml()).unwrap();
        let _written = atomic::staged(&file, job().to_toml().as_bytes()).unwrap();
        assert_eq!(job_files(folder.path()).unwrap(), [file]);
    }

    #[test]
    fn a_file_that_is_skipped_is_named_with_the_reason() {
        let mut unfit = job();
        let mut missing = unfit.objects[0].clone();
        missing.shape.id = 999;
        unfit.objects.push(missing);
        let wanted = Wanted { job_id: job().id, model_hash: 0 };
        let search = search(&[("broken.toml", "no job"), ("unfit.toml", &unfit.to_toml())], wanted);
        assert!(search.found.is_empty(), "{search:?}");
        assert_eq!(search.refusal, Some(Refusal::Unfit));
        let [broken, unfit] = search.skipped.as_slice() else { unreachable!("{search:?}") };
        assert!(broken.contains("broken.toml"), "{broken}");
        assert!(unfit.contains("unfit.toml") && unfit.contains("no object 999"), "{unfit}");
    }

    #[test]
    fn another_version_is_skipped_and_both_versions_are_named() {
        let wanted = Wanted { job_id: job().id, model_hash: 1 };
        let search = search(&[("one.toml", &job().to_toml())], wanted);
        assert_eq!(search.refusal, Some(Refusal::OtherVersion));
        let reason = search.skipped.concat();
        assert!(reason.contains(&format!("{:016x}", job().model_hash())), "{reason}");
        assert!(reason.contains("0000000000000001 is wanted"), "{reason}");
    }
}
