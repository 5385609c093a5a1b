//! What only repeats in a track file. A tracker that has lost something, or stands still, may go on with the last place: bit for bit, while
//! the time goes on. Whatever measures has errors and never does that, so such a place was not seen.

use super::{Header, TrackError, TrackReader, Truncation};
use andon_core::input::{Frame, Hand, Object, Point};
use andon_core::object::REACH_M;
use andon_core::segment::MOVED_M;
use std::collections::VecDeque;
use std::io::BufRead;

/// A hand that has gone this far from where it was goes on, in metres.
const GOES_ON_M: f32 = 0.03;

/// A track file, frame by frame, without what only repeats in it.
#[derive(Debug)]
pub struct SeenTracks<R> {
    reader: TrackReader<R>,
    repeats: Repeats,
    /// All has been read, up to this fault if there is one.
    has_ended: bool,
    fault: Option<TrackError>,
}

impl<R: BufRead> SeenTracks<R> {
    /// Reads the header; see [`TrackReader::new`]. What stands still for longer than `blind_ms` may only repeat.
    ///
    /// # Errors
    /// As [`TrackReader::new`].
    pub fn new(file: &str, source: R, blind_ms: u32) -> Result<Self, TrackError> {
        let reader = TrackReader::new(file, source)?;
        Ok(Self { reader, repeats: Repeats::new(blind_ms), has_ended: false, fault: None })
    }

    /// The first line.
    pub fn header(&self) -> &Header {
        self.reader.header()
    }

    /// Where the file was cut off; see [`TrackReader::truncation`].
    pub fn truncation(&self) -> Option<&Truncation> {
        self.reader.truncation()
    }
}

impl<R: BufRead> Iterator for SeenTracks<R> {
    type Item = Result<Frame, TrackError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(frame) = self.repeats.pop(self.has_ended) {
                return Some(Ok(frame));
            }
            if self.has_ended {
                return self.fault.take().map(Err);
            }
            match self.reader.next() {
                Some(Ok(frame)) => self.repeats.push(frame),
                ended => (self.has_ended, self.fault) = (true, ended.and_then(Result::err)),
            }
        }
    }
}

/// The frames of a track file, held back for as long as a place may stand still.
///
/// A frame that repeats the one before, hands and parts, for longer than `blind_ms` was not seen. Neither was a part whose place does, while the hand
/// that has moved it goes on. Where parts lie still bit for bit by themselves, as those of a simulator without errors, that says nothing. Then all is
/// taken for seen.
#[derive(Debug, Default)]
struct Repeats {
    blind_ns: u64,
    ahead: VecDeque<Frame>,
    /// The newest frame as it came.
    newest: Option<Frame>,
    /// Since when the whole frame stands still, in nanoseconds.
    since_ns: u64,
    parts: Vec<Part>,
    stands_still_by_itself: bool,
}

/// A part, and since when it stands still.
#[derive(Debug)]
struct Part {
    place: Object,
    since_ns: u64,
    /// For how long it has, without the time in which the whole frame did.
    still_ns: u64,
    /// The hand that moved it before that, where it was then, and whether it has gone on.
    hand: Option<Hand>,
    has_hand_gone_on: bool,
}

impl Repeats {
    fn new(blind_ms: u32) -> Self {
        Self { blind_ns: u64::from(blind_ms) * 1_000_000, ..Self::default() }
    }

    fn push(&mut self, frame: Frame) {
        let now_ns = frame.captured_ns;
        let before = self.newest.replace(frame.clone());
        let elapsed_ns = before.as_ref().map_or(0, |before| now_ns.saturating_sub(before.captured_ns));
        let is_same =
            before.is_some_and(|before| before.hands == frame.hands && before.objects == frame.objects);
        let is_something = !frame.hands.is_empty() || !frame.objects.is_empty();
        self.ahead.push_back(frame.clone());
        if !is_same || !is_something {
            self.since_ns = now_ns;
            self.see_parts(&frame, elapsed_ns);
        } else if now_ns.saturating_sub(self.since_ns) > self.blind_ns {
            self.judge_frame();
        }
    }

