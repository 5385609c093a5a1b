//! `andond history`: queries the journal, also while it is written.

use std::io::{BufWriter, ErrorKind, stdout};
use std::time::Duration;

use andon_journal::{Format, History, JournalError, Query};
use jiff::Timestamp;

use super::part::part_id;
use super::{ToolError, running_config};
use crate::cli::History as Arguments;
use crate::exit::Code;

/// Runs the command.
///
/// # Errors
/// A time that cannot be read, and a journal that is not there or damaged.
pub fn run(arguments: &Arguments) -> Result<Code, ToolError> {
    let since = arguments.since.as_deref();
    let since_utc_ns = since.map(|text| since_ns(text, Timestamp::now())).transpose()?;
    let part = arguments.part.as_deref().map(|id| part_id("--part", id)).transpose()?;
    let query = Query { since_utc_ns, job_id: arguments.job, part, nok: arguments.nok };
    let path = running_config(&arguments.config)?.config.journal_path();
    let history = History::open(&path)?;
    let mut out = BufWriter::new(stdout().lock());
    let format = if arguments.csv { Format::Csv } else { Format::Table };
    let written = if arguments.audit {
        history.write_deeds(since_utc_ns, format, &mut out)
    } else {
        history.write(&query, format, &mut out)
    };
    match written {
        // The reader has seen enough, as `head` does.
        Err(JournalError::Export(error)) if error.kind() == ErrorKind::BrokenPipe => Ok(Code::Stopped),
        outcome => Ok(outcome.map(|()| Code::Stopped)?),
    }
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
