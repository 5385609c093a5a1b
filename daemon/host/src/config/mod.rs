//! The configuration: from TOML files to one typed [`Config`], or to every fault at once.
//!
//! ```
//! use andon_host::config::Config;
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("bench1.toml");
//! std::fs::write(&path, "[station]\nnmae = 'bench1'\n[camera]\nrate_hz = 1000\n")?;
//! let faults = Config::load(&[&path]).unwrap_err().to_string();
//! assert!(faults.contains("bench1.toml:2: station.nmae = 'bench1': is not a key that exists; did you mean `name`?"));
//! assert!(faults.contains("bench1.toml:4: camera.rate_hz = 1000: must be a number from 1.0 to 240.0 Hz"));
//! # Ok::<(), std::io::Error>(())
//! ```
//!
//! Each key is declared once (`sections`) for a visitor (`keys`). One visitor reads files (`read`), one writes the annotated reference (`reference`),
//! one writes the configuration in force (`in_force`). What several keys must agree on is in `check`.

mod check;
mod document;
mod fault;
mod in_force;
mod keys;
mod read;
mod reference;
mod sections;
mod value;

pub use fault::{Fault, Faults};
pub use in_force::in_force;
pub use reference::reference;
pub use sections::bench::{Bench, Object};
pub use sections::board::Board;
pub use sections::camera::{Camera, Encoding, Source, Speed};
pub use sections::executor::Executor;
pub use sections::perception::{HandModel, Perception};
pub use sections::record::{Mode as RecordMode, Record, Trigger};
pub use sections::service::{Health, Journal, Log, Metrics, Plc};
pub use sections::station::Station;

use andon_core::config::Method;
use andon_core::object::ObjectShape;
use andon_learn::digest::sha256_hex;
use check::Learned;
use document::{Document, File};
use keys::Keys;
use read::Reader;
use shm_schemas::RoleId;
use std::path::{Path, PathBuf};

/// The folder of all that has no path of its own: `StateDirectory=` of the units.
pub const STATE: &str = "/var/lib/andon";

/// The configuration of one station.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Config {
    /// Which bench this is.
    pub station: Station,
    /// Where the frames come from.
    pub camera: Camera,
    /// The frame of reference.
    pub bench: Bench,
    /// How hands and objects are found.
    pub perception: Perception,
    /// The things that carry a marker.
    pub objects: Vec<Object>,
    /// The constants of the method, with the bench's `space`.
    pub method: Method,
    /// Where verdicts are kept.
    pub journal: Journal,
    /// The Modbus TCP server.
    pub plc: Plc,
    /// Numbers for a monitoring system.
    pub metrics: Metrics,
    /// What is recorded.
    pub record: Record,
    /// The pages for people.
    pub board: Board,
    /// What an engineer may order there.
    pub executor: Executor,
    /// When a role counts as stuck.
    pub health: Health,
    /// How much is logged.
    pub log: Log,
    /// The files that it was read from. They are no part of what it says.
    pub files: Vec<PathBuf>,
}

impl Config {
    /// Reads `paths` over the defaults, a later one over an earlier one.
    ///
    /// # Errors
    /// Every fault of all files: the caller prints them, starts nothing and exits with
    /// [`crate::exit::Code::Configuration`].
    pub fn load(paths: &[impl AsRef<Path>]) -> Result<Self, Faults> {
        Self::read(paths, Learned::Needed)
    }

    /// As [`Config::load`], for the tools that make the job or the calibration, or read recordings of their own. Neither those nor the station's own
    /// recording need to exist yet.
    ///
    /// # Errors
    /// As [`Config::load`].
    pub fn load_to_learn(paths: &[impl AsRef<Path>]) -> Result<Self, Faults> {
        Self::read(paths, Learned::Awaited)
    }

    /// What could be read of files that may be half edited, with all their faults.
    pub(crate) fn read_leniently(paths: &[impl AsRef<Path>]) -> (Self, Option<Faults>) {
        Self::read_all(paths, Learned::Needed)
    }

    /// Identifies what it says: the same values give the same number on every machine.
    #[must_use]
    pub fn hash(&self) -> u64 {
        let digest = sha256_hex(in_force(self).as_bytes());
        // The first 16 of 64 hexadecimal digits.
        digest.get(..16).and_then(|digits| u64::from_str_radix(digits, 16).ok()).unwrap_or_default()
    }

    fn read(paths: &[impl AsRef<Path>], learned: Learned) -> Result<Self, Faults> {
        match Self::read_all(paths, learned) {
            (config, None) => Ok(config),
            (_, Some(faults)) => Err(faults),
        }
    }

    fn read_all(paths: &[impl AsRef<Path>], learned: Learned) -> (Self, Option<Faults>) {
        let mut faults = Vec::new();
        let files: Vec<File> =
            paths.iter().filter_map(|path| File::open(path.as_ref(), &mut faults)).collect();
        let documents: Vec<Document<'_>> =
            files.iter().map(|file| Document::parse(file, &mut faults)).collect();
        // A file that cannot be read may hold any key: to call a key missing would only confuse.
        let complete = faults.is_empty();
        let files_read = paths.iter().map(|path| path.as_ref().to_owned()).collect();
        let mut config = Self { files: files_read, ..Self::default() };
        let mut reader = Reader::new(&documents, complete);
        config.keys(&mut reader);
        let (origins, refused) = reader.finish();
        let line = |fault: &Fault| (fault.file.clone(), fault.line);
        let not_toml: Vec<_> = faults.iter().map(line).collect();
        faults.extend(refused.into_iter().filter(|fault| !not_toml.contains(&line(fault))));
        if complete {
            faults.extend(check::check(&config, &documents, &origins, learned));
        }
        let position =
            |fault: &Fault| (paths.iter().position(|path| path.as_ref() == fault.file), fault.line);
        faults.sort_by_key(position);
        let faults = (!faults.is_empty()).then_some(Faults(faults));
        (config, faults)
    }

