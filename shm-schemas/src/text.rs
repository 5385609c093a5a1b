//! Texts in messages: UTF-8 in an array of a fixed length, with zeros behind it.

/// Writes as much of a text as fits, and never half a character.
pub(crate) fn write_text(text: &str, to: &mut [u8]) {
    let end = text.char_indices().map(|(at, c)| at + c.len_utf8()).take_while(|end| *end <= to.len()).last();
    to.fill(0);
    let bytes = text.as_bytes().get(..end.unwrap_or(0)).unwrap_or_default();
    for (to, from) in to.iter_mut().zip(bytes) {
        *to = *from;
    }
}

/// The text up to its zeros; empty where it is not UTF-8.
pub(crate) fn read_text(from: &[u8]) -> &str {
    let text = from.split(|&byte| byte == 0).next().unwrap_or_default();
    core::str::from_utf8(text).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_that_is_too_long_ends_at_a_whole_character() {
        let mut bytes = [7; 4];
        write_text("aüß", &mut bytes);
        assert_eq!(read_text(&bytes), "aü");
        write_text("", &mut bytes);
        assert_eq!(read_text(&bytes), "");
    }
}
