//! Files that people and other programs made. Opening one never waits, as it would for a pipe. Text is read whichever editor has saved it.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, ErrorKind, Read as _};
use std::path::Path;

/// The mark that some editors put before a text in UTF-8.
pub(crate) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// So many bytes show what a file is.
const HEAD: usize = 4096;

/// Opens a file to read it. A pipe is refused, because its writer would be waited for, and so is a device, which has no end.
///
/// # Errors
/// That it is no file, and what the system says.
pub fn open(path: &Path) -> io::Result<File> {
    let there = path.metadata()?;
    if there.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    if !there.is_file() {
        return Err(io::Error::other("it is a pipe or a device, and a file is needed: save it as one first"));
    }
    File::open(path)
}

/// Reads a whole file.
///
/// # Errors
/// As [`open`].
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a file, or the beginning of one that has more bytes.
///
/// # Errors
/// As [`open`].
pub fn read_up_to(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a whole file as text.
///
/// # Errors
/// As [`open`], and that it is no text.
pub fn read_text(path: &Path) -> io::Result<String> {
    let bytes = read(path)?;
    let text = text(&bytes).map_err(|error| io::Error::new(ErrorKind::InvalidData, error))?;
    Ok(text.into_owned())
}

/// Why a file is no text that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotText {
    /// There are two bytes for each character.
    #[error("it is saved as UTF-16; save it as UTF-8, as an editor offers it under \"Save as\"")]
    Utf16,
    /// It is a picture, a film or a program.
    #[error("it is no text")]
    Binary,
    /// Something in this line is in another encoding.
    #[error(
        "line {0} is not UTF-8, as where an editor has saved umlauts in an older encoding; save it as UTF-8, or restore it from a backup"
    )]
    Encoding(usize),
}

/// The text of a file as every program means it, whichever editor has saved it. It has no byte order mark, and `\n` ends each line.
///
/// # Errors
/// [`NotText`].
pub fn text(bytes: &[u8]) -> Result<Cow<'_, str>, NotText> {
    if is_utf16(bytes) {
        return Err(NotText::Utf16);
    }
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    if bytes.iter().take(HEAD).any(|byte| *byte == 0) {
        return Err(NotText::Binary);
    }
    let text = str::from_utf8(bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        NotText::Encoding(1 + before.iter().filter(|byte| **byte == b'\n').count())
    })?;
    let unified = || text.replace("\r\n", "\n").replace('\r', "\n");
    Ok(if text.contains('\r') { Cow::Owned(unified()) } else { Cow::Borrowed(text) })
}

/// Whether a text has two bytes for each character: by its mark, or because every other one of its first bytes is zero.
pub(crate) fn is_utf16(bytes: &[u8]) -> bool {
    const MIN_BYTES: usize = 16;
    let zeros = |parity: usize| bytes.iter().skip(parity).step_by(2).take(MIN_BYTES).all(|byte| *byte == 0);
    let none = |parity: usize| bytes.iter().skip(parity).step_by(2).take(MIN_BYTES).all(|byte| *byte != 0);
    let has_mark = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    has_mark || bytes.len() >= MIN_BYTES && (zeros(0) && none(1) || zeros(1) && none(0))
}

/// What is to be done about the line of a text at this byte, where a word processor has put other than plain characters. They look alike, and no
/// parser knows them.
pub fn typographic(text: &str, at: usize) -> Option<String> {
    const FOR: [(&[char], &str); 5] = [
        (&['\u{201c}', '\u{201d}', '\u{201e}', '\u{201f}', '\u{ab}', '\u{bb}'], "a straight \""),
        (&['\u{2018}', '\u{2019}', '\u{201a}', '\u{201b}'], "a straight '"),
        (&['\u{2010}', '\u{2011}', '\u{2012}', '\u{2013}', '\u{2014}', '\u{2212}'], "a plain -"),
        (&['\u{a0}', '\u{2007}', '\u{2009}', '\u{202f}'], "a plain blank"),
        (&['\u{200b}', '\u{200c}', '\u{200d}', '\u{2060}', '\u{feff}'], "nothing"),
    ];
    let before = text.get(..at)?;
    let begin = before.rfind('\n').map_or(0, |end| end + 1);
    let line = text[begin..].lines().next()?;
    let meant = |character: char| FOR.iter().find(|(others, _)| others.contains(&character));
    let (character, (_, plain)) = line.chars().find_map(|character| Some((character, meant(character)?)))?;
    Some(format!(
        "there is U+{:04X} in this line, where {plain} is meant: a word processor does so, an editor for plain text does not",
        character as u32
    ))
}

