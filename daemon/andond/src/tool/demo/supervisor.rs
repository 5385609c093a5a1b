//! The processes of a demo: started, watched and stopped by it, in a directory of their own.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

use crate::tool::ToolError;

/// How many lines of a role's log are shown when it has ended: the error, and what led to it.
const LOG_LINES: usize = 3;

/// How long a role may take to stop when asked.
const GRACE: Duration = Duration::from_secs(3);

/// A role that runs.
pub(in crate::tool) struct Running {
    pub(in crate::tool) name: &'static str,
    child: Child,
    log: PathBuf,
}

impl Running {
    /// Starts `andond run NAME` with these configuration files; what it logs goes into `folder`.
    ///
    /// The roles of a demo have configurations of their own: each capture plays another clip.
    pub(in crate::tool) fn start(
        name: &'static str,
        configs: &[PathBuf],
        folder: &Path,
    ) -> Result<Self, ToolError> {
        let failed = |path: &Path| {
            let what = path.display().to_string();
            |source| ToolError::Demo { what, source }
        };
        let program = std::env::current_exe().map_err(failed(Path::new("andond")))?;
        let log = folder.join(format!("{name}.log"));
        let stderr = File::options().create(true).append(true).open(&log).map_err(failed(&log))?;
        let mut command = Command::new(&program);
        command.args(["run", name, "--as-given"]);
        for config in configs {
            command.arg("--config").arg(config);
        }
        let child = command
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(stderr)
            .spawn()
            .map_err(failed(&program))?;
        Ok(Self { name, child, log })
    }

    pub(in crate::tool) fn pid(&self) -> u32 {
        self.child.id()
    }

    /// Fails with the end of the role's log when the role has ended.
    pub(in crate::tool) fn check(&mut self) -> Result<(), ToolError> {
        match self.child.try_wait() {
            Ok(None) => Ok(()),
            Ok(Some(status)) => {
                let text = std::fs::read_to_string(&self.log).unwrap_or_default();
                let lines: Vec<&str> = text.lines().collect();
                let log = lines[lines.len().saturating_sub(LOG_LINES)..].join("\n");
                Err(ToolError::RoleEnded { role: self.name, status, log })
            }
            Err(source) => Err(ToolError::Demo { what: self.name.to_owned(), source }),
        }
    }

    /// Asks it to stop, and kills it when it does not stop in time.
    pub(in crate::tool) fn stop(&mut self) {
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
