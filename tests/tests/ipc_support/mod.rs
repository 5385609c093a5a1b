//! A station for each test, and processes in it.
#![allow(clippy::unwrap_used, clippy::panic, dead_code, unreachable_pub)]

use andon_ipc::{Error, Limits, Node, Station, Steward, Stop};
use shm_schemas::RoleId;
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// For what must happen sooner or later. Only a test that fails waits for this long.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// Enough for the frames of most tests, in little memory.
pub const SMALL: Limits = Limits { frame_bytes: 64 * 48 * 3 };

/// A station under a directory of its own. When it is dropped, it leaves no file behind.
pub struct Bench {
    pub station: Station,
    // Under /tmp, whatever TMPDIR says, because the path must be short.
    _root: TempDir,
}

impl Bench {
    pub fn new(name: &str) -> Self {
        let root = tempfile::Builder::new().prefix("andon-").tempdir_in("/tmp").unwrap();
        Self { station: Station::under(name, &root.path().join("run")).unwrap(), _root: root }
    }

    pub fn steward(&self) -> Steward {
        self.try_steward(SMALL).unwrap()
    }

    /// The lock of a steward that was dropped may be held a moment longer. That is where another test of this process has just forked, until the
    /// child becomes another program.
    pub fn try_steward(&self, limits: Limits) -> Result<Steward, Error> {
        let until = Instant::now() + PATIENCE;
        loop {
            match Steward::create(&self.station, limits) {
                Err(Error::StewardRunning { .. }) if Instant::now() < until => {
                    std::thread::sleep(Duration::from_millis(5));
                }
                created => return created,
            }
        }
    }

    pub fn node(&self, role: RoleId) -> Node {
        Node::open(&self.station, role, PATIENCE, &Stop::new().unwrap()).unwrap()
    }

    /// Starts `ipc_peer` and waits until it says `up`.
    pub fn start(&self, task: &str, arguments: &[u64]) -> Peer {
        let mut peer = self.spawn(task, arguments, "");
        peer.until("up");
        peer
    }

    /// Does the same as [`Bench::start`], with a word as the last argument.
    pub fn start_with(&self, task: &str, arguments: &[u64], word: &str) -> Peer {
        let mut peer = self.spawn(task, arguments, word);
        peer.until("up");
        peer
    }

    /// Starts `ipc_peer` without waiting for it.
    pub fn spawn(&self, task: &str, arguments: &[u64], word: &str) -> Peer {
        let mut command = Command::new(env!("CARGO_BIN_EXE_ipc_peer"));
        command.arg(task).arg(self.station.name()).arg(self.station.root());
        command.args(arguments.iter().map(u64::to_string));
        command.args(Some(word).filter(|word| !word.is_empty()));
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap());
        Peer { child, lines, output: Vec::new() }
    }

    /// Files of this station in /dev/shm.
    pub fn shared_files(&self) -> Vec<String> {
        let prefix = self.station.shm_prefix();
        let names = fs::read_dir("/dev/shm").unwrap().flatten();
        let names = names.map(|entry| entry.file_name().to_string_lossy().into_owned());
        names.filter(|name| name.starts_with(&prefix)).collect()
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        for name in self.shared_files() {
            let _ = fs::remove_file(format!("/dev/shm/{name}"));
        }
    }
}

/// A process that the test has started. When it is dropped, it is killed.
pub struct Peer {
    child: Child,
    lines: BufReader<ChildStdout>,
    output: Vec<String>,
}

impl Peer {
    /// Reads its output up to a line that begins with `begin`, and returns the rest of that line.
    pub fn until(&mut self, begin: &str) -> String {
        loop {
            let mut line = String::new();
            let bytes = self.lines.read_line(&mut line).unwrap();
            assert!(bytes > 0, "it ended without printing {begin:?}; its output: {:?}", self.output);
            self.output.push(line.trim().to_owned());
            if let Some(rest) = line.trim().strip_prefix(begin) {
                return rest.to_owned();
            }
        }
    }

    /// A number that it has printed or will print.
    pub fn number(&mut self, key: &str) -> u64 {
        let begin = format!("{key}=");
        let earlier = self.output.iter().find_map(|line| line.strip_prefix(&begin)).map(str::to_owned);
        earlier.unwrap_or_else(|| self.until(&begin)).parse().unwrap()
    }

    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    pub fn signal(&self, signal: rustix::process::Signal) {
        let pid = rustix::process::Pid::from_raw(i32::try_from(self.child.id()).unwrap()).unwrap();
        rustix::process::kill_process(pid, signal).unwrap();
    }

    /// Kills it with SIGKILL and waits for its end. Returns its process id.
    pub fn kill(mut self) -> u32 {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        self.child.id()
    }

    /// Stops it with SIGTERM. It must end without an error.
    pub fn stop(mut self) {
        self.signal(rustix::process::Signal::TERM);
        assert!(self.child.wait().unwrap().success(), "its output: {:?}", self.output);
    }

    /// Waits for its end. It must end by itself and without an error.
    pub fn finish(mut self) {
        assert!(self.child.wait().unwrap().success(), "its output: {:?}", self.output);
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
