//! The journal as CSV (RFC 4180), for spreadsheets.

use std::borrow::Cow;
use std::io::{self, Write};

use jiff::Timestamp;
use shm_schemas::{COLUMNS, Value, Verdict, VerdictLevel, VerdictOutcome, verdict_kind};

use super::audit::AuditEntry;
use super::entry::{Entry, Gap, NotWatching};

pub(super) const AUDIT_HEADER: &str = "utc,kind,who,what\r\n";

/// What a line begins with, before the columns of a verdict.
const FIRST: [&str; 3] = ["decided_utc", "entry", "kind"];
/// Columns of gaps and of times without sight alone.
const OF_OTHERS: [&str; 2] = ["last_seq", "ended_utc"];
/// The part is the last: it is the one text of people.
const LAST: &str = "part";
/// The columns of a verdict that are not in CSV: `decided_utc` says one of them, and the others mean nothing outside of the machine.
const LEFT_OUT: [&str; 4] = ["decided_utc_ns", "frame_seq", "captured_ns", "sent_ns"];

/// The columns of a line, in their order.
fn names() -> Vec<&'static str> {
    let has_its_place = |name: &&str| !LEFT_OUT.contains(name) && *name != LAST;
    let of_verdict = COLUMNS.iter().map(|column| column.name).filter(has_its_place);
    FIRST.into_iter().chain(of_verdict).chain(OF_OTHERS).chain([LAST]).collect()
}

/// The first line.
pub(super) fn header() -> String {
    let unit = |name: &str| match name.strip_suffix("_ns") {
        Some(time) => format!("{time}_s"),
        None => name.to_owned(),
    };
    names().into_iter().map(unit).collect::<Vec<_>>().join(",") + "\r\n"
}

/// Writes the line of what was done. These are words of people, so they are quoted.
pub(super) fn write_audit(audit: &AuditEntry, out: &mut dyn Write) -> io::Result<()> {
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    write!(out, "{},{},{},{}\r\n", utc(audit.utc_ns), audit.kind, quoted(&audit.who), quoted(&audit.what))
}

/// Writes the line of an entry.
pub(super) fn write(entry: &Entry, out: &mut dyn Write) -> io::Result<()> {
    match entry {
        Entry::Verdict(verdict) => line(out, |name| of_verdict(verdict, name)),
        Entry::Gap(gap) => line(out, |name| of_gap(gap, name)),
        Entry::NotWatching(blind) => line(out, |name| of_not_watching(blind, name)),
    }
}

fn line<'e>(out: &mut dyn Write, value: impl Fn(&str) -> Cow<'e, str>) -> io::Result<()> {
    let values: Vec<Cow<'_, str>> = names().into_iter().map(value).collect();
    write!(out, "{}\r\n", values.join(","))
}

fn of_verdict<'v>(verdict: &'v Verdict, name: &str) -> Cow<'v, str> {
    match name {
        "decided_utc" => utc(verdict.decided_utc_ns).into(),
        "entry" => "verdict".into(),
        "kind" => kind(verdict).into(),
        name => {
            let column = COLUMNS.iter().find(|column| column.name == name);
            column.map_or(Cow::default(), |column| text((column.get)(verdict)))
        }
    }
}

/// Level and outcome in one word. One that this build does not know was not judged.
fn kind(verdict: &Verdict) -> &'static str {
    match (verdict.level(), verdict.outcome()) {
        (Ok(level), Ok(outcome)) => verdict_kind(level, outcome),
        _ => verdict_kind(VerdictLevel::Iu, VerdictOutcome::NotJudged),
    }
}

fn of_gap<'g>(gap: &'g Gap, name: &str) -> Cow<'g, str> {
    match name {
        "decided_utc" => utc(gap.utc_ns).into(),
        "entry" => "gap".into(),
        "reason" => gap.why.as_str().into(),
        "epoch" => gap.epoch.to_string().into(),
        "seq" => gap.first_seq.to_string().into(),
        "last_seq" => gap.last_seq.map(|last| last.to_string()).unwrap_or_default().into(),
        _ => Cow::default(),
    }
}

fn of_not_watching<'b>(blind: &'b NotWatching, name: &str) -> Cow<'b, str> {
    match name {
        "decided_utc" => utc(blind.began_utc_ns).into(),
        "entry" => "not_watching".into(),
        "reason" => blind.why.as_str().into(),
        "ended_utc" => blind.ended_utc_ns.map(utc).unwrap_or_default().into(),
        _ => Cow::default(),
    }
}

fn text(value: Value<'_>) -> Cow<'_, str> {
    match value {
        Value::None => Cow::default(),
        Value::Whole(number) => number.to_string().into(),
        Value::Hash(hash) => format!("{hash:016x}").into(),
        Value::Time(ns) => seconds(ns).into(),
        Value::Number(number) => number.to_string().into(),
        Value::Word(word) => word.into(),
        Value::Unknown(code) => code.to_string().into(),
        Value::Text(text) => quoted(text),
    }
}

/// A text that may have commas, quotes and ends of lines in it.
pub(super) fn quoted(text: &str) -> Cow<'_, str> {
    let is_plain = !text.contains([',', '"', '\r', '\n']);
    if is_plain { text.into() } else { format!("\"{}\"", text.replace('"', "\"\"")).into() }
}

fn seconds(ns: u64) -> String {
    format!("{}.{:09}", ns / 1_000_000_000, ns % 1_000_000_000)
}

/// The time as in RFC 3339, or as a number where it is beyond the calendar.
fn utc(ns: u64) -> String {
    Timestamp::from_nanosecond(ns.into()).map_or_else(|_| ns.to_string(), |time| time.to_string())
}
