//! `andond demo`: runs every role as its own process, plays the shipped clips through all of them, and prints what a
//! technician would read.

mod channels;
mod film;
mod summary;
pub(super) mod supervisor;
pub(super) mod usage;

use std::io::ErrorKind;
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use andon_core::verdict::Verdict;
use andon_host::cli::ConfigArgs;
use andon_host::config::Config;
use andon_host::exit::Code;
use andon_ipc::{Node, Station, Stop};
use shm_schemas::RoleId;

use super::progress::Progress;
use super::{ToolError, job, progress};
use crate::cli::{Demo, Speed};
use crate::report::{Names, Teller, on_recording};
use crate::wire;
use channels::{Channels, Received};
use summary::{Row, Summary};
use supervisor::Running;
use usage::Usage;

/// The roles that stay up from clip to clip, in the order of the data path.
const ROLES: [(&str, RoleId); 6] = [
    ("steward", RoleId::Steward),
    ("perceive", RoleId::Perceive),
    ("encode", RoleId::Encode),
    ("judge", RoleId::Judge),
    ("journal", RoleId::Journal),
    ("plc", RoleId::Plc),
];

/// Those that a board needs: it shows what just ran, with clips of the faults.
const BOARD_ROLES: [(&str, RoleId); 2] = [("record", RoleId::Record), ("board", RoleId::Board)];

/// The name of the demo's station.
const STATION: &str = "demo";

/// Where the clips, the job and the parts of the demo are: in a source tree, then in an installation.
const CLIPS: [&str; 2] = ["tests/footage", "/usr/share/andon"];
const JOBS: [&str; 2] = ["config/jobs/polish-and-measure.toml", "/etc/andon/jobs/polish-and-measure.toml"];
const STATIONS: [&str; 2] = ["config/stations/demo.toml", "/etc/andon/stations/film.toml"];

/// What to read next.
const PAGES: [&str; 2] = ["README.md", "/usr/share/doc/andon/README.md"];

/// What to do about a folder without clips.
const CLIPS_REMEDY: &str = "name a folder with films (.mp4) with --clips";

/// How long the roles may take to come up: the models are loaded from a cold disk.
const START: Duration = Duration::from_secs(60);

/// For how long nothing may happen while a clip runs.
const SILENCE: Duration = Duration::from_secs(30);

/// Runs the command.
///
/// # Errors
/// What is missing, or the role that ended, with the end of its log.
pub fn run(arguments: &Demo) -> Result<Code, ToolError> {
    let job = arguments.job.clone().unwrap_or_else(|| existing(JOBS));
    let file = job::load(&job)?;
    let names = Names::of_job(&file);
    let folder = arguments.clips.clone().unwrap_or_else(|| existing(CLIPS));
    let clips = clips(&folder)?;
    let mut line = Line::start(arguments, &job, &clips[0])?;
    // And capture.
    println!("watching the job {:?} with {} roles, one process each", file.name, line.roles.len() + 1);
    println!("{} clips; an IU is the time in which a hand touches the same parts", clips.len());
    let mut played = Vec::new();
    for clip in &clips {
        let Some(outcome) = line.play(clip, arguments, &names)? else { return Ok(Code::Stopped) };
        outcome.print();
        played.push(outcome.received);
    }
    line.print_usage();
    let rate_hz = file.method.rate_hz;
    let row = |(clip, received): (&PathBuf, &Received)| Row::new(clip, received, &names, rate_hz);
    let rows = clips.iter().zip(&played).map(row).collect();
    let pages = existing(PAGES);
    print!("\n{}", Summary { rows, rate_hz, needed_hz: file.min_rate_hz, pages: &pages });
    // Afterwards: drawing would take the processor from the line.
    if let Some(folder) = &arguments.annotate {
        for (clip, received) in clips.iter().zip(&played) {
            film::write(clip, folder, received, &names, file.method.blind_ms)?;
        }
    }
    if let Some(address) = line.board.clone() {
        println!("\nthe board shows what ran, until Ctrl-C:");
        println!("      {address} for the worker, {address}technician for the technician");
        line.show(&clips[0])?;
    }
    Ok(Code::Stopped)
}

/// The first of the paths that there is; the first of all where there is none, so that the error names it.
fn existing(paths: [&str; 2]) -> PathBuf {
    paths.into_iter().find(|path| Path::new(path).exists()).unwrap_or(paths[0]).into()
}

/// The configuration files that were named, or those of the demo's bench. An installation has the parts in the station that plays a film.
fn configs(arguments: &ConfigArgs) -> Vec<PathBuf> {
    if arguments.files.is_empty() && std::env::var_os("ANDON_CONFIG").is_none() {
        return vec![existing(STATIONS)];
    }
    arguments.in_force()
}

