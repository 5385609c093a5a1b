//! The journal as a table for a terminal.

use std::io::{self, Write};

use jiff::Timestamp;
use shm_schemas::{MeasuredWords, VerdictMeasure};

use super::audit::Deed;
use super::entry::{Entry, Gap, NotWatching, Record};

pub(super) const HEADER: &str = "decided (UTC)        what             why           hand   act  iu  context            distance  threshold\n";

pub(super) const DEEDS_HEADER: &str = "when (UTC)           what           who                  said\n";

/// Writes the line of what was done.
pub(super) fn write_deed(deed: &Deed, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{:20} {:14} {:20} {}", utc(deed.utc_ns), deed.kind, deed.who, deed.what)
}

/// Writes the line of an entry.
pub(super) fn write(entry: &Entry, out: &mut dyn Write) -> io::Result<()> {
    match entry {
        Entry::Verdict(record) => write_record(record, out),
        Entry::Gap(gap) => write_gap(gap, out),
        Entry::NotWatching(blind) => write_not_watching(blind, out),
    }
}

fn write_record(r: &Record, out: &mut dyn Write) -> io::Result<()> {
    let number = |value: Option<f32>| value.map(|value| format!("{value:.2}")).unwrap_or_default();
    let index = |value: Option<u16>| value.map(|value| (value + 1).to_string()).unwrap_or_default();
    writeln!(
        out,
        "{:20} {:16} {:13} {:5} {:>4} {:>3}  {:18} {:>8} {:>10}{}{}{}{}",
        utc(r.decided_utc_ns),
        r.kind(),
        if r.reason == "None" { "" } else { &r.reason },
        r.hand,
        index(r.activity),
        index(r.iu),
        format!("{:?}", r.x_c),
        number(r.distance),
        number(r.threshold),
        if r.early { "  early" } else { "" },
        measured(r).map(|words| format!("  {words}")).unwrap_or_default(),
        if r.note == "None" { String::new() } else { format!("  note {}", r.note) },
        if r.part.is_empty() { String::new() } else { format!("  part {}", r.part) },
    )
}

/// The measure that was out of its bounds, in words.
fn measured(r: &Record) -> Option<MeasuredWords> {
    let measure = *VerdictMeasure::ALL.iter().find(|measure| measure.name() == r.measure)?;
    let [shown_min, shown_max] = r.shown;
    let (value, shown_min, shown_max) = (r.measured?, shown_min?, shown_max?);
    Some(MeasuredWords { measure, value, shown_min, shown_max })
}

fn write_gap(gap: &Gap, out: &mut dyn Write) -> io::Result<()> {
    let last = gap.last_seq.map_or("?".into(), |seq| seq.to_string());
    writeln!(
        out,
        "{:20} -- gap: {}, verdicts {} to {last} of epoch {}",
        utc(gap.utc_ns),
        gap.why,
        gap.first_seq,
        gap.epoch
    )
}

fn write_not_watching(blind: &NotWatching, out: &mut dyn Write) -> io::Result<()> {
    let end = blind.ended_utc_ns.map_or("?".into(), utc);
    let what = if blind.is_beside() { "" } else { "not watching " };
    writeln!(out, "{:20} -- {what}until {end}: {}", utc(blind.began_utc_ns), blind.meaning())
}

/// The time to the second, which is enough for a reader, or as a number where it is beyond the calendar.
fn utc(ns: u64) -> String {
    let second =
        i64::try_from(ns / 1_000_000_000).ok().and_then(|second| Timestamp::from_second(second).ok());
    second.map_or_else(|| ns.to_string(), |time| time.to_string())
}
