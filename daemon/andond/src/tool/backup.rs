//! `andond backup`: configuration, jobs with the pictures of their steps, calibration, what was made for an engineer, and journal in one file.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use andon_host::atomic::{self, folder_of};
use andon_host::config::Config;
use andon_host::exit::Code;
use andon_journal::{History, JournalError};
use andon_learn::file;

use super::{ToolError, cannot_write, jobs, running_config};
use crate::backup::{self, Kind, Manifest};
use crate::cli::Backup;
use crate::made::Made;
use crate::{role, step_pictures};

/// Runs the command. The journal is copied as it is at one moment, also while the line writes it.
///
/// # Errors
/// What cannot be read, or that the archive cannot be written.
pub fn run(arguments: &Backup) -> Result<Code, ToolError> {
    let config = running_config(&arguments.config)?.config;
    let (manifest, contents) = gather(&config, files(&config)?, &arguments.archive)?;
    let archive = &arguments.archive;
    let write = || -> std::io::Result<()> {
        // Beside it first: a backup that is broken off leaves the one before it. It holds what is not for everybody.
        let file = tempfile::NamedTempFile::new_in(folder_of(archive))?;
        backup::write(file.reopen()?, manifest.clone(), &contents)?;
        atomic::put(file.into_temp_path(), archive)
    };
    write().map_err(cannot_write(archive))?;
    for entry in &manifest.files {
        println!("{}  {}", entry.sha256, entry.path.display());
    }
    println!("written: {}", archive.display());
    Ok(Code::Stopped)
}

/// The bytes of these files, and the list of them. What was found in a folder and is gone meanwhile is in neither.
fn gather(
    config: &Config,
    files: Vec<(PathBuf, Kind)>,
    archive: &Path,
) -> Result<(Manifest, Vec<Vec<u8>>), ToolError> {
    let (mut manifest, mut contents) = (backup::manifest(&config.station.name, config.root()), Vec::new());
    for (path, kind) in files {
        let read = if kind == Kind::Journal { journal(&path, archive) } else { read(&path) };
        let bytes = match read {
            Err(ToolError::Read { source, .. })
                if source.kind() == ErrorKind::NotFound && !is_named(config, &path, kind) =>
            {
                continue;
            }
            read => read?,
        };
        manifest.files.push(backup::entry(contents.len() + 1, &path, kind, &bytes));
        contents.push(bytes);
    }
    Ok((manifest, contents))
}

/// Whether a station without this file is none: the configuration names it, or it is the journal.
fn is_named(config: &Config, path: &Path, kind: Kind) -> bool {
    let job = config.station.job.as_ref().and_then(|job| std::path::absolute(job).ok());
    matches!(kind, Kind::Configuration | Kind::Calibration | Kind::Journal) || job.as_deref() == Some(path)
}

/// What belongs to the station, each file once.
fn files(config: &Config) -> Result<Vec<(PathBuf, Kind)>, ToolError> {
    let mut files: Vec<(PathBuf, Kind)> = Vec::new();
    let mut add = |path: &Path, kind| {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.into());
        if !files.iter().any(|(known, _)| *known == path) {
            files.push((path, kind));
        }
    };
    config.files.iter().for_each(|file| add(file, Kind::Configuration));
    for job in jobs::files_of_station(config)? {
        add(&job, Kind::Job);
        // What is left of another job than the one that the file holds now is no part of the station.
        let hash = role::read_job(&job).ok().map(|job| job.model_hash());
        let pictures = step_pictures::beside(&job).into_iter();
        pictures
            .filter(|picture| Some(picture.model_hash) == hash)
            .for_each(|picture| add(&picture.path, Kind::StepPicture));
    }
    config.bench.calibration.iter().for_each(|calibration| add(calibration, Kind::Calibration));
    Made::new(config).kept().iter().for_each(|file| add(file, Kind::Made));
    let journal = config.journal_path();
    if journal.exists() {
        add(&journal, Kind::Journal);
    }
    Ok(files)
}

/// The journal as it is at one moment. The copy lies beside the archive meanwhile, where room for it is needed anyway.
fn journal(path: &Path, archive: &Path) -> Result<Vec<u8>, ToolError> {
    let folder = tempfile::Builder::new()
        .prefix(".andon-")
        .tempdir_in(folder_of(archive))
        .map_err(cannot_write(archive))?;
    let copy = folder.path().join("journal.sqlite");
    History::open(path)?.copy_to(&copy).map_err(|error| match error {
        // It is the copy that finds no room, not the journal.
        JournalError::Full { .. } => cannot_write(archive)(rustix::io::Errno::NOSPC.into()),
        other => other.into(),
    })?;
    read(&copy)
}

fn read(path: &Path) -> Result<Vec<u8>, ToolError> {
    file::read(path).map_err(cannot_read(path))
}

fn cannot_read(path: &Path) -> impl Fn(std::io::Error) -> ToolError {
    |source| ToolError::Read { path: path.into(), source, remedy: "let this user read it" }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::fs;

    #[test]
    fn what_is_removed_while_it_runs_is_not_in_it_and_what_the_configuration_names_must_be_there() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let mut config = Config { files: vec![at("station.toml")], ..Config::default() };
        config.station.jobs = at("jobs");
        config.station.job = Some(at("jobs/own.toml"));
        config.executor.path = Some(folder.path().into());
        config.journal.path = Some(at("none.sqlite"));
        let [own, other, report] = ["jobs/own.toml", "jobs/other.toml", "reports/other.html"].map(at);
        for file in [&at("station.toml"), &own, &other, &report] {
            fs::create_dir_all(folder_of(file)).unwrap();
            fs::write(file, "bytes").unwrap();
        }
        let found = files(&config).unwrap();
        let gathered = |found: &[(PathBuf, Kind)]| {
            let (manifest, contents) = gather(&config, found.to_vec(), &at("station.tar"))?;
            assert_eq!(manifest.files.len(), contents.len());
            Ok::<_, ToolError>(manifest.files.into_iter().map(|entry| entry.path).collect::<Vec<_>>())
        };
        let all = [at("station.toml"), own.clone(), other.clone(), report.clone()];
        assert_eq!(gathered(&found).unwrap(), all);
        fs::remove_file(other).unwrap();
        fs::remove_file(report).unwrap();
        assert_eq!(gathered(&found).unwrap(), all[..2]);
        fs::remove_file(own).unwrap();
        assert!(gathered(&found).unwrap_err().to_string().contains("own.toml"));
    }
}
