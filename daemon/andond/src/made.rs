//! The files of the commands that an engineer orders on the board: the role `executor` makes them, and the board shows them.

use std::path::{Path, PathBuf};

use andon_host::atomic;
use andon_host::config::Config;
use andon_learn::digest::sha256_hex;
use andon_learn::job_file::JobFile;

use crate::mark::{Mark, mark};

/// Letters of a hash in the name of a file.
const HASH: usize = 16;

/// Where they are.
#[derive(Clone, Debug)]
pub(crate) struct Made {
    folder: PathBuf,
    jobs: PathBuf,
    films: PathBuf,
    station: String,
}

impl Made {
    pub(crate) fn new(config: &Config) -> Self {
        Self {
            folder: config.executor_path(),
            jobs: config.station.jobs.clone(),
            films: config.films(),
            station: config.station.name.clone(),
        }
    }

    /// The folders that are written in.
    pub(crate) fn folders(&self) -> [PathBuf; 6] {
        let of = |name: &str| self.folder.join(name);
        let own = ["reports", "markers", "versions", "stations"].map(of);
        let [reports, markers, versions, stations] = own;
        [self.folder.clone(), reports, markers, versions, stations, self.jobs.clone()]
    }

    /// What a backup has of it: neither recordings nor pictures of the bench.
    pub(crate) fn kept(&self) -> Vec<PathBuf> {
        // Others may have files in the folder itself.
        let [_folder, folders @ .., _jobs] = self.folders();
        let own = [self.calibration(), self.loaded()].into_iter().filter(|path| path.is_file());
        let kept = folders.iter().flat_map(|folder| files(folder)).filter(|path| atomic::is_named(path));
        kept.chain(own).collect()
    }

    /// The pictures of the bench that were taken when somebody looked or calibrated.
    pub(crate) fn pictures(&self) -> [PathBuf; 3] {
        [self.picture(), self.seen(), self.calibrated()]
    }

    /// All files that there are, and what changes with those that were written anew. It is less to ask for than what is in them.
    pub(crate) fn marks(&self) -> Vec<(PathBuf, Mark)> {
        let folders = self.folders().into_iter().chain([self.films.clone()]);
        let paths = folders.flat_map(|folder| files(&folder));
        paths.map(|path| (path.clone(), mark(&path))).collect()
    }

    /// What the running task has changed, for the next start of the role.
    pub(crate) fn unfinished(&self) -> PathBuf {
        self.folder.join("unfinished.json")
    }

    /// Which job and version an engineer has loaded last: its number and its hash.
    pub(crate) fn loaded(&self) -> PathBuf {
        self.folder.join("loaded")
    }

    /// The folder of the jobs.
    pub(crate) fn jobs(&self) -> &Path {
        &self.jobs
    }

    /// The job of this name, whether there is one or not.
    pub(crate) fn job(&self, name: &str) -> PathBuf {
        self.jobs.join(format!("{name}.toml"))
    }

    /// The report of its last teaching.
    pub(crate) fn report(&self, job: &str) -> PathBuf {
        self.folder.join("reports").join(format!("{job}.html"))
    }

    /// The report of the teaching that made this version of a job.
    pub(crate) fn report_of(&self, job: &str, hash: &str) -> PathBuf {
        self.report(&format!("{job}.{hash}"))
    }

    /// The folder of the markers.
    pub(crate) fn markers(&self) -> PathBuf {
        self.folder.join("markers")
    }

    /// The markers to print.
    pub(crate) fn markers_pdf(&self) -> PathBuf {
        self.markers().join(format!("{}-markers.pdf", self.station))
    }

    /// The file of a new station.
    pub(crate) fn station(&self, name: &str) -> PathBuf {
        self.folder.join("stations").join(format!("{name}.toml"))
    }

    /// The files of new stations.
    pub(crate) fn stations(&self) -> Vec<PathBuf> {
        files(&self.folder.join("stations"))
    }

    /// What the camera saw when somebody looked last, as it gave it.
    pub(crate) fn picture(&self) -> PathBuf {
        self.folder.join("look.png")
    }

    /// The same with what is seen in it.
    pub(crate) fn seen(&self) -> PathBuf {
        self.folder.join("seen.jpg")
    }

    /// A new calibration, where the station file names none.
    pub(crate) fn calibration(&self) -> PathBuf {
        self.folder.join("calibration.toml")
    }

    /// Where the markers of the calibration lie, and where it places them.
    pub(crate) fn calibrated(&self) -> PathBuf {
        self.folder.join("calibrated.jpg")
    }

