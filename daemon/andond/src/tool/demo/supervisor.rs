//! The processes of a demo: started, watched and stopped by it, in a directory of their own.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use crate::exit::Code;
use crate::tool::Failure;

/// How long a role may take to stop when asked.
const GRACE: Duration = Duration::from_secs(3);

/// A role that runs.
pub(super) struct Running {
    pub(super) name: &'static str,
    child: Child,
    log: PathBuf,
}

impl Running {
    /// Starts `andond run NAME` with these configuration files; what it logs goes into `folder`.
    pub(super) fn start(name: &'static str, configs: &[PathBuf], folder: &Path) -> Result<Self, Failure> {
        let program = std::env::current_exe().map_err(|error| Failure::new(Code::Fault, error))?;
        let log = folder.join(format!("{name}.log"));
        let stderr = File::options().create(true).append(true).open(&log);
        let stderr =
            stderr.map_err(|error| Failure::new(Code::Fault, format!("{}: {error}", log.display())))?;
        let mut command = Command::new(&program);
        command.args(["run", name]);
        for config in configs {
            command.arg("--config").arg(config);
        }
        let child = command
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(stderr)
            .spawn()
            .map_err(|error| Failure::new(Code::Fault, format!("{}: {error}", program.display())))?;
        Ok(Self { name, child, log })
    }

    pub(super) fn pid(&self) -> u32 {
        self.child.id()
    }

    /// An error with the role's own last words when it has ended.
    pub(super) fn check(&mut self) -> Result<(), Failure> {
        match self.child.try_wait() {
            Ok(None) => Ok(()),
            Ok(Some(status)) => {
                let words = std::fs::read_to_string(&self.log).unwrap_or_default();
                let last = words
                    .lines()
                    .rev()
                    .take(3)
                    .collect::<Vec<_>>()
                    .into_iter()
                    .rev()
                    .collect::<Vec<_>>()
                    .join("\n");
                let code = match status.code() {
                    Some(78) => Code::Configuration,
                    _ => Code::Fault,
                };
                Err(Failure::new(code, format!("the role {} has ended ({status}):\n{last}", self.name)))
            }
            Err(error) => Err(Failure::new(Code::Fault, error)),
        }
    }

    /// Asks it to stop, and makes it when it does not.
    pub(super) fn stop(&mut self) {
        let pid = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw);
        if let Some(pid) = pid
            && matches!(self.child.try_wait(), Ok(None))
        {
            let _ = kill_process(pid, Signal::TERM);
            let began = Instant::now();
            while began.elapsed() < GRACE && matches!(self.child.try_wait(), Ok(None)) {
                std::thread::sleep(Duration::from_millis(10));
            }
            let _ = self.child.kill();
        }
        let _ = self.child.wait();
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop();
    }
}
