//! A station of its own for each test, and processes in it.
#![allow(clippy::unwrap_used, clippy::panic, dead_code, unreachable_pub)]

use andon_ipc::{Limits, Node, Station, Steward, Stop};
use shm_schemas::RoleId;
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// For whatever must happen sooner or later; only a test that fails waits for so long.
pub const PATIENCE: Duration = Duration::from_secs(60);

/// Enough for the frames of most tests, and little memory.
pub const SMALL: Limits = Limits { frame_bytes: 64 * 48 * 3 };

/// A station under a directory of its own. Dropped, it leaves no file behind.
pub struct Bench {
    pub station: Station,
    // Under /tmp whatever TMPDIR says: the path must be short.
    _root: TempDir,
}

impl Bench {
    pub fn new(name: &str) -> Self {
        let root = tempfile::Builder::new().prefix("andon-").tempdir_in("/tmp").unwrap();
        Self { station: Station::under(name, &root.path().join("run")).unwrap(), _root: root }
    }

    pub fn steward(&self) -> Steward {
        Steward::create(&self.station, SMALL).unwrap()
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

    /// As [`Bench::start`], with a word as the last argument.
    pub fn start_with(&self, task: &str, arguments: &[u64], word: &str) -> Peer {
        let mut peer = self.spawn(task, arguments, word);
        peer.until("up");
        peer
    }

    /// Starts `ipc_peer` and does not wait.
    pub fn spawn(&self, task: &str, arguments: &[u64], word: &str) -> Peer {
        let mut command = Command::new(env!("CARGO_BIN_EXE_ipc_peer"));
        command.arg(task).arg(self.station.name()).arg(self.station.root());
        command.args(arguments.iter().map(u64::to_string));
        command.args(Some(word).filter(|word| !word.is_empty()));
        let mut child = command.stdout(Stdio::piped()).spawn().unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap());
        Peer { child, lines, said: Vec::new() }
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

/// A process that the test has started. Dropped, it is killed.
pub struct Peer {
    child: Child,
    lines: BufReader<ChildStdout>,
    said: Vec<String>,
}

impl Peer {
    /// Reads what it says until a line that begins so; returns the rest of that line.
    pub fn until(&mut self, begin: &str) -> String {
        loop {
            let mut line = String::new();
            let bytes = self.lines.read_line(&mut line).unwrap();
            assert!(bytes > 0, "ended without saying {begin:?}; it said {:?}", self.said);
            self.said.push(line.trim().to_owned());
            if let Some(rest) = line.trim().strip_prefix(begin) {
                return rest.to_owned();
            }
        }
    }

    /// A number that it has said or will say.
    pub fn number(&mut self, key: &str) -> u64 {
        let begin = format!("{key}=");
        let said = self.said.iter().find_map(|line| line.strip_prefix(&begin)).map(str::to_owned);
        said.unwrap_or_else(|| self.until(&begin)).parse().unwrap()
    }

    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    pub fn signal(&self, signal: rustix::process::Signal) {
        let pid = rustix::process::Pid::from_raw(i32::try_from(self.child.id()).unwrap()).unwrap();
        rustix::process::kill_process(pid, signal).unwrap();
    }

    /// SIGKILL, and gone.
    pub fn kill(mut self) -> u32 {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        self.child.id()
    }

    /// SIGTERM; it must end well.
    pub fn stop(mut self) {
        self.signal(rustix::process::Signal::TERM);
        assert!(self.child.wait().unwrap().success(), "it said {:?}", self.said);
    }

    /// It ends by itself, and well.
    pub fn finish(mut self) {
        assert!(self.child.wait().unwrap().success(), "it said {:?}", self.said);
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
