//! The text of a station file.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use andon_host::config::{Config, STATE};

use super::hands_listed;
use crate::cli::Hands;

/// A part that carries a marker.
#[derive(Debug)]
pub(super) struct Part {
    pub(super) id: u16,
    pub(super) name: String,
    pub(super) side_m: f64,
}

/// Where the frames come from.
#[derive(Debug)]
pub(super) enum Camera {
    /// A V4L2 device.
    Device(String),
    Realsense,
    /// A recording of this kind, by the word of `camera.source`.
    Recording {
        kind: &'static str,
        path: PathBuf,
    },
}

/// Where the program finds what belongs to it.
#[derive(Debug)]
pub(super) enum Installation {
    /// The package is installed: the defaults hold.
    Package,
    /// A source tree, whose models are in this folder.
    Sources { models: Option<PathBuf> },
}

impl Installation {
    pub(super) fn of_this_machine() -> Self {
        if Config::default().perception.models.is_dir() {
            return Self::Package;
        }
        // The program is in target/debug or target/release, the models in target/runtime.
        let program = std::env::current_exe().unwrap_or_default();
        let folders = program.ancestors().map(|folder| folder.join("runtime"));
        Self::Sources { models: folders.skip(1).take(3).find(|folder| folder.is_dir()) }
    }
}

/// What a station file says.
#[derive(Debug)]
pub(super) struct Station {
    pub(super) name: String,
    pub(super) parts: Vec<Part>,
    pub(super) camera: Camera,
    pub(super) hands: Hands,
    /// The port of its board, if it has one.
    pub(super) board: Option<u16>,
    /// The language of that board.
    pub(super) language: String,
    pub(super) installation: Installation,
}

impl Station {
    /// Where its jobs lie, from the folder of its file.
    pub(super) fn jobs(&self) -> PathBuf {
        match self.installation {
            // There the units write, so that an engineer can teach.
            Installation::Package if self.board.is_some() => {
                Path::new(STATE).join(format!("{}.jobs", self.name))
            }
            Installation::Package => Config::default().station.jobs,
            Installation::Sources { .. } => "jobs".into(),
        }
    }

    /// The file, with comments for the person who will edit it.
    pub(super) fn text(&self) -> String {
        let mut text = format!(
            "# The station {}. `andond check -c FILE` reports every fault in this file, and `andond config --default` explains\n# every key.\n\n\
             [station]\nname = {}\n",
            self.name,
            quoted(&self.name)
        );
        if let Installation::Sources { .. } = self.installation {
            text += "# Without root's rights. Where the package is installed, leave this key out: a cleaner of /tmp would split the line.\n\
                     root = \"/tmp/andon\"\n";
            text += "# Where `andond jobs` and `andond use` look.\njobs = \"jobs\"\n";
        }
        if let (Installation::Package, Some(_)) = (&self.installation, self.board) {
            let _ = writeln!(text, "# Where an engineer's jobs lie.\njobs = {}", quoted_path(&self.jobs()));
        }
        let _ = writeln!(
            text,
            "# The job that the line begins with, once `andond teach` has written it.\n#job = {}\n",
            quoted_path(&self.jobs().join("my-job.toml"))
        );
        text += &self.camera();
        text += "[perception]\n# The hands that work here: \"right\", \"left\" or both.\n";
        let _ = writeln!(text, "hands = {}", hands_listed(self.hands));
        if let Installation::Sources { models: Some(models) } = &self.installation {
            let _ = writeln!(text, "models = {}", quoted_path(models));
        }
        text += "\n# What carries a marker, and the marker's id. Print them with `andond markers`, measure the black square of one with a\n\
                 # ruler, and correct marker_side_m if the printer has changed its size. Id 0 cannot be used: it stands for no object.\n";
        for Part { id, name, side_m } in &self.parts {
            let _ = writeln!(
                text,
                "[[objects]]\nid = {id}\nname = {}\nmarker_side_m = {side_m:?}\n",
                quoted(name)
            );
        }
        text += "[plc]\n# Modbus TCP; with true, `allow` and `writes` say who may connect and who may command.\nenable = false\n";
        if let Some(port) = self.board {
            let _ = writeln!(
                text,
                "\n[board]\n# Pages for worker, technician and engineer, in a browser of this machine. `language` is one of de, en, es, fr, zh.\n\
                 enable = true\nport = {port}\nlanguage = {}\n\n[executor]\n# What an engineer orders on the board is done.\nenable = true",
                quoted(&self.language)
            );
        }
        if let Installation::Sources { .. } = self.installation {
            let _ = writeln!(text, "\n[journal]\npath = {}", quoted(&format!("{}.sqlite", self.name)));
        }
        text
    }

