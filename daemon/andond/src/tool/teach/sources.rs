//! The recordings that a job was taught from, found again: a job file names them without folders, with the hash of their bytes.
//!
//! They are looked for by name, first among the recordings that are given on the command line. Then come those beside these, beside the job file and
//! in the current folder. A file counts only if its bytes have the hash that the job file has.
//!
//! A path would make other bytes of the same job on another machine. A name alone would take a new recording for the old one.

use std::path::{Path, PathBuf};

use andon_learn::digest::sha256_hex;
use andon_learn::job_file::{JobFile, Source};

use crate::tool::runs::{bytes_of, file_name};

/// Why the recordings that a job was taught from cannot be used again.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// Some are in none of the places.
    #[error(
        "job {} was taught from {}, not found in {}: copy them there, give them on the command line too, or leave them out with --without \
         NAME",
        job.display(), names.join(", "), folders(looked_in)
    )]
    Missing {
        /// The job file.
        job: PathBuf,
        /// Their names.
        names: Vec<String>,
        /// Where they were looked for.
        looked_in: Vec<PathBuf>,
    },
    /// The file of this name is another one.
    #[error(
        "{} is not the {name} that job {} was taught from: its SHA-256 begins with {found}, not with {taught}; give the right one on the \
         command line, or leave it out with --without {name}",
        path.display(), job.display()
    )]
    Changed {
        /// The job file.
        job: PathBuf,
        /// The name.
        name: String,
        /// The file that has it.
        path: PathBuf,
        /// The beginning of the hash of that file.
        found: String,
        /// The beginning of the hash in the job file.
        taught: String,
    },
    /// The job was not taught from what is to be left out.
    #[error("--without {name}: job {} was not taught from it, but from {}", job.display(), names.join(", "))]
    Unknown {
        /// The job file.
        job: PathBuf,
        /// What was asked for.
        name: String,
        /// The names that there are.
        names: Vec<String>,
    },
    /// A recording was given that the job was not taught from.
    #[error("job {} was not taught from {}: add it with --add {}", job.display(), path.display(), path.display())]
    NotOfJob {
        /// The job file.
        job: PathBuf,
        /// The recording.
        path: PathBuf,
    },
}

/// What was asked for: an existing job file, recordings of it, and what is to be added and left out.
pub(super) struct Wanted<'a> {
    pub(super) path: &'a Path,
    pub(super) job: &'a JobFile,
    pub(super) recordings: &'a [PathBuf],
    pub(super) add: &'a [PathBuf],
    pub(super) without: &'a [String],
}

impl Wanted<'_> {
    /// The recordings to teach from: those of the job that are not left out, then those that are added.
    ///
    /// # Errors
    /// What cannot be found, and where it was looked for.
    pub(super) fn find(&self) -> Result<Vec<PathBuf>, SourceError> {
        let sources = &self.job.provenance.sources;
        let job = || self.path.to_path_buf();
        let is_source = |name: &str| sources.iter().any(|source| source.name == name);
        if let Some(name) = self.without.iter().find(|name| !is_source(name)) {
            let names = sources.iter().map(|source| source.name.clone()).collect();
            return Err(SourceError::Unknown { job: job(), name: name.clone(), names });
        }
        if let Some(path) = self.recordings.iter().find(|path| !is_source(&file_name(path))) {
            return Err(SourceError::NotOfJob { job: job(), path: path.clone() });
        }
        let kept = sources.iter().filter(|source| !self.without.contains(&source.name));
        let (mut found, mut names) = (Vec::new(), Vec::new());
        for source in kept {
            match self.find_one(source)? {
                Some(path) => found.push(path),
                None => names.push(source.name.clone()),
            }
        }
        if !names.is_empty() {
            return Err(SourceError::Missing { job: job(), names, looked_in: self.folders() });
        }
        found.extend_from_slice(self.add);
        Ok(found)
    }

    fn find_one(&self, source: &Source) -> Result<Option<PathBuf>, SourceError> {
        let given = self.recordings.iter().filter(|path| file_name(path) == source.name).cloned();
        let beside = self.folders().into_iter().map(|folder| folder.join(&source.name));
        let mut other = None;
        for path in given.chain(beside).filter(|path| path.exists()) {
            let sha256 = bytes_of(&path).map(|bytes| sha256_hex(&bytes)).unwrap_or_default();
            if sha256 == source.sha256 {
                return Ok(Some(path));
            }
            other = other.or(Some((path, sha256)));
        }
        let Some((path, sha256)) = other else { return Ok(None) };
        let head = |sha256: &str| sha256.get(..8).unwrap_or("nothing that can be read").to_owned();
        Err(SourceError::Changed {
            job: self.path.to_path_buf(),
            name: source.name.clone(),
            path,
            found: head(&sha256),
            taught: head(&source.sha256),
        })
    }

    /// The folders of what was given, of the job file, and the current one.
    fn folders(&self) -> Vec<PathBuf> {
        let given = self.recordings.iter().chain(self.add).map(PathBuf::as_path).chain([self.path]);
        let parents = given.filter_map(Path::parent).chain([Path::new("")]);
        let mut folders: Vec<PathBuf> = Vec::new();
        for folder in
            parents.map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder })
        {
            if !folders.iter().any(|other| other == folder) {
                folders.push(folder.to_path_buf());
            }
        }
        folders
    }
}

fn folders(paths: &[PathBuf]) -> String {
    let paths: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    paths.join(", ")
}
