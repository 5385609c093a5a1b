//! Times that people name: one, or a span before now.

use std::time::Duration;

use jiff::Timestamp;

use super::ToolError;

/// A time, or a span before now, as nanoseconds since 1970 UTC.
pub(super) fn since_ns(option: &'static str, text: &str, now: Timestamp) -> Result<u64, ToolError> {
    let refused = || ToolError::Option {
        option,
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
        assert_eq!(since_ns("--since", "1970-01-01T00:00:01Z", now).unwrap(), 1_000_000_000);
        assert_eq!(
            since_ns("--since", "2h", now).unwrap(),
            since_ns("--since", "2026-05-04T06:00:00Z", now).unwrap()
        );
        assert_eq!(
            since_ns("--since", "7d", now).unwrap(),
            since_ns("--since", "2026-04-27T08:00:00Z", now).unwrap()
        );
    }

    #[test]
    fn anything_else_is_refused_with_examples() {
        for text in ["", "h", "yesterday", "-3h", "8ä", "99999999999999999999d", "9999999d"] {
            let failure = since_ns("--since", text, Timestamp::now()).unwrap_err();
            assert!(failure.to_string().contains("8h"), "{text}: {failure}");
        }
    }
}
