//! The real binary: its roles as processes, and its commands.

use rustix::process::{Pid, Signal, kill_process};
use std::ffi::OsString;
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::time::{Duration, Instant};

/// The time that a unit gives a role to stop.
const GRACE: Duration = Duration::from_secs(5);

/// Path of the binary: beside this program, or one folder up where this is a test.
pub fn andond() -> PathBuf {
    let own = std::env::current_exe().unwrap();
    let folders = own.ancestors().skip(1).take(2);
    let found = folders.map(|folder| folder.join("andond")).find(|path| path.is_file());
    found.unwrap_or_else(|| {
        panic!("andond is not beside {}: build it first with `cargo build --workspace --bins`", own.display())
    })
}

/// Runs a command of `andond` to its end.
pub(super) fn run(command: &str, config: &Path, arguments: &[&str]) -> Output {
    Command::new(andond())
        .args([command, "--config"])
        .arg(config)
        .args(arguments)
        .env_remove("JOURNAL_STREAM")
        .output()
        .unwrap()
}

/// As [`run`], and the command is told a line on its standard input.
pub(super) fn run_and_tell(command: &str, config: &Path, arguments: &[&str], told: &str) -> Output {
    let mut child = Command::new(andond())
        .arg(command)
        .args(arguments)
        .arg("--config")
        .arg(config)
        .env_remove("JOURNAL_STREAM")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // A command that asks for nothing has ended.
    let _ = writeln!(child.stdin.take().unwrap(), "{told}");
    child.wait_with_output().unwrap()
}

/// A program that is killed when this is dropped.
pub struct Killed(pub Child);

impl Drop for Killed {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A role that runs. It is killed when this is dropped.
pub struct Process {
    /// Its name.
    pub role: &'static str,
    /// When it was started.
    pub started: Instant,
    child: Child,
}

impl Process {
    pub(super) fn start(
        role: &'static str,
        config: &Path,
        log: &Path,
        environment: &[(&str, OsString)],
    ) -> Self {
        let log = File::options().create(true).append(true).open(log).unwrap();
        let child = Command::new(andond())
            .args(["run", role, "--config"])
            .arg(config)
            .env_remove("JOURNAL_STREAM")
            .envs(environment.iter().map(|(name, value)| (name, value)))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(log)
            .spawn()
            .unwrap();
        Self { role, started: Instant::now(), child }
    }

    /// Its process id.
    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Sends a signal.
    pub fn signal(&self, signal: Signal) {
        let pid = Pid::from_raw(i32::try_from(self.child.id()).unwrap()).unwrap();
        // One that has ended by itself needs no signal.
        let _ = kill_process(pid, signal);
    }

    /// Sends SIGKILL and waits for the end.
    pub fn kill(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }

    /// The exit status, if it has ended.
    pub fn ended(&mut self) -> Option<ExitStatus> {
        self.child.try_wait().unwrap()
    }

    /// Waits for the end and gives the exit status; panics after [`super::PATIENCE`].
    pub fn wait(&mut self) -> ExitStatus {
        let until = Instant::now() + super::PATIENCE;
        loop {
            if let Some(status) = self.ended() {
                return status;
            }
            assert!(Instant::now() < until, "{} does not end", self.role);
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Sends SIGTERM and waits. The error says how it ended instead of with success.
    pub(super) fn stop(mut self) -> Result<(), String> {
        self.signal(Signal::TERM);
        let until = Instant::now() + GRACE;
        while Instant::now() < until {
            match self.ended() {
                Some(status) if status.success() => return Ok(()),
                Some(status) => return Err(status.to_string()),
                None => std::thread::sleep(Duration::from_millis(5)),
            }
        }
        Err("did not stop in time".into())
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

/// A process's own memory in KiB: without files and shared memory.
pub fn own_memory_kib(pid: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("RssAnon:"))?;
    line.trim().strip_suffix(" kB")?.parse().ok()
}
