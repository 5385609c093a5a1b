//! Brightens the input of a model where the picture is dark.
//!
//! The models were trained on ordinary photographs. In a dark one the hand and the bench lie a few grey levels apart. The models lose the hand
//! although a person still sees it.

/// An input whose bright tenth lies below this, of 1, is dark. In ordinary pictures of a bench it is at 0.35 to 0.6. A hand fills more than a tenth
/// of its own region, and skin in good light is a middle grey at least.
const DARK: f32 = 0.3;
/// The share of the pixels that are brighter: less than a hand fills, and more than the white of a marker does.
const BRIGHT_SHARE: f32 = 0.1;
/// Nothing can be seen in five grey levels of 255.
const BLACK: f32 = 0.02;
/// Grey levels that are distinguished.
const LEVELS: usize = 256;
/// Only every fourth pixel is counted: 9,000 of the smaller input are more than enough for a tenth.
const COUNTED: usize = 4;

/// Brightens a dark input (RGB, 0..1) and leaves every other one as it is, to the bit.
///
/// The curve is a power, which moves the middle greys most and keeps black and white where they are. Its exponent takes the
/// bright tenth to [`DARK`] and no further, so that an input at the border is hardly changed.
pub(super) fn brighten(tensor: &mut [f32]) {
    let Some(bright) = bright_tenth(tensor).filter(|bright| (BLACK..DARK).contains(bright)) else { return };
    let exponent = DARK.ln() / bright.ln();
    let curve: [f32; LEVELS + 1] = std::array::from_fn(|level| (level as f32 / LEVELS as f32).powf(exponent));
    for value in tensor {
        let place = value.clamp(0.0, 1.0) * LEVELS as f32;
        let level = (place as usize).min(LEVELS - 1);
        *value = curve[level] + (place - level as f32) * (curve[level + 1] - curve[level]);
    }
}

/// The brightness that a tenth of the pixels exceed. Pixels that are quite black do not count: outside the picture all are.
fn bright_tenth(tensor: &[f32]) -> Option<f32> {
    let mut counts = [0_u32; LEVELS];
    let mut all = 0;
    for pixel in tensor.chunks_exact(3).step_by(COUNTED) {
        // The weights of ITU-R BT.601, to a hundredth.
        let brightness = 0.3 * pixel[0] + 0.59 * pixel[1] + 0.11 * pixel[2];
        if brightness > 0.0 {
            // The cast saturates.
            counts[((brightness * LEVELS as f32) as usize).min(LEVELS - 1)] += 1;
            all += 1;
        }
    }
    let mut brighter = (all as f32 * BRIGHT_SHARE) as u32;
    for (level, count) in counts.into_iter().enumerate().rev() {
        match brighter.checked_sub(count) {
            Some(left) => brighter = left,
            None => return Some(level as f32 / LEVELS as f32),
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bench of one brightness with a hand of another one over a fifth of it.
    fn input(bench: f32, hand: f32) -> Vec<f32> {
        (0..192 * 192).flat_map(|pixel| [if pixel % 192 < 38 { hand } else { bench }; 3]).collect()
    }

    #[test]
    fn an_ordinary_input_stays_as_it_is_to_the_bit() {
        for (bench, hand) in [(0.1, 0.35), (0.55, 0.4), (0.9, 0.2), (0.02, 1.0)] {
            let mut tensor = input(bench, hand);
            brighten(&mut tensor);
            assert_eq!(tensor, input(bench, hand), "bench {bench}, hand {hand}");
        }
    }

    #[test]
    fn in_a_dark_input_the_hand_comes_out_of_the_dark_and_stays_brighter_than_the_bench() {
        for hand in [0.04, 0.1, 0.2] {
            let mut tensor = input(hand / 2.0, hand);
            brighten(&mut tensor);
            let (bright, dark) = (tensor[0], tensor[3 * 191]);
            assert!((0.28..0.34).contains(&bright), "{hand} became {bright}");
            assert!(dark > hand / 2.0 && dark < bright - 0.04, "the bench of {hand} became {dark}");
        }
    }

    #[test]
    fn nothing_leaps_where_the_dark_begins() {
        let mut tensor = input(0.2, 0.299);
        brighten(&mut tensor);
        let max =
            tensor.iter().zip(input(0.2, 0.299)).map(|(new, old)| (new - old).abs()).fold(0.0, f32::max);
        assert!(max < 0.01, "{max}");
    }

    #[test]
    fn a_black_picture_stays_black_and_numbers_that_are_none_do_no_harm() {
        for value in [0.0, 0.01] {
            let mut tensor = input(value, value);
            brighten(&mut tensor);
            assert_eq!(tensor, input(value, value));
        }
        brighten(&mut [f32::NAN; 300]);
        brighten(&mut []);
    }

    #[test]
    fn what_lies_outside_the_picture_does_not_make_an_input_dark() {
        let mut tensor = input(0.4, 0.5);
        tensor[..192 * 192 * 3 / 4].fill(0.0);
        let before = tensor.clone();
        brighten(&mut tensor);
        assert_eq!(tensor, before);
    }
}
