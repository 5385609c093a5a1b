//! What of the hands and parts was seen in a recording, and what moved although no hand was seen to move it.

use andon_core::input::{Frame, Point, Side};
use andon_core::segment::MOVED_M;

use super::{ASSUMED, Axis, GAP, LEFT, MOVED, NO_HAND, SEEN, UNSEEN, dot, rectangle, text};
use crate::report::Names;

/// The height of a lane, and of the marks beneath it, in pixels.
const LANE: f64 = 12.0;
const MARK: f64 = 4.0;

/// A stretch that is narrower gets a dot where nothing is near it: otherwise nobody finds it. Pixels.
const NARROW: f64 = 3.0;
const ALONE: f64 = 8.0;

/// Everything that the frames of a recording show.
#[derive(Clone, Debug, Default)]
pub struct RecordedVisibility {
    /// The time from one frame to the next, in nanoseconds.
    pub frame_ns: u64,
    /// For how long what is hidden is assumed to be where it was, in nanoseconds.
    pub blind_ns: u64,
    /// Frames, hands, then parts.
    tracks: Vec<Track>,
    /// When something moved at which no hand was seen: first and last frame, in nanoseconds.
    handless: Vec<(u64, u64)>,
}

#[derive(Clone, Debug)]
struct Track {
    what: What,
    /// When it was seen, in nanoseconds, and where, in metres in the bench frame.
    seen: Vec<(u64, Point)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    /// That a frame came.
    Frame,
    Hand(Side),
    Part(u16),
}

/// A stretch of a lane.
#[derive(Clone, Debug, PartialEq)]
struct Stretch {
    look: (&'static str, &'static str),
    began_ns: u64,
    ended_ns: u64,
}

impl RecordedVisibility {
    /// Nothing yet of these hands and parts.
    pub fn new(hands: &[Side], parts: impl Iterator<Item = u16>, frame_ns: u64, blind_ns: u64) -> Self {
        let hands = hands.iter().map(|side| What::Hand(*side));
        let what = [What::Frame].into_iter().chain(hands).chain(parts.map(What::Part));
        let tracks = what.map(|what| Track { what, seen: Vec::new() }).collect();
        Self { frame_ns, blind_ns, tracks, handless: Vec::new() }
    }

    /// Takes the next frame.
    pub fn take(&mut self, frame: &Frame) {
        for track in &mut self.tracks {
            let place = match track.what {
                What::Frame => Some([0.0; 3]),
                What::Hand(side) => {
                    frame.hands.iter().find(|hand| hand.side == side).map(|hand| hand.middle_knuckle)
                }
                What::Part(id) => {
                    frame.objects.iter().find(|object| object.id == id).map(|object| object.position)
                }
            };
            track.seen.extend(place.map(|place| (frame.captured_ns, place)));
        }
    }

    /// Notes that something moved in this frame at which no hand was seen.
    pub fn take_handless(&mut self, at_ns: u64) {
        let is_next = |last: u64| at_ns.saturating_sub(last) <= self.frame_ns + self.frame_ns / 2;
        match self.handless.last_mut() {
            Some((_, last)) if is_next(*last) => *last = at_ns,
            _ => self.handless.push((at_ns, at_ns)),
        }
    }

    /// The times of the first and of the last sighting of anything, in nanoseconds.
    pub(super) fn span_ns(&self) -> Option<(u64, u64)> {
        let times = || self.tracks.iter().flat_map(|track| &track.seen).map(|(at_ns, _)| *at_ns);
        Some((times().min()?, times().max()? + self.frame_ns))
    }

