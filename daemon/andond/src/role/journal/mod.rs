//! `journal`: verdicts to the database, and from there to the role `plc`, which hears of no others.

mod delivery;

use std::time::{Duration, Instant};

use andon_ipc::{MonotonicTime, Node, Port, Reader, UtcTime};
use andon_journal::{Journal, JournalError, Retention};
use shm_schemas::{Health, RoleId, Sight, Verdict};

use super::clock::ClockWatch;
use super::cycle::{Cycle, Role, Turn};
use super::{RoleError, WAIT};
use crate::config::Config;
use crate::log::{code, log};
use crate::sight;
use delivery::Delivery;

/// Between two tries to write while the disk is full or the database locked. Each may itself wait as long for the lock.
const TRY_AGAIN: Duration = Duration::from_millis(250);

/// Between two bursts of rows to a plc that is far behind: long enough for it to take them.
const NEXT_ROWS: Duration = Duration::from_millis(20);

/// Runs until it is asked to stop. What is on the channel then is written first.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    let mut cycle = Cycle::new(node)?;
    let mut role = Keeper::open(&mut cycle, config)?;
    cycle.run(&mut role)?;
    Ok(())
}

struct Keeper {
    journal: Journal,
    verdicts: Reader<Verdict>,
    health: Reader<Health>,
    /// What the line cannot see by the newest health, and since when on the monotonic clock.
    sight: (Option<Sight>, u64),
    /// The same as the journal has it.
    written_sight: (Option<Sight>, u64),
    delivery: Delivery,
    /// Verdicts in gaps that have been logged.
    lost: u64,
    /// Removed verdicts that have been logged.
    removed: u64,
    is_failing: bool,
    clock: ClockWatch,
}

impl Role for Keeper {
    const INPUT_IS_STEADY: bool = false;

    /// While nothing can be written, verdicts must not turn the loop: they wait where they are.
    fn ports(&mut self) -> Vec<&mut dyn Port> {
        if self.is_failing {
            return self.delivery.outputs().into();
        }
        let mut ports: Vec<&mut dyn Port> = self.delivery.ports().into();
        ports.push(&mut self.verdicts);
        ports.push(&mut self.health);
        ports
    }

    fn patience(&self) -> Duration {
        match (self.is_failing, self.delivery.has_more()) {
            (true, _) => TRY_AGAIN,
            (false, true) => NEXT_ROWS,
            (false, false) => WAIT,
        }
    }

    /// Writes all that has come in one transaction: a disk that syncs takes as long for one row as for a hundred.
    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        self.clock.look();
        self.watch_sight()?;
        self.take(cycle)?;
        self.delivery.hear(&self.journal)?;
        let turn = self.write(cycle)?;
        if !self.is_failing {
            self.delivery.answer(&self.journal, cycle)?;
        }
        self.delivery.deliver(&self.journal, cycle)?;
        Ok(turn)
    }

    fn stop(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        self.turn(cycle).map(|_| ())
    }
}

impl Keeper {
    /// An open database is the first step: readiness must not wait for a worker.
    fn open(cycle: &mut Cycle<'_>, config: &Config) -> Result<Self, RoleError> {
        let path = config.journal_path();
        let began = Instant::now();
        let retention = Retention { keep_days: config.journal.keep_days, keep_mb: config.journal.keep_mb };
        let mut keeper = Self {
            journal: Journal::open(&path, retention)?,
            delivery: Delivery::open(cycle.node())?,
            verdicts: cycle.node().reader()?,
            health: cycle.node().reader()?,
            sight: (None, 0),
            written_sight: (None, 0),
            lost: 0,
            removed: 0,
            is_failing: false,
            clock: ClockWatch::new(),
        };
        log!(code::JOURNAL_OPENED, { path = %path.display() }, "writing to {}", path.display());
        keeper.log_missing();
        keeper.delivery.answer(&keeper.journal, cycle)?;
        cycle.stepped(began);
        Ok(keeper)
    }

    /// Writes when the line stopped seeing its bench and when it saw it again. What cannot be written now is tried in the next turn.
    fn watch_sight(&mut self) -> Result<(), RoleError> {
        while let Some(health) = self.health.take()? {
            if health.role == RoleId::Perceive.code() && health.sight != 0 {
                self.sight = (sight::trouble_of(&health), health.sight_since_ns);
            }
        }
        let (trouble, since_ns) = self.sight;
        if self.written_sight.0 == trouble {
            return Ok(());
        }
        let at_utc_ns = utc_ns(since_ns);
        let mut write = || {
            if self.written_sight.0.is_some() {
                self.journal.watches_again(at_utc_ns)?;
            }
            trouble.map_or(Ok(()), |trouble| self.journal.stops_watching(at_utc_ns, trouble))
        };
        match write() {
            Ok(()) => self.written_sight = self.sight,
            Err(JournalError::Full { .. } | JournalError::Locked { .. }) => {}
            Err(error) => return Err(error.into()),
        }
        Ok(())
    }

    /// Takes what has come and fits. The rest stays on the channel, which holds as many again.
    fn take(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        while self.journal.has_room() {
            let Some(verdict) = cycle.take(&mut self.verdicts)? else { break };
            self.journal.push(&verdict);
        }
        Ok(())
    }

    fn write(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        if self.journal.waiting() == 0 && !self.delivery.is_pending() {
            return Ok(Turn::Idle);
        }
        let written = self.journal.flush().and_then(|()| {
            self.delivery.has_written();
            self.delivery.keep(&mut self.journal)
        });
        match written {
            Ok(()) => {
                if std::mem::take(&mut self.is_failing) {
                    log!(
                        code::JOURNAL_OPENED,
                        "the journal can be written again; nothing that waited is lost"
                    );
                }
                self.log_missing();
                Ok(Turn::Stepped)
            }
            Err(error @ (JournalError::Full { .. } | JournalError::Locked { .. })) => {
                cycle.liveness().failing();
                // Once, until it is over.
                if !std::mem::replace(&mut self.is_failing, true) {
                    super::error::report_journal(&error);
                }
                Ok(Turn::Idle)
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Logs what the journal has lost and removed since the last time.
    fn log_missing(&mut self) {
        let (lost, removed) = (self.journal.lost(), self.journal.removed());
        if lost > self.lost {
            log!(code::JOURNAL_GAP, "{} verdicts were lost", lost - self.lost);
        }
        if removed > self.removed {
            log!(code::JOURNAL_TRIMMED, "{} verdicts were removed by age or size", removed - self.removed);
        }
        (self.lost, self.removed) = (lost, removed);
    }
}

/// The UTC time at which the monotonic clock showed this.
fn utc_ns(monotonic_ns: u64) -> u64 {
    let ago = MonotonicTime::now().since(MonotonicTime::from_nanoseconds(monotonic_ns));
    // 2^64 ns are 584 years.
    UtcTime::now().nanoseconds().saturating_sub(ago.as_nanos() as u64)
}
