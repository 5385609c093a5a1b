//! The opening-closing filter on `x_m` inside an IU, as a stream.
//!
//! An opening is an erosion followed by a dilation, a closing a dilation followed by an erosion. The two dilations in the middle equal one of twice
//! the reach, also where they are clipped at the borders of the IU. So with a window of `2h + 1` frames the filter is an erosion, a dilation and an
//! erosion. They reach over `h`, `2h` and `h` frames to each side. Its output is `4h` frames late; the rest is flushed when the IU ends.

use crate::capacity::FILTER_FRAMES;
use crate::couple::Motion;
use heapless::Deque;

/// Number of features in `x_m`.
const FEATURES: usize = 7;

/// Maximum reach to one side, that of the dilation.
const REACH: usize = FILTER_FRAMES - 1;

/// Frames that a window may have to remember: its own and one more.
const WINDOW: usize = 2 * REACH + 2;

/// The minimum or maximum in a window around each frame, clipped at the ends.
#[derive(Clone, Debug)]
struct Extreme {
    /// Candidates for the extreme with their frames, from the best to the newest (a monotonic queue). Each value goes in and out
    /// once, so the amortised cost per frame is O(1).
    candidates: Deque<(u32, i8), WINDOW>,
    is_max: bool,
    reach: u32,
    taken: u32,
    given: u32,
}

impl Extreme {
    fn new(is_max: bool, reach: u32) -> Self {
        Self { candidates: Deque::new(), is_max, reach, taken: 0, given: 0 }
    }

    fn clear(&mut self) {
        self.candidates.clear();
        (self.taken, self.given) = (0, 0);
    }

    /// Takes the next value and returns the extreme of the frame `reach` before it.
    fn push(&mut self, value: i8) -> Option<i8> {
        let beaten = |old: i8| if self.is_max { old <= value } else { old >= value };
        while self.candidates.back().is_some_and(|(_, old)| beaten(*old)) {
            self.candidates.pop_back();
        }
        // There is room: candidates lie between `given - reach - 1` and `given + reach`.
        let _ = self.candidates.push_back((self.taken, value));
        self.taken += 1;
        if self.taken > self.given + self.reach { self.give() } else { None }
    }

    /// Returns the value of the next frame; `None` after the last one.
    fn give(&mut self) -> Option<i8> {
        if self.given == self.taken {
            return None;
        }
        while self.candidates.front().is_some_and(|(frame, _)| frame + self.reach < self.given) {
            self.candidates.pop_front();
        }
        self.given += 1;
        self.candidates.front().map(|(_, value)| *value)
    }
}

/// The filter of one feature.
#[derive(Clone, Debug)]
struct Feature([Extreme; 3]);

impl Feature {
    fn new(half: u32) -> Self {
        Self([Extreme::new(false, half), Extreme::new(true, 2 * half), Extreme::new(false, half)])
    }

    fn push(&mut self, value: i8) -> Option<i8> {
        self.0.iter_mut().try_fold(value, |value, stage| stage.push(value))
    }

    /// After the last input: returns the value of the next frame; `None` after the last one.
    fn flush(&mut self) -> Option<i8> {
        let [first, second, third] = &mut self.0;
        while let Some(value) = first.give() {
            if let Some(value) = second.push(value).and_then(|value| third.push(value)) {
                return Some(value);
            }
        }
        while let Some(value) = second.give() {
            if let Some(value) = third.push(value) {
                return Some(value);
            }
        }
        third.give()
    }
}

/// The filter for all features of one IU.
#[derive(Clone, Debug)]
pub(super) struct OpeningClosing {
    features: [Feature; FEATURES],
}

impl OpeningClosing {
    /// `window` is an odd number of frames.
    pub(super) fn new(window: u8) -> Self {
        let half = u32::from(window) / 2;
        Self { features: core::array::from_fn(|_| Feature::new(half)) }
    }

    /// Forgets the IU.
    pub(super) fn clear(&mut self) {
        self.features.iter_mut().flat_map(|feature| &mut feature.0).for_each(Extreme::clear);
    }

    /// Takes the next motion and returns the filtered one of the frame `4h` before it.
    pub(super) fn push(&mut self, motion: Motion) -> Option<Motion> {
        self.each(|feature, index| feature.push(motion.0[index]))
    }

    /// After the last motion: returns the next filtered one; `None` after the last one.
    pub(super) fn flush(&mut self) -> Option<Motion> {
        self.each(|feature, _| feature.flush())
    }

    /// All features have the same delay: either each of them returns a value or none does.
    fn each(&mut self, mut step: impl FnMut(&mut Feature, usize) -> Option<i8>) -> Option<Motion> {
        let mut motion = Some(Motion::default());
        for (index, feature) in self.features.iter_mut().enumerate() {
            let value = step(feature, index);
            motion = motion.zip(value).map(|(mut motion, value)| {
                motion.0[index] = value;
                motion
            });
        }
        motion
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    /// The definition, in four passes over the whole IU.
    fn two_filters(values: &[i8], half: usize) -> Vec<i8> {
        let pass = |values: &[i8], is_max: bool| -> Vec<i8> {
            (0..values.len())
                .map(|t| {
                    let window = &values[t.saturating_sub(half)..(t + half + 1).min(values.len())];
                    let extreme = if is_max { window.iter().max() } else { window.iter().min() };
                    extreme.copied().unwrap_or_default()
                })
                .collect()
        };
        let opened = pass(&pass(values, false), true);
        pass(&pass(&opened, true), false)
    }

    proptest! {
        #[test]
        fn the_stream_equals_an_opening_and_a_closing_of_the_whole_iu(
            ius in prop::collection::vec(prop::collection::vec(-1i8..9, 0..150), 1..4),
            half in 0u8..=15,
        ) {
            let mut filter = OpeningClosing::new(2 * half + 1);
            for values in ius {
                filter.clear();
                let mut streamed = Vec::new();
                for (t, value) in values.iter().enumerate() {
                    let given = filter.push(Motion([*value; 7]));
                    prop_assert_eq!(given.is_some(), t >= 4 * usize::from(half));
                    streamed.extend(given);
                }
                streamed.extend(core::iter::from_fn(|| filter.flush()));
                let wanted: Vec<Motion> =
                    two_filters(&values, half.into()).into_iter().map(|value| Motion([value; 7])).collect();
                prop_assert_eq!(streamed, wanted);
            }
        }
    }

    #[test]
    fn a_value_that_is_shorter_than_the_window_is_filtered_out() {
        let mut filter = OpeningClosing::new(5);
        let values = [0, 0, 0, 0, 0, 7, 7, 0, 0, 0, 0, 3, 3, 3, 3, 3, 1, 1, 3, 3, 3, 3, 3];
        let mut given: Vec<i8> =
            values.iter().filter_map(|value| filter.push(Motion([*value; 7]))).map(|m| m.0[6]).collect();
        given.extend(core::iter::from_fn(|| filter.flush()).map(|m| m.0[6]));
        assert_eq!(given, [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3]);
    }
}
