//! A consumer of the journal: a role that is sent every row, acknowledges it, and goes on where it ended.
//!
//! The journal keeps an account for each consumer, so one that lags, is killed or comes back costs the others nothing. A row comes again until
//! it is acknowledged and the journal has that on disk. So a consumer may see a row twice after it was killed, and never misses one that the
//! journal has. The PLC, whose account holds more, has a state machine of its own (`andon_plc::handshake`).

use std::time::{Duration, Instant};

use andon_ipc::{Error, Port, Reader, Writer};
use shm_schemas::{Account, AccountKept, AccountUpdate, Journalled, RoleId, Verdict};

use super::{Cycle, CycleError, Input, Output};

/// What the journal has not answered by then is said again.
const AGAIN: Duration = Duration::from_millis(500);

/// Rows that are taken before the journal hears of it: half of what it sends without hearing anything.
const ROWS: u64 = 16;

/// A row of the journal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Its number, which grows by one with each.
    pub row: u64,
    /// How many rows before it the journal does not have any more, and this consumer never had.
    pub missing: u64,
    /// The verdict.
    pub verdict: Verdict,
}

/// The consumer's end of the three channels.
pub struct Consumer {
    consumer: RoleId,
    updates: Output<Writer<AccountUpdate>>,
    kept: Reader<AccountKept>,
    rows: Reader<Journalled>,
    /// `None` until the journal has said what it keeps.
    standing: Option<Standing>,
    /// When it was said last how it stands, and with which number and row.
    said: Option<(Instant, u64, u64)>,
    /// Rows that were lost on their way so far.
    lost: u64,
}

/// How it stands with the journal.
#[derive(Clone, Copy, Debug)]
struct Standing {
    journal: u64,
    /// The start of the role `journal`.
    epoch: u64,
    boot: u32,
    asked: u32,
    /// The newest change that must be kept, and the newest that is kept.
    number: u64,
    kept: u64,
    taken: u64,
    acknowledged: u64,
}

impl Standing {
    fn ask(&mut self) {
        self.asked = self.asked.wrapping_add(1);
        self.number += 1;
    }
}

impl Consumer {
    /// A consumer that goes on where it ended; a new one begins with the next row that is written.
    ///
    /// # Errors
    /// That a channel cannot be opened.
    pub fn open(cycle: &Cycle<'_>) -> Result<Self, Error> {
        let node = cycle.node();
        Ok(Self {
            consumer: node.role(),
            updates: Output::beside(node.writer()?),
            kept: node.reader()?,
            rows: node.reader()?,
            standing: None,
            said: None,
            lost: 0,
        })
    }

    /// For [`super::Role::ports`].
    pub fn ports(&mut self) -> [&mut dyn Port; 3] {
        [self.updates.port(), &mut self.kept, &mut self.rows]
    }

    /// The next row, if one has come. To be called in every turn: it also says what must be said.
    ///
    /// # Errors
    /// The station's shared memory.
    pub fn take(&mut self, cycle: &mut Cycle<'_>) -> Result<Option<Row>, CycleError> {
        while let Some(kept) = self.kept.take()? {
            if kept.consumer() == Ok(self.consumer) {
                self.hear(&kept);
            }
        }
        let mut next = None;
        while next.is_none()
            && let Some(row) = cycle.take(&mut self.rows)?
        {
            next = self.accept(&row);
        }
        // What was lost on its way is asked for again.
        let lost = Input::losses(&self.rows).0;
        if std::mem::replace(&mut self.lost, lost) != lost
            && let Some(standing) = &mut self.standing
        {
            standing.ask();
        }
        self.say(cycle)?;
        Ok(next)
    }

    /// This row, and with it every row before it, needs not come again.
    pub fn acknowledge(&mut self, row: u64) {
        if let Some(standing) = &mut self.standing
            && row > standing.acknowledged
        {
            standing.acknowledged = row;
            standing.number += 1;
        }
    }

    /// The row up to which the journal has on disk that everything is acknowledged; `None` while that is not known.
    pub fn settled(&self) -> Option<u64> {
        self.standing
            .filter(|standing| standing.kept >= standing.number)
            .map(|standing| standing.acknowledged)
    }

    fn hear(&mut self, kept: &AccountKept) {
        let (journal, epoch) = (kept.journal, kept.stamp.epoch);
        match &mut self.standing {
            None => {
                let row = kept.account.row;
                let boot = kept.account.boot.wrapping_add(1).max(1);
                let standing = Standing {
                    journal,
                    epoch,
                    boot,
                    asked: 1,
                    number: 1,
                    kept: 0,
                    taken: row,
                    acknowledged: row,
                };
                self.standing = Some(standing);
            }
            Some(standing) if standing.journal != journal => {
                // The rows of another database are others, from the first on.
                (standing.journal, standing.epoch) = (journal, epoch);
                (standing.taken, standing.acknowledged) = (0, 0);
                standing.ask();
            }
            Some(standing) if standing.epoch != epoch => {
                // It has started again, and does not know what was asked for.
                standing.epoch = epoch;
                standing.ask();
            }
            Some(standing) if standing.boot == kept.account.boot => {
                standing.kept = standing.kept.max(kept.account.number);
            }
            Some(_) => (),
        }
    }

    /// Whether this is the next row that was asked for.
    fn accept(&mut self, row: &Journalled) -> Option<Row> {
        let standing = self.standing.as_mut()?;
        let is_answer = row.consumer() == Ok(self.consumer)
            && (row.journal, row.boot, row.asked) == (standing.journal, standing.boot, standing.asked);
        // After a row that was lost on its way nothing is in order until it has come again.
        if !is_answer || row.row <= standing.taken || row.before > standing.taken {
            return None;
        }
        let missing = row.row - standing.taken - 1;
        standing.taken = row.row;
        Some(Row { row: row.row, missing, verdict: row.verdict })
    }

    /// Says how it stands, where that is news, or was not answered.
    fn say(&mut self, cycle: &mut Cycle<'_>) -> Result<(), CycleError> {
        let standing = self.standing.as_ref();
        let (number, taken) = standing.map_or((0, 0), |standing| (standing.number, standing.taken));
        let is_open = standing.is_none_or(|standing| standing.kept < standing.number);
        let is_due = self.said.is_none_or(|(at, said, row)| {
            said != number || taken >= row + ROWS || is_open && at.elapsed() >= AGAIN
        });
        if !is_due {
            return Ok(());
        }
        self.said = Some((Instant::now(), number, taken));
        let consumer = self.consumer.code().into();
        let (asked, account) = standing.map_or((0, Account::default()), |standing| {
            let Standing { journal, boot, number, acknowledged, .. } = *standing;
            (standing.asked, Account { journal, boot, number, row: acknowledged, ..Account::default() })
        });
        self.updates.send(cycle, |message| {
            (message.consumer, message.after_row, message.asked) = (consumer, taken, asked);
            message.account = account;
        })
    }
}
