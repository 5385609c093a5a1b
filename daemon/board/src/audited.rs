//! Who has changed what.

use crate::board::Board;

/// One thing that was done, as the audit trail of the journal has it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Audited {
    /// When, nanoseconds since 1970 UTC.
    pub utc_ns: u64,
    /// A word of [`AuditKind`](shm_schemas::AuditKind).
    pub kind: String,
    /// Who did it.
    pub who: String,
    /// What was done.
    pub what: String,
    /// What became of it; empty where that is not said apart.
    pub became: String,
}

impl Board {
    /// What was done last, newest first.
    pub fn audited(&mut self, audited: Vec<Audited>) {
        self.version += u64::from(self.desk.audited != audited);
        self.desk.audited = audited;
    }
}
