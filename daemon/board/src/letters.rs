//! Bytes as letters of six bits each, as RFC 4648 says for addresses (base64url): a form carries them as they are.

/// The bytes that these letters are, without what fills them up; `None` where they are none.
pub(crate) fn bytes(letters: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(letters.len() / 4 * 3 + 2);
    let (mut bits, mut count) = (0_u32, 0);
    for letter in letters.bytes() {
        let six = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'-' => 62,
            b'_' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(six);
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
            bits &= (1 << count) - 1;
        }
    }
    // A single letter is no byte, and what is left of the last one says nothing.
    (count < 6 && bits == 0).then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_the_bytes_that_they_were_and_what_is_none_is_refused() {
        // From RFC 4648, chapter 10, without what fills them up.
        for (text, letters) in [("", ""), ("f", "Zg"), ("fo", "Zm8"), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(bytes(letters).as_deref(), Some(text.as_bytes()));
        }
        assert_eq!(bytes("-_-_"), Some(vec![0xfb, 0xff, 0xbf]));
        for letters in ["Z", "Zg==", "Zm9v Zm9v", "Zm9v+", "/", "Zh", "\u{fc}"] {
            assert_eq!(bytes(letters), None, "{letters}");
        }
    }
}
