//! A whole line: the real roles as processes of a station under /tmp, fed by the track file of a simulated worker.
//!
//! The roles are started and supervised as systemd does it, and watched from outside only. That is by the channels, by Modbus, by the commands of
//! `andond` and by `/proc`.
#![allow(clippy::unwrap_used, clippy::panic)]

mod client;
mod film;
mod journalled;
mod metrics;
mod process;
mod recorded;
mod shift;
mod soft_plc;
mod stand_in;
mod watcher;

pub use client::{Modbus, control, status};
pub use film::{NOISE, UNSEEN, UNSEEN_S, root};
pub use journalled::Journalled;
pub use metrics::{ask, measure, samples, scrape, tally, verdicts};
pub use process::{Killed, Process, andond, own_memory_kib};
pub use recorded::detections_in;
pub use shift::{Counted, Kept, Shift, Told, account, kept, told, told_last};
pub use soft_plc::soft_plc;
pub use stand_in::{Sender, stand_in};
pub use watcher::{Watcher, role_id};

use crate::simulator::{Flaw, Noise, Performance, perform};
use andon_core::config::Contact;
use andon_core::input::Frame;
use andon_core::object::ContactRegion;
use andon_ipc::Station;
use andon_learn::job_file::JobFile;
use andon_learn::recording::{self, Header};
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs;
use std::io::BufWriter;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Whatever must happen sooner or later has happened by then, also on a machine that does twenty other things. Only a test that fails waits for so
/// long.
pub const PATIENCE: Duration = Duration::from_secs(300);

/// The roles of a line without pictures, in the order in which a target starts them.
pub const ROLES: [&str; 6] = ["steward", "perceive", "encode", "judge", "journal", "plc"];

/// How the worker's recording is played.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// As fast as the readers take it, instead of at the worker's own pace.
    pub at_full_speed: bool,
    /// From the start again at its end, for ever.
    pub repeat: bool,
    /// Whether the PLC may write.
    pub writes: bool,
    /// What the worker does wrong.
    pub flaw: Flaw,
}

impl Default for Settings {
    fn default() -> Self {
        Self { at_full_speed: true, repeat: false, writes: false, flaw: Flaw::None }
    }
}

impl Settings {
    /// The worker repeats the job for ever, at their own pace.
    pub fn live() -> Self {
        Self { at_full_speed: false, repeat: true, ..Self::default() }
    }
}

/// A station with its files. Nothing of it is left when this is dropped.
pub struct Line {
    /// Running roles; see [`Line::start`].
    pub roles: Vec<Process>,
    /// The station.
    pub station: Station,
    /// Where Modbus listens.
    pub port: u16,
    /// Environment variables of the roles that are started from now on.
    pub environment: Vec<(&'static str, OsString)>,
    folder: TempDir,
}

impl Line {
    /// Lays out the station; nothing runs yet.
    pub fn new(settings: Settings) -> Self {
        let line = Self::configured(|folder, port| {
            let (recording, _) = perform(&performance(9, 1), settings.flaw);
            save(&folder.join("work.tracks.jsonl"), &recording);
            configuration(settings, folder, port, &recording.header)
        });
        fs::write(line.path("job.toml"), job(&line.config())).unwrap();
        line
    }

    /// As [`Line::new`], with the job in a folder, from which a PLC may load it. It is there a second time under the number 2, with a part at which a
    /// hand acts from a little farther away.
    pub fn with_second_job(settings: Settings) -> Self {
        let line = Self::new(settings);
        let folder = line.path("jobs");
        fs::create_dir(&folder).unwrap();
        let mut job = JobFile::parse("job.toml", &fs::read(line.path("job.toml")).unwrap()).unwrap();
        assert_eq!(job.id, 1);
        fs::copy(line.path("job.toml"), folder.join("one.toml")).unwrap();
        job.id = 2;
        // Whoever watches it must have followed: couples that are made for another job are not judged.
        let contact = Contact { on_m: 0.035, off_m: 0.05 };
        job.objects[0].shape.contact_regions =
            [ContactRegion { with: ContactRegion::HAND, points: heapless::Vec::new(), contact }]
                .into_iter()
                .collect();
        fs::write(folder.join("two.toml"), job.to_toml()).unwrap();
        line.reconfigure("job = \"job.toml\"\n", &format!("job = \"job.toml\"\njobs = {folder:?}\n"));
        line
    }

