//! The checksum inside a job file, over all of its text except the checksum itself.

use sha2::{Digest, Sha256};

/// What the line of the checksum begins with; the rest of it is the digest.
pub(super) const KEY: &str = "checksum = \"sha256:";

/// SHA-256 in hexadecimal.
pub fn sha256_hex(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Puts the checksum into a text whose checksum is still empty.
pub(super) fn seal(text: &str) -> String {
    text.replacen(KEY, &format!("{KEY}{}", digest(text)), 1)
}

/// What the checksum of this text should be, and what it says it is. `None` where there is none.
pub(super) fn check(text: &str) -> Option<(String, &str)> {
    let at = line_start(text)? + KEY.len();
    let end = at + text[at..].find('"')?;
    Some((digest(&format!("{}{}", &text[..at], &text[end..])), &text[at..end]))
}

/// The first eight bytes of the digest as a number.
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

fn digest(unsealed: &str) -> String {
    hex(&Sha256::digest(unsealed.as_bytes()))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
