//! What happened before the board began, from the journal. It is read in a thread, because a disk may be slow, and without the right to write.
//!
//! Such a reader needs the log that the role `journal` makes. Both roles start at once, so it is tried until the log is there.

use std::path::{Path, PathBuf};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use andon_board::{Board, Past};
use andon_journal::{Entry, History, JournalError, NotWatching, Query};
use jiff::Timestamp;

use super::super::error::report_journal;
use super::{is_due, midnight_utc_ns, nanoseconds};
use crate::confirmed;

/// What the technician finds of the time before the board began, at least.
const BEFORE: Duration = Duration::from_secs(24 * 3600);

/// How often it is tried.
const TRY: Duration = Duration::from_secs(1);

type Read = Result<Past, JournalError>;

/// Reads the past once.
pub(super) struct PastReader {
    path: PathBuf,
    tried: Option<Instant>,
    reading: Option<JoinHandle<Read>>,
    is_over: bool,
}

impl PastReader {
    pub(super) fn new(path: PathBuf) -> Self {
        Self { path, tried: None, reading: None, is_over: false }
    }

    /// What the board keeps, as soon as it was read.
    pub(super) fn take(&mut self) -> Option<Past> {
        let joined = self.reading.take_if(|reading| reading.is_finished()).map(JoinHandle::join);
        let past = joined.and_then(|joined| self.finish(joined.ok()?));
        if !self.is_over && self.reading.is_none() && is_due(&mut self.tried, TRY) {
            let path = self.path.clone();
            // Without a thread it is tried again.
            self.reading = Builder::new().name("past".into()).spawn(move || read(&path)).ok();
        }
        past
    }

    fn finish(&mut self, read: Read) -> Option<Past> {
        match read {
            Err(JournalError::Open { .. } | JournalError::NotFile { .. } | JournalError::Locked { .. }) => {
                return None;
            }
            Err(ref error) => report_journal(error),
            Ok(_) => (),
        }
        self.is_over = true;
        read.ok()
    }
}

fn read(path: &Path) -> Read {
    let since_utc_ns = midnight_utc_ns().min(nanoseconds(Timestamp::now() - BEFORE));
    let query = Query { since_utc_ns: Some(since_utc_ns), ..Query::default() };
    let mut past = Past::default();
    // Since when nobody watched, where nobody saw the end of it.
    let mut open = None;
    let history = History::open_read_only(path)?;
    history.visit(&query, |entry| {
        if let Some(began_utc_ns) = open.take() {
            past.unwatched.push([began_utc_ns, began(&entry)]);
        }
        match entry {
            Entry::NotWatching(of) if of.is_beside() => (),
            Entry::Verdict(verdict) if Board::keeps(&verdict) => past.verdicts.push(*verdict),
            Entry::NotWatching(NotWatching { began_utc_ns, ended_utc_ns: Some(end_utc_ns), .. }) => {
                past.unwatched.push([began_utc_ns, end_utc_ns]);
            }
            Entry::NotWatching(NotWatching { began_utc_ns, .. }) => open = Some(began_utc_ns),
            _ => (),
        }
        Ok(())
    })?;
    let said = confirmed::since(&history, Some(since_utc_ns))?.into_values();
    past.confirmed.extend(said.map(|(said, who)| (said.id, said.was, who)));
    // It lasts.
    past.unwatched.extend(open.map(|began_utc_ns| [began_utc_ns, nanoseconds(Timestamp::now())]));
    Ok(past)
}

/// When a row of the journal began: nobody watched until then at the latest.
fn began(entry: &Entry) -> u64 {
    match entry {
        Entry::Verdict(verdict) => verdict.decided_utc_ns,
        Entry::Gap(gap) => gap.utc_ns,
        Entry::NotWatching(unwatched) => unwatched.began_utc_ns,
    }
}
