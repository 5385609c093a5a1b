//! The journal as CSV (RFC 4180), for spreadsheets.

use std::fmt::Display;
use std::io::{self, Write};

use jiff::Timestamp;

use super::audit::Deed;
use super::entry::{Entry, Gap, NotWatching, Record};

pub(super) const HEADER: &str = "decided_utc,entry,kind,level,outcome,reason,hand,station,job_id,model_hash,activity,iu,nearest,x_c0,x_c1,x_c2,x_c3,distance,\
                      threshold,early,note,broken,broken_activity,broken_runs,measure,measured,shown_min,shown_max,captured_percent,seen_percent,missing_hand,missing_object,\
                      missing_s,missing_percent,needed_percent,began_s,ended_s,decided_s,epoch,seq,last_seq,ended_utc,part\r\n";

pub(super) const DEEDS_HEADER: &str = "utc,kind,who,what\r\n";

/// Writes the line of what was done. These are words of people, so they are quoted.
pub(super) fn write_deed(deed: &Deed, out: &mut dyn Write) -> io::Result<()> {
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    write!(out, "{},{},{},{}\r\n", utc(deed.utc_ns), deed.kind, quoted(&deed.who), quoted(&deed.what))
}

/// Writes the line of an entry.
pub(super) fn write(entry: &Entry, out: &mut dyn Write) -> io::Result<()> {
    match entry {
        Entry::Verdict(record) => write_record(record, out),
        Entry::Gap(gap) => write_gap(gap, out),
        Entry::NotWatching(blind) => write_not_watching(blind, out),
    }
}

// No field but the last needs quoting: they are numbers, names of codes, and the station's name, which consists of a-z, 0-9 and -.
fn write_record(r: &Record, out: &mut dyn Write) -> io::Result<()> {
    write!(
        out,
        "{},verdict,{},{},{},{},{},{},{},{}",
        utc(r.decided_utc_ns),
        r.kind(),
        r.level,
        r.outcome,
        r.reason,
        r.hand,
        r.station,
        r.job_id,
        r.model_hash
    )?;
    write!(out, ",{},{},{}", or_empty(r.activity), or_empty(r.iu), or_empty(r.nearest))?;
    write!(out, ",{},{},{},{}", r.x_c[0], r.x_c[1], r.x_c[2], r.x_c[3])?;
    write!(out, ",{},{},{}", or_empty(r.distance), or_empty(r.threshold), u8::from(r.early))?;
    write!(out, ",{},{},{},{}", r.note, r.broken, or_empty(r.broken_activity), r.broken_runs)?;
    let [min, max] = r.shown.map(or_empty);
    write!(out, ",{},{},{min},{max}", r.measure, or_empty(r.measured))?;
    write!(out, ",{},{}", or_empty(r.captured_percent), or_empty(r.seen_percent))?;
    write!(out, ",{},{},{}", r.missing_hand, or_empty(r.missing_object), or_empty(r.missing_s))?;
    write!(out, ",{},{}", or_empty(r.missing_percent), or_empty(r.needed_percent))?;
    write!(out, ",{},{},{}", seconds(r.began_ns), seconds(r.ended_ns), seconds(r.decided_ns))?;
    write!(out, ",{},{},,,{}\r\n", r.epoch, r.seq, quoted(&r.part))
}

/// A text that may have commas and quotes in it.
fn quoted(text: &str) -> String {
    let is_plain = !text.contains([',', '"']);
    if is_plain { text.to_owned() } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

fn write_gap(gap: &Gap, out: &mut dyn Write) -> io::Result<()> {
    let last_seq = or_empty(gap.last_seq);
    write!(
        out,
        "{},gap,,,,{},,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,{},{},{last_seq},,\r\n",
        utc(gap.utc_ns),
        gap.why,
        gap.epoch,
        gap.first_seq
    )
}

fn write_not_watching(blind: &NotWatching, out: &mut dyn Write) -> io::Result<()> {
    let end = or_empty(blind.ended_utc_ns.map(utc));
    write!(
        out,
        "{},not_watching,,,,{},,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,,{end},\r\n",
        utc(blind.began_utc_ns),
        blind.why
    )
}

fn or_empty(value: Option<impl Display>) -> String {
    value.map(|value| value.to_string()).unwrap_or_default()
}

fn seconds(ns: u64) -> String {
    format!("{}.{:09}", ns / 1_000_000_000, ns % 1_000_000_000)
}

/// The time as in RFC 3339, or as a number where it is beyond the calendar.
fn utc(ns: u64) -> String {
    Timestamp::from_nanosecond(ns.into()).map_or_else(|_| ns.to_string(), |time| time.to_string())
}
