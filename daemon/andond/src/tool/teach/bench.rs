//! The bench as `teach --live` sees it: through the running station, or, where none runs, through roles of its own.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use andon_core::input::Frame;
use andon_host::config::{Config, Source, Speed, in_force};
use andon_host::exit::Code;
use andon_ipc::{Node, Reader, Stop, Wake};
use shm_schemas::{Detections, RoleId, flag};
use tempfile::TempDir;

use crate::tool::ToolError;
use crate::tool::demo::own_folder;
use crate::tool::demo::supervisor::Running;
use crate::wire;

/// How long a station may take to be there, and its first frame to come: models are loaded from a cold disk.
const PATIENCE: Duration = Duration::from_secs(60);
/// How often it is looked whether a person has answered.
const WAIT: Duration = Duration::from_millis(100);
/// For how long it is looked which parts lie on the bench.
const FIRST_LOOK: Duration = Duration::from_millis(500);

/// What comes from the bench next.
pub(super) enum Event {
    Frame(Box<Frame>),
    /// The recording of the station is at its end.
    End,
    /// Somebody has interrupted the program.
    Stop,
    Nothing,
}

/// A bench that is looked at.
pub(super) struct Bench {
    detections: Reader<Detections>,
    node: Node,
    stop: Stop,
    /// The last to go.
    roles: Option<Roles>,
}

impl Bench {
    /// Joins the station if it runs, or else starts what it needs to see.
    ///
    /// # Errors
    /// A role that does not come up, and a station of another version.
    pub(super) fn open(config: &Config) -> Result<Self, ToolError> {
        let stop = Stop::on_signals()?;
        let station = config.ipc_station().map_err(ToolError::Station)?;
        let (station, roles) = if station.is_in_use() {
            eprintln!("looking through the running station {}", config.station.name);
            (station, None)
        } else {
            eprintln!("the station {} does not run: looking through its camera", config.station.name);
            let roles = Roles::start(config)?;
            (roles.config.ipc_station().map_err(ToolError::Station)?, Some(roles))
        };
        let node = Node::open(&station, RoleId::Tool, PATIENCE, &stop)?;
        let detections = node.reader()?;
        Ok(Self { detections, node, stop, roles })
    }

    /// Waits for the first frame, and says which parts are seen and which are not.
    ///
    /// # Errors
    /// A role that has ended, and a station that sees nothing.
    pub(super) fn first_look(&mut self, config: &Config) -> Result<String, ToolError> {
        let opened = Instant::now();
        let mut began = None::<Instant>;
        let mut seen: Vec<u16> = Vec::new();
        while began.is_none_or(|began| began.elapsed() < FIRST_LOOK) {
            match self.next_event()? {
                Event::Frame(frame) => {
                    began.get_or_insert_with(Instant::now);
                    seen.extend(frame.objects.iter().map(|object| object.id));
                }
                Event::End | Event::Stop => break,
                Event::Nothing if began.is_none() && opened.elapsed() > PATIENCE => {
                    return Err(ToolError::NoFrames);
                }
                Event::Nothing => {}
            }
        }
        let names = |is_seen: bool| {
            let objects = config.objects.iter().filter(|object| seen.contains(&object.id) == is_seen);
            objects.map(|object| object.name.as_str()).collect::<Vec<_>>().join(", ")
        };
        Ok(match (names(true).as_str(), names(false).as_str()) {
            ("", _) => "no part is seen on the bench".to_owned(),
            (seen, "") => format!("all parts are seen on the bench: {seen}"),
            (seen, unseen) => format!("seen on the bench: {seen}; not seen: {unseen}"),
        })
    }

    /// Waits a little for the next frame.
    ///
    /// # Errors
    /// A role of its own that has ended.
    pub(super) fn next_event(&mut self) -> Result<Event, ToolError> {
        if let Some(event) = self.waiting()? {
            return Ok(event);
        }
        if let Some(roles) = &mut self.roles {
            roles.running.iter_mut().try_for_each(Running::check)?;
        }
        let wake = self.node.wait(&mut [&mut self.detections], WAIT)?;
        Ok(if wake == Wake::Stop { Event::Stop } else { Event::Nothing })
    }

    /// What has come and was not looked at, without waiting.
    ///
    /// # Errors
    /// The station's shared memory.
    pub(super) fn waiting(&mut self) -> Result<Option<Event>, ToolError> {
        let message = self.detections.take()?;
        Ok(message.map(|message| match message.flags & flag::END_OF_STREAM {
            0 => Event::Frame(Box::new(wire::detections::to_core(&message))),
            _ => Event::End,
        }))
    }

    /// Forgets what has come and was not looked at.
    ///
    /// # Errors
    /// The station's shared memory.
    pub(super) fn forget(&mut self) -> Result<(), ToolError> {
        while self.detections.take()?.is_some() {}
        Ok(())
    }

    /// How many frames were lost so far.
    pub(super) fn lost(&self) -> u64 {
        self.detections.lost()
    }

    /// Leaves the station. From now on an interrupt ends the process, as if it had never waited for one.
    pub(super) fn close(self) {
        let Self { stop, .. } = self;
        std::thread::spawn(move || {
            while !stop.wait(PATIENCE) {}
            std::process::exit(i32::from(Code::Stopped as u8));
        });
    }
}

/// What a station needs to see, as processes of its own in a directory of their own.
struct Roles {
    running: Vec<Running>,
    config: Config,
    _folder: TempDir,
}

impl Roles {
    fn start(config: &Config) -> Result<Self, ToolError> {
        let failed = |source| ToolError::Demo { what: "its files".into(), source };
        let folder = own_folder().map_err(failed)?;
        let mut config = config.clone();
        config.station.root = folder.path().to_owned();
        // It is only looked at: nobody judges, keeps or tells, and nobody is waited for.
        config.station.job = None;
        config.camera.speed = Speed::File;
        (config.plc.enable, config.metrics.enable) = (false, false);
        let path: PathBuf = folder.path().join("station.toml");
        std::fs::write(&path, in_force(&config)).map_err(failed)?;
        let names = match config.camera.source {
            Source::Tracks => &["steward", "perceive"][..],
            _ => &["steward", "capture", "perceive"],
        };
        let files = [path];
        let start = |name: &&'static str| Running::start(name, &files, folder.path());
        let running = names.iter().map(start).collect::<Result<_, _>>()?;
        Ok(Self { running, config, _folder: folder })
    }
}

impl Drop for Roles {
    /// The steward cleans up after those that left before it.
    fn drop(&mut self) {
        while self.running.pop().is_some() {}
    }
}
