//! A command of `andond` that runs as a child: what it prints, what it is told, and its end.

use std::ffi::OsString;
use std::io::{self, BufRead as _, BufReader, Read, Write as _};
use std::os::unix::process::CommandExt as _;
use std::path::Path;
use std::process::{self, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::thread::Builder;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process_group};

/// Lines that wait. A child that prints more waits as well.
const WAITING: usize = 256;

/// How long a child that was asked to end may take.
const GRACE: Duration = Duration::from_secs(2);

/// Bytes of a line that are kept. No command prints a longer one.
const LONGEST: u64 = 8 << 10;

/// A command that runs.
pub(super) struct Child {
    child: process::Child,
    input: Option<ChildStdin>,
    lines: Receiver<String>,
    /// Whether both of its outputs have ended.
    is_silent: bool,
    status: Option<ExitStatus>,
    /// When it was asked to end.
    asked: Option<Instant>,
}

impl Child {
    /// Starts `andond` with these arguments, in a group of its own: what it starts itself ends with it. It runs in this folder, if that is one.
    pub(super) fn start(arguments: &[OsString], folder: &Path) -> io::Result<Self> {
        let mut command = Command::new(std::env::current_exe()?);
        command.args(arguments).process_group(0);
        if folder.is_dir() {
            command.current_dir(folder);
        }
        // What the unit tells its role is not meant for this.
        for variable in ["NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID", "JOURNAL_STREAM"] {
            command.env_remove(variable);
        }
        let mut child =
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        let (send, lines) = sync_channel(WAITING);
        let input = child.stdin.take();
        let outputs: [Option<Box<dyn Read + Send>>; 2] = [
            child.stdout.take().map(|output| Box::new(output) as _),
            child.stderr.take().map(|output| Box::new(output) as _),
        ];
        let started = Self { child, input, lines, is_silent: false, status: None, asked: None };
        for output in outputs.into_iter().flatten() {
            let send = send.clone();
            // Where there is no thread, the child ends with this.
            Builder::new().name("printed".into()).spawn(move || pass_on(output, &send))?;
        }
        Ok(started)
    }

    /// Tells it a line.
    pub(super) fn tell(&mut self, line: &str) -> io::Result<()> {
        match &mut self.input {
            Some(input) => writeln!(input, "{line}"),
            None => Err(io::ErrorKind::BrokenPipe.into()),
        }
    }

    /// So many of the lines that wait.
    pub(super) fn lines(&mut self, most: usize) -> Vec<String> {
        let mut lines = Vec::new();
        while lines.len() < most && !self.is_silent {
            match self.lines.try_recv() {
                Ok(line) => lines.push(line),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => self.is_silent = true,
            }
        }
        lines
    }

    /// How it has ended, once all that it has printed was taken. What does not end when it was asked to is killed. It is waited for last: until then
    /// its number is that of its group, and what it has started itself can be ended as well.
    pub(super) fn ended(&mut self) -> Option<ExitStatus> {
        let is_late = self.asked.is_some_and(|asked| asked.elapsed() > GRACE);
        if is_late {
            self.signal(Signal::KILL);
        }
        if self.status.is_none() && (self.is_silent || is_late) {
            self.status = self.child.try_wait().ok().flatten();
        }
        self.status
    }

    /// Asks it, and whatever it has started, to end.
    pub(super) fn ask_to_end(&mut self) {
        self.input = None;
        self.asked.get_or_insert_with(Instant::now);
        self.signal(Signal::TERM);
    }

    /// Ends it.
    pub(super) fn end(&mut self) {
        if self.status.is_some() {
            return;
        }
        self.ask_to_end();
        let began = Instant::now();
        while began.elapsed() < GRACE && !self.is_silent {
            // What it prints now nobody reads, and it must not wait for that.
            let _ = self.lines(WAITING);
            std::thread::sleep(Duration::from_millis(10));
        }
        self.signal(Signal::KILL);
        // A child that was killed has ended.
        self.status = self.child.wait().ok();
    }

    fn signal(&self, signal: Signal) {
        // A number that was waited for may be that of another process.
        if self.status.is_none()
            && let Some(group) = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw)
        {
            // It may have ended by itself.
            let _ = kill_process_group(group, signal);
        }
    }
}

impl Drop for Child {
    fn drop(&mut self) {
        self.end();
    }
}

/// Passes on line by line until the end. A line that is too long goes on as the next one.
fn pass_on(output: impl Read, lines: &SyncSender<String>) {
    let mut output = BufReader::new(output);
    let mut bytes = Vec::new();
    loop {
        bytes.clear();
        match output.by_ref().take(LONGEST).read_until(b'\n', &mut bytes) {
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
        let line = String::from_utf8_lossy(bytes.strip_suffix(b"\n").unwrap_or(&bytes)).into_owned();
        if lines.send(line).is_err() {
            return;
        }
    }
}
