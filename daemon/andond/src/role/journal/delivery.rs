//! What the journal owes its consumers: it keeps the account of each on disk, and sends each the rows that it asks for.
//!
//! No consumer opens the database. So a result that is not on disk cannot be offered, and a restart goes on where the last start ended.
//! Each is owed by itself: one that does not answer gets no more than [`ROWS`] rows, and the others go on.

use andon_host::role::{Cycle, Output};
use andon_ipc::{Error, Node, Port, Reader, Writer};
use andon_journal::{Journal, JournalError};
use shm_schemas::{Account, AccountKept, AccountUpdate, CONSUMERS, Journalled, RoleId};

use super::super::RoleError;

/// Rows that a consumer is sent before it says something: more than it can take at a time. What is left it asks for when it has room. Those of
/// all consumers fit into the channel.
const ROWS: usize = 32;

/// The journal's side of the accounts.
pub(super) struct Delivery {
    updates: Reader<AccountUpdate>,
    kept: Output<Writer<AccountKept>>,
    rows: Output<Writer<Journalled>>,
    backlogs: Vec<Backlog>,
    /// The consumers must be told what is on disk.
    owes_answer: bool,
}

/// What is owed to one consumer.
struct Backlog {
    consumer: RoleId,
    /// What is to be kept and is not on disk yet.
    pending: Option<Account>,
    /// The start of the consumer that asked for rows, and its number; `None` until it has.
    asked: Option<(u32, u32)>,
    /// The newest row that was sent since then.
    sent_row: u64,
    /// Rows that may still be sent before it says something.
    room: usize,
    has_more: bool,
}

impl Backlog {
    fn new(consumer: RoleId) -> Self {
        Self { consumer, pending: None, asked: None, sent_row: 0, room: 0, has_more: false }
    }

    fn receive(&mut self, update: &AccountUpdate, journal: u64) {
        // Rows of another database mean nothing in this one; the answer says which this is.
        if update.account.journal == journal && update.account.boot != 0 {
            self.pending = Some(update.account);
        }
        self.room = ROWS;
        let asked = Some((update.account.boot, update.asked));
        if update.account.boot != 0 && asked != self.asked {
            (self.asked, self.sent_row, self.has_more) = (asked, update.after_row, true);
        }
    }
}

impl Delivery {
    pub(super) fn open(node: &Node, journal: &Journal) -> Result<Self, RoleError> {
        // The PLC has an account from its first start on.
        let mut consumers = journal.consumers()?;
        if !consumers.contains(&RoleId::Plc) {
            consumers.push(RoleId::Plc);
        }
        Ok(Self {
            updates: node.reader()?,
            kept: Output::beside(node.writer()?),
            rows: Output::new(node.writer()?, &[]),
            backlogs: consumers.into_iter().map(Backlog::new).collect(),
            // Whoever waits must hear of a journal that has come.
            owes_answer: true,
        })
    }

    /// The ports that may turn the loop even while nothing can be written.
    pub(super) fn outputs(&mut self) -> [&mut dyn Port; 2] {
        [self.kept.port(), self.rows.port()]
    }

    /// All ports.
    pub(super) fn ports(&mut self) -> [&mut dyn Port; 3] {
        [self.kept.port(), self.rows.port(), &mut self.updates]
    }

    /// Takes what the consumers have sent: of each only the newest counts.
    pub(super) fn receive(&mut self, journal: &Journal, cycle: &mut Cycle<'_>) -> Result<(), Error> {
        while let Some(update) = self.updates.take()? {
            match update.consumer().ok().and_then(|consumer| self.backlog(consumer)) {
                Some(backlog) => {
                    backlog.receive(&update, journal.identity());
                    self.owes_answer = true;
                }
                None => cycle.liveness().refused(),
            }
        }
        Ok(())
    }

    /// What this consumer is owed; `None` where there are too many consumers.
    fn backlog(&mut self, consumer: RoleId) -> Option<&mut Backlog> {
        let known = self.backlogs.iter().position(|backlog| backlog.consumer == consumer);
        if known.is_none() && self.backlogs.len() < CONSUMERS {
            self.backlogs.push(Backlog::new(consumer));
            return self.backlogs.last_mut();
        }
        known.map(|index| &mut self.backlogs[index])
    }

    /// Another database has taken the place of the one before: the consumers must hear which, and ask again.
    pub(super) fn journal_is_new(&mut self) {
        self.owes_answer = true;
        for backlog in &mut self.backlogs {
            *backlog = Backlog::new(backlog.consumer);
        }
    }

    /// Verdicts were written.
    pub(super) fn has_written(&mut self) {
        self.backlogs.iter_mut().for_each(|backlog| backlog.has_more = true);
    }

    /// Whether an account waits to be written.
    pub(super) fn is_pending(&self) -> bool {
        self.backlogs.iter().any(|backlog| backlog.pending.is_some())
    }

    /// Writes the accounts that wait.
    pub(super) fn keep(&mut self, journal: &mut Journal) -> Result<(), JournalError> {
        for backlog in &mut self.backlogs {
            if let Some(account) = &backlog.pending {
                journal.keep(backlog.consumer, account)?;
                backlog.pending = None;
            }
        }
        Ok(())
    }

    /// Says what is on disk, if a consumer does not know it.
    pub(super) fn answer(&mut self, journal: &Journal, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        if !self.owes_answer {
            return Ok(());
        }
        for backlog in &self.backlogs {
            let (identity, account) = (journal.identity(), journal.account(backlog.consumer)?);
            self.kept.send(cycle, |message| {
                (message.journal, message.account) = (identity, account);
                message.consumer = backlog.consumer.code().into();
            })?;
        }
        self.owes_answer = false;
        Ok(())
    }

    /// Sends each consumer the next rows that it asks for.
    pub(super) fn deliver(&mut self, journal: &Journal, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        for backlog in &mut self.backlogs {
            let Some((boot, asked)) = backlog.asked.filter(|_| backlog.has_more) else { continue };
            let written = journal.rows_after(backlog.sent_row, backlog.room)?;
            backlog.has_more = written.len() == backlog.room;
            backlog.room -= written.len();
            for row in written {
                let before = std::mem::replace(&mut backlog.sent_row, row.row);
                self.rows.send(cycle, |message| {
                    (message.journal, message.row, message.before) = (journal.identity(), row.row, before);
                    (message.boot, message.asked, message.verdict) = (boot, asked, row.verdict);
                    message.consumer = backlog.consumer.code().into();
                })?;
            }
        }
        Ok(())
    }
}
