//! What the journal owes the role `plc`: it keeps the PLC's account on disk, and sends the rows that it is asked for.
//!
//! The role `plc` never opens the database. So a result that is not on disk cannot be offered, and a restart goes on where the last start
//! ended.

use andon_host::role::{Cycle, Output};
use andon_ipc::{Error, Node, Port, Reader, Writer};
use andon_journal::{Journal, JournalError};
use shm_schemas::{Account, AccountKept, AccountUpdate, Journalled};

use super::super::RoleError;

/// Rows that are sent before plc says something: half of what the channel holds, and more than plc can take at a time. What is left
/// it asks for when it has room.
const ROWS: usize = 32;

/// The journal's side of the account.
pub(super) struct Delivery {
    updates: Reader<AccountUpdate>,
    kept: Output<Writer<AccountKept>>,
    rows: Output<Writer<Journalled>>,
    /// What is to be kept and is not on disk yet.
    pending: Option<Account>,
    /// Plc must be told what is on disk.
    owes_answer: bool,
    /// The start of plc that asked for rows, and its number; `None` until it has.
    asked: Option<(u32, u32)>,
    /// The newest row that was sent since then.
    sent_row: u64,
    /// Rows that may still be sent before plc says something.
    room: usize,
    has_more: bool,
}

impl Delivery {
    pub(super) fn open(node: &Node) -> Result<Self, Error> {
        Ok(Self {
            updates: node.reader()?,
            kept: Output::beside(node.writer()?),
            rows: Output::new(node.writer()?, &[]),
            pending: None,
            // A plc that waits must hear of a journal that has come.
            owes_answer: true,
            asked: None,
            sent_row: 0,
            room: 0,
            has_more: false,
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

    /// Takes what plc has sent: only the newest counts.
    pub(super) fn receive(&mut self, journal: &Journal) -> Result<(), Error> {
        while let Some(update) = self.updates.take()? {
            // Rows of another database mean nothing in this one; the answer tells plc which this is.
            if update.account.journal == journal.identity() {
                self.pending = Some(update.account);
            }
            (self.owes_answer, self.room) = (true, ROWS);
            let asked = Some((update.account.boot, update.asked));
            if asked != self.asked {
                (self.asked, self.sent_row, self.has_more) = (asked, update.after_row, true);
            }
        }
        Ok(())
    }

    /// Another database has taken the place of the one before: plc must hear which, and asks again.
    pub(super) fn journal_is_new(&mut self) {
        self.pending = None;
        self.owes_answer = true;
        (self.asked, self.sent_row, self.has_more) = (None, 0, false);
    }

    /// Verdicts were written.
    pub(super) fn has_written(&mut self) {
        self.has_more = true;
    }

    /// Whether an account waits to be written.
    pub(super) fn is_pending(&self) -> bool {
        self.pending.is_some()
    }

    /// Writes the account that waits.
    pub(super) fn keep(&mut self, journal: &mut Journal) -> Result<(), JournalError> {
        if let Some(account) = &self.pending {
            journal.keep(account)?;
            self.pending = None;
        }
        Ok(())
    }

    /// Says what is on disk, if plc does not know it.
    pub(super) fn answer(&mut self, journal: &Journal, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        if !self.owes_answer {
            return Ok(());
        }
        let (identity, account) = (journal.identity(), journal.account()?);
        self.kept.send(cycle, |message| (message.journal, message.account) = (identity, account))?;
        self.owes_answer = false;
        Ok(())
    }

    /// Sends the next rows that are asked for.
    pub(super) fn deliver(&mut self, journal: &Journal, cycle: &mut Cycle<'_>) -> Result<(), RoleError> {
        let Some((boot, asked)) = self.asked.filter(|_| self.has_more) else { return Ok(()) };
        let written = journal.rows_after(self.sent_row, self.room)?;
        self.has_more = written.len() == self.room;
        self.room -= written.len();
        for row in written {
            let before = std::mem::replace(&mut self.sent_row, row.row);
            self.rows.send(cycle, |message| {
                (message.journal, message.row, message.before) = (journal.identity(), row.row, before);
                (message.boot, message.asked, message.verdict) = (boot, asked, row.verdict);
            })?;
        }
        Ok(())
    }
}
