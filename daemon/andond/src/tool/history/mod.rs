//! `andond history`: queries the journal, also while it is written.

mod plot;
mod summary;
mod table;

use std::io::{BufWriter, Write};
use std::time::Duration;

use andon_host::atomic;
use andon_host::config::Config;
use andon_host::exit::Code;
use andon_journal::{Entry, History, JournalError, Query};
use jiff::Timestamp;

use super::clock::Clock;
use super::known_jobs::KnownJobs;
use super::part::part_id;
use super::{ToolError, cannot_write, check_writable, job, running_config};
use crate::cli::History as Arguments;
use summary::Summary;
use table::Table;

/// The number of the job that somebody means. A number needs no file: the job may be gone.
fn job_number(wanted: &str, config: &Config) -> Result<u32, ToolError> {
    if let Ok(number) = wanted.parse() {
        return Ok(number);
    }
    let meant = job::meant(wanted, config)?;
    match meant.iter().all(|job| job.file.id == meant[0].file.id) {
        true => Ok(meant[0].file.id),
        false => Err(job::several(wanted, &meant)),
    }
}

/// Runs the command.
///
/// # Errors
/// A time that cannot be read, a job that is not known, and a journal that is not there or damaged.
pub fn run(arguments: &Arguments) -> Result<Code, ToolError> {
    let since = arguments.since.as_deref();
    let since_utc_ns = since.map(|text| since_ns(text, Timestamp::now())).transpose()?;
    let part = arguments.part.as_deref().map(|id| part_id("--part", id)).transpose()?;
    let config = running_config(&arguments.config)?.config;
    let known = KnownJobs::of(&config);
    let job_id = arguments.job.as_deref().map(|job| job_number(job, &config)).transpose()?;
    let query = Query { since_utc_ns, job_id, part, nok: arguments.nok };
    arguments.plot.as_deref().map(check_writable).transpose()?;
    let history = History::open(&config.journal_path())?;
    let clock = Clock::new(arguments.utc);
    let mut out = BufWriter::new(anstream::stdout().lock());
    if arguments.csv {
        match arguments.audit {
            true => history.write_audit_csv(since_utc_ns, &mut out)?,
            false => history.write_csv(&query, &mut out)?,
        }
    } else if arguments.audit {
        write!(out, "{}", table::audit_header(&clock)).map_err(ToolError::Print)?;
        history.visit_audit(since_utc_ns, |audit| Ok(table::write_audit(&audit, &clock, &mut out)?))?;
    } else if arguments.summary || arguments.plot.is_some() {
        let mut summary = Summary::new(&known);
        history.visit(&query, |entry| {
            summary.add(&entry);
            Ok(())
        })?;
        if arguments.summary {
            write!(out, "{}", summary.text(&clock)).map_err(ToolError::Print)?;
        }
        if let Some(plot) = &arguments.plot {
            atomic::write(plot, plot::draw(&summary, &clock).as_bytes()).map_err(cannot_write(plot))?;
            writeln!(out, "drawn: {}", plot.display()).map_err(ToolError::Print)?;
        }
    } else {
        let mut table = Table::new(&known, &clock);
        write!(out, "{}", table.header()).map_err(ToolError::Print)?;
        history.visit(&query, |entry: Entry| Ok::<(), JournalError>(table.write(&entry, &mut out)?))?;
    }
    out.flush().map_err(ToolError::Print)?;
    Ok(Code::Stopped)
}

/// A time, or a span before now, as nanoseconds since 1970 UTC.
fn since_ns(text: &str, now: Timestamp) -> Result<u64, ToolError> {
    let refused = || ToolError::Option {
        option: "--since",
        given: text.to_owned(),
        expected: "give a time as 2026-05-04T08:00:00Z, or a span as 90m, 8h, 7d",
    };
    let time = match text.parse::<Timestamp>() {
        Ok(time) => time,
        Err(_) => now - span(text).ok_or_else(refused)?,
    };
    u64::try_from(time.as_nanosecond()).map_err(|_| refused())
}

/// A whole number of seconds, minutes, hours or days; at most a century, so that no clock overflows.
fn span(text: &str) -> Option<Duration> {
    let (number, unit) = text.split_at_checked(text.len().checked_sub(1)?)?;
    let seconds = match unit {
        "s" => 1,
        "m" => 60,
        "h" => 3600,
        "d" => 86_400,
        _ => return None,
    };
    let seconds = number.parse::<u64>().ok()?.checked_mul(seconds)?;
    (seconds <= 36_525 * 86_400).then(|| Duration::from_secs(seconds))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_time_and_a_span_before_now_are_understood() {
        let now: Timestamp = "2026-05-04T08:00:00Z".parse().unwrap();
        assert_eq!(since_ns("1970-01-01T00:00:01Z", now).unwrap(), 1_000_000_000);
        assert_eq!(since_ns("2h", now).unwrap(), since_ns("2026-05-04T06:00:00Z", now).unwrap());
        assert_eq!(since_ns("7d", now).unwrap(), since_ns("2026-04-27T08:00:00Z", now).unwrap());
    }

    #[test]
    fn anything_else_is_refused_with_examples() {
        for text in ["", "h", "yesterday", "-3h", "8ä", "99999999999999999999d", "9999999d"] {
            let failure = since_ns(text, Timestamp::now()).unwrap_err();
            assert!(failure.to_string().contains("8h"), "{text}: {failure}");
        }
    }
}
