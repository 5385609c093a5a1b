//! The checksum of a job file: the SHA-256 digest of its text without the digest itself and without the names of the steps.

use super::names;
use crate::digest::sha256_hex;

/// The beginning of the line with the checksum; the digest follows.
pub(super) const KEY: &str = "checksum = \"sha256:";

/// Puts the digest into a text that has everything but the digest.
pub(super) fn seal(text: &str) -> String {
    text.replacen(KEY, &format!("{KEY}{}", sha256_hex(text.as_bytes())), 1)
}

/// The digest that this text should have, and the digest that it has. `None` if it has none.
pub(super) fn check(text: &str) -> Option<(String, &str)> {
    let text = names::before(text);
    let at = line_start(text)? + KEY.len();
    let end = at + text[at..].find('"')?;
    Some((sha256_hex([&text[..at], &text[end..]].concat().as_bytes()), &text[at..end]))
}

/// The first eight bytes of the digest as a number; 0 if the text has no digest.
pub(super) fn model_hash(text: &str) -> u64 {
    let stated = check(text).map_or("", |(_, stated)| stated);
    stated.get(..16).and_then(|head| u64::from_str_radix(head, 16).ok()).unwrap_or_default()
}

fn line_start(text: &str) -> Option<usize> {
    if text.starts_with(KEY) {
        return Some(0);
    }
    text.find(&format!("\n{KEY}")).map(|at| at + 1)
}
