//! Other stations of the same folder: two cannot have one port, one camera, one journal or one name.

use std::net::IpAddr;
use std::path::{Path, PathBuf};

use andon_host::atomic::folder_of;
use andon_host::config::{Config, Source};
use andon_learn::file;

/// What this station shares with one beside it.
pub(in crate::tool) fn faults(config: &Config) -> Vec<String> {
    let what_is_shared = |(path, other): (PathBuf, Config)| {
        let own = config.files.last().and_then(|own| file::read(own).ok());
        if own.is_some() && own == file::read(&path).ok() {
            let copy = path.display();
            let said = format!(
                "station.name: {copy} is a copy of this station's file: move it to another folder, or give it a name, a port, a journal and a \
                 camera of its own"
            );
            return vec![said];
        }
        let said = move |what| format!("{what}, as the station in {}", path.display());
        shared(config, &other).map(said).collect::<Vec<_>>()
    };
    stations(config).flat_map(what_is_shared).collect()
}

/// The other stations of the same folder, with their files.
pub(in crate::tool) fn stations(config: &Config) -> impl Iterator<Item = (PathBuf, Config)> {
    let own_and_before = config.files.split_last();
    own_and_before.into_iter().flat_map(|(own, before)| {
        beside(own, &config.files).into_iter().filter_map(move |path| {
            let files: Vec<&Path> = before.iter().map(PathBuf::as_path).chain([path.as_path()]).collect();
            // A file that is no station of its own, or has faults, is no neighbour.
            Some((path.clone(), Config::load(&files).ok()?))
        })
    })
}

/// The other files of the folder, in the order of their names.
fn beside(own: &Path, ours: &[PathBuf]) -> Vec<PathBuf> {
    let is_ours = |path: &PathBuf| {
        ours.iter().any(|file| std::fs::canonicalize(file).ok() == std::fs::canonicalize(path).ok())
    };
    let entries = std::fs::read_dir(folder_of(own)).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_toml = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "toml");
    let mut files: Vec<PathBuf> = entries.filter(|path| is_toml(path) && !is_ours(path)).collect();
    files.sort();
    files
}

fn shared(config: &Config, other: &Config) -> impl Iterator<Item = String> {
    let name = (config.root() == other.root())
        .then(|| format!("station.name: this station is called {:?}", config.station.name));
    let port = (config.plc.enable && other.plc.enable && config.plc.port == other.plc.port)
        .then_some(())
        .filter(|()| overlap(config.plc.bind, other.plc.bind))
        .map(|()| format!("plc.port: this station listens on port {}", config.plc.port));
    let board = (config.board.enable && other.board.enable && config.board.port == other.board.port)
        .then_some(())
        .filter(|()| overlap(config.board.bind, other.board.bind))
        .map(|()| format!("board.port: the board of this station listens on port {}", config.board.port));
    let journal = (config.journal_path() == other.journal_path())
        .then(|| format!("journal.path: this station writes {}", config.journal_path().display()));
    let camera = camera(config)
        .filter(|own| camera(other).as_ref() == Some(own))
        .map(|own| format!("camera: this station looks through {own}"));
    [name, port, board, journal, camera].into_iter().flatten()
}

/// An address that means all of them is every other one as well.
fn overlap(one: IpAddr, other: IpAddr) -> bool {
    one == other || one.is_unspecified() || other.is_unspecified()
}

/// The camera, if it is named; a RealSense without a serial number is whichever is found first.
fn camera(config: &Config) -> Option<String> {
    let camera = &config.camera;
    match camera.source {
        Source::V4l2 => Some(camera.device.display().to_string()),
        Source::Realsense => {
            Some(camera.serial.clone().unwrap_or_else(|| "the only RealSense camera".into()))
        }
        Source::Video | Source::Images | Source::Tracks | Source::Bag => None,
    }
}