    /// Draws a lane for each hand and part from this height on; the height at which they end.
    pub(super) fn draw(&self, out: &mut String, names: &Names, axis: &Axis, mut y: f64) -> f64 {
        for track in &self.tracks {
            let name = match track.what {
                What::Frame => "frames".to_owned(),
                What::Hand(side) => format!("{} hand", side.name()),
                What::Part(id) => names.object(id),
            };
            text(out, LEFT - 10.0, y + LANE - 2.0, "end", "normal", &name);
            self.draw_track(out, track, &name, axis, y);
            for (began_ns, ended_ns) in self.handless.iter().filter(|when| self.has_moved(track, **when)) {
                let (x, end) = (axis.x(*began_ns), axis.x(*ended_ns));
                let tip = format!("{name}: {}", MOVED.1);
                rectangle(out, x, y + LANE, (end - x).max(NARROW), MARK, MOVED.0, &tip);
            }
            y += LANE + MARK + GAP;
        }
        y
    }

    fn draw_track(&self, out: &mut String, track: &Track, name: &str, axis: &Axis, y: f64) {
        let stretches = self.stretches(track, axis);
        let (mut seen_until, mut alone) = (f64::NEG_INFINITY, Vec::new());
        for (index, stretch) in stretches.iter().enumerate() {
            let (x, end) = (axis.x(stretch.began_ns), axis.x(stretch.ended_ns));
            let tip = format!("{name}: {}", stretch.look.1);
            rectangle(out, x, y, (end - x).max(1.0), LANE, stretch.look.0, &tip);
            if stretch.look != SEEN {
                continue;
            }
            let next = stretches[index + 1..].iter().find(|next| next.look == SEEN);
            let is_next_far = next.is_none_or(|next| axis.x(next.began_ns) - end > ALONE);
            if end - x < NARROW && x - seen_until > ALONE && is_next_far {
                alone.push((f64::midpoint(x, end), tip));
            }
            seen_until = end;
        }
        // Above the stretches beside them.
        alone.iter().for_each(|(x, tip)| dot(out, *x, y + LANE / 2.0, 4.5, SEEN.0, tip));
    }

    /// When it was seen, and what was taken of it meanwhile. A hand need not be in the picture; a part that is not seen is missed.
    fn stretches(&self, track: &Track, axis: &Axis) -> Vec<Stretch> {
        let (lost, blind_ns) = match track.what {
            What::Frame => (UNSEEN, 0),
            What::Hand(_) => (NO_HAND, self.blind_ns),
            What::Part(_) => (UNSEEN, self.blind_ns),
        };
        let mut stretches = Vec::new();
        let mut push = |look, began_ns: u64, ended_ns: u64| {
            if ended_ns > began_ns {
                stretches.push(Stretch { look, began_ns, ended_ns });
            }
        };
        // Where nothing has been seen before, nothing is assumed.
        let (mut known_until, mut seen_until) = (axis.began_ns, axis.began_ns);
        let is_next = |a: &(u64, Point), b: &(u64, Point)| b.0 - a.0 <= self.frame_ns + self.frame_ns / 2;
        for run in track.seen.chunk_by(is_next) {
            let (began_ns, ended_ns) = (run[0].0, run[run.len() - 1].0 + self.frame_ns);
            let assumed_until = known_until.clamp(seen_until, began_ns.max(seen_until));
            push(ASSUMED, seen_until, assumed_until);
            push(lost, assumed_until, began_ns);
            push(SEEN, began_ns, ended_ns);
            (seen_until, known_until) = (ended_ns, ended_ns + blind_ns);
        }
        let assumed_until = known_until.min(axis.ended_ns);
        push(ASSUMED, seen_until, assumed_until);
        push(lost, assumed_until.max(seen_until), axis.ended_ns);
        stretches
    }

