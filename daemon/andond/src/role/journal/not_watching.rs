//! The times in which the line did not watch, on their way to the journal.

use std::collections::{HashMap, VecDeque};

use andon_host::config::Config;
use andon_ipc::{MonotonicTime, UtcTime};
use andon_journal::{Journal, JournalError, OpenRow};
use shm_schemas::{Health, RoleId};

use super::alive::Alive;
use crate::outage::{Outage, Outages};
use crate::sight::SightChanges;

/// Changes that wait while nothing can be written: more than come in an hour of the worst line.
const MAX_WAITING: usize = 1024;

/// What was not watching: the line's sight, or a role.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Cause {
    Sight,
    Role(RoleId),
}

/// What is to be written.
#[derive(Debug)]
enum Change {
    Began { cause: Cause, utc_ns: u64, why: String },
    Ended { cause: Cause, utc_ns: u64 },
}

/// Collects begins and ends from the health of the roles.
pub(super) struct NotWatching {
    /// The journal's own role, whose outages no other role reports.
    own: Alive,
    outages: Outages,
    sight: SightChanges,
    /// Roles whose begin has been noted and whose end has not.
    down: Vec<RoleId>,
    waiting: VecDeque<Change>,
    /// The rows of what has begun and not ended.
    rows: HashMap<Cause, OpenRow>,
}

impl NotWatching {
    pub(super) fn new(config: &Config) -> Self {
        Self {
            own: Alive::new(config),
            outages: Outages::new(config, RoleId::Journal),
            sight: SightChanges::default(),
            down: Vec::new(),
            waiting: VecDeque::new(),
            rows: HashMap::new(),
        }
    }

    /// Takes what a role says of itself.
    pub(super) fn receive(&mut self, health: &Health) {
        if let Some(change) = self.sight.receive(health) {
            let utc_ns = UtcTime::at(MonotonicTime::from_nanoseconds(health.sight_since_ns)).nanoseconds();
            if change.before.is_some() {
                self.push(Change::Ended { cause: Cause::Sight, utc_ns });
            }
            if let Some(trouble) = change.now {
                let why = trouble.name().to_owned();
                self.push(Change::Began { cause: Cause::Sight, utc_ns, why });
            }
        }
        if let Some(outage) = self.outages.receive(health) {
            self.note(&outage);
        }
    }

    /// Finds who has fallen silent.
    pub(super) fn look(&mut self) {
        let now = MonotonicTime::now();
        for outage in self.outages.look(now) {
            self.note(&outage);
        }
        if let Some(outage) = self.own.beat(now) {
            self.note(&outage);
        }
    }

    fn note(&mut self, outage: &Outage) {
        let (role, cause) = (outage.role, Cause::Role(outage.role));
        if !self.down.contains(&role) {
            self.down.push(role);
            self.push(Change::Began {
                cause,
                utc_ns: UtcTime::at(outage.began).nanoseconds(),
                why: outage.why(),
            });
        }
        if let Some(ended) = outage.ended {
            self.down.retain(|down| *down != role);
            self.push(Change::Ended { cause, utc_ns: UtcTime::at(ended).nanoseconds() });
        }
    }

    fn push(&mut self, change: Change) {
        if self.waiting.len() < MAX_WAITING {
            self.waiting.push_back(change);
        }
    }

    /// The rows are those of another database from now on.
    pub(super) fn forget_rows(&mut self) {
        self.rows.clear();
    }

    /// Writes what waits, in order. What cannot be written stays for the next call.
    pub(super) fn write(&mut self, journal: &mut Journal) -> Result<(), JournalError> {
        while let Some(change) = self.waiting.front() {
            match change {
                Change::Began { cause, utc_ns, why } => {
                    let row = journal.stops_watching(*utc_ns, why)?;
                    self.rows.insert(*cause, row);
                }
                Change::Ended { cause, utc_ns } => {
                    if let Some(row) = self.rows.get(cause) {
                        journal.watches_again(*row, *utc_ns)?;
                        self.rows.remove(cause);
                    }
                }
            }
            self.waiting.pop_front();
        }
        Ok(())
    }
}