    /// An earlier version of a job, by its hash.
    pub(crate) fn version(&self, job: &str, hash: &str) -> PathBuf {
        self.folder.join("versions").join(format!("{job}.{hash}.toml"))
    }

    /// These bytes, which were in the file of a job and had a fault. They are no version, and each has a file of its own.
    pub(crate) fn faulty(&self, job: &str, bytes: &[u8]) -> PathBuf {
        self.kept_as(&format!("{job}.faulty"), bytes)
    }

    /// A calibration with these bytes, which another one has replaced. By its name it is a version of no job.
    pub(crate) fn calibration_before(&self, bytes: &[u8]) -> PathBuf {
        self.kept_as("bench.calibration", bytes)
    }

    fn kept_as(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let digest = sha256_hex(bytes);
        self.folder.join("versions").join(format!("{name}.{}.toml", &digest[..HASH]))
    }

    /// The earlier versions of a job, in the order of their names.
    pub(crate) fn versions(&self, job: &str) -> Vec<PathBuf> {
        let is_of = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let hash = name.strip_prefix(job).and_then(|rest| rest.strip_prefix('.')?.strip_suffix(".toml"));
            hash.is_some_and(is_hash)
        };
        files(&self.folder.join("versions")).into_iter().filter(is_of).collect()
    }

    /// The folder of the recordings that can be taught from.
    pub(crate) fn films_folder(&self) -> &Path {
        &self.films
    }

    /// The recordings that can be taught from.
    pub(crate) fn films(&self) -> Vec<PathBuf> {
        files(&self.films).into_iter().filter(|path| named(path).is_some_and(is_name)).collect()
    }

    /// The recording of this name, if it is one of those there are.
    pub(crate) fn film(&self, name: &str) -> Option<PathBuf> {
        self.films().into_iter().find(|path| named(path) == Some(name))
    }
}

/// How a version of a job is called.
pub(crate) fn hash_of(job: &JobFile) -> String {
    format!("{:016x}", job.model_hash())
}

/// Whether this is the hash of a version.
pub(crate) fn is_hash(text: &str) -> bool {
    text.len() == HASH && text.bytes().all(|byte| byte.is_ascii_hexdigit())
}

/// Whether a job or a recording may be called like that: a name that is no path, no option and nothing to a shell.
pub(crate) fn is_name(text: &str) -> bool {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"._-".contains(&byte);
    let begins = text.bytes().next().is_some_and(|byte| byte.is_ascii_alphanumeric());
    begins && text.len() <= 56 && text.bytes().all(is_plain)
}

fn named(path: &Path) -> Option<&str> {
    path.file_name()?.to_str()
}

/// The plain files of a folder, in the order of their names; none where it cannot be read.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_file()).collect();
    paths.sort();
    paths
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_name_is_no_path_no_option_and_nothing_to_a_shell() {
        for name in ["polish", "Polish-2", "p1_J1_r1.mp4", "7"] {
            assert!(is_name(name), "{name}");
        }
        let long = "x".repeat(57);
        for name in
            ["", "..", "../x", "a/b", "-rf", ".hidden", "a b", "a;b", "$(x)", "a\nb", "ä", "a\0b", "~", &long]
        {
            assert!(!is_name(name), "{name}");
        }
    }

    #[test]
    fn only_files_of_the_folder_are_recordings_and_only_hashes_are_versions() {
        let folder = tempfile::tempdir().unwrap();
        let mut config = Config::default();
        config.executor.path = Some(folder.path().into());
        let made = Made::new(&config);
        for inner in ["films/inner", "versions"] {
            std::fs::create_dir_all(folder.path().join(inner)).unwrap();
        }
        for file in ["a.mp4", "-rf", "b c.mp4"] {
            std::fs::write(folder.path().join("films").join(file), "").unwrap();
        }
        assert_eq!(made.films(), [folder.path().join("films/a.mp4")]);
        assert_eq!((made.film("inner"), made.film("../films/a.mp4")), (None, None));
        for file in ["job.0123456789abcdef.toml", "job.toml", "job.x.toml", "other.0123456789abcdef.toml"] {
            std::fs::write(folder.path().join("versions").join(file), "").unwrap();
        }
        assert_eq!(made.versions("job"), [made.version("job", "0123456789abcdef")]);
        let marks = made.marks();
        assert_eq!(made.marks(), marks);
        std::fs::write(made.version("job", "0123456789abcdef"), "another one").unwrap();
        assert_ne!(made.marks(), marks);
    }
}