    /// The next frame of which it is known what only repeats in it; at the end of the file, whatever there is.
    fn pop(&mut self, is_at_end: bool) -> Option<Frame> {
        let newest_ns = self.ahead.back()?.captured_ns;
        let is_known = |frame: &Frame| newest_ns.saturating_sub(frame.captured_ns) > self.blind_ns;
        if is_at_end || self.ahead.front().is_some_and(is_known) { self.ahead.pop_front() } else { None }
    }

    /// The whole frame has stood still for too long.
    fn judge_frame(&mut self) {
        let has_changed = !self.parts.is_empty() && self.parts.iter().all(|part| part.since_ns > 0);
        if !has_changed {
            self.stands_still_by_itself = true;
        }
        if !self.stands_still_by_itself {
            let since_ns = self.since_ns;
            for frame in self.ahead.iter_mut().filter(|frame| frame.captured_ns > since_ns) {
                *frame = Frame { captured_ns: frame.captured_ns, is_unseen: true, ..Frame::default() };
            }
        }
    }

    fn see_parts(&mut self, frame: &Frame, elapsed_ns: u64) {
        for object in &frame.objects {
            let before = self.parts.iter().position(|part| part.place.id == object.id);
            match before {
                Some(index) if self.parts[index].place == *object => {
                    self.stand_still(index, frame, elapsed_ns)
                }
                Some(index) => self.parts[index] = self.moved(object, frame),
                None => {
                    let part = Part { since_ns: 0, hand: None, ..self.moved(object, frame) };
                    self.parts.push(part);
                }
            }
        }
    }

    /// A part that is at another place than before.
    fn moved(&self, object: &Object, frame: &Frame) -> Part {
        let places = self.ahead.iter().flat_map(|frame| &frame.objects).filter(|other| other.id == object.id);
        let was_moved = places.into_iter().any(|other| apart_m(other.position, object.position) > MOVED_M);
        let is_near = |hand: &&Hand| apart_m(hand.middle_knuckle, object.position) < REACH_M;
        let hand = frame.hands.iter().find(is_near).filter(|_| was_moved).copied();
        Part { place: *object, since_ns: frame.captured_ns, still_ns: 0, hand, has_hand_gone_on: false }
    }

    fn stand_still(&mut self, index: usize, frame: &Frame, elapsed_ns: u64) {
        let part = &mut self.parts[index];
        part.still_ns += elapsed_ns;
        let has_gone = |was: Hand| {
            let mut hands = frame.hands.iter().filter(|hand| hand.side == was.side);
            hands.any(|hand| apart_m(hand.middle_knuckle, was.middle_knuckle) > GOES_ON_M)
        };
        part.has_hand_gone_on |= part.hand.is_some_and(has_gone);
        if part.still_ns <= self.blind_ns {
            return;
        }
        self.stands_still_by_itself |= part.hand.is_none();
        if part.has_hand_gone_on && !self.stands_still_by_itself {
            let (id, since_ns) = (part.place.id, part.since_ns);
            for frame in self.ahead.iter_mut().filter(|frame| frame.captured_ns > since_ns) {
                frame.objects.retain(|object| object.id != id);
            }
        }
    }
}

