//! `andond demo`: every role as its own process, the shipped clips through all of them, and what a technician reads.

mod film;
mod supervisor;
mod usage;
mod watch;

use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use andon_core::verdict::Verdict;
use andon_ipc::{Node, Station, Stop};
use indicatif::ProgressBar;
use shm_schemas::RoleId;

use super::{Failure, config_files, job, progress};
use crate::cli::{Demo, Speed};
use crate::config::Config;
use crate::exit::Code;
use crate::report::{Names, verdict_sentence};
use crate::wire;
use supervisor::Running;
use usage::Usage;
use watch::{Channels, Heard};

/// The roles that stay up from clip to clip, in the order of the data path.
const ROLES: [(&str, RoleId); 6] = [
    ("steward", RoleId::Steward),
    ("perceive", RoleId::Perceive),
    ("encode", RoleId::Encode),
    ("judge", RoleId::Judge),
    ("journal", RoleId::Journal),
    ("plc", RoleId::Plc),
];

/// Name of the demo's station.
const STATION: &str = "demo";

/// How long the roles may take to come up: the models are loaded from a cold disk.
const START: Duration = Duration::from_secs(60);

/// For how long nothing may happen while a clip runs.
const SILENCE: Duration = Duration::from_secs(30);

/// Runs the command.
///
/// # Errors
/// What is missing, or the role that ended with its last words.
pub fn run(arguments: &Demo) -> Result<Code, Failure> {
    let file = job::load(&arguments.job)?;
    let names = Names::new(file.objects.iter().map(|object| (object.shape.id, object.name.clone())));
    let clips = clips(&arguments.clips)?;
    let mut line = Line::start(arguments, &clips[0])?;
    println!("watching the job {:?} with {} roles, one process each", file.name, ROLES.len() + 1);
    let mut played = Vec::new();
    for clip in &clips {
        let Some(outcome) = line.play(clip, arguments, &names)? else { return Ok(Code::Stopped) };
        outcome.print();
        played.push(outcome.heard);
    }
    line.print_usage();
    // Afterwards: drawing would take the processor from the line.
    if let Some(folder) = &arguments.annotate {
        for (clip, heard) in clips.iter().zip(&played) {
            film::write(clip, folder, heard, &names)?;
        }
    }
    Ok(Code::Stopped)
}

/// The films of a folder, by name.
fn clips(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let listed = std::fs::read_dir(folder).map_err(|error| {
        Failure::new(Code::Usage, format!("{}: {error}; name the clips with --clips", folder.display()))
    })?;
    let mut clips: Vec<PathBuf> = listed.flatten().map(|entry| entry.path()).collect();
    clips.retain(|path| path.extension().is_some_and(|ending| ending == "mp4"));
    clips.sort();
    if clips.is_empty() {
        return Err(Failure::new(Code::Usage, format!("{}: no film (.mp4) in it", folder.display())));
    }
    Ok(clips)
}

/// A port that nobody listens on now: a demo may run beside a station.
fn free_port() -> std::io::Result<u16> {
    Ok(TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?.local_addr()?.port())
}

/// A folder that goes with the demo. Sockets lie in it, whose paths must be short: where TMPDIR is too long, under /tmp.
fn own_folder() -> std::io::Result<tempfile::TempDir> {
    let folder = tempfile::Builder::new().prefix("andon-").tempdir()?;
    if Station::under(STATION, &folder.path().join(STATION)).is_ok() {
        return Ok(folder);
    }
    tempfile::Builder::new().prefix("andon-").tempdir_in("/tmp")
}

/// The running line.
struct Line {
    // Declared in the order in which they must go: the reader, the roles, their directory.
    channels: Channels,
    node: Node,
    roles: Vec<Running>,
    folder: tempfile::TempDir,
    configs: Vec<PathBuf>,
    began: Instant,
    /// Messages lost and frames skipped in all clips so far.
    losses: u64,
    /// Of all captures together, one a clip.
    capture: Usage,
}

/// What one clip gave.
struct Outcome {
    heard: Heard,
    took: Duration,
    losses: u64,
}

impl Line {
    fn start(arguments: &Demo, clip: &Path) -> Result<Self, Failure> {
        let fault = |error: std::io::Error| Failure::new(Code::Fault, error);
        let folder = own_folder().map_err(fault)?;
        let own = folder.path().join("demo.toml");
        let job = std::path::absolute(&arguments.job).map_err(fault)?;
        let text = format!(
            "[station]\nname = {STATION:?}\nroot = {:?}\njob = {:?}\n[camera]\nsource = \"video\"\npath = {:?}\n\
             [journal]\npath = {:?}\n[plc]\nenable = true\nport = {}\n",
            folder.path(),
            job,
            std::path::absolute(clip).map_err(fault)?,
            folder.path().join("journal.sqlite"),
            free_port().map_err(fault)?
        );
        std::fs::write(&own, text).map_err(fault)?;
        let mut configs = config_files(&arguments.config);
        configs.push(own);
        let config = Config::load(&configs)?;
        let mut roles = vec![Running::start("steward", &configs, folder.path())?];
        let unusable = |error: andon_ipc::Error| Failure::new(Code::Fault, error);
        let stop = Stop::on_signals().map_err(unusable)?;
        let station = Station::under(&config.station.name, &config.root()).map_err(unusable)?;
        let node = Node::open(&station, RoleId::Tool, START, &stop).map_err(unusable)?;
        let mut channels = Channels::open(&node).map_err(unusable)?;
        for (name, _) in ROLES.into_iter().skip(1) {
            roles.push(Running::start(name, &configs, folder.path())?);
        }
        let missing = channels.wait_for(&node, &ROLES.map(|(_, id)| id), START).map_err(unusable)?;
        for role in &mut roles {
            role.check()?;
        }
        if !missing.is_empty() {
            return Err(Failure::new(Code::Fault, format!("these roles did not come up: {missing:?}")));
        }
        // They stop in this order: the steward cleans up after those who left before it.
        roles.reverse();
        Ok(Self {
            channels,
            node,
            roles,
            folder,
            configs,
            began: Instant::now(),
            losses: 0,
            capture: Usage::default(),
        })
    }