    fn camera(&self) -> String {
        let picture = "# The size and the rate that the camera is asked for.\nwidth = 1280\nheight = 720\nrate_hz = 30.0\n\
                       # Under 50 Hz light a multiple of 10000 does not flicker; without it the camera chooses.\n#exposure_us = 10000\n";
        match &self.camera {
            Camera::Device(device) => {
                let device = quoted(device);
                format!("[camera]\nsource = \"v4l2\"\ndevice = {device}\n{picture}\n")
            }
            Camera::Realsense => format!("[camera]\nsource = \"realsense\"\n{picture}\n"),
            Camera::Recording { kind, path } => {
                let path = quoted_path(path);
                format!(
                    "[camera]\n# A recording in place of a camera.\nsource = \"{kind}\"\npath = {path}\n\n"
                )
            }
        }
    }
}

fn quoted_path(path: &Path) -> String {
    quoted(&path.display().to_string())
}

/// A text as TOML has it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use andon_core::input::Side;
    use andon_host::config::Source;

    fn station(camera: Camera, installation: Installation) -> Station {
        let part = |(id, name): (u16, &str)| Part { id, name: name.into(), side_m: 0.036 };
        let parts = [(1, "brick"), (2, "the \"grey\" Schleifklotz\\2")].map(part).into();
        Station {
            name: "bench1".into(),
            parts,
            camera,
            hands: Hands::Right,
            board: None,
            language: "de".into(),
            installation,
        }
    }

    fn read(station: &Station) -> Config {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bench1.toml");
        std::fs::write(&path, station.text()).unwrap();
        Config::load(&[&path]).unwrap()
    }

    #[test]
    fn what_is_written_is_read_without_a_fault_and_says_what_was_given() {
        let installed = station(Camera::Device("/dev/video2".into()), Installation::Package);
        let config = read(&installed);
        assert_eq!((config.camera.source, config.camera.device), (Source::V4l2, "/dev/video2".into()));
        assert_eq!(config.perception.hands, [Side::Right]);
        let objects: Vec<_> = config
            .objects
            .iter()
            .map(|object| (object.id, object.name.as_str(), object.marker_side_m.unwrap()))
            .collect();
        assert_eq!(objects, [(1, "brick", 0.036), (2, "the \"grey\" Schleifklotz\\2", 0.036)]);
        assert_eq!(config.station.root, Path::new("/run/andon"));

        let config = read(&Station { board: Some(9470), ..installed });
        assert_eq!((config.board.enable, config.board.port, config.executor.enable), (true, 9470, true));
        assert_eq!(config.board.language, "de");
        assert_eq!(config.station.jobs, Path::new("/var/lib/andon/bench1.jobs"));

        let models = tempfile::tempdir().unwrap();
        let film = models.path().join("run 1.mp4");
        std::fs::write(&film, "").unwrap();
        let from_sources = Installation::Sources { models: Some(models.path().into()) };
        let config = read(&station(Camera::Recording { kind: "video", path: film.clone() }, from_sources));
        assert_eq!((config.camera.source, config.camera.path), (Source::Video, Some(film)));
        assert_eq!(config.perception.models, models.path());
        assert_eq!(config.station.root, Path::new("/tmp/andon"));
        assert!(config.journal.path.unwrap().ends_with("bench1.sqlite"));
    }

    #[test]
    fn no_line_is_longer_than_a_terminal() {
        let text = station(Camera::Realsense, Installation::Sources { models: None }).text();
        assert!(text.lines().all(|line| line.len() <= 120), "{text}");
        assert!(toml::from_str::<toml::Table>(&text).is_ok());
    }
}
