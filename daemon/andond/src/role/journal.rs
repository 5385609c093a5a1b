//! `journal`: verdicts to the database. What is on disk is told on the channel `confirmed`, and the PLC only then.

use std::time::{Duration, Instant};

use andon_ipc::{Node, Reader, Wake, Writer};
use shm_schemas::{Confirmed as Message, Verdict};

use super::clock::ClockWatch;
use super::{Pulse, RoleError, WAIT};
use crate::config::Config;
use crate::journal::{Confirmed, Journal, JournalError, Retention};
use crate::log::{code, log};

/// Between two tries to write while the disk is full or the database locked. Each may itself wait as long for the lock.
const TRY_AGAIN: Duration = Duration::from_millis(250);

/// Runs until it is asked to stop. What is on the channel then is written first.
pub(super) fn run(node: &Node, config: &Config) -> Result<(), RoleError> {
    let mut keeper = Keeper::open(node, config)?;
    let mut clock = ClockWatch::new();
    loop {
        let wake = keeper.wait()?;
        keeper.take()?;
        keeper.write()?;
        if wake == Wake::Stop {
            return Ok(());
        }
        clock.look();
        keeper.pulse.losses(keeper.verdicts.lost(), keeper.verdicts.restarts());
        // This role works while its loop turns. On a bench where nobody works there are no verdicts; whether the judge lives, its own health
        // tells, and the next verdict may be an hour away.
        keeper.pulse.beat()?;
    }
}

struct Keeper<'a> {
    node: &'a Node,
    journal: Journal,
    verdicts: Reader<Verdict>,
    confirmed: Writer<Message>,
    told: Option<Confirmed>,
    /// Verdicts in gaps that have been logged.
    lost: u64,
    /// Removed verdicts that have been logged.
    removed: u64,
    failing: bool,
    pulse: Pulse,
}

impl<'a> Keeper<'a> {
    /// An open database is the first step: readiness must not wait for a worker.
    fn open(node: &'a Node, config: &Config) -> Result<Self, RoleError> {
        let path = config.journal_path();
        let began = Instant::now();
        let retention = Retention { keep_days: config.journal.keep_days, keep_mb: config.journal.keep_mb };
        let journal = Journal::open(&path, retention)?;
        let mut keeper = Self {
            node,
            journal,
            confirmed: node.writer()?,
            verdicts: node.reader()?,
            told: None,
            lost: 0,
            removed: 0,
            failing: false,
            pulse: Pulse::new(node)?,
        };
        log!(code::JOURNAL_OPENED, { path = %path.display() }, "writing to {}", path.display());
        keeper.tell_removed();
        keeper.confirm()?;
        keeper.pulse.stepped(began.elapsed());
        Ok(keeper)
    }

    /// While nothing can be written, verdicts that come must not turn the loop: they wait where they are.
    fn wait(&mut self) -> Result<Wake, RoleError> {
        Ok(if self.failing {
            self.node.wait(&mut [&mut self.confirmed], TRY_AGAIN)?
        } else {
            self.node.wait(&mut [&mut self.verdicts, &mut self.confirmed], WAIT)?
        })
    }

    /// Takes what has come and fits. The rest stays on the channel, which holds as many again.
    fn take(&mut self) -> Result<(), RoleError> {
        while self.journal.has_room() {
            let Some(verdict) = self.verdicts.take()? else { break };
            self.pulse.received(&verdict.stamp);
            self.journal.push(&verdict);
        }
        Ok(())
    }

    fn write(&mut self) -> Result<(), RoleError> {
        if self.journal.waiting() == 0 {
            return Ok(());
        }
        let began = Instant::now();
        match self.journal.flush() {
            Ok(_) => {
                self.pulse.stepped(began.elapsed());
                self.confirm()?;
                if std::mem::take(&mut self.failing) {
                    log!(
                        code::JOURNAL_OPENED,
                        "the journal can be written again; nothing that waited is lost"
                    );
                }
                self.tell_gaps();
                self.tell_removed();
                Ok(())
            }
            Err(error @ (JournalError::Full { .. } | JournalError::Locked { .. })) => {
                self.pulse.failing();
                // Once, until it is over.
                if !std::mem::replace(&mut self.failing, true) {
                    super::error::report_journal(&error);
                }
                Ok(())
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Tells what is on disk by now.
    fn confirm(&mut self) -> Result<(), RoleError> {
        let newest = self.journal.newest();
        if let Some(Confirmed { epoch, seq }) = newest.filter(|_| newest != self.told) {
            let mut message = self.confirmed.loan()?;
            message.verdict_epoch = epoch;
            message.verdict_seq = seq;
            self.confirmed.send(message)?;
            self.pulse.sent();
            self.told = newest;
        }
        Ok(())
    }

    fn tell_gaps(&mut self) {
        let lost = self.journal.lost();
        if lost > self.lost {
            log!(code::JOURNAL_GAP, "{} verdicts were lost", lost - self.lost);
            self.lost = lost;
        }
    }

    fn tell_removed(&mut self) {
        let removed = self.journal.removed();
        if removed > self.removed {
            log!(code::JOURNAL_TRIMMED, "{} verdicts were removed by age or size", removed - self.removed);
            self.removed = removed;
        }
    }
}