    /// Plays one clip to its end; `None` when a stop was asked for.
    fn play(&mut self, clip: &Path, arguments: &Demo, names: &Names) -> Result<Option<Outcome>, Failure> {
        let began = Instant::now();
        let mut configs = self.configs.clone();
        configs.push(self.clip_config(clip, arguments.speed)?);
        let mut capture = Running::start("capture", &configs, self.folder.path())?;
        let bar = progress(None, clip);
        println!("\n{}", clip.file_name().unwrap_or_default().to_string_lossy());
        let mut heard = Heard::default();
        let mut newest = Instant::now();
        while !heard.finished {
            let before = (heard.verdicts.len(), heard.detections.len());
            let wait = Duration::from_millis(500);
            let goes_on = self.channels.listen(&self.node, &mut heard, wait);
            if !goes_on.map_err(|error| Failure::new(Code::Fault, error))? {
                return Ok(None);
            }
            print_new(&heard, before.0, names, &bar);
            bar.set_position(heard.detections.len() as u64);
            if before != (heard.verdicts.len(), heard.detections.len()) {
                newest = Instant::now();
            }
            for role in self.roles.iter_mut().chain([&mut capture]) {
                role.check()?;
            }
            if newest.elapsed() > SILENCE {
                return Err(Failure::new(
                    Code::NoProgress,
                    format!("{}: nothing came for {SILENCE:?}", clip.display()),
                ));
            }
        }
        bar.finish_and_clear();
        self.capture.add(usage::of(capture.pid()));
        // Health counts from the start of a role.
        let so_far: u64 = heard.health.iter().map(|health| health.losses).sum();
        let losses = so_far.saturating_sub(self.losses);
        self.losses = so_far;
        Ok(Some(Outcome { heard, took: began.elapsed(), losses }))
    }

    fn clip_config(&self, clip: &Path, speed: Speed) -> Result<PathBuf, Failure> {
        let fault = |error: std::io::Error| Failure::new(Code::Fault, error);
        let path = self.folder.path().join("clip.toml");
        let speed = match speed {
            Speed::File => "file",
            Speed::Max => "max",
        };
        let clip = std::path::absolute(clip).map_err(fault)?;
        std::fs::write(&path, format!("[camera]\nsource = \"video\"\npath = {clip:?}\nspeed = {speed:?}\n"))
            .map_err(fault)?;
        Ok(path)
    }

    fn print_usage(&self) {
        let up_s = self.began.elapsed().as_secs_f64();
        println!("\nrole        processor   own memory   shared memory");
        let capture = [("capture", self.capture)].into_iter();
        for (name, usage) in
            capture.chain(self.roles.iter().rev().map(|role| (role.name, usage::of(role.pid()))))
        {
            println!(
                "{name:10}  {:7.1} %   {:6.1} MiB   {:6.1} MiB",
                100.0 * usage.cpu_s / up_s,
                usage.own_mib,
                usage.shared_mib
            );
        }
    }
}

/// Prints the verdicts from number `from` on.
fn print_new(heard: &Heard, from: usize, names: &Names, bar: &ProgressBar) {
    let new: Vec<Verdict> = heard.verdicts[from..].iter().filter_map(wire::verdict::read).collect();
    bar.suspend(|| {
        for verdict in new {
            println!("{}", verdict_sentence(&verdict, names));
        }
    });
}

impl Outcome {
    fn print(&self) {
        let frames = self.heard.detections.len();
        let mut latencies: Vec<u64> = self
            .heard
            .verdicts
            .iter()
            .map(|verdict| verdict.stamp.sent_ns.saturating_sub(verdict.stamp.captured_ns))
            .collect();
        latencies.sort_unstable();
        let at = |share: f64| {
            let place = ((latencies.len() as f64 - 1.0) * share).round().max(0.0) as usize;
            latencies.get(place).map_or(0.0, |&ns| ns as f64 / 1e6)
        };
        println!(
            "{frames} frames in {:.1} s ({:.1} a second), {} lost or skipped; frame to verdict {:.1} ms (median), {:.1} ms (p99)",
            self.took.as_secs_f64(),
            frames as f64 / self.took.as_secs_f64(),
            self.losses,
            at(0.50),
            at(0.99)
        );
    }
}
