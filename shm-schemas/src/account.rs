//! Channels `account`, `kept` and `journalled`: the accounts of those who read the journal, and the rows that they are owed.
//!
//! A consumer of the journal is a role that acknowledges rows. The journal keeps an account for each on disk, so that each goes on where it
//! ended, whatever the others do. All of them share the three channels, and each message names the consumer that it is for.

use crate::code::UnknownCode;
use crate::health::RoleId;
use crate::layout::wire;
use crate::part::PartId;
use crate::stamp::{Stamp, message};
use crate::verdict::Verdict;

/// Consumers of one journal: the PLC, an uplink, a board, and one to spare.
pub const CONSUMERS: usize = 4;

/// Results that can wait behind the offered one.
pub const WAITING_RESULTS: usize = 8;

wire! { "andon.Account", 216;
    /// What a consumer has been told and what it is owed. From it a new start of its role goes on where the last one ended.
    ///
    /// `journal`, `number`, `row` and `boot` mean the same for all. The others are the PLC's; another consumer may leave them at 0.
    struct Account {
        /// The identity of the journal that the rows are of.
        journal: u64,
        /// Counts the changes that must be kept, from 1 in every start of the role.
        number: u64,
        /// Every row of the journal up to this one is acknowledged, or has been given a number for the PLC.
        row: u64,
        /// The epoch of the newest verdict that has been numbered.
        epoch: u64,
        /// Its `seq`.
        seq: u64,
        /// The row of the result that was offered last; 0 is none.
        shown_row: u64,
        /// The hash of the job that the PLC has loaded; 0 accepts any.
        wanted_hash: u64,
        /// The rows of the results that wait behind it, oldest first; 0 where none waits.
        waiting_rows: [u64; WAITING_RESULTS],
        /// Their numbers; 0 where none waits.
        waiting_sequences: [u32; WAITING_RESULTS],
        /// Counts the starts of the role; 0 says that none was ever kept.
        boot: u32,
        /// The newest number that was given to a result.
        sequence: u32,
        /// Results that were lost to the PLC.
        lost: u32,
        /// The number of the result that was offered last; 0 is none.
        shown_sequence: u32,
        /// The number of the log's code that belongs to `error`.
        error_detail: u32,
        /// The job that the PLC has loaded; 0 where it has loaded none.
        wanted_job: u32,
        /// 1 when the PLC has given a part id, or has said that there is none; else 0.
        gives_parts: u32,
        /// The latched fault as its number on the registers; 0 is none.
        error: u16,
        /// 1 when the result that was offered last has been acknowledged, else 0.
        is_acknowledged: u8,
        /// 1 when a result was lost and nobody has reset it, else 0.
        has_overrun: u8,
        /// The part id that the PLC has given last.
        part: PartId,
    }
}

wire! { "andon.AccountUpdate", 272;
    /// From a consumer to the journal: keep this account, and send the rows after `after_row`.
    struct AccountUpdate {
        /// The stamp. It belongs to no frame.
        stamp: Stamp,
        /// The rows after this one are asked for.
        after_row: u64,
        /// Counts the times that rows were asked for. A new number asks for all of them again.
        asked: u32,
        /// The consumer, a number of [`RoleId`].
        consumer: u32,
        /// The account. One with `boot` 0 is not kept: it asks what is kept.
        account: Account,
    }
}
message!(AccountUpdate);

wire! { "andon.AccountKept", 272;
    /// From the journal to a consumer: this account is on disk.
    struct AccountKept {
        /// The stamp. It belongs to no frame.
        stamp: Stamp,
        /// The identity of this journal.
        journal: u64,
        /// The consumer, a number of [`RoleId`].
        consumer: u32,
        /// Keeps the size a multiple of 8.
        reserved: u32,
        /// The account. One with `boot` 0 was never kept: it says where the journal ends.
        account: Account,
    }
}
message!(AccountKept);

wire! { "andon.Journalled", 272;
    /// From the journal to a consumer: one row, which is on disk.
    struct Journalled {
        /// The stamp, as that of the verdict.
        stamp: Stamp,
        /// The identity of this journal.
        journal: u64,
        /// The row.
        row: u64,
        /// The row before it; what is between the two is not in the journal.
        before: u64,
        /// The start of the role that asked for it.
        boot: u32,
        /// The newest [`AccountUpdate::asked`].
        asked: u32,
        /// The consumer, a number of [`RoleId`].
        consumer: u32,
        /// Keeps the size a multiple of 8.
        reserved: u32,
        /// The verdict, with its own stamp.
        verdict: Verdict,
    }
}
message!(Journalled);

impl Account {
    /// The row up to which the consumer needs nothing any more: what is offered or waits is still owed.
    #[must_use]
    pub fn settled(&self) -> u64 {
        let waiting = self.waiting_rows.iter().copied();
        let offered = (self.is_acknowledged == 0).then_some(self.shown_row);
        let oldest = waiting.chain(offered).filter(|row| *row > 0).min();
        oldest.map_or(self.row, |oldest| oldest - 1)
    }
}

macro_rules! of_consumer {
    ($($message:ty),+) => {$(
        impl $message {
            /// The consumer.
            ///
            /// # Errors
            /// A number that is no role.
            pub fn consumer(&self) -> Result<RoleId, UnknownCode> {
                let unknown = UnknownCode { list: "RoleId", code: self.consumer };
                u8::try_from(self.consumer).map_err(|_| unknown).and_then(RoleId::try_from)
            }
        }
    )+};
}
of_consumer!(AccountUpdate, AccountKept, Journalled);
