//! MP4 and QuickTime: boxes with a length and a name of four letters, as ISO/IEC 14496-12 has them.

use std::io::{self, Read, Seek, SeekFrom};

use super::{Container, Turn};

/// The index of a day of film has a few megabytes.
const MAX_INDEX: u64 = 256 << 20;

/// Reads the boxes of a file of this length.
///
/// # Errors
/// What the system says.
pub(super) fn read(file: &mut (impl Read + Seek), length: u64) -> io::Result<Container> {
    let mut container = Container::default();
    let mut at = 0;
    while at + 8 <= length {
        file.seek(SeekFrom::Start(at))?;
        let mut head = [0; 16];
        let read = if at + 16 <= length { 16 } else { 8 };
        file.read_exact(&mut head[..read])?;
        let (size, begin) = match number(&head, 0, 4) {
            Some(0) => (length - at, 8),
            Some(1) => (number(&head, 8, 8).unwrap_or(0), 16),
            size => (size.unwrap_or(0), 8),
        };
        if size < begin {
            break;
        }
        if at + size > length {
            container.is_cut = true;
            break;
        }
        if &head[4..8] == b"moov" && size <= MAX_INDEX {
            let mut index = vec![0; (size - begin) as usize];
            file.seek(SeekFrom::Start(at + begin))?;
            file.read_exact(&mut index)?;
            (container.pictures, container.turn) = film_of(&index).unwrap_or((None, None));
        }
        at += size;
    }
    // What is left is less than the head of a box.
    container.is_cut |= at < length && length - at < 8;
    Ok(container)
}

/// A number of so many bytes, the most significant first.
fn number(bytes: &[u8], at: usize, length: usize) -> Option<u64> {
    let bytes = bytes.get(at..at.checked_add(length)?)?;
    Some(bytes.iter().fold(0, |number, byte| number << 8 | u64::from(*byte)))
}

/// The boxes in a box.
fn boxes(bytes: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        let name = rest.get(4..8)?.try_into().ok()?;
        let (size, begin) = match number(rest, 0, 4)? {
            0 => (rest.len(), 8),
            1 => (usize::try_from(number(rest, 8, 8)?).ok()?, 16),
            size => (size as usize, 8),
        };
        let inside = rest.get(begin..size)?;
        rest = &rest[size..];
        Some((name, inside))
    })
}

fn find<'a>(bytes: &'a [u8], path: &[&[u8; 4]]) -> Option<&'a [u8]> {
    path.iter().try_fold(bytes, |bytes, name| {
        boxes(bytes).find(|(found, _)| found == *name).map(|(_, inside)| inside)
    })
}

/// How many pictures the first film in an index shows, and how they are turned.
fn film_of(index: &[u8]) -> Option<(Option<u64>, Option<Turn>)> {
    let is_film =
        |track: &&[u8]| find(track, &[b"mdia", b"hdlr"]).and_then(|hdlr| hdlr.get(8..12)) == Some(b"vide");
    let track = boxes(index).filter(|(name, _)| name == b"trak").map(|(_, track)| track).find(is_film)?;
    // The pictures of a fragmented film are listed elsewhere.
    let is_fragmented = find(index, &[b"mvex"]).is_some();
    let head = find(index, &[b"mvhd"])?;
    let shown = if is_fragmented { None } else { pictures(track, timescale(head, 12)?) };
    let of_all = turn(head, 36).unwrap_or_default();
    let own = turn(find(track, &[b"tkhd"])?, 40);
    let turn = own.map(|own| Turn { quarters: (own.quarters + of_all.quarters) % 4, ..own });
    Some((shown, turn))
}

/// The time scale in a head, which is so far into it in version 0; times have twice the bytes in version 1.
fn timescale(head: &[u8], at: usize) -> Option<u64> {
    number(head, if head.first() == Some(&1) { at + 8 } else { at }, 4).filter(|scale| *scale > 0)
}

/// How pictures are turned by the matrix in a head, which is so far into it in version 0. A picture is not turned by other angles than quarters.
fn turn(head: &[u8], at: usize) -> Option<Turn> {
    let at = if head.first() == Some(&1) { at + 12 } else { at };
    let fixed = |index: usize| Some(f64::from(number(head, at + 4 * index, 4)? as u32 as i32));
    let (mut a, mut b, c, d) = (fixed(0)?, fixed(1)?, fixed(3)?, fixed(4)?);
    let is_mirrored = a * d - b * c < 0.0;
    if is_mirrored {
        (a, b) = (-a, -b);
    }
    let quarters = (b.atan2(a) / std::f64::consts::FRAC_PI_2).round().rem_euclid(4.0);
    Some(Turn { is_mirrored, quarters: quarters as u8 })
}