/// The films of a folder, by name.
fn clips(folder: &Path) -> Result<Vec<PathBuf>, ToolError> {
    let refused = |source| ToolError::Read { path: folder.into(), source, remedy: CLIPS_REMEDY };
    let listed = std::fs::read_dir(folder).map_err(refused)?;
    let mut clips: Vec<PathBuf> = listed.flatten().map(|entry| entry.path()).collect();
    clips.retain(|path| path.extension().is_some_and(|ending| ending == "mp4"));
    clips.sort();
    if clips.is_empty() {
        return Err(refused(ErrorKind::NotFound.into()));
    }
    Ok(clips)
}

/// Two ports that no program listens on now: a demo may run beside a station.
fn free_ports() -> std::io::Result<[u16; 2]> {
    let free = || TcpListener::bind((Ipv4Addr::LOCALHOST, 0));
    // Both are taken before one is free again, so that they differ.
    let [one, other] = [free()?, free()?];
    Ok([one.local_addr()?.port(), other.local_addr()?.port()])
}

/// A folder that is removed with the demo. It holds sockets, whose paths must be short: where TMPDIR is too long, it is made
/// under /tmp.
pub(super) fn own_folder() -> std::io::Result<tempfile::TempDir> {
    let folder = tempfile::Builder::new().prefix("andon-").tempdir()?;
    if Station::under(STATION, &folder.path().join(STATION)).is_ok() {
        return Ok(folder);
    }
    tempfile::Builder::new().prefix("andon-").tempdir_in("/tmp")
}

fn no_files(source: std::io::Error) -> ToolError {
    ToolError::Demo { what: "its files".into(), source }
}

/// Writes what the demo's station has of its own.
fn own_config(folder: &Path, job: &Path, clip: &Path, has_board: bool) -> std::io::Result<PathBuf> {
    let [plc, board] = free_ports()?;
    let mut text = format!(
        "[station]\nname = {STATION:?}\nroot = {folder:?}\njob = {:?}\n[camera]\nsource = \"video\"\npath = {:?}\n\
         [journal]\npath = {:?}\n[plc]\nenable = true\nport = {}\n",
        std::path::absolute(job)?,
        std::path::absolute(clip)?,
        folder.join("journal.sqlite"),
        plc
    );
    if has_board {
        text += &format!(
            "[board]\nenable = true\nbind = \"127.0.0.1\"\nport = {board}\nlogins = {:?}\n[record]\nmode = \"fault\"\npath = {:?}\n",
            folder.join("logins.toml"),
            folder.join("recordings")
        );
    }
    let path = folder.join("demo.toml");
    std::fs::write(&path, text)?;
    Ok(path)
}

/// The running line.
struct Line {
    // Declared in the order in which they must be dropped: the readers, the roles, their directory.
    channels: Channels,
    node: Node,
    roles: Vec<Running>,
    folder: tempfile::TempDir,
    configs: Vec<PathBuf>,
    began: Instant,
    /// Messages lost and frames skipped in all clips so far.
    losses: u64,
    /// What all captures used together, one per clip.
    capture: Usage,
    /// The address of the board, where there is one.
    board: Option<String>,
}

/// What came of one clip.
struct Outcome {
    received: Received,
    took: Duration,
    losses: u64,
}

