//! The journal as people read it.

use std::io::{self, Write};

use andon_core::verdict::Level;
use andon_journal::{AuditEntry, Entry, Gap, NotWatching};
use shm_schemas::Verdict as Message;

use crate::clock::Clock;
use crate::report::Teller;
use crate::tool::known_jobs::KnownJobs;
use crate::wire;

/// Writes one line per entry. What follows from a fault stands beneath it.
pub(super) struct Table<'a> {
    known: &'a KnownJobs,
    clock: &'a Clock,
    teller: Teller,
}

impl<'a> Table<'a> {
    pub(super) fn new(known: &'a KnownJobs, clock: &'a Clock) -> Self {
        Self { known, clock, teller: Teller::default() }
    }

    pub(super) fn header(&self) -> String {
        format!("{:19}  hand   outcome     what, and why ({})\n", "decided", self.clock.zone())
    }

    /// `clip` is the number of a verdict that was recorded, by which `andond clip` finds it.
    pub(super) fn write(&mut self, entry: &Entry, clip: Option<u64>, out: &mut impl Write) -> io::Result<()> {
        match entry {
            Entry::Verdict(message) => self.write_verdict(message, clip, out),
            Entry::Gap(gap) => self.write_gap(gap, out),
            Entry::NotWatching(blind) => self.write_not_watching(blind, out),
        }
    }

    fn write_verdict(
        &mut self,
        message: &Message,
        clip: Option<u64>,
        out: &mut impl Write,
    ) -> io::Result<()> {
        let when = self.clock.date_time(message.decided_utc_ns);
        let Some(verdict) = wire::verdict::read(message) else {
            return writeln!(
                out,
                "{when}  a verdict of a newer Andon: {} {}",
                message.level, message.outcome
            );
        };
        let mut line = self.teller.tell(&when, &verdict, self.known.names(message.model_hash));
        let job = (verdict.level == Level::Job).then(|| self.known.name(message.job_id, message.model_hash));
        let part = (!message.part.is_none()).then(|| format!("part {}", message.part.text()));
        let clip = clip.map(|row| format!("clip {row}"));
        let of: Vec<String> = job.into_iter().chain(part).chain(clip).collect();
        if !of.is_empty() {
            line.text += &format!("  [{}]", of.join(", "));
        }
        line.write(out)
    }

    fn write_gap(&self, gap: &Gap, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "{}  -- {}", self.clock.date_time(gap.utc_ns), missing_words(gap))
    }

    fn write_not_watching(&self, blind: &NotWatching, out: &mut impl Write) -> io::Result<()> {
        let when = self.clock.date_time(blind.began_utc_ns);
        let what = if blind.is_beside() { "" } else { "not watching " };
        match blind.ended_utc_ns {
            Some(end) => {
                writeln!(out, "{when}  -- {what}until {}: {}", self.clock.date_time(end), blind.meaning())
            }
            None => writeln!(out, "{when}  -- {what}from here on, no end is known: {}", blind.meaning()),
        }
    }
}

/// Which verdicts are missing before this place, and why.
fn missing_words(gap: &Gap) -> String {
    let before = |why: &str| format!("what was before is not here any more: {why}");
    let count = gap.last_seq.map(|last| (last + 1).saturating_sub(gap.first_seq));
    match (gap.why.as_str(), count) {
        ("lost", Some(1)) => "1 verdict is missing: it was lost on its way to the journal".to_owned(),
        ("lost", Some(count)) => {
            format!("{count} verdicts are missing: they were lost on their way to the journal")
        }
        ("restart", _) => "verdicts may be missing: the judge has started again".to_owned(),
        ("retention", _) => before("the oldest are removed, as journal.keep_days and journal.keep_mb say"),
        ("removed", _) => before("somebody has removed the database under its writer"),
        ("damaged", _) => before("the database was damaged and has been put aside"),
        (other, _) => format!("verdicts may be missing: {other}"),
    }
}

pub(super) fn audit_header(clock: &Clock) -> String {
    format!("{:19}  what           who                  said ({})\n", "when", clock.zone())
}

pub(super) fn write_audit(audit: &AuditEntry, clock: &Clock, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "{:19}  {:14} {:20} {}", clock.date_time(audit.utc_ns), audit.kind, audit.who, audit.what)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_said_with_its_number_and_its_reason() {
        let gap =
            |why: &str, last_seq| Gap { utc_ns: 0, why: why.to_owned(), epoch: 7, first_seq: 4, last_seq };
        for (gap, words) in [
            (gap("lost", Some(4)), "1 verdict is missing: it was lost on its way to the journal"),
            (gap("lost", Some(6)), "3 verdicts are missing: they were lost on their way to the journal"),
            (gap("restart", None), "verdicts may be missing: the judge has started again"),
            (
                gap("retention", Some(9)),
                "what was before is not here any more: the oldest are removed, as journal.keep_days and journal.keep_mb say",
            ),
            (
                gap("damaged", None),
                "what was before is not here any more: the database was damaged and has been put aside",
            ),
        ] {
            assert_eq!(missing_words(&gap), words);
        }
    }
}
