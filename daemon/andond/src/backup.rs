//! The archive of a station: configuration, jobs, pictures of their steps, calibration, what was made for an engineer, and journal, each with its
//! hash, in one tar file.
//!
//! The first entry lists the others: its name in the archive, where it was, its length and SHA-256. A restore looks at all of it before it
//! writes anything.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Component, Path, PathBuf};

use andon_learn::digest::sha256_hex;
use andon_learn::file;
use serde::{Deserialize, Serialize};

/// The name of the entry that lists the others.
const MANIFEST: &str = "andon-backup.json";

/// The version of this layout.
const VERSION: u32 = 1;

/// What an archive holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Manifest {
    /// The layout.
    pub(crate) version: u32,
    /// Version of the program that wrote it.
    pub(crate) program: String,
    /// When it was written, RFC 3339.
    pub(crate) written: String,
    /// The station.
    pub(crate) station: String,
    /// The station's directory, by which a line that runs is found.
    pub(crate) root: PathBuf,
    /// What follows, in this order.
    pub(crate) files: Vec<Entry>,
    /// SHA-256 of all of the above, so that the list itself is checked.
    #[serde(default)]
    pub(crate) seal: String,
}

/// One file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Entry {
    /// Its name in the archive.
    pub(crate) name: String,
    /// Where it was, absolute.
    pub(crate) path: PathBuf,
    /// What it is to the station.
    pub(crate) kind: Kind,
    /// SHA-256 of its bytes, in hexadecimal.
    pub(crate) sha256: String,
}

/// What a file is to the station.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Kind {
    /// A file of the configuration.
    Configuration,
    /// A job.
    Job,
    /// What a step of a job looks like.
    StepPicture,
    /// The place of the bench.
    Calibration,
    /// What was made for an engineer: earlier versions of jobs, reports, markers, files of stations.
    Made,
    /// The database of the verdicts.
    Journal,
}

/// Why an archive cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// It cannot be read or written.
    #[error("the archive {path}: {source}")]
    File {
        /// The archive.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// It is damaged, or was not written by `andond backup`.
    #[error("the archive {path} is damaged or none of `andond backup`: {why}; nothing was changed")]
    Damaged {
        /// The archive.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// The line runs.
    #[error(
        "the station {0} is running: stop it first (`systemctl stop andon@{0}.target`); nothing was changed"
    )]
    Running(String),
    /// Files that are there differ from those of the archive.
    #[error("these files exist and differ: {}; nothing was changed, --replace would replace them", list(.0))]
    InTheWay(Vec<PathBuf>),
}

fn list(paths: &[PathBuf]) -> String {
    paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ")
}

impl Manifest {
    fn sealed(mut self) -> Self {
        self.seal = self.digest();
        self
    }

    fn digest(&self) -> String {
        let bare = Self { seal: String::new(), ..self.clone() };
        // A struct of texts and numbers always has a JSON.
        sha256_hex(serde_json::to_string(&bare).unwrap_or_default().as_bytes())
    }
}

/// Writes the archive: the manifest, then the files with their bytes.
///
/// # Errors
/// What the system says.
pub(crate) fn write(to: File, manifest: Manifest, contents: &[Vec<u8>]) -> io::Result<()> {
    let mut archive = tar::Builder::new(to);
    let text = serde_json::to_string_pretty(&manifest.clone().sealed())?;
    append(&mut archive, MANIFEST, text.as_bytes())?;
    for (entry, bytes) in manifest.files.iter().zip(contents) {
        append(&mut archive, &entry.name, bytes)?;
    }
    archive.into_inner()?.sync_all()
}

fn append(archive: &mut tar::Builder<File>, name: &str, bytes: &[u8]) -> io::Result<()> {
    let mut header = tar::Header::new_gnu();
    header.set_size(bytes.len() as u64);
    header.set_mode(0o600);
    archive.append_data(&mut header, name, bytes)
}

/// An archive that was read and is whole.
#[derive(Debug)]
pub(crate) struct Archive {
    pub(crate) manifest: Manifest,
    /// The bytes of each file, in the order of the manifest.
    pub(crate) contents: Vec<Vec<u8>>,
}

impl Archive {
    /// Reads all of it and checks every hash.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(crate) fn read(path: &Path) -> Result<Self, ArchiveError> {
        let file = file::open(path).map_err(|source| ArchiveError::File { path: path.into(), source })?;
        let damaged = |why: String| ArchiveError::Damaged { path: path.into(), why };
        let entries = read_entries(file).map_err(|error| damaged(error.to_string()))?;
        let mut entries = entries.into_iter();
        let (name, text) = entries.next().ok_or_else(|| damaged("it is empty".into()))?;
        if name != MANIFEST {
            return Err(damaged(format!("it begins with {name} and not with {MANIFEST}")));
        }
        let manifest: Manifest = serde_json::from_slice(&text).map_err(|error| damaged(error.to_string()))?;
        if manifest.version != VERSION {
            return Err(damaged(format!(
                "it has version {}, and this Andon knows {VERSION}",
                manifest.version
            )));
        }
        if manifest.seal != manifest.digest() {
            return Err(damaged("its list of files was changed".into()));
        }
        let mut contents = Vec::new();
        for entry in &manifest.files {
            let found = entries.next().filter(|(name, _)| *name == entry.name);
            let (_, bytes) = found.ok_or_else(|| damaged(format!("{} is missing", entry.name)))?;
            if sha256_hex(&bytes) != entry.sha256 {
                return Err(damaged(format!("{} has another hash", entry.name)));
            }
            let is_plain = |part: Component<'_>| matches!(part, Component::RootDir | Component::Normal(_));
            if !entry.path.is_absolute() || !entry.path.components().all(is_plain) {
                return Err(damaged(format!("{} has no absolute path", entry.name)));
            }
            contents.push(bytes);
        }
        Ok(Self { manifest, contents })
    }

    /// The files with their bytes.
    pub(crate) fn files(&self) -> impl Iterator<Item = (&Entry, &[u8])> {
        self.manifest.files.iter().zip(self.contents.iter().map(Vec::as_slice))
    }
}

fn read_entries(file: File) -> io::Result<Vec<(String, Vec<u8>)>> {
    let mut archive = tar::Archive::new(file);
    let mut entries = Vec::new();
    for entry in archive.entries()? {
        let mut entry = entry?;
        let name = entry.path()?.to_string_lossy().into_owned();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes)?;
        if bytes.len() as u64 != entry.size() {
            return Err(io::Error::new(io::ErrorKind::UnexpectedEof, format!("{name} is cut short")));
        }
        entries.push((name, bytes));
    }
    Ok(entries)
}

/// A list of nothing yet, for a station.
pub(crate) fn manifest(station: &str, root: PathBuf) -> Manifest {
    Manifest {
        version: VERSION,
        program: env!("CARGO_PKG_VERSION").into(),
        written: jiff::Timestamp::now().to_string(),
        station: station.into(),
        root,
        files: Vec::new(),
        seal: String::new(),
    }
}

/// The entry of a file with these bytes, the `number`th of the archive.
pub(crate) fn entry(number: usize, path: &Path, kind: Kind, bytes: &[u8]) -> Entry {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    Entry { name: format!("{number:03}-{name}"), path: path.into(), kind, sha256: sha256_hex(bytes) }
}