    /// Lays out a station with a configuration of its own, made for its folder and for a free port.
    pub fn configured(configuration: impl FnOnce(&Path, u16) -> String) -> Self {
        // Under /tmp whatever TMPDIR says: the path must be short.
        let folder = tempfile::Builder::new().prefix("andon-").tempdir_in("/tmp").unwrap();
        let station = Station::under("line", &folder.path().join("line")).unwrap();
        let port = free_port();
        fs::write(folder.path().join("station.toml"), configuration(folder.path(), port)).unwrap();
        Self { roles: Vec::new(), station, port, environment: Vec::new(), folder }
    }

    /// A file of the station.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Its configuration file.
    pub fn config(&self) -> PathBuf {
        self.path("station.toml")
    }

    /// Replaces a text of its configuration by another, before a role is started.
    pub fn reconfigure(&self, from: &str, to: &str) {
        let text = fs::read_to_string(self.config()).unwrap();
        assert!(text.contains(from), "{text}");
        fs::write(self.config(), text.replace(from, to)).unwrap();
    }

    /// Gives the station a board with these keys besides its port, which is returned.
    pub fn board(&self, keys: &str) -> u16 {
        let port = free_port();
        self.reconfigure("[plc]\n", &format!("[board]\nport = {port}\n{keys}\n[plc]\n"));
        port
    }

    /// Starts the role `board`, and waits until its pages can be asked for.
    pub fn start_board(&mut self) {
        self.start("board");
        self.wait_for_log("board", "AND-620", "");
    }

    /// The worker's track file.
    pub fn tracks(&self) -> PathBuf {
        self.path("work.tracks.jsonl")
    }

    /// Starts a role.
    pub fn start(&mut self, role: &'static str) -> &mut Process {
        self.roles.retain(|running| running.role != role);
        self.roles.push(Process::start(role, &self.config(), &self.log_path(role), &self.environment));
        self.roles.last_mut().unwrap()
    }

    /// Starts every role. The watcher is there before anything is sent.
    pub fn launch(&mut self) -> Watcher {
        self.start("steward");
        let watcher = Watcher::join(&self.station);
        self.start_all_but(&["steward"]);
        watcher
    }

    /// Starts every role, and waits until each runs.
    pub fn up(&mut self) -> Watcher {
        let mut watcher = self.launch();
        for role in ROLES {
            let pid = self.role(role).pid();
            watcher.until(role, |watcher| watcher.runs(role_id(role), pid));
        }
        watcher
    }

    /// Lets the worker do these jobs one after the other instead, each after a pause of this many seconds. No hand is in the picture, and at its
    /// beginning the parts of the job are put in place. Returns from when to when the hand is in the picture for each, and how long the recording is,
    /// in seconds.
    pub fn work_in_turn(&self, flaws: &[Flaw], pause_s: f64) -> (Vec<(f64, f64)>, f64) {
        let mut recording = recording::read("work", &fs::read(self.tracks()).unwrap()).unwrap();
        recording.frames.clear();
        let step_ns = (1e9 / f64::from(recording.header.rate_hz)) as u64;
        let mut next_ns = 0;
        let mut works_s = Vec::new();
        for flaw in flaws {
            let (job, _) = perform(&performance(9, 1), *flaw);
            let idle = Frame { hands: Default::default(), ..job.frames[0].clone() };
            for _ in 0..(pause_s * f64::from(recording.header.rate_hz)) as usize {
                recording.frames.push(Frame { captured_ns: next_ns, ..idle.clone() });
                next_ns += step_ns;
            }
            let (began_ns, first_ns) = (next_ns, job.frames[0].captured_ns);
            for frame in job.frames {
                next_ns = began_ns + frame.captured_ns - first_ns;
                recording.frames.push(Frame { captured_ns: next_ns, ..frame });
            }
            next_ns += step_ns;
            works_s.push((began_ns as f64 / 1e9, next_ns as f64 / 1e9));
        }
        save(&self.tracks(), &recording);
        (works_s, next_ns as f64 / 1e9)
    }