/// What a file is that no decoder may take for a film: FFmpeg makes pictures of any text, and opens what a playlist names.
///
/// # Errors
/// That it cannot be read.
pub fn other_than_film(mut file: impl io::Read) -> io::Result<Option<&'static str>> {
    let mut head = Vec::new();
    file.by_ref().take(HEAD as u64).read_to_end(&mut head)?;
    let is_text = str::from_utf8(&head).map_or_else(
        // A character may be cut off at the end of what was read.
        |error| error.error_len().is_none() && !head.contains(&0),
        |text| !text.chars().any(|c| c.is_control() && !c.is_whitespace()),
    );
    Ok(match &head[..] {
        [0x1f, 0x8b, ..] => Some("it is compressed; unpack it with gunzip"),
        _ if is_text || is_utf16(&head) => {
            Some("it is text and no film; a track file is read where its name ends in .tracks.jsonl")
        }
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_text_is_the_same_whichever_editor_has_saved_it() {
        for saved in ["a = 1\nb = 2\n", "a = 1\r\nb = 2\r\n", "a = 1\rb = 2\r", "\u{feff}a = 1\r\nb = 2\n"] {
            assert_eq!(text(saved.as_bytes()).unwrap(), "a = 1\nb = 2\n");
        }
    }

    #[test]
    fn what_is_no_text_is_told_by_what_it_is() {
        let utf16 = |mark: bool| {
            let text = if mark { "\u{feff}format = 'andon.job'" } else { "format = 'andon.job'" };
            text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>()
        };
        assert_eq!(text(&utf16(true)), Err(NotText::Utf16));
        assert_eq!(text(&utf16(false)), Err(NotText::Utf16));
        assert_eq!(text(b"\0\0\0\x20ftypisom\0\0\x02\0isomiso2avc1mp41"), Err(NotText::Binary));
        assert_eq!(text(b"name = 'a'\nname = 'Pr\xfcfer'"), Err(NotText::Encoding(2)));
        assert_eq!(text(b"").unwrap(), "");
    }

    #[test]
    fn a_character_that_only_looks_like_a_plain_one_is_named_with_the_plain_one() {
        let text = "a = \"\u{201c}fine\u{201d}\"\nb = \u{201c}x\u{201d}\nc = \u{2013}1\nd\u{a0}= 2\n\u{200b}[e]\nf = 3\n";
        let said = |what: &str| typographic(text, text.find(what).unwrap()).unwrap_or_default();
        for (line, words) in [
            ("b =", "U+201C in this line, where a straight \" is meant"),
            ("c =", "U+2013 in this line, where a plain -"),
            ("= 2", "U+00A0 in this line, where a plain blank"),
            ("[e]", "U+200B in this line, where nothing"),
        ] {
            assert!(said(line).contains(words), "{line}: {}", said(line));
        }
        assert_eq!(said("f ="), "");
        assert_eq!(typographic(text, text.len() + 1), None);
    }

    #[test]
    fn text_and_what_is_compressed_are_no_films_and_a_film_is_one() {
        let other = |bytes: &[u8]| other_than_film(bytes).unwrap().unwrap_or_default();
        let long = "\u{e4}".repeat(3000);
        for text in ["{\"t\": 0.0}\r\n", "#EXTM3U\nfilm.mp4\n", "<html>404</html>", &long, &long[..4098]] {
            assert!(other(text.as_bytes()).starts_with("it is text and no film"), "{text:.20}");
        }
        assert!(other(b"{\0}\0\n\0{\0}\0\n\0{\0}\0\n\0{\0}\0\n\0{\0}\0\n\0").contains("it is text"));
        assert!(other(b"\x1f\x8b\x08\0").contains("gunzip"));
        for film in [
            &b"\0\0\0\x20ftypisom"[..],
            b"RIFF\x10\xff\x01\0AVI LIST",
            b"\x1aE\xdf\xa3\x93",
            b"GIF89a\x80\x02",
        ] {
            assert_eq!(other(film), "");
        }
    }

    #[test]
    fn a_pipe_and_a_device_are_refused_and_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for path in [pipe.as_path(), Path::new("/dev/zero"), Path::new("/dev/null")] {
            assert!(open(path).unwrap_err().to_string().contains("save it as one first"), "{path:?}");
        }
        assert_eq!(open(folder.path()).unwrap_err().kind(), ErrorKind::IsADirectory);
    }
}
