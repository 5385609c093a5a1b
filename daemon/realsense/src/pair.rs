//! Which depth picture belongs to which colour picture.
//!
//! Two sensors take their pictures independently of each other. Depth is of the moment of a colour picture when the two stamps are at most half a
//! period of the colour stream apart. Whatever is farther away shows where things were one picture earlier or later.

use std::collections::VecDeque;

use crate::clock::SensorTime;

/// How many pictures of each stream wait for the other one. One stream of a D4xx is never later than the other by this number of pictures, and the
/// SDK has 32 buffers for each.
const MAX_WAITING: usize = 16;

/// Whether depth that was taken at `depth` is of the moment of a colour picture that was taken at `colour`. Its stream has `rate_hz` pictures per
/// second. Stamps of two clocks cannot be compared.
pub fn is_of_one_moment(colour: SensorTime, depth: SensorTime, rate_hz: u32) -> bool {
    colour.domain == depth.domain && (colour.ms - depth.ms).abs() <= 500.0 / f64::from(rate_hz.max(1))
}

/// Gives each colour picture of a recording the depth picture that is nearest to it in time.
///
/// The order in which the streams are interleaved makes no difference. No picture is given twice, and a colour picture without depth of its moment is
/// left out.
#[derive(Debug)]
pub struct Pairing<C, D> {
    rate_hz: u32,
    colours: VecDeque<(SensorTime, C)>,
    depths: VecDeque<(SensorTime, D)>,
}

impl<C, D> Pairing<C, D> {
    /// For a colour stream with this number of pictures per second.
    pub fn new(rate_hz: u32) -> Self {
        Self { rate_hz, colours: VecDeque::new(), depths: VecDeque::new() }
    }

    /// The next colour picture.
    pub fn push_colour(&mut self, time: SensorTime, picture: C) {
        self.colours.push_back((time, picture));
    }

    /// The next depth picture.
    pub fn push_depth(&mut self, time: SensorTime, picture: D) {
        self.depths.push_back((time, picture));
        if self.depths.len() > MAX_WAITING {
            self.depths.pop_front();
        }
    }

    /// The next pair; `None` while its depth may still come, which it does not at the end of the recording.
    pub fn next(&mut self, is_at_end: bool) -> Option<(C, D)> {
        while self.is_first_decided() || (is_at_end && !self.colours.is_empty()) {
            let (time, colour) = self.colours.pop_front()?;
            if let Some(depth) = self.take_depth(time) {
                return Some((colour, depth));
            }
        }
        None
    }

    /// Whether no depth that is still to come can be nearer to the first colour picture.
    fn is_first_decided(&self) -> bool {
        let Some((colour, _)) = self.colours.front() else { return false };
        self.depths.back().is_some_and(|(depth, _)| depth.ms >= colour.ms)
            || has_jumped_back(&self.colours)
            || has_jumped_back(&self.depths)
            || self.colours.len() > MAX_WAITING
    }

    fn take_depth(&mut self, colour: SensorTime) -> Option<D> {
        let distance_ms = |(depth, _): &(SensorTime, D)| (depth.ms - colour.ms).abs();
        let (nearest, _) = self
            .depths
            .iter()
            .enumerate()
            .filter(|(_, (depth, _))| is_of_one_moment(colour, *depth, self.rate_hz))
            .min_by(|(_, a), (_, b)| distance_ms(a).total_cmp(&distance_ms(b)))?;
        self.depths.drain(..=nearest).next_back().map(|(_, depth)| depth)
    }
}