    /// Whether this is what moved at that time: a part that lies elsewhere afterwards.
    fn has_moved(&self, track: &Track, (began_ns, ended_ns): (u64, u64)) -> bool {
        if !matches!(track.what, What::Part(_)) {
            return false;
        }
        // That a part moves is known only after it has moved for a while.
        let before = track.seen.iter().rev().find(|(at_ns, _)| at_ns + self.blind_ns < began_ns);
        let before = before.or(track.seen.first());
        let after = track.seen.iter().find(|(at_ns, _)| *at_ns >= ended_ns).or(track.seen.last());
        let Some(((_, from), (_, to))) = before.zip(after) else { return false };
        let squared: f32 = from.iter().zip(to).map(|(a, b)| (a - b) * (a - b)).sum();
        squared > MOVED_M * MOVED_M
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use andon_core::input::{Hand, Object};

    const FRAME_NS: u64 = 33_333_333;

    /// A recording of 90 frames, in which this hand and this part are seen where these say so.
    fn seen(hand: impl Fn(u64) -> bool, part_x: impl Fn(u64) -> Option<f32>) -> RecordedVisibility {
        let mut seen = RecordedVisibility::new(&[Side::Right], [6].into_iter(), FRAME_NS, 700_000_000);
        for number in 0..90 {
            let mut frame = Frame { captured_ns: number * FRAME_NS, ..Frame::default() };
            if hand(number) {
                let at = [0.0; 3];
                let hand =
                    Hand { side: Side::Right, score: 1.0, wrist: at, middle_knuckle: at, tips: [at; 3] };
                frame.hands.push(hand).unwrap();
            }
            if let Some(x) = part_x(number) {
                let object = Object { id: 6, position: [x, 0.0, 0.0], orientation: [1.0, 0.0, 0.0, 0.0] };
                frame.objects.push(object).unwrap();
            }
            seen.take(&frame);
        }
        seen
    }

    fn axis() -> Axis {
        Axis { began_ns: 0, ended_ns: 90 * FRAME_NS }
    }

    fn looks(seen: &RecordedVisibility, track: usize) -> Vec<&'static str> {
        seen.stretches(&seen.tracks[track], &axis()).iter().map(|stretch| stretch.look.1).collect()
    }

    #[test]
    fn what_is_hidden_is_assumed_for_a_while_and_then_unseen() {
        let seen =
            seen(|number| (30..40).contains(&number), |number| (!(30..=60).contains(&number)).then_some(0.0));
        assert_eq!(looks(&seen, 1), [NO_HAND.1, SEEN.1, ASSUMED.1, NO_HAND.1]);
        assert_eq!(looks(&seen, 2), [SEEN.1, ASSUMED.1, UNSEEN.1, SEEN.1]);
        assert_eq!(looks(&seen, 0), [SEEN.1]);
        let whole = seen.stretches(&seen.tracks[2], &axis());
        assert!(whole.windows(2).all(|pair| pair[0].ended_ns == pair[1].began_ns), "{whole:?}");
        assert_eq!((whole[0].began_ns, whole[3].ended_ns), (0, 90 * FRAME_NS));
    }

    #[test]
    fn what_is_seen_in_one_frame_only_is_drawn_as_a_dot() {
        let draw = |seen: &RecordedVisibility| {
            let mut out = String::new();
            let long = Axis { began_ns: 0, ended_ns: 900 * FRAME_NS };
            seen.draw(&mut out, &Names::new([(6, "brick".to_owned())]), &long, 0.0);
            out
        };
        assert_eq!(
            draw(&seen(|_| false, |number| (number == 45).then_some(0.0))).matches("<circle").count(),
            1
        );
        assert!(!draw(&seen(|_| false, |_| Some(0.0))).contains("<circle"));
    }

    #[test]
    fn a_part_that_moves_while_no_hand_is_seen_at_it_is_marked() {
        let mut seen = seen(|_| false, |number| Some(if number < 45 { 0.0 } else { 0.1 }));
        let mut out = String::new();
        seen.draw(&mut out, &Names::default(), &axis(), 0.0);
        assert!(!out.contains(MOVED.1), "{out}");
        (45..50).for_each(|number| seen.take_handless(number * FRAME_NS));
        seen.draw(&mut out, &Names::new([(6, "brick".to_owned())]), &axis(), 0.0);
        assert_eq!(out.matches(&format!("brick: {}", MOVED.1)).count(), 1, "{out}");
    }
}