impl Line {
    fn start(arguments: &Demo, job: &Path, clip: &Path) -> Result<Self, ToolError> {
        let folder = own_folder().map_err(no_files)?;
        let mut configs = configs(&arguments.config);
        configs.push(own_config(folder.path(), job, clip, arguments.board).map_err(no_files)?);
        let config = Config::load(&configs)?;
        let mut roles = vec![Running::start("steward", &configs, folder.path())?];
        let stop = Stop::on_signals()?;
        let station = Station::under(&config.station.name, &config.root())?;
        let node = Node::open(&station, RoleId::Tool, START, &stop)?;
        let mut channels = Channels::open(&node)?;
        let mut wanted = ROLES.to_vec();
        wanted.extend(BOARD_ROLES.into_iter().filter(|_| arguments.board));
        for &(name, _) in &wanted[1..] {
            roles.push(Running::start(name, &configs, folder.path())?);
        }
        // A role that has ended says why; waiting for it would only delay that.
        let mut check = || roles.iter_mut().try_for_each(Running::check);
        let ids: Vec<RoleId> = wanted.iter().map(|(_, id)| *id).collect();
        let missing = channels.wait_for(&node, &ids, START, &mut check)?;
        if !missing.is_empty() {
            return Err(ToolError::NotUp(missing));
        }
        // They stop in this order: the steward cleans up after the others.
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
            board: arguments.board.then(|| {
                let scheme = if config.board.certificate.is_some() { "https" } else { "http" };
                format!("{scheme}://localhost:{}/", config.board.port)
            }),
        })
    }

    /// Plays one clip to its end; `None` when a stop was asked for.
    fn play(&mut self, clip: &Path, arguments: &Demo, names: &Names) -> Result<Option<Outcome>, ToolError> {
        let began = Instant::now();
        let mut capture = self.start_capture(clip, arguments.speed, false)?;
        let bar = progress(None, clip);
        println!("\n{}", clip.file_name().unwrap_or_default().to_string_lossy());
        let mut received = Received::default();
        let (mut newest, mut teller) = (Instant::now(), Teller::default());
        while !received.finished {
            let before = (received.verdicts.len(), received.detections.len());
            let wait = Duration::from_millis(500);
            let goes_on = self.channels.listen(&self.node, &mut received, wait);
            if !goes_on? {
                return Ok(None);
            }
            print_new(&received, before.0, names, &mut teller, &bar)?;
            bar.set_position(received.detections.len() as u64);
            if before != (received.verdicts.len(), received.detections.len()) {
                newest = Instant::now();
            }
            for role in self.roles.iter_mut().chain([&mut capture]) {
                role.check()?;
            }
            if newest.elapsed() > SILENCE {
                return Err(ToolError::Silence { clip: clip.into(), silence: SILENCE });
            }
        }
        bar.finish_and_clear();
        self.capture.add(usage::of(capture.pid()));
        // Health counts from the start of a role.
        let so_far: u64 = received.health.iter().map(|health| health.losses).sum();
        let losses = so_far.saturating_sub(self.losses);
        self.losses = so_far;
        Ok(Some(Outcome { received, took: began.elapsed(), losses }))
    }

    /// Plays a clip again and again, until a stop is asked for: a board without a camera says that nobody watches.
    fn show(&mut self, clip: &Path) -> Result<(), ToolError> {
        let mut capture = self.start_capture(clip, Speed::File, true)?;
        // What nobody takes would count as lost.
        while self.channels.listen(&self.node, &mut Received::default(), Duration::from_millis(500))? {
            for role in self.roles.iter_mut().chain([&mut capture]) {
                role.check()?;
            }
        }
        Ok(())
    }

    /// Starts the role that plays a clip, once or in a loop.
    fn start_capture(&self, clip: &Path, speed: Speed, is_loop: bool) -> Result<Running, ToolError> {
        let mut configs = self.configs.clone();
        configs.push(self.clip_config(clip, speed, is_loop)?);
        Running::start("capture", &configs, self.folder.path())
    }

    fn clip_config(&self, clip: &Path, speed: Speed, is_loop: bool) -> Result<PathBuf, ToolError> {
        let path = self.folder.path().join("clip.toml");
        let speed = match speed {
            Speed::File => "file",
            Speed::Max => "max",
        };
        let clip = std::path::absolute(clip).map_err(no_files)?;
        std::fs::write(
            &path,
            format!("[camera]\nsource = \"video\"\npath = {clip:?}\nspeed = {speed:?}\nloop = {is_loop}\n"),
        )
        .map_err(no_files)?;
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
fn print_new(
    received: &Received,
    from: usize,
    names: &Names,
    teller: &mut Teller,
    bar: &Progress,
) -> Result<(), ToolError> {
    if received.verdicts.len() == from {
        return Ok(());
    }
    let mut new = received.verdicts[from..].iter().filter_map(wire::verdict::read);
    let printed = bar.suspend(|| {
        let mut out = anstream::stdout().lock();
        new.try_for_each(|verdict: Verdict| {
            teller.tell(&on_recording(verdict.decided_ns), &verdict, names).write(&mut out)
        })
    });
    printed.map_err(ToolError::Print)
}

impl Outcome {
    fn print(&self) {
        let frames = self.received.detections.len();
        let mut latencies: Vec<u64> = self
            .received
            .verdicts
            .iter()
            .map(|verdict| verdict.stamp.sent_ns.saturating_sub(verdict.stamp.captured_ns))
            .collect();
        latencies.sort_unstable();
        let at = |share: f64| {
            let index = ((latencies.len() as f64 - 1.0) * share).round().max(0.0) as usize;
            latencies.get(index).map_or(0.0, |&ns| ns as f64 / 1e6)
        };
        println!(
            "{frames} frames in {:.1} s ({:.1} per second), {} lost or skipped; frame to verdict {:.1} ms (median), {:.1} ms (p99)",
            self.took.as_secs_f64(),
            frames as f64 / self.took.as_secs_f64(),
            self.losses,
            at(0.50),
            at(0.99)
        );
    }
}
