//! What a JPEG says of itself, before anything is decoded (ITU-T T.81, B.1 and B.2).

/// What every JPEG begins with.
const START: [u8; 2] = [0xff, 0xd8];

/// Columns and rows of a JPEG; `None` where it is none. Each segment follows the one before it at once: a decoder that looks for the next marker
/// elsewhere would find another size.
pub(crate) fn size(jpeg: &[u8]) -> Option<[u32; 2]> {
    let mut rest = jpeg.strip_prefix(&START)?;
    loop {
        let (marker, after) = next_marker(rest)?;
        let length = usize::from(u16::from_be_bytes(*after.first_chunk()?));
        // The length counts itself.
        let content = after.get(2..length)?;
        if is_frame(marker) {
            return size_in(content);
        }
        rest = after.get(length..)?;
    }
}

/// The next marker that has a segment, and what follows it. Any number of bytes may fill the room before it.
fn next_marker(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let filled = bytes.iter().take_while(|byte| **byte == 0xff).count();
    let (marker, after) = bytes.get(filled..)?.split_first()?;
    let has_segment = (0xc0..=0xfe).contains(marker) && !(0xd0..=0xd9).contains(marker);
    (filled > 0 && has_segment).then_some((*marker, after))
}

/// Whether a frame begins, of any kind of coding. The other three of these markers are for tables and for what comes one day.
fn is_frame(marker: u8) -> bool {
    (0xc0..=0xcf).contains(&marker) && ![0xc4, 0xc8, 0xcc].contains(&marker)
}

/// Behind the bits of a sample come rows and columns.
fn size_in(frame: &[u8]) -> Option<[u32; 2]> {
    let [rows, columns] = [frame.get(1..3)?, frame.get(3..5)?];
    let number = |bytes: &[u8]| bytes.iter().fold(0, |number, byte| number << 8 | u32::from(*byte));
    Some([number(columns), number(rows)])
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: [u8; 7] = [0xff, 0xff, 0xdb, 0, 4, 1, 2];
    const FRAME: [u8; 11] = [0xff, 0xc0, 0, 9, 8, 2, 0xd0, 5, 0, 3, 0];

    #[test]
    fn the_size_is_that_of_the_frame_after_any_other_segments() {
        let jpeg = [&START[..], &TABLE, &TABLE, &FRAME].concat();
        assert_eq!(size(&jpeg), Some([1280, 720]));
        assert_eq!(size(&[&START[..], &FRAME].concat()), Some([1280, 720]));
    }

    #[test]
    fn what_has_no_frame_where_it_must_be_is_no_jpeg() {
        let whole = [&START[..], &TABLE, &FRAME].concat();
        for length in 0..whole.len() {
            assert_eq!(size(&whole[..length]), None, "{length} bytes of it");
        }
        assert_eq!(size(&[&START[..], &[7], &FRAME].concat()), None, "something before the marker");
        assert_eq!(size(&[&START[..], &[0xff, 0xd9], &FRAME].concat()), None, "an end before it");
        assert_eq!(size(&[&START[..], &[0xff, 0xdb, 0, 1], &FRAME].concat()), None, "a length that is none");
        assert_eq!(size(b"\x89PNG\r\n"), None);
    }
}
