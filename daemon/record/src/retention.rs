//! The role while nothing is recorded: what was recorded before still grows too old, and goes in time.

use std::time::{Duration, Instant};

use andon_host::config::Config;
use andon_host::log::{code, log};
use andon_host::role::{Cycle, Role, Turn};
use andon_ipc::{Node, Port};

use crate::disk::{Disk, Told};
use crate::role::RecordError;
use crate::store::Budget;

struct Retention {
    /// None where nothing was ever recorded.
    disk: Option<Disk>,
}

/// Runs until it is asked to stop.
///
/// # Errors
/// What ends the role.
pub fn run(node: &Node, config: &Config) -> Result<(), RecordError> {
    let folder = config.recordings();
    let disk = folder.is_dir().then(|| Disk::start(folder, budget(config), 0));
    let mut role = Retention { disk: disk.transpose().map_err(RecordError::Thread)? };
    let mut cycle = Cycle::new(node)?;
    // No message ever comes.
    cycle.stepped(Instant::now());
    cycle.run(&mut role)
}

impl Retention {
    fn listen_to_disk(&self) {
        self.disk.iter().flat_map(Disk::told).for_each(say);
    }
}

impl Role for Retention {
    type Error = RecordError;
    const INPUT_IS_STEADY: bool = false;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        Vec::new()
    }

    fn turn(&mut self, _cycle: &mut Cycle<'_>) -> Result<Turn, RecordError> {
        self.listen_to_disk();
        Ok(Turn::Idle)
    }

    fn stop(&mut self, _cycle: &mut Cycle<'_>) -> Result<(), RecordError> {
        self.disk.iter_mut().for_each(Disk::finish);
        self.listen_to_disk();
        Ok(())
    }
}

/// What recordings may take.
pub(crate) fn budget(config: &Config) -> Budget {
    let record = &config.record;
    Budget {
        // The one that is being written may become as large as a file may.
        bytes: u64::from(record.keep_mb.saturating_sub(record.file_mb)) << 20,
        age: Duration::from_secs(86_400) * record.keep_days,
        journal: Some((config.journal_path(), u64::from(config.journal.keep_mb) << 20)),
    }
}

/// Logs what has become of the folder.
pub(crate) fn say(told: Told) {
    match told {
        Told::Began(path) => log!(code::RECORDING_BEGAN, "{}", path.display()),
        Told::Kept(path) => log!(code::RECORDING_KEPT, "{}", path.display()),
        Told::Repaired(path) => log!(code::RECORDING_REPAIRED, "{}", path.display()),
        Told::Trimmed(count) => log!(code::RECORDINGS_TRIMMED, "{count} recordings were removed"),
        Told::Unwritten(why) => log!(code::RECORDINGS_UNWRITTEN, "{why}"),
        Told::Unrepaired(why) => log!(code::RECORDING_UNREPAIRED, remedied: "{why}"),
        Told::Unremoved(why) => log!(code::RECORDING_UNREMOVED, "{why}"),
    }
}