    /// Changes the frames of the recording before it is played.
    pub fn edit_tracks(&self, edit: impl FnOnce(&mut [Frame])) {
        let mut recording = recording::read("work", &fs::read(self.tracks()).unwrap()).unwrap();
        edit(&mut recording.frames);
        save(&self.tracks(), &recording);
    }

    /// Starts every role but these.
    pub fn start_all_but(&mut self, without: &[&str]) {
        for role in ROLES.into_iter().filter(|role| !without.contains(role)) {
            self.start(role);
        }
    }

    /// A running role.
    pub fn role(&mut self, role: &str) -> &mut Process {
        self.roles.iter_mut().find(|running| running.role == role).unwrap()
    }

    /// Everything that a role has logged, over all of its starts.
    pub fn log(&self, role: &str) -> String {
        fs::read_to_string(self.log_path(role)).unwrap_or_default()
    }

    /// Waits for a message with this code, which must contain this remedy and say nothing twice, in a role's log; panics after [`PATIENCE`].
    pub fn wait_for_log(&self, role: &str, code: &str, remedy: &str) {
        let until = Instant::now() + PATIENCE;
        loop {
            let log = self.log(role);
            if let Some(message) = log.lines().find(|message| message.contains(code)) {
                assert!(message.contains(remedy), "{message}");
                let sentences: Vec<&str> = message.split(". ").collect();
                let is_new = |(before, sentence)| !sentences[..before].contains(sentence);
                assert!(sentences.iter().enumerate().all(is_new), "{message}");
                return;
            }
            assert!(Instant::now() < until, "{role} does not log {code}:\n{log}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    fn log_path(&self, role: &str) -> PathBuf {
        self.path(&format!("{role}.log"))
    }

    /// Runs a command of `andond` on this station.
    pub fn command(&self, command: &str, arguments: &[&str]) -> Output {
        process::run(command, &self.config(), arguments)
    }

    /// Runs a command of `andond` on this station, which is told a line on its standard input, as a password.
    pub fn command_told(&self, command: &str, arguments: &[&str], told: &str) -> Output {
        process::run_and_tell(command, &self.config(), arguments, told)
    }

    /// As [`Line::stop`], without the steward, which cleans up after those that left before it.
    pub fn stop_all_but_steward(&mut self) -> Vec<String> {
        self.stop_these(&ROLES[1..])
    }

    /// Stops every role along the data path, so that each takes what the one before it has sent, and the steward last.
    /// Returns the roles that did not end with success, and how they ended.
    pub fn stop(&mut self) -> Vec<String> {
        let mut failures = self.stop_all_but_steward();
        failures.extend(self.stop_these(&ROLES[..1]));
        failures
    }

    /// Tells what each role logged last, and whether it still ran: for whoever reads why a test has failed on another machine.
    fn tell(&mut self) {
        const LAST: usize = 12;
        for running in &mut self.roles {
            let log = fs::read_to_string(self.folder.path().join(format!("{}.log", running.role)));
            let log = log.unwrap_or_default();
            let rows: Vec<&str> = log.lines().collect();
            let last = rows[rows.len().saturating_sub(LAST)..].join("\n");
            let ended = running.ended();
            eprintln!("{}, ended: {ended:?}\n{last}", running.role);
        }
    }

    fn stop_these(&mut self, names: &[&str]) -> Vec<String> {
        let mut failures = Vec::new();
        for &name in names {
            let Some(index) = self.roles.iter().position(|role| role.role == name) else { continue };
            if let Err(how) = self.roles.remove(index).stop() {
                failures.push(format!("{name}: {how}"));
            }
        }
        failures
    }

    /// The rows of the journal, by `andond history`.
    pub fn journal(&self) -> Journalled {
        let output = self.command("history", &["--csv"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Journalled::read(&String::from_utf8(output.stdout).unwrap())
    }

    /// Files of this station in /dev/shm.
    pub fn shared_files(&self) -> Vec<String> {
        let prefix = self.station.shm_prefix();
        let names = fs::read_dir("/dev/shm").unwrap().flatten();
        let names = names.map(|entry| entry.file_name().to_string_lossy().into_owned());
        names.filter(|name| name.starts_with(&prefix)).collect()
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.tell();
        }
        self.roles.clear();
        for name in self.shared_files() {
            let _ = fs::remove_file(format!("/dev/shm/{name}"));
        }
    }
}

fn performance(person: u64, repetition: u64) -> Performance {
    Performance { seed: 4, person, repetition, noise: Noise::default() }
}

fn save(path: &Path, recording: &recording::Recording) {
    let mut file = BufWriter::new(fs::File::create(path).unwrap());
    recording::write(&mut file, &recording.header, &recording.frames).unwrap();
}

/// A port that was free a moment ago. No other line of this process has been given it.
pub fn free_port() -> u16 {
    static GIVEN: Mutex<BTreeSet<u16>> = Mutex::new(BTreeSet::new());
    let free = || TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    std::iter::repeat_with(free).find(|port| GIVEN.lock().unwrap().insert(*port)).unwrap()
}

fn configuration(settings: Settings, root: &Path, port: u16, header: &Header) -> String {
    let Settings { at_full_speed, repeat, writes, .. } = settings;
    let speed = if at_full_speed { "max" } else { "file" };
    let mut text = format!(
        "[station]\nname = \"line\"\nroot = {root:?}\njob = \"job.toml\"\n\n\
         [camera]\nsource = \"tracks\"\npath = \"work.tracks.jsonl\"\nspeed = \"{speed}\"\nloop = {repeat}\n\n\
         [journal]\npath = \"journal.sqlite\"\n\n\
         [plc]\nenable = true\nport = {port}\nwrites = {writes}\n"
    );
    for object in &header.objects {
        let points: Vec<[f32; 3]> = object.shape.interaction_points.iter().copied().collect();
        text += &format!(
            "\n[[objects]]\nid = {}\nname = {:?}\nmarker_side_m = 0.03\ninteraction_points = {points:?}\n",
            object.shape.id, object.name
        );
    }
    text
}

/// Writes recordings of correct runs of some people.
pub fn save_runs(folder: &Path) -> Vec<PathBuf> {
    let people = [(1, 1), (2, 1), (3, 1), (4, 1), (9, 2), (9, 3)];
    let save_run = |(person, repetition)| {
        let path = folder.join(format!("p{person}_r{repetition}.tracks.jsonl"));
        save(&path, &perform(&performance(person, repetition), Flaw::None).0);
        path
    };
    people.map(save_run).into()
}

/// The job, taught by `andond teach`: once per process, because it is the same for every line.
fn job(config: &Path) -> &'static [u8] {
    static JOB: OnceLock<Vec<u8>> = OnceLock::new();
    JOB.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("job.toml");
        let mut arguments = vec!["--out".to_owned(), out.to_str().unwrap().to_owned()];
        arguments.extend(save_runs(folder.path()).iter().map(|path| path.to_str().unwrap().to_owned()));
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let output = process::run("teach", config, &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        fs::read(out).unwrap()
    })
}
