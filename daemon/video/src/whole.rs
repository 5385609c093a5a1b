//! Whether the file of a picture is whole: a decoder shows grey in place of what is missing, and says nothing.

use crate::jpeg;

/// Whether a picture ends before it says that it is at its end. Any other format is left to its decoder.
pub(crate) fn is_cut(bytes: &[u8]) -> bool {
    match bytes {
        [0xff, 0xd8, rest @ ..] => !jpeg_ends(rest),
        [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n', rest @ ..] => !png_ends(rest),
        [b'B', b'M', ..] => !bmp_ends(bytes),
        _ => false,
    }
}

/// Whether a JPEG has its end. Behind the head of each scan its data follow, in which a marker is no 0 and no restart.
fn jpeg_ends(bytes: &[u8]) -> bool {
    let mut rest = bytes;
    while let Some((kind, after)) = jpeg::next_marker(rest) {
        rest = match kind {
            jpeg::END => return true,
            jpeg::SCAN => {
                let is_marker =
                    |pair: &[u8]| pair[0] == 0xff && pair[1] != 0 && !jpeg::RESTARTS.contains(&pair[1]);
                let Some(length) = after.windows(2).position(is_marker) else { return false };
                &after[length..]
            }
            _ => after,
        };
    }
    false
}

/// Whether a PNG has its last chunk, with its checksum.
fn png_ends(bytes: &[u8]) -> bool {
    let mut rest = bytes;
    while let Some((&[a, b, c, d, ref name @ ..], _)) = rest.split_first_chunk::<8>() {
        let whole = u32::from_be_bytes([a, b, c, d]) as usize + 12;
        let Some(after) = rest.get(whole..) else { return false };
        if name == b"IEND" {
            return true;
        }
        rest = after;
    }
    false
}

/// Whether a BMP has all of its rows.
fn bmp_ends(bytes: &[u8]) -> bool {
    let number = |at: usize| {
        let bytes = bytes.get(at..)?.first_chunk()?;
        Some(u64::from(u32::from_le_bytes(*bytes)))
    };
    let (Some(size), Some(begin), Some(width), Some(height)) =
        (number(2), number(10), number(18), number(22))
    else {
        return false;
    };
    let bits = number(28).unwrap_or(0) & 0xffff;
    let height = u64::from((height as u32 as i32).unsigned_abs());
    let is_packed = number(30).is_some_and(|compression| compression == 1 || compression == 2);
    // Some programs write no size; what is packed has no fixed one.
    let needed = if is_packed { size } else { begin + (width * bits).div_ceil(32) * 4 * height };
    bytes.len() as u64 >= needed
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use opencv::core::{CV_8UC3, Mat, RNG, RNGTrait as _, Scalar, Vector};
    use opencv::imgcodecs;

    /// A picture of noise in this format.
    fn picture(ending: &str, flags: &[i32]) -> Vec<u8> {
        let mut picture = Mat::new_rows_cols_with_default(40, 70, CV_8UC3, Scalar::all(0.0)).unwrap();
        let (least, most) = (Scalar::all(0.0), Scalar::all(255.0));
        RNG::new(1).unwrap().fill(&mut picture, 0, &least, &most, false).unwrap();
        let mut file = Vector::new();
        imgcodecs::imencode(ending, &picture, &mut file, &Vector::from_slice(flags)).unwrap();
        file.as_slice().to_vec()
    }

    #[test]
    fn a_whole_picture_is_whole_and_a_cut_one_is_cut_wherever_it_is_cut() {
        let progressive = [imgcodecs::IMWRITE_JPEG_PROGRESSIVE, 1, imgcodecs::IMWRITE_JPEG_RST_INTERVAL, 3];
        for (ending, flags) in [(".jpg", &[][..]), (".jpg", &progressive), (".png", &[]), (".bmp", &[])] {
            let file = picture(ending, flags);
            assert!(!is_cut(&file), "{ending}");
            assert!(!is_cut(&[file.as_slice(), b"what a telephone adds"].concat()), "{ending}");
            for length in (10..file.len()).step_by(97).chain([file.len() - 1]) {
                assert!(is_cut(&file[..length]), "{ending} of {length} from {} bytes", file.len());
            }
        }
    }
}
