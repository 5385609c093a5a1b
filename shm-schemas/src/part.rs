//! The id of a part, which goes with its verdicts.

use core::fmt;

use crate::layout::Layout;

/// Longest part id, in bytes.
pub const PART_BYTES: usize = 32;

/// A part or serial id: printable ASCII, padded with zeros. Empty says that none was given.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
#[repr(transparent)]
pub struct PartId([u8; PART_BYTES]);

// SAFETY: plain bytes, every pattern of which is valid: `text` shows nothing of one that is not text.
unsafe impl Layout for PartId {
    const HASH: u64 = <[u8; PART_BYTES]>::HASH;
}

/// Why bytes are no part id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BadPart {
    /// There are more than [`PART_BYTES`].
    TooLong,
    /// One of them is not printable ASCII.
    NotPrintable(u8),
}

impl fmt::Display for BadPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong => write!(f, "a part id has at most {PART_BYTES} bytes"),
            Self::NotPrintable(byte) => {
                write!(f, "a part id is printable ASCII, and this has the byte {byte:#04x}")
            }
        }
    }
}

impl core::error::Error for BadPart {}

impl PartId {
    /// No part id.
    pub const NONE: Self = Self([0; PART_BYTES]);

    /// Reads an id. It ends before the first zero; what follows that is ignored, because a controller may leave old characters there.
    /// Blanks and line ends at both ends are padding, as scanners add them: where there is nothing else, there is no id.
    ///
    /// # Errors
    /// [`BadPart`]
    pub fn new(bytes: &[u8]) -> Result<Self, BadPart> {
        let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
        let text = bytes[..end].trim_ascii();
        if let Some(&byte) = text.iter().find(|byte| !matches!(byte, b' '..=b'~')) {
            return Err(BadPart::NotPrintable(byte));
        }
        let mut id = [0; PART_BYTES];
        id.get_mut(..text.len()).ok_or(BadPart::TooLong)?.copy_from_slice(text);
        Ok(Self(id))
    }

    /// Whether none was given.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// The bytes, padded with zeros.
    pub const fn bytes(&self) -> &[u8; PART_BYTES] {
        &self.0
    }

    /// The text; empty where none was given.
    pub fn text(&self) -> &str {
        let end = self.0.iter().position(|&byte| byte == 0).unwrap_or(PART_BYTES);
        core::str::from_utf8(&self.0[..end]).unwrap_or_default()
    }
}

impl fmt::Debug for PartId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_ends_at_the_first_zero_and_blanks_and_line_ends_around_it_are_padding() {
        for bytes in [&b"A-17"[..], b"A-17\0\0", b"A-17\0old", b"  A-17  ", b"A-17\r\n"] {
            assert_eq!(PartId::new(bytes).map(|id| *id.bytes()), PartId::new(b"A-17").map(|id| *id.bytes()));
            assert_eq!(PartId::new(bytes).as_ref().map(PartId::text), Ok("A-17"));
        }
        let full = [b'x'; PART_BYTES];
        assert_eq!(PartId::new(&full).as_ref().map(|id| id.text().len()), Ok(PART_BYTES));
    }

    #[test]
    fn blanks_line_ends_and_zeros_are_no_id() {
        for bytes in [&b""[..], b"\0\0", b"   ", b"\r\n", b"\0old"] {
            assert_eq!(PartId::new(bytes), Ok(PartId::NONE));
        }
    }

    #[test]
    fn what_is_no_printable_ascii_or_too_long_is_refused() {
        assert_eq!(PartId::new(b"A\x07B"), Err(BadPart::NotPrintable(7)));
        assert_eq!(PartId::new("Ä1".as_bytes()), Err(BadPart::NotPrintable(0xC3)));
        assert_eq!(PartId::new(&[b'x'; PART_BYTES + 1]), Err(BadPart::TooLong));
    }
}
