//! `journal`: verdicts to the database, and from there to its consumers, as the role `plc`, which hear of no others.

mod alive;
mod delivery;
mod not_watching;

use std::collections::VecDeque;
use std::path::Path;
use std::time::{Duration, Instant};

use andon_host::config::Config;
use andon_host::log::{code, log};
use andon_host::role::{Cycle, Role, Turn, WAIT};
use andon_ipc::{Node, Port, Reader, UtcTime};
use andon_journal::{Journal, JournalError, Retention};
use shm_schemas::{Audit, AuditKind, Health, RoleId, Verdict};

use super::RoleError;
use super::clock::ClockWatch;
use crate::identity;
use delivery::Delivery;
use not_watching::NotWatching;

/// Between two tries to write while the disk is full or the database locked. Each may itself wait as long for the lock.
const TRY_AGAIN: Duration = Duration::from_millis(250);

/// What was done and waits while nothing can be written; as much as the channel's writers keep together.
const MAX_AUDITS: usize = 256;

/// Runs until it is asked to stop. What is on the channel then is written first.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    let mut cycle = Cycle::new(node)?;
    let Some(mut role) = Keeper::open(&mut cycle, config)? else { return Ok(()) };
    cycle.run(&mut role)
}

struct Keeper {
    journal: Journal,
    /// The database was removed or is damaged: nothing is written until a new one has begun.
    needs_new: bool,
    verdicts: Reader<Verdict>,
    health: Reader<Health>,
    audits: Reader<Audit>,
    /// What was done and is not written yet.
    unwritten_audits: VecDeque<Audit>,
    not_watching: NotWatching,
    delivery: Delivery,
    /// Verdicts in gaps that have been logged.
    lost: u64,
    /// Removed verdicts that have been logged, and those of them that nobody had acknowledged.
    removed: u64,
    unacknowledged: u64,
    is_failing: bool,
    clock: ClockWatch,
}

impl Role for Keeper {
    type Error = RoleError;
    const INPUT_IS_STEADY: bool = false;

    /// While nothing can be written, verdicts must not turn the loop: they wait where they are.
    fn ports(&mut self) -> Vec<&mut dyn Port> {
        if self.is_failing {
            return self.delivery.outputs().into();
        }
        let mut ports: Vec<&mut dyn Port> = self.delivery.ports().into();
        ports.extend([&mut self.verdicts as &mut dyn Port, &mut self.health, &mut self.audits]);
        ports
    }

    fn patience(&self) -> Duration {
        if self.is_failing { TRY_AGAIN } else { WAIT }
    }

    /// Writes all that has come in one transaction: a disk that syncs takes as long for one row as for a hundred.
    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        self.clock.look();
        self.take(cycle)?;
        self.needs_new |= !self.journal.is_in_place();
        let done = self.renew().and_then(|()| self.work(cycle));
        match done {
            Err(RoleError::Journal(error)) => self.fail(error, cycle),
            done => done,
        }
    }

    fn stop(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        self.turn(cycle).map(|_| ())
    }
}

/// What the journal of a station keeps, and which consumers it does without.
pub(crate) fn retention(config: &Config) -> Retention {
    Retention {
        keep_days: config.journal.keep_days,
        keep_mb: config.journal.keep_mb,
        without: if config.plc.enable { &[] } else { &[RoleId::Plc] },
    }
}

impl Keeper {
    /// An open database is the first step: readiness must not wait for a worker. `None` when a stop is asked for before that.
    fn open(cycle: &mut Cycle<'_>, config: &Config) -> Result<Option<Self>, RoleError> {
        let path = config.journal_path();
        let began = Instant::now();
        let opened = cycle
            .until_open(|| Journal::open_or_replace(&path, retention(config)).map_err(RoleError::from))?;
        let Some((journal, aside)) = opened else { return Ok(None) };
        let delivery = Delivery::open(cycle.node(), &journal)?;
        let mut keeper = Self {
            journal,
            needs_new: false,
            delivery,
            verdicts: cycle.node().reader()?,
            health: cycle.node().reader()?,
            audits: cycle.node().reader()?,
            unwritten_audits: VecDeque::new(),
            not_watching: NotWatching::new(config),
            lost: 0,
            removed: 0,
            unacknowledged: 0,
            is_failing: false,
            clock: ClockWatch::new(),
        };
        if let Some(aside) = aside {
            keeper.tell_damage(&aside)?;
        }
        log!(code::JOURNAL_OPENED, { path = %path.display() }, "writing to {}", path.display());
        keeper.log_missing();
        keeper.note_changes(config)?;
        keeper.delivery.answer(&keeper.journal, cycle)?;
        cycle.stepped(began);
        Ok(Some(keeper))
    }

