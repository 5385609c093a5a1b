//! Recordings as runs that a job can be learned from, for the commands that look at several of them.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use andon_core::config::Method;
use andon_core::input::Space;
use andon_host::config::Config;
use andon_learn::digest::sha256_hex;
use andon_learn::file;
use andon_learn::recording as learn;
use andon_learn::run::Run;

use super::{ToolError, each_frame};
use crate::recording::Recording;

/// The space that all recordings share; that of the configuration where there is none.
///
/// # Errors
/// What cannot be opened, and recordings of two spaces.
pub(super) fn common_space(recordings: &[PathBuf], config: &Config) -> Result<Space, ToolError> {
    let mut space = None;
    for path in recordings {
        // A film is not opened for this: it has no depth.
        let own = match Recording::knows_its_station(path) {
            true => Recording::open(path, config)?.header().space,
            false => Space::Plane,
        };
        if *space.get_or_insert(own) != own {
            return Err(ToolError::MixedSpaces(path.clone()));
        }
    }
    Ok(space.unwrap_or(config.method.space))
}

/// Reads the recordings, as many at a time as the machine has processors: each film is decoded in a process of its own. They come in the
/// order in which they were given. `done` is told after each.
///
/// # Errors
/// The first that cannot be read or is no run.
pub(super) fn read_runs(
    recordings: &[PathBuf],
    config: &Config,
    method: &Method,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Run>, ToolError> {
    let next = Mutex::new(0..recordings.len());
    let runs: Mutex<Vec<Option<Result<Run, ToolError>>>> =
        Mutex::new((0..recordings.len()).map(|_| None).collect());
    let work = || {
        // A poisoned lock means that another worker panicked, which ends the process anyway.
        while let Some(index) = next.lock().ok().and_then(|mut next| next.next()) {
            let run = read_run(&recordings[index], config, method);
            if let Ok(mut runs) = runs.lock() {
                runs[index] = Some(run);
            }
            done();
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from).min(recordings.len()) {
            scope.spawn(work);
        }
    });
    runs.into_inner().unwrap_or_default().into_iter().flatten().collect()
}

fn read_run(path: &Path, config: &Config, method: &Method) -> Result<Run, ToolError> {
    let mut recording = Recording::open_run(path, config)?;
    let mut frames = Vec::new();
    each_frame(&mut recording, path, |frame| {
        frames.push(frame);
        Ok(())
    })?;
    let refused = |source| ToolError::Read { path: path.into(), source, remedy: "let this user read it" };
    let sha256 = sha256_hex(&bytes_of(path).map_err(refused)?);
    let recording = learn::Recording { header: recording.header().clone(), frames, truncation: None };
    Run::new(&file_name(path), &sha256, &recording, method)
        .map_err(|source| ToolError::Run { path: path.into(), source })
}

/// The bytes that the hash of a recording covers: those of a file, or of the pictures of a folder one after the other.
pub(super) fn bytes_of(path: &Path) -> std::io::Result<Vec<u8>> {
    if !path.is_dir() {
        return file::read(path);
    }
    let mut files: Vec<_> =
        std::fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    files.sort();
    let mut bytes = Vec::new();
    for file in files.iter().filter(|file| file.is_file()) {
        bytes.extend(std::fs::read(file)?);
    }
    Ok(bytes)
}

/// The name of a recording without its folder, as a job file has it.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
