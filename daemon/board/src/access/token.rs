//! What nobody can guess, as a browser keeps it in a cookie.

use std::fmt::Write as _;

use sha2::{Digest as _, Sha256};
use subtle::ConstantTimeEq as _;

/// 256 bits.
const BYTES: usize = 32;

/// A token. The board keeps its hash alone, so that whoever reads the memory or the file of logins has no token.
#[derive(Clone)]
pub(crate) struct Token(String);

/// It must not get into a log.
impl std::fmt::Debug for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Token")
    }
}

/// The hash of a token.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TokenHash([u8; BYTES]);

impl Token {
    /// A new one; `None` where the system gives no random bytes.
    pub(crate) fn new() -> Option<Self> {
        let mut bytes = [0; BYTES];
        getrandom::fill(&mut bytes).ok()?;
        Some(Self(hex(&bytes)))
    }

    /// A token that somebody sends.
    pub(crate) fn read(text: &str) -> Option<Self> {
        let is_one = text.len() == 2 * BYTES && text.bytes().all(|byte| byte.is_ascii_hexdigit());
        is_one.then(|| Self(text.to_owned()))
    }

    pub(crate) fn text(&self) -> &str {
        &self.0
    }

    pub(crate) fn hash(&self) -> TokenHash {
        TokenHash(Sha256::digest(self.0.as_bytes()).into())
    }

    /// Whether this is what somebody sends, which takes as long whether it is or not.
    pub(crate) fn is(&self, text: &str) -> bool {
        self.0.as_bytes().ct_eq(text.as_bytes()).into()
    }
}

impl TokenHash {
    /// Whether they are the same, which takes as long whether they are or not.
    pub(crate) fn equals(&self, token: &Self) -> bool {
        self.0.ct_eq(&token.0).into()
    }

    pub(crate) fn text(&self) -> String {
        hex(&self.0)
    }

    /// A hash as [`TokenHash::text`] writes it.
    pub(crate) fn read(text: &str) -> Option<Self> {
        let digits = text.as_bytes();
        let mut bytes = [0; BYTES];
        if digits.len() != 2 * BYTES || !digits.iter().all(u8::is_ascii_hexdigit) {
            return None;
        }
        for (byte, pair) in bytes.iter_mut().zip(text.as_bytes().chunks(2)) {
            *byte = u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok()?;
        }
        Some(Self(bytes))
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a `String` cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_token_is_another_each_time_and_is_known_by_its_hash_alone() {
        let [one, other] = [Token::new().unwrap(), Token::new().unwrap()];
        assert_ne!(one.text(), other.text());
        let kept = TokenHash::read(&one.hash().text()).unwrap();
        assert!(kept.equals(&Token::read(one.text()).unwrap().hash()) && !kept.equals(&other.hash()));
        assert!(!kept.text().contains(one.text()) && !format!("{one:?}").contains(one.text()));
        assert!(one.is(one.text()) && !one.is(other.text()) && !one.is(""));
    }

    #[test]
    fn what_is_no_token_is_not_compared_with_any() {
        for text in ["", "abc", &"g".repeat(64), &"a".repeat(63), &"a".repeat(65), &"\u{e9}".repeat(32)] {
            assert!(Token::read(text).is_none() && TokenHash::read(text).is_none(), "{text}");
        }
    }
}
