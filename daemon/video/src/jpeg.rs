//! The markers of a JPEG (ITU-T T.81, B.1).

use std::ops::RangeInclusive;

/// What every JPEG begins with.
pub(crate) const START: [u8; 2] = [0xff, 0xd8];
/// The end of the picture.
pub(crate) const END: u8 = 0xd9;
/// The head of a scan, behind which its data follow.
pub(crate) const SCAN: u8 = 0xda;
/// Huffman tables (DHT).
pub(crate) const TABLES: u8 = 0xc4;
/// Where a decoder may go on within a scan.
pub(crate) const RESTARTS: RangeInclusive<u8> = 0xd0..=0xd7;

/// Whether a marker has no segment behind it.
pub(crate) fn is_alone(kind: u8) -> bool {
    kind == 0x01 || kind == END || RESTARTS.contains(&kind)
}

/// The marker that these bytes begin with, behind any padding, and what follows its segment. `None` where none is there, or its segment is cut.
pub(crate) fn next_marker(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let padding = bytes.iter().take_while(|byte| **byte == 0xff).count();
    let (kind, rest) = bytes.get(padding..)?.split_first()?;
    let length = match rest {
        _ if padding == 0 => return None,
        _ if is_alone(*kind) => 0,
        [high, low, ..] => usize::from(u16::from_be_bytes([*high, *low])),
        _ => return None,
    };
    Some((*kind, rest.get(length..)?))
}
