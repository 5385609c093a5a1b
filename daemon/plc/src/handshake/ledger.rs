//! The account with the journal: what is to be kept, what is kept, and which rows are asked for.

use shm_schemas::{Account, Journalled};

use super::MS;

/// An account that the journal has not kept by then is sent again, and rows that have not come are asked for again.
const AGAIN_NS: u64 = 500 * MS;

/// What is sent to the journal: keep this account, and send the rows after this one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update {
    /// The rows after this one are needed.
    pub after_row: u64,
    /// The number of this request for rows.
    pub asked: u32,
    /// The account.
    pub account: Account,
}

/// What is known of the journal's side. Before the journal has said what it keeps, `boot` is 0 and nothing is known.
#[derive(Debug, Default)]
pub(super) struct Ledger {
    journal: u64,
    boot: u32,
    /// The newest change that must be kept.
    number: u64,
    /// The newest change that is kept.
    kept: u64,
    /// The change that holds the newest acknowledgement.
    released: u64,
    asked: u32,
    sent: Option<Sent>,
}

#[derive(Clone, Copy, Debug)]
struct Sent {
    number: u64,
    at_ns: u64,
}

/// What the news from the journal means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum News {
    /// The first: go on from its account.
    Resume,
    /// Another journal has taken its place.
    OtherJournal,
    /// The newest acknowledgement is on disk.
    Acknowledged,
    /// Nothing else follows.
    Nothing,
}

impl Ledger {
    pub(super) fn is_open(&self) -> bool {
        self.boot != 0
    }

    /// The number of this start; 0 until the journal keeps it: after a loss of power the next start would have the same number.
    pub(super) fn boot(&self) -> u32 {
        if self.kept == 0 { 0 } else { self.boot }
    }

    /// The journal has said what it keeps.
    pub(super) fn account_kept(&mut self, journal: u64, kept: &Account) -> News {
        if !self.is_open() {
            (self.journal, self.boot) = (journal, kept.boot.wrapping_add(1).max(1));
            self.ask();
            return News::Resume;
        }
        if journal != self.journal {
            self.journal = journal;
            self.ask();
            return News::OtherJournal;
        }
        if kept.boot != self.boot {
            // What an earlier start has sent, or a journal that has come back: it must hear of this one.
            self.sent = None;
            return News::Nothing;
        }
        self.kept = self.kept.max(kept.number);
        if self.released != 0 && self.kept >= self.released {
            self.released = 0;
            return News::Acknowledged;
        }
        News::Nothing
    }

    /// The journal has started again: it does not know any more what was asked for.
    pub(super) fn journal_restarted(&mut self) {
        if self.is_open() {
            self.ask();
        }
    }

    /// Whether the row answers the newest request.
    pub(super) fn is_answer(&self, row: &Journalled) -> bool {
        self.is_open() && (row.journal, row.boot, row.asked) == (self.journal, self.boot, self.asked)
    }

    /// A change that must be kept; `is_release` when it is an acknowledgement.
    pub(super) fn change(&mut self, is_release: bool) {
        self.number += 1;
        if is_release {
            self.released = self.number;
        }
    }

    /// Asks for all rows that are needed, as a change: so it is sent again until the journal has it.
    pub(super) fn ask(&mut self) {
        self.asked = self.asked.wrapping_add(1);
        self.change(false);
    }

    /// Asks again, unless the journal may still be at it.
    pub(super) fn ask_again(&mut self, now_ns: u64) {
        let is_waiting = self.sent.is_none_or(|sent| now_ns.saturating_sub(sent.at_ns) < AGAIN_NS);
        if self.is_open() && !is_waiting {
            self.ask();
        }
    }

    /// Whether the journal must be sent something now.
    pub(super) fn is_due(&self, now_ns: u64) -> bool {
        let is_kept = self.kept >= self.number;
        self.is_open()
            && self.sent.is_none_or(|sent| {
                sent.number != self.number || !is_kept && now_ns.saturating_sub(sent.at_ns) >= AGAIN_NS
            })
    }

    /// The update that is due is being sent.
    pub(super) fn sent(&mut self, now_ns: u64) -> u32 {
        self.sent = Some(Sent { number: self.number, at_ns: now_ns });
        self.asked
    }

    /// Writes what only the ledger knows.
    pub(super) fn save(&self, account: &mut Account) {
        (account.journal, account.boot, account.number) = (self.journal, self.boot, self.number);
    }
}
