//! The journal as people read it.

use std::io::{self, Write};

use andon_core::verdict::Level;
use andon_journal::{Deed, Entry, Gap, NotWatching, Record};

use crate::report::Teller;
use crate::tool::clock::Clock;
use crate::tool::known::KnownJobs;
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

    pub(super) fn write(&mut self, entry: &Entry, out: &mut impl Write) -> io::Result<()> {
        match entry {
            Entry::Verdict(record) => self.write_verdict(record, out),
            Entry::Gap(gap) => self.write_gap(gap, out),
            Entry::NotWatching(blind) => self.write_not_watching(blind, out),
        }
    }

    fn write_verdict(&mut self, record: &Record, out: &mut impl Write) -> io::Result<()> {
        let message = record.message();
        let when = self.clock.date_time(message.decided_utc_ns);
        let Some(verdict) = wire::verdict::read(&message) else {
            return writeln!(out, "{when}  a verdict of a newer Andon: {} {}", record.level, record.outcome);
        };
        let mut line = self.teller.tell(&when, &verdict, self.known.names(message.model_hash));
        let job = (verdict.level == Level::Job).then(|| self.known.name(message.job_id, message.model_hash));
        let part = (!record.part.is_empty()).then(|| format!("part {}", record.part));
        let of: Vec<String> = job.into_iter().chain(part).collect();
        if !of.is_empty() {
            line.text += &format!("  [{}]", of.join(", "));
        }
        line.write(out)
    }

    fn write_gap(&self, gap: &Gap, out: &mut impl Write) -> io::Result<()> {
        let when = self.clock.date_time(gap.utc_ns);
        let last = gap.last_seq.map_or("?".into(), |seq| seq.to_string());
        writeln!(
            out,
            "{when}  -- gap: {}, verdicts {} to {last} of epoch {}",
            gap.why, gap.first_seq, gap.epoch
        )
    }

    fn write_not_watching(&self, blind: &NotWatching, out: &mut impl Write) -> io::Result<()> {
        let when = self.clock.date_time(blind.began_utc_ns);
        let end = blind.ended_utc_ns.map_or("?".into(), |end| self.clock.date_time(end));
        let what = if blind.is_beside() { "" } else { "not watching " };
        writeln!(out, "{when}  -- {what}until {end}: {}", blind.meaning())
    }
}

pub(super) fn deeds_header(clock: &Clock) -> String {
    format!("{:19}  what           who                  said ({})\n", "when", clock.zone())
}

pub(super) fn write_deed(deed: &Deed, clock: &Clock, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "{:19}  {:14} {:20} {}", clock.date_time(deed.utc_ns), deed.kind, deed.who, deed.what)
}
