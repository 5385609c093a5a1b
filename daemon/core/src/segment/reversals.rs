//! How often a motion reversed. DTW forgives a repeated motion that was cut short; a count of its reversals does not.

use crate::couple::{Context, Motion};

/// Counts the reversals of the motion of one IU.
///
/// The direction is the azimuth of `o_j` against `o_l` if there is an `o_l`, else that of the hand against `o_j`. Its turns are
/// summed. When the sum exceeds a quarter turn, the motion has reversed, and half a turn is subtracted. So the gentle turn at
/// the end of a rounded stroke counts once, noise of a bin or two around a straight stroke does not count, and strokes across
/// the first direction of the motion count like those along it. Frames at rest, and in metric mode frames of motion straight
/// up or down, have no azimuth and are ignored.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reversals {
    bins: i16,
    /// Indices of elevation and azimuth in `x_m`.
    features: [usize; 2],
    previous: Option<i16>,
    /// By how much the direction has turned, in half bins, counter-clockwise positive.
    turned: i16,
    count: u32,
}

impl Reversals {
    pub(super) fn new(context: Context, bins: u8) -> Self {
        let features = if context.0[3] == 0 { [1, 2] } else { [4, 5] };
        Self { bins: i16::from(bins), features, previous: None, turned: 0, count: 0 }
    }

    /// Takes the next frame and returns the count so far.
    pub(super) fn push(&mut self, motion: Motion) -> u32 {
        let [elevation, azimuth] = self.features.map(|feature| i16::from(motion.0[feature]));
        let is_vertical = elevation == 1 || elevation == self.bins / 2 + 1;
        if azimuth <= 0 || is_vertical {
            return self.count;
        }
        if let Some(previous) = self.previous.replace(azimuth) {
            self.turned += self.turn(previous, azimuth);
            // Half a turn is `bins` half bins.
            if 2 * self.turned.abs() > self.bins {
                self.turned -= self.bins * self.turned.signum();
                self.count = self.count.saturating_add(1);
            }
        }
        self.count
    }

    /// The shorter turn from one direction to another, in half bins; exactly half a turn takes the sense of the turns so far.
    fn turn(&self, from: i16, to: i16) -> i16 {
        let forward = (2 * (to - from)).rem_euclid(2 * self.bins);
        let backward = forward - 2 * self.bins;
        if forward < self.bins || forward == self.bins && self.turned >= 0 { forward } else { backward }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(azimuths: impl IntoIterator<Item = i8>) -> u32 {
        let mut reversals = Reversals::new(Context([1, 5, 5, 6]), 8);
        azimuths.into_iter().fold(0, |_, azimuth| reversals.push(Motion([0, 0, 9, 0, 0, azimuth, 0])))
    }

    #[test]
    fn six_strokes_back_and_forth_are_eleven_reversals() {
        let stroke = [1, 1, 1, 0, 5, 5, 5, 0];
        assert_eq!(count(stroke.into_iter().cycle().take(6 * 8)), 11);
    }

    #[test]
    fn noise_of_one_bin_does_not_count() {
        assert_eq!(count([1, 8, 1, 2, 1, 0, 8, 2, 8, 2]), 0);
        assert_eq!(count([2, 1, 1, 0, 4, 5, 6, 5, 0, 2, 1, 8]), 2);
    }

    #[test]
    fn a_full_circle_counts_two() {
        // Five times around the circle.
        assert_eq!(count((0..40).map(|step| step % 8 + 1)), 10);
    }

    #[test]
    fn a_quarter_turn_is_no_reversal() {
        assert_eq!(count([1, 3, 1, 7, 1]), 0);
    }

    #[test]
    fn strokes_across_the_first_direction_count() {
        let stroke = [1, 1, 1, 0, 5, 5, 5, 0];
        assert_eq!(count([3, 3].into_iter().chain(stroke.into_iter().cycle().take(6 * 8))), 11);
    }

    #[test]
    fn without_another_object_the_hand_counts() {
        let mut reversals = Reversals::new(Context([1, 5, 0, 0]), 8);
        let turns = [[3, 1], [3, 5], [1, 1], [5, 1], [3, 1]]
            .map(|[elevation, azimuth]| reversals.push(Motion([0, elevation, azimuth, 0, 0, 0, 0])));
        assert_eq!(turns, [0, 1, 1, 1, 2]);
    }
}
