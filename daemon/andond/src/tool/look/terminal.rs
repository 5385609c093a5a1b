//! A picture in a terminal: each letter is a half block, whose upper and lower half have colours of their own (24 bits).

use std::fmt::Write as _;

use andon_host::video::pipe::PictureFormat;

/// Letters per line where the terminal does not say.
const COLUMNS: usize = 80;
/// A wider picture says no more, and needs more lines than a screen has.
const MAX_COLUMNS: usize = 120;

/// The picture, as wide as the terminal.
pub(super) fn picture(pixels: &[u8], format: PictureFormat) -> String {
    let columns = rustix::termios::tcgetwinsize(std::io::stdout()).map_or(COLUMNS, |size| size.ws_col.into());
    in_columns(pixels, format, columns.clamp(20, MAX_COLUMNS))
}

/// A letter is twice as high as wide, so its halves are square.
fn in_columns(pixels: &[u8], format: PictureFormat, columns: usize) -> String {
    let (width, height) = (format.width as usize, format.height as usize);
    let rows = (columns * height / width.max(1)).div_ceil(2);
    let mut text = String::new();
    for row in 0..rows {
        for column in 0..columns {
            let half = |half: usize| {
                let x = [column, column + 1].map(|at| at * width / columns);
                let y = [2 * row + half, 2 * row + half + 1].map(|at| at * height / (2 * rows));
                mean(pixels, width, x, y)
            };
            let [[r, g, b], [below_r, below_g, below_b]] = [half(0), half(1)];
            // Writing to a `String` cannot fail.
            let _ = write!(text, "\x1b[38;2;{r};{g};{b};48;2;{below_r};{below_g};{below_b}m\u{2580}");
        }
        text.push_str("\x1b[0m\n");
    }
    text
}

/// The mean red, green and blue of a rectangle, which has at least one pixel.
fn mean(pixels: &[u8], width: usize, [left, right]: [usize; 2], [top, bottom]: [usize; 2]) -> [u32; 3] {
    let (mut sums, mut count) = ([0_u32; 3], 0);
    for y in top..bottom.max(top + 1) {
        for x in left..right.max(left + 1) {
            let Some([blue, green, red]) =
                pixels.get(3 * (y * width + x)..).and_then(|rest| rest.first_chunk())
            else {
                continue;
            };
            for (sum, value) in sums.iter_mut().zip([red, green, blue]) {
                *sum += u32::from(*value);
            }
            count += 1;
        }
    }
    sums.map(|sum| sum / count.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_halves_of_a_letter_have_the_colours_of_the_picture() {
        // Two columns: red above green, blue above white.
        let pixels = [[0, 0, 200], [250, 0, 0], [0, 100, 0], [255, 255, 255]].concat();
        let format = PictureFormat { width: 2, height: 2, rate_hz: 30.0, count: 1 };
        let expected = "\x1b[38;2;200;0;0;48;2;0;100;0m▀\x1b[38;2;0;0;250;48;2;255;255;255m▀\x1b[0m\n";
        assert_eq!(in_columns(&pixels, format, 2), expected);
    }
}