/// How many pictures of a track are shown: an edit list leaves some out.
fn pictures(track: &[u8], movie_scale: u64) -> Option<u64> {
    let scale = timescale(find(track, &[b"mdia", b"mdhd"])?, 12)?;
    let samples = find(track, &[b"mdia", b"minf", b"stbl"])?;
    let times = shown_at(samples)?;
    let Some(list) = find(track, &[b"edts", b"elst"]) else { return Some(times.len() as u64) };
    let mut shown = 0;
    let edits = edits(list)?;
    for (duration, from) in edits.iter().filter(|(_, from)| *from >= 0) {
        let length = u128::from(*duration) * u128::from(scale) / u128::from(movie_scale);
        // An edit of no length lasts to the end.
        let until = if length == 0 { i128::MAX } else { i128::from(*from) + length as i128 };
        shown += times.iter().filter(|time| (i128::from(*from)..until).contains(&i128::from(**time))).count()
            as u64;
    }
    // An edit list that shows nothing is ignored: some programs write an empty one.
    Some(if shown == 0 { times.len() as u64 } else { shown })
}

/// The length of each edit in the film's time, and where it begins in the track's; -1 for a pause.
fn edits(list: &[u8]) -> Option<Vec<(u64, i64)>> {
    let long = list.first() == Some(&1);
    let count = number(list, 4, 4)? as usize;
    let edit = |index: usize| {
        if long {
            let at = 8 + 20 * index;
            Some((number(list, at, 8)?, number(list, at + 8, 8)? as i64))
        } else {
            let at = 8 + 12 * index;
            Some((number(list, at, 4)?, i64::from(number(list, at + 4, 4)? as u32 as i32)))
        }
    };
    (0..count).map(edit).collect()
}

/// When each picture of a track is due, in the track's time.
fn shown_at(samples: &[u8]) -> Option<Vec<i64>> {
    /// No film has this many pictures.
    const MAX_PICTURES: u64 = 1 << 24;
    let mut times = Vec::new();
    let mut now: i64 = 0;
    for (count, duration) in runs(find(samples, &[b"stts"])?)? {
        if times.len() as u64 + count > MAX_PICTURES {
            return None;
        }
        for _ in 0..count {
            times.push(now);
            now = now.checked_add(duration)?;
        }
    }
    if let Some(offsets) = find(samples, &[b"ctts"]) {
        let offsets = runs(offsets)?.into_iter().flat_map(|(count, offset)| (0..count).map(move |_| offset));
        times.iter_mut().zip(offsets).for_each(|(time, offset)| *time += offset);
    }
    Some(times)
}

/// A table of counts and the value that so many pictures have.
fn runs(table: &[u8]) -> Option<Vec<(u64, i64)>> {
    let run = |index: usize| {
        let at = 8 + 8 * index;
        Some((number(table, at, 4)?, i64::from(number(table, at + 4, 4)? as u32 as i32)))
    };
    (0..number(table, 4, 4)? as usize).map(run).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn head(matrix: [i32; 9]) -> Vec<u8> {
        let mut head = vec![0; 40];
        head.extend(matrix.iter().flat_map(|number| number.to_be_bytes()));
        head
    }

    #[test]
    fn a_matrix_says_by_how_many_quarters_a_picture_is_turned_and_whether_it_is_mirrored() {
        const ONE: i32 = 1 << 16;
        let turned =
            |a: i32, b: i32, c: i32, d: i32| turn(&head([a, b, 0, c, d, 0, 0, 0, 1 << 30]), 40).unwrap();
        let straight = |quarters| Turn { is_mirrored: false, quarters };
        assert_eq!(turned(ONE, 0, 0, ONE), straight(0));
        assert_eq!(turned(0, ONE, -ONE, 0), straight(1));
        assert_eq!(turned(-ONE, 0, 0, -ONE), straight(2));
        assert_eq!(turned(0, -ONE, ONE, 0), straight(3));
        assert_eq!(turned(-ONE, 0, 0, ONE), Turn { is_mirrored: true, quarters: 0 });
    }

    #[test]
    fn what_is_no_index_says_nothing() {
        for bytes in [&b""[..], b"\0\0\0\0", b"\xff\xff\xff\xfftrak", b"\0\0\0\x08trak\0\0\0\x01trak\xff"] {
            assert_eq!(film_of(bytes), None);
        }
    }

    #[test]
    fn a_file_that_ends_in_a_box_is_cut() {
        let whole = [&b"\0\0\0\x10ftypisom\0\0\0\0"[..], b"\0\0\0\x0cmdat\0\0\0\0"].concat();
        for length in 1..=whole.len() {
            let container = read(&mut std::io::Cursor::new(&whole[..length]), length as u64).unwrap();
            assert_eq!(container.is_cut, ![16, whole.len()].contains(&length), "{length} bytes");
        }
    }
}