    /// Declares all sections, in the order of the data path.
    fn keys(&mut self, k: &mut impl Keys) {
        k.section("station", "which bench this is.", |k| self.station.keys(k));
        k.section("camera", "where the frames come from.", |k| self.camera.keys(k));
        k.section("bench", "the frame of reference.", |k| self.bench.keys(&mut self.method.space, k));
        k.section("perception", "how hands and objects are found.", |k| self.perception.keys(k));
        k.list("objects", "one section per thing that carries a marker.", &mut self.objects, |object, k| {
            object.keys(k);
        });
        k.section("method", "the constants of the method.", |k| sections::method::keys(&mut self.method, k));
        k.section("journal", "where verdicts are kept.", |k| self.journal.keys(k));
        k.section("plc", "the Modbus TCP server.", |k| self.plc.keys(k));
        k.section("metrics", "numbers for a monitoring system.", |k| self.metrics.keys(k));
        k.section("record", "what is kept to be looked at again.", |k| self.record.keys(k));
        k.section("board", "pages for worker, technician and engineer.", |k| self.board.keys(k));
        k.section("executor", "what an engineer may order on the board.", |k| self.executor.keys(k));
        k.section("health", "when a role counts as stuck.", |k| self.health.keys(k));
        k.section("log", "how much is logged.", |k| self.log.keys(k));
    }

    /// The station's directory, `<root>/<name>`: the files of its services live there.
    #[must_use]
    pub fn root(&self) -> PathBuf {
        self.station.root.join(&self.station.name)
    }

    /// The station in shared memory.
    ///
    /// # Errors
    /// A root that cannot be one.
    pub fn ipc_station(&self) -> Result<andon_ipc::Station, andon_ipc::Error> {
        andon_ipc::Station::under(&self.station.name, &self.root())
    }

    /// The database of the journal.
    #[must_use]
    pub fn journal_path(&self) -> PathBuf {
        let default = || Path::new(STATE).join(format!("{}.sqlite", self.station.name));
        self.journal.path.clone().unwrap_or_else(default)
    }

    /// The folder of the recordings.
    #[must_use]
    pub fn recordings(&self) -> PathBuf {
        let default = || Path::new(STATE).join(format!("{}.recordings", self.station.name));
        self.record.path.clone().unwrap_or_else(default)
    }

    /// The file of the board's logins.
    #[must_use]
    pub fn logins_path(&self) -> PathBuf {
        let default = || Path::new(STATE).join(format!("{}.logins.toml", self.station.name));
        self.board.logins.clone().unwrap_or_else(default)
    }

    /// The folder of what is made for an engineer: reports, markers, pictures, earlier versions of jobs.
    #[must_use]
    pub fn executor_path(&self) -> PathBuf {
        let default = || Path::new(STATE).join(format!("{}.executor", self.station.name));
        self.executor.path.clone().unwrap_or_else(default)
    }

    /// The folder of the recordings that an engineer can teach from.
    #[must_use]
    pub fn films(&self) -> PathBuf {
        self.executor.films.clone().unwrap_or_else(|| self.executor_path().join("films"))
    }

    /// The roles that this station needs: the steward, then the others in the order of the data path.
    #[must_use]
    pub fn roles(&self) -> Vec<RoleId> {
        let is_needed = |role: &RoleId| match role {
            // A track file has no pictures to capture.
            RoleId::Capture => self.camera.source != Source::Tracks,
            RoleId::Plc => self.plc.enable,
            RoleId::Metrics => self.metrics.enable,
            RoleId::Record => self.record.mode != RecordMode::Off,
            RoleId::Board => self.board.enable,
            RoleId::Executor => self.executor.enable,
            _ => true,
        };
        let roles = [
            RoleId::Steward,
            RoleId::Capture,
            RoleId::Perceive,
            RoleId::Encode,
            RoleId::Judge,
            RoleId::Journal,
            RoleId::Plc,
            RoleId::Metrics,
            RoleId::Record,
            RoleId::Board,
            RoleId::Executor,
        ];
        roles.into_iter().filter(is_needed).collect()
    }

    /// The constants of the method.
    #[must_use]
    pub fn method(&self) -> Method {
        self.method
    }

    /// What is known of the objects before they are seen.
    #[must_use]
    pub fn shapes(&self) -> Vec<ObjectShape> {
        let shape = |object: &Object| ObjectShape {
            id: object.id,
            // `load` allows no more of them than fit.
            interaction_points: match &object.interaction_points {
                Some(points) => points.iter().copied().collect(),
                None => [[0.0; 3]].into_iter().collect(),
            },
            ..ObjectShape::default()
        };
        self.objects.iter().map(shape).collect()
    }
}
