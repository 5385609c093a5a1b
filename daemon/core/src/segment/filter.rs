//! The opening-closing filter on `x_m` inside an IU, as a stream.
//!
//! An opening is an erosion followed by a dilation, a closing a dilation followed by an erosion. The two dilations in the middle equal one of twice
//! the reach. So with a window of `2h + 1` frames the filter is an erosion, a dilation and an erosion. They reach over `h`, `2h` and `h` frames to each
//! side. Its output is `4h` frames late; the rest is flushed when the IU ends.

use crate::capacity::FILTER_FRAMES;
use crate::couple::Motion;
use heapless::Deque;

/// Maximum reach to one side, that of the dilation.
const REACH: usize = FILTER_FRAMES - 1;

/// Frames of the longest window.
const WINDOW: usize = 2 * REACH + 1;

/// The minimum or maximum of each feature in a window around each frame, clipped at the ends.
#[derive(Clone, Debug)]
struct Extreme {
    /// Returns the more extreme one of two values.
    of_two: fn(i8, i8) -> i8,
    reach: usize,
    /// The newest frames, from `reach` before the one whose extreme comes next.
    window: Deque<Motion, WINDOW>,
    /// How many of them have no extreme yet, at most `reach` between two calls.
    waiting: usize,
}

impl Extreme {
    fn new(of_two: fn(i8, i8) -> i8, reach: usize) -> Self {
        Self { of_two, reach, window: Deque::new(), waiting: 0 }
    }

    fn clear(&mut self) {
        self.window.clear();
        self.waiting = 0;
    }

    /// Takes the next frame and returns the extreme of the one `reach` before it.
    fn push(&mut self, motion: Motion) -> Option<Motion> {
        // There is room: of a full window the oldest frame has gone.
        let _ = self.window.push_back(motion);
        self.waiting += 1;
        if self.waiting > self.reach { self.give() } else { None }
    }

    /// Returns the extreme of the next frame; `None` after the last one.
    fn give(&mut self) -> Option<Motion> {
        self.waiting = self.waiting.checked_sub(1)?;
        let of_both = |one: Motion, other: Motion| {
            Motion(core::array::from_fn(|feature| (self.of_two)(one.0[feature], other.0[feature])))
        };
        let extreme = self.window.iter().copied().reduce(of_both);
        if self.window.len() > self.reach + self.waiting {
            self.window.pop_front();
        }
        extreme
    }
}

/// The filter for one IU: an erosion, a dilation and an erosion.
#[derive(Clone, Debug)]
pub(super) struct OpeningClosing([Extreme; 3]);

impl OpeningClosing {
    /// `window` is an odd number of frames.
    pub(super) fn new(window: u8) -> Self {
        let half = usize::from(window) / 2;
        let erosion = Extreme::new(i8::min, half);
        Self([erosion.clone(), Extreme::new(i8::max, 2 * half), erosion])
    }

    /// Forgets the IU.
    pub(super) fn clear(&mut self) {
        self.0.iter_mut().for_each(Extreme::clear);
    }

    /// Takes the next motion and returns the filtered one of the frame `4h` before it.
    pub(super) fn push(&mut self, motion: Motion) -> Option<Motion> {
        self.0.iter_mut().try_fold(motion, |motion, stage| stage.push(motion))
    }

    /// After the last motion: returns the next filtered one; `None` after the last one.
    pub(super) fn flush(&mut self) -> Option<Motion> {
        (0..self.0.len()).find_map(|index| {
            let (stage, behind) = self.0[index..].split_first_mut()?;
            let mut left = core::iter::from_fn(|| stage.give());
            left.find_map(|motion| behind.iter_mut().try_fold(motion, |motion, stage| stage.push(motion)))
        })
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
}