    /// Writes with what the line runs where that is not what it ran with before. On a full disk it is left out.
    fn note_changes(&mut self, config: &Config) -> Result<(), RoleError> {
        let now = UtcTime::now().nanoseconds();
        let configuration = format!("hash {:016x}", config.hash());
        let changed_by = identity::owner_of_newest(&config.files);
        let program = identity::program();
        let noted = self
            .journal
            .note_change(now, AuditKind::Configuration, &changed_by, &configuration)
            .and_then(|()| self.journal.note_change(now, AuditKind::Program, "installation", &program));
        match noted {
            Ok(()) | Err(JournalError::Full { .. } | JournalError::Locked { .. }) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// Takes what has come and fits. The rest stays on the channels.
    fn take(&mut self, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        while let Some(health) = self.health.take()? {
            self.not_watching.receive(&health);
        }
        self.not_watching.look();
        while self.unwritten_audits.len() < MAX_AUDITS {
            let Some(audit) = self.audits.take()? else { break };
            self.unwritten_audits.push_back(*audit);
        }
        while self.journal.has_room() {
            let Some(verdict) = cycle.take(&mut self.verdicts)? else { break };
            self.journal.push(&verdict);
        }
        self.delivery.receive(&self.journal, cycle)?;
        Ok(())
    }

    /// Begins a new database where the old one was removed or is damaged.
    fn renew(&mut self) -> Result<(), RoleError> {
        if !self.needs_new {
            return Ok(());
        }
        let aside = self.journal.begin_anew()?;
        self.needs_new = false;
        self.not_watching.forget_rows();
        self.delivery.journal_is_new();
        match aside {
            Some(aside) => self.tell_damage(&aside)?,
            None => {
                let what = "the database was removed or replaced while it was in use; a new one has begun";
                log!(code::JOURNAL_REMOVED, "{what}");
                self.journal.note(UtcTime::now().nanoseconds(), AuditKind::Journal, "journal", what)?;
            }
        }
        Ok(())
    }

    fn tell_damage(&mut self, aside: &Path) -> Result<(), RoleError> {
        let what =
            format!("the database was damaged and lies in {} now; a new one has begun", aside.display());
        log!(code::JOURNAL_DAMAGED, { aside = %aside.display() }, "{what}");
        self.journal.note(UtcTime::now().nanoseconds(), AuditKind::Journal, "journal", &what)?;
        Ok(())
    }

    /// Writes what waits, and tells the consumers what is on disk.
    fn work(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        let has_work = self.journal.waiting() > 0 || self.delivery.is_pending();
        if has_work {
            self.journal.flush()?;
            self.delivery.has_written();
            self.delivery.keep(&mut self.journal)?;
        }
        self.not_watching.write(&mut self.journal)?;
        while let Some(audit) = self.unwritten_audits.front() {
            self.journal.record(audit)?;
            self.unwritten_audits.pop_front();
        }
        let was_failing = std::mem::take(&mut self.is_failing);
        if was_failing {
            log!(code::JOURNAL_OPENED, "the journal can be written again; nothing that waited is lost");
        }
        self.log_missing();
        self.delivery.answer(&self.journal, cycle)?;
        self.delivery.deliver(&self.journal, cycle)?;
        Ok(if has_work || was_failing { Turn::Stepped } else { Turn::Idle })
    }

    /// Nothing could be written: what can pass is waited for, and a database that is lost is replaced in the next turn.
    fn fail(&mut self, error: JournalError, cycle: &mut Cycle<'_>) -> Result<Turn, RoleError> {
        let is_lost = matches!(error, JournalError::Removed { .. } | JournalError::Damaged { .. });
        self.needs_new |= is_lost;
        if !is_lost && !super::error::may_pass(&error) {
            return Err(error.into());
        }
        cycle.liveness().failing();
        // Once, until it is over. What has become of a lost one is said when there is a new one.
        if !std::mem::replace(&mut self.is_failing, true) && !is_lost {
            super::error::report_journal(&error);
        }
        if is_lost {
            return Ok(Turn::Idle);
        }
        // What is on disk is still owed.
        match self.delivery.deliver(&self.journal, cycle) {
            Ok(()) | Err(RoleError::Journal(_)) => Ok(Turn::Idle),
            Err(error) => Err(error),
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
        let unacknowledged = self.journal.unacknowledged();
        if unacknowledged > self.unacknowledged {
            let count = unacknowledged - self.unacknowledged;
            log!(
                code::JOURNAL_UNACKNOWLEDGED,
                "{count} verdicts were removed that a consumer had not acknowledged"
            );
        }
        (self.lost, self.removed, self.unacknowledged) = (lost, removed, unacknowledged);
    }
}