/// Whether the clock of a stream has been started again between two pictures that wait.
fn has_jumped_back<T>(waiting: &VecDeque<(SensorTime, T)>) -> bool {
    matches!((waiting.front(), waiting.back()), (Some((first, _)), Some((last, _))) if first.ms > last.ms)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::clock::Domain;

    const RATE_HZ: u32 = 30;
    const PERIOD_MS: f64 = 1000.0 / RATE_HZ as f64;

    fn at(ms: f64) -> SensorTime {
        SensorTime { ms, domain: Domain::Hardware }
    }

    /// A picture of either stream, with its number.
    #[derive(Clone, Copy, Debug)]
    enum Picture {
        Colour(f64, usize),
        Depth(f64, usize),
    }
    use Picture::{Colour, Depth};

    /// The numbers of the pairs.
    fn pairs(pictures: &[Picture]) -> Vec<(usize, usize)> {
        let (mut pairing, mut paired) = (Pairing::new(RATE_HZ), Vec::new());
        for picture in pictures {
            match *picture {
                Colour(ms, number) => pairing.push_colour(at(ms), number),
                Depth(ms, number) => pairing.push_depth(at(ms), number),
            }
            paired.extend(std::iter::from_fn(|| pairing.next(false)));
        }
        paired.extend(std::iter::from_fn(|| pairing.next(true)));
        paired
    }

    #[test]
    fn depth_of_the_picture_before_is_of_another_moment() {
        let colour = at(1000.0);
        for (lag_ms, is) in [(0.0, true), (-16.6, true), (16.6, true), (-16.7, false), (33.3, false)] {
            assert_eq!(is_of_one_moment(colour, at(1000.0 + lag_ms), RATE_HZ), is, "{lag_ms}");
        }
    }

    #[test]
    fn stamps_of_two_clocks_are_not_compared() {
        let depth = SensorTime { ms: 1000.0, domain: Domain::System };
        assert!(!is_of_one_moment(at(1000.0), depth, RATE_HZ));
    }

    #[test]
    fn a_nearer_depth_that_comes_later_is_taken() {
        assert_eq!(pairs(&[Depth(90.0, 0), Colour(100.0, 0), Depth(101.0, 1)]), [(0, 1)]);
    }

    #[test]
    fn a_picture_whose_depth_is_missing_is_left_out_and_takes_none_from_its_neighbours() {
        let pictures =
            [Depth(96.0, 0), Colour(100.0, 0), Colour(133.0, 1), Depth(162.0, 2), Colour(166.0, 2)];
        assert_eq!(pairs(&pictures), [(0, 0), (2, 2)]);
    }

    #[test]
    fn a_depth_stream_that_breaks_off_does_not_hold_up_more_than_can_wait() {
        let mut pairing = Pairing::<usize, usize>::new(RATE_HZ);
        for number in 0..100 {
            pairing.push_colour(at(number as f64 * PERIOD_MS), number);
            assert_eq!(pairing.next(false), None);
        }
        assert_eq!(pairing.colours.len(), MAX_WAITING);
    }

    #[test]
    fn a_clock_that_starts_again_costs_at_most_one_picture() {
        let mut pictures = Vec::new();
        for number in 0..20 {
            let ms = (number % 10) as f64 * PERIOD_MS;
            pictures.extend([Colour(ms, number), Depth(ms - 4.0, number)]);
        }
        let paired = pairs(&pictures);
        assert!(paired.iter().all(|(colour, depth)| colour == depth), "{paired:?}");
        assert!(paired.len() >= 19, "{paired:?}");
    }

    proptest! {
        #[test]
        fn however_the_streams_are_interleaved_each_picture_has_its_own_depth(
            lag in -0.49..0.49_f64,
            delays in prop::collection::vec(0..10_u32, 100),
        ) {
            let mut pictures = Vec::new();
            for number in 0..50 {
                let ms = number as f64 * PERIOD_MS;
                pictures.push((number as u32 + delays[2 * number], Colour(ms, number)));
                pictures.push((number as u32 + delays[2 * number + 1], Depth(ms + lag * PERIOD_MS, number)));
            }
            // A stream is never out of order, and the sort is stable.
            let [mut colour_at, mut depth_at] = [0, 0];
            for (at, picture) in &mut pictures {
                let newest = if matches!(picture, Colour(..)) { &mut colour_at } else { &mut depth_at };
                *newest = (*at).max(*newest);
                *at = *newest;
            }
            pictures.sort_by_key(|(at, _)| *at);
            let pictures: Vec<Picture> = pictures.into_iter().map(|(_, picture)| picture).collect();
            prop_assert_eq!(pairs(&pictures), (0..50).map(|number| (number, number)).collect::<Vec<_>>());
        }
    }
}
