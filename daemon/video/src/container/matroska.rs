//! Matroska and WebM: elements with a name and a length of up to eight bytes each, as RFC 9559 has them.

use std::io::{self, BufRead, Seek, SeekFrom};

use super::Container;

/// Elements that hold others. Whether their length is known or not, what they hold comes next.
const HOLDERS: [u32; 5] = [SEGMENT, CLUSTER, 0xa0, 0x1654_ae6b, TRACK];
const SEGMENT: u32 = 0x1853_8067;
const CLUSTER: u32 = 0x1f43_b675;
const TRACK: u32 = 0xae;
const TRACK_NUMBER: u32 = 0xd7;
const TRACK_TYPE: u32 = 0x83;
/// Pictures or sound, alone or in a group.
const BLOCKS: [u32; 2] = [0xa3, 0xa1];
/// The type of a track with pictures.
const VIDEO: u64 = 1;

/// Reads the elements of a file of this length.
///
/// # Errors
/// What the system says.
pub(super) fn read(file: &mut (impl BufRead + Seek), length: u64) -> io::Result<Container> {
    let (mut at, mut is_cut) = (0, false);
    // The number of the track that is being described, and that of the first one with pictures.
    let (mut track, mut film) = (None, None);
    let mut pictures = 0;
    while at < length {
        let Some((name, size, begin)) = element(file, at)? else {
            is_cut = true;
            break;
        };
        let end = size.map(|size| begin.saturating_add(size));
        if end.is_some_and(|end| end > length) {
            is_cut = true;
        }
        match name {
            TRACK => track = None,
            TRACK_NUMBER => track = size.map(|size| unsigned(file, size)).transpose()?,
            TRACK_TYPE if film.is_none() => {
                let kind = size.map(|size| unsigned(file, size)).transpose()?;
                film = track.filter(|_| kind == Some(VIDEO));
            }
            name if BLOCKS.contains(&name) => {
                let of = number(file, true)?.map(|(track, _)| track);
                // A block that is not whole is no picture.
                pictures += u64::from(film.is_some() && of == film && end.is_some_and(|end| end <= length));
            }
            _ => {}
        }
        at = match end {
            Some(end) if !HOLDERS.contains(&name) => end,
            // Nothing else has an unknown length.
            None if !HOLDERS.contains(&name) => break,
            _ => begin,
        };
    }
    Ok(Container { pictures: film.map(|_| pictures), turn: None, is_cut })
}

/// Name, length and start of the element at this place; `None` where the file ends in it. A length that is not known is `None` too.
fn element(file: &mut (impl BufRead + Seek), at: u64) -> io::Result<Option<(u32, Option<u64>, u64)>> {
    seek(file, at)?;
    let Some((name, name_bytes)) = number(file, false)? else { return Ok(None) };
    let Some((size, size_bytes)) = number(file, true)? else { return Ok(None) };
    let unknown = (1 << (7 * size_bytes)) - 1;
    let size = Some(size).filter(|size| *size != unknown);
    Ok(Some((name as u32, size, at + name_bytes + size_bytes)))
}

/// Goes to a place, which is near and ahead most of the time.
fn seek(file: &mut (impl BufRead + Seek), at: u64) -> io::Result<()> {
    let now = file.stream_position()?;
    match i64::try_from(i128::from(at) - i128::from(now)) {
        Ok(by) => file.seek_relative(by),
        Err(_) => file.seek(SeekFrom::Start(at)).map(drop),
    }
}

/// A number whose first byte says how many bytes it has, and that count; with or without the bit that says so. `None` at the end of the file.
fn number(file: &mut impl BufRead, without_mark: bool) -> io::Result<Option<(u64, u64)>> {
    let mut bytes = [0; 8];
    if !fill(file, &mut bytes[..1])? {
        return Ok(None);
    }
    let count = bytes[0].leading_zeros() as usize + 1;
    if count > 8 || !fill(file, &mut bytes[1..count])? {
        return Ok(None);
    }
    let all = bytes[..count].iter().fold(0, |number, byte| number << 8 | u64::from(*byte));
    let mark = if without_mark { 1 << (7 * count) } else { 0 };
    Ok(Some((all & !mark, count as u64)))
}

/// The value of an element.
fn unsigned(file: &mut impl BufRead, size: u64) -> io::Result<u64> {
    let mut bytes = [0; 8];
    let length = (size as usize).min(8);
    fill(file, &mut bytes[..length])?;
    Ok(bytes[..length].iter().fold(0, |number, byte| number << 8 | u64::from(*byte)))
}

/// Whether so much could be read.
fn fill(file: &mut impl BufRead, bytes: &mut [u8]) -> io::Result<bool> {
    match file.read_exact(bytes) {
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
        other => other.map(|()| true),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::io::Cursor;

    fn element(name: &[u8], inside: &[u8]) -> Vec<u8> {
        [name, &[0x80 | inside.len() as u8], inside].concat()
    }

    /// A film of two pictures and four bits of sound.
    fn film() -> Vec<u8> {
        let track = |number: u8, kind: u8| {
            element(&[0xae], &[element(&[0xd7], &[number]), element(&[0x83], &[kind])].concat())
        };
        let block = |track: u8| element(&[0xa3], &[0x80 | track, 0, 0, 0, 7]);
        let tracks = element(&[0x16, 0x54, 0xae, 0x6b], &[track(1, 2), track(2, 1)].concat());
        let cluster = element(&[0x1f, 0x43, 0xb6, 0x75], &[block(1), block(2), block(1)].concat());
        let group = element(&[0xa0], &element(&[0xa1], &[0x82, 0, 0, 0, 7]));
        let other = element(&[0x1f, 0x43, 0xb6, 0x75], &[group, block(1), block(1)].concat());
        [
            element(&[0x1a, 0x45, 0xdf, 0xa3], b"?"),
            element(&[0x18, 0x53, 0x80, 0x67], &[tracks, cluster, other].concat()),
        ]
        .concat()
    }

    #[test]
    fn the_pictures_are_counted_and_the_sound_is_not() {
        let film = film();
        let container = read(&mut Cursor::new(&film), film.len() as u64).unwrap();
        assert_eq!(container, Container { pictures: Some(2), turn: None, is_cut: false });
    }

    #[test]
    fn a_film_that_was_written_without_its_length_is_read_as_well() {
        let mut film = film();
        // The length of the segment, behind a head of six bytes and its name.
        film[10] = 0xff;
        let container = read(&mut Cursor::new(&film), film.len() as u64).unwrap();
        assert_eq!(container, Container { pictures: Some(2), turn: None, is_cut: false });
    }

    #[test]
    fn a_film_that_ends_too_early_is_cut() {
        let film = film();
        for length in 7..film.len() {
            let container = read(&mut Cursor::new(&film[..length]), length as u64).unwrap();
            assert!(container.is_cut, "{length} of {} bytes", film.len());
        }
    }
}