fn apart_m(one: Point, other: Point) -> f32 {
    let square: f32 = one.iter().zip(other).map(|(one, other)| (one - other) * (one - other)).sum();
    square.sqrt()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use andon_core::input::Side;

    const HAND: u16 = 0;
    const TOOL: u16 = 5;
    const BOX: u16 = 7;

    /// Strokes of a tool beside a box, for ten seconds at 30 Hz; where errors are, all places have them.
    fn strokes(has_errors: bool) -> Vec<Frame> {
        let mut seed = 1u32;
        let mut error = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            if has_errors { (seed >> 8) as f32 / (1 << 24) as f32 * 0.001 } else { 0.0 }
        };
        let mut frame = |index: u64| {
            // It rests for two seconds at first, and from the eighth on.
            let x = 0.06 * ((index.clamp(60, 240) - 60) as f32 * 0.3).sin();
            let mut at = |x: f32, y: f32| [x + error(), y + error(), 0.0];
            let (wrist, middle_knuckle, tip) = (at(x, -0.17), at(x, -0.08), at(x, 0.0));
            let hand = Hand { side: Side::Right, score: 1.0, wrist, middle_knuckle, tips: [tip; 3] };
            let object = |id, position| Object { id, position, orientation: [1.0, 0.0, 0.0, 0.0] };
            let objects = [object(TOOL, at(x, 0.02)), object(BOX, at(0.5, 0.0))];
            Frame {
                captured_ns: index * 33_333_333,
                hands: [hand].into_iter().collect(),
                objects: objects.into_iter().collect(),
                ..Frame::default()
            }
        };
        (0..300).map(&mut frame).collect()
    }

    /// From one frame on, the place of what has this id is that of the frame before, for as many frames. Of 0, all that is seen.
    fn held(frames: &mut [Frame], id: u16, from: usize, count: usize) {
        let last = frames[from - 1].clone();
        for frame in &mut frames[from..from + count] {
            if id == HAND {
                *frame = Frame { captured_ns: frame.captured_ns, ..last.clone() };
            }
            let place = last.objects.iter().find(|object| object.id == id);
            let now = frame.objects.iter_mut().find(|object| object.id == id);
            now.into_iter().zip(place).for_each(|(now, place)| *now = *place);
        }
    }

    /// What is taken for seen.
    fn seen(frames: &[Frame]) -> Vec<Frame> {
        let mut repeats = Repeats::new(700);
        let mut seen = Vec::new();
        for frame in frames {
            repeats.push(frame.clone());
            seen.extend(std::iter::from_fn(|| repeats.pop(false)));
        }
        seen.extend(std::iter::from_fn(|| repeats.pop(true)));
        assert_eq!(seen.len(), frames.len());
        seen
    }

    #[test]
    fn the_place_of_a_part_that_repeats_while_its_hand_goes_on_was_not_seen_from_its_beginning() {
        let mut frames = strokes(true);
        held(&mut frames, TOOL, 100, 45);
        let has_tool = |frame: &Frame| frame.objects.iter().any(|object| object.id == TOOL);
        let unseen: Vec<usize> = seen(&frames)
            .iter()
            .enumerate()
            .filter(|(_, frame)| !has_tool(frame))
            .map(|(index, _)| index)
            .collect();
        assert_eq!(unseen, (100..145).collect::<Vec<_>>());
    }

    #[test]
    fn frames_that_repeat_were_not_seen_from_the_first_one_on() {
        let mut frames = strokes(true);
        held(&mut frames, HAND, 100, 30);
        let seen = seen(&frames);
        assert!(seen[100..130].iter().all(|frame| frame.is_unseen && frame.objects.is_empty()));
        assert!(seen[..100].iter().chain(&seen[130..]).all(|frame| !frame.is_unseen));
    }

    #[test]
    fn what_repeats_no_longer_than_blind_ms_or_lies_still_by_itself_is_seen() {
        for id in [HAND, TOOL] {
            let mut frames = strokes(true);
            held(&mut frames, id, 100, 20);
            assert_eq!(seen(&frames), frames, "{id}");
        }
        let mut frames = strokes(true);
        held(&mut frames, BOX, 100, 90);
        assert_eq!(seen(&frames), frames, "nobody has moved it");
        let mut frames = strokes(false);
        assert_eq!(seen(&frames), frames, "a simulator without errors");
        held(&mut frames, TOOL, 100, 45);
        assert_eq!(seen(&frames), frames, "a simulator says nothing by it");
    }
}
