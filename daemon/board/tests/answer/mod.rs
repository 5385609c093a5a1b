//! What stands in an answer.

#![allow(clippy::unwrap_used)]

/// The status of an answer; 0 where there is none.
pub(crate) fn status(answer: &str) -> u16 {
    answer.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or_default()
}

/// The value of a header; empty where there is none.
pub(crate) fn header<'a>(answer: &'a str, name: &str) -> &'a str {
    let mut lines = answer.lines().take_while(|line| !line.is_empty());
    lines.find_map(|line| line.strip_prefix(name)?.strip_prefix(": ")).unwrap_or_default()
}

/// The cookie that an answer sets, as the browser sends it back.
pub(crate) fn cookie(answer: &str) -> String {
    header(answer, "set-cookie").split(';').next().unwrap().to_owned()
}
