//! What the line has lost sight of: a marker that stays hidden, or a hand that leaves the picture while it touches something. The log then
//! says, in a technician's words, why a step is not judged.

use std::time::Duration;

use andon_core::couple::{Context, Couple, Couples};
use andon_core::input::{Frame, Side};
use andon_host::config::Config;
use andon_host::log::{code, log};
use andon_ipc::SourceTime;

/// Arms cover a marker that no hand works with all the time, but none rests on it for this long.
const UNUSED: Duration = Duration::from_secs(10);

/// A change that a technician should know of.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Change {
    MarkerCovered { object: u16, hidden: Duration },
    MarkerNeverSeen { object: u16 },
    MarkerBack { object: u16 },
    HandLeft { side: Side, touched: u16 },
    HandBack { side: Side },
}

/// When something was last seen, and whether it is missed.
#[derive(Clone, Copy, Debug, Default)]
struct LastSeen {
    /// `None` before the first time.
    time: Option<SourceTime>,
    is_missed: bool,
}

impl LastSeen {
    /// How long it has not been seen; zero before the first time.
    fn hidden(&self, now: SourceTime) -> Duration {
        self.time.map_or(Duration::ZERO, |time| now.since(time))
    }

    /// Counts it as missed. Returns whether it was not before.
    fn becomes_missed(&mut self) -> bool {
        !std::mem::replace(&mut self.is_missed, true)
    }

    /// Whether it was missed and is seen now.
    fn is_back(&mut self, now: SourceTime) -> bool {
        self.time == Some(now) && std::mem::take(&mut self.is_missed)
    }
}

struct Object {
    id: u16,
    name: String,
    seen: LastSeen,
}

struct Hand {
    side: Side,
    seen: LastSeen,
    /// The object that it touched when it was last seen.
    touched: Option<u16>,
}

/// Follows what is seen.
pub(super) struct Visibility {
    /// `method.blind_ms`.
    blind: Duration,
    /// The time of the first frame.
    began: Option<SourceTime>,
    objects: Vec<Object>,
    hands: [Hand; 2],
}

impl Visibility {
    pub(super) fn new(config: &Config) -> Self {
        let object = |object: &andon_host::config::Object| Object {
            id: object.id,
            name: object.name.clone(),
            seen: LastSeen::default(),
        };
        Self {
            blind: Duration::from_millis(config.method.blind_ms.into()),
            began: None,
            objects: config.objects.iter().map(object).collect(),
            hands: Side::ALL.map(|side| Hand { side, seen: LastSeen::default(), touched: None }),
        }
    }

    /// Takes a frame and the couples that it led to, and logs what has changed.
    pub(super) fn look(&mut self, frame: &Frame, couples: &[Couples]) {
        for change in self.changes(frame, couples) {
            match change {
                Change::MarkerCovered { object, hidden } => {
                    let (name, hidden_s) = (self.name(object), hidden.as_secs_f64());
                    log!(
                        code::MARKER_COVERED,
                        { object },
                        "the marker of {name} has not been seen for {hidden_s:.1} s: its position was assumed so far, and is unknown now"
                    );
                }
                Change::MarkerNeverSeen { object } => log!(
                    code::MARKER_COVERED,
                    { object },
                    "the marker of {} has not been seen yet: until it is, nothing that needs it is accused; `andond look` shows what the camera sees",
                    self.name(object)
                ),
                Change::MarkerBack { object } => {
                    log!(code::MARKER_BACK, { object }, "the marker of {} is seen again", self.name(object));
                }
                Change::HandLeft { side, touched } => log!(
                    code::HAND_OUT_OF_VIEW,
                    "the {} hand is out of sight, and it touched {} when it was last seen: what it does is unknown",
                    side.name(),
                    self.name(touched)
                ),
                Change::HandBack { side } => {
                    log!(code::HAND_BACK, "the {} hand is seen again", side.name());
                }
            }
        }
    }

    fn name(&self, id: u16) -> String {
        let object = self.objects.iter().find(|object| object.id == id);
        object.map_or_else(|| format!("object {id}"), |object| format!("{} ({id})", object.name))
    }

    fn changes(&mut self, frame: &Frame, couples: &[Couples]) -> Vec<Change> {
        let now = SourceTime::from_nanoseconds(frame.captured_ns);
        let watched = now.since(*self.began.get_or_insert(now));
        let newest = Newest { now, watched, blind: self.blind, frame, couples };
        let objects = self.objects.iter_mut().filter_map(|object| object.change(&newest));
        objects.chain(self.hands.iter_mut().filter_map(|hand| hand.change(&newest))).collect()
    }
}

/// What there is to see at one time.
struct Newest<'a> {
    now: SourceTime,
    /// Since the first frame.
    watched: Duration,
    blind: Duration,
    frame: &'a Frame,
    couples: &'a [Couples],
}

impl Newest<'_> {
    /// Whether a hand works with the object.
    fn is_touched(&self, object: u16) -> bool {
        let has = |couple: &Couple| couple.context.0[1] == object || couple.context.0[3] == object;
        self.couples.iter().flat_map(|couples| &couples.hands).any(has)
    }
}

impl Object {
    fn change(&mut self, newest: &Newest<'_>) -> Option<Change> {
        let object = self.id;
        if newest.frame.objects.iter().any(|seen| seen.id == object) {
            self.seen.time = Some(newest.now);
        }
        if self.seen.time.is_none() {
            let is_missed = newest.watched > UNUSED && self.seen.becomes_missed();
            return is_missed.then_some(Change::MarkerNeverSeen { object });
        }
        let hidden = self.seen.hidden(newest.now);
        let is_missed = hidden > UNUSED || hidden > newest.blind && newest.is_touched(object);
        if self.seen.is_back(newest.now) {
            Some(Change::MarkerBack { object })
        } else {
            (is_missed && self.seen.becomes_missed()).then_some(Change::MarkerCovered { object, hidden })
        }
    }
}

impl Hand {
    fn change(&mut self, newest: &Newest<'_>) -> Option<Change> {
        let side = self.side;
        if newest.frame.hands.iter().any(|hand| hand.side == side) {
            self.seen.time = Some(newest.now);
        }
        let mut own = newest.couples.iter().map(|couples| &couples.hands[side.index()]);
        if let Some(couple) = own.rfind(|couple| couple.is_hand_seen()) {
            self.touched = touched(couple.context);
        }
        if self.seen.is_back(newest.now) {
            return Some(Change::HandBack { side });
        }
        let touched = self.touched.filter(|_| self.seen.hidden(newest.now) > newest.blind)?;
        self.seen.becomes_missed().then_some(Change::HandLeft { side, touched })
    }
}

fn touched(context: Context) -> Option<u16> {
    context.is_touch().then_some(context.0[1])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use andon_core::capacity::OBJECTS;
    use andon_core::couple::{self, Unseen};
    use andon_core::input;
    use andon_core::set::ObjectSet;

    const S: u64 = 1_000_000_000;

    fn both(at_ns: u64, left: Couple) -> Couples {
        Couples {
            captured_ns: at_ns,
            known_ns: at_ns,
            unseen: Unseen::EMPTY,
            objects: [0; OBJECTS],
            at_start: ObjectSet::EMPTY,
            out_of_sight: ObjectSet::EMPTY,
            twice: ObjectSet::EMPTY,
            hands: [Couple::idle(Side::Right, at_ns), left],
        }
    }

    fn visibility() -> Visibility {
        let object =
            andon_host::config::Object { id: 5, name: "cup".into(), ..andon_host::config::Object::default() };
        let config = Config { objects: vec![object], ..Config::default() };
        let visibility = Visibility::new(&config);
        assert!(visibility.blind < Duration::from_secs(1), "the times below are longer than that");
        visibility
    }

    fn frame(at_ns: u64, object: bool, hand: bool) -> Frame {
        let mut frame = Frame { captured_ns: at_ns, ..Frame::default() };
        if object {
            let pose = input::Object { id: 5, position: [0.0; 3], orientation: [1.0, 0.0, 0.0, 0.0] };
            frame.objects.push(pose).unwrap();
        }
        if hand {
            let zero = [0.0; 3];
            let (side, score, tips) = (Side::Left, 1.0, [zero; 3]);
            let hand = input::Hand { side, score, wrist: zero, middle_knuckle: zero, tips };
            frame.hands.push(hand).unwrap();
        }
        frame
    }

    /// The left hand touches the cup.
    fn touch(at_ns: u64) -> [Couples; 1] {
        let left = Couple { context: Context([2, 5, 0, 0]), ..Couple::idle(Side::Left, at_ns) };
        [both(at_ns, left)]
    }

    #[test]
    fn a_marker_that_is_hidden_while_a_hand_works_with_it_is_reported_once_and_so_is_its_return() {
        let mut visibility = visibility();
        assert_eq!(visibility.changes(&frame(0, true, true), &touch(0)), []);
        assert_eq!(visibility.changes(&frame(S / 100, false, true), &touch(0)), [], "a moment is normal");
        let covered = Change::MarkerCovered { object: 5, hidden: Duration::from_secs(1) };
        assert_eq!(visibility.changes(&frame(S, false, true), &touch(S)), [covered]);
        assert_eq!(visibility.changes(&frame(2 * S, false, true), &touch(2 * S)), []);
        assert_eq!(
            visibility.changes(&frame(3 * S, true, true), &touch(3 * S)),
            [Change::MarkerBack { object: 5 }]
        );
        assert_eq!(visibility.changes(&frame(4 * S, true, true), &touch(4 * S)), []);
    }

    #[test]
    fn a_marker_that_nobody_works_with_is_reported_only_when_it_stays_hidden() {
        let mut visibility = visibility();
        assert_eq!(visibility.changes(&frame(0, true, false), &[]), []);
        assert_eq!(visibility.changes(&frame(9 * S, false, false), &[]), [], "an arm over it");
        let covered = Change::MarkerCovered { object: 5, hidden: Duration::from_secs(11) };
        assert_eq!(visibility.changes(&frame(11 * S, false, false), &[]), [covered]);
    }

    #[test]
    fn a_marker_that_was_never_seen_is_reported_once() {
        let mut visibility = visibility();
        assert_eq!(visibility.changes(&frame(0, false, false), &touch(0)), []);
        assert_eq!(visibility.changes(&frame(9 * S, false, false), &[]), [], "it may still be brought");
        let never = Change::MarkerNeverSeen { object: 5 };
        assert_eq!(visibility.changes(&frame(11 * S, false, false), &[]), [never]);
        assert_eq!(visibility.changes(&frame(22 * S, false, false), &[]), []);
        assert_eq!(visibility.changes(&frame(23 * S, true, false), &[]), [Change::MarkerBack { object: 5 }]);
    }

    /// The left hand touches this object; 0 is none.
    fn left(at_ns: u64, seen: bool, object: u16) -> [Couples; 1] {
        let context = if object == 0 { Context::IDLE } else { Context([2, object, 0, 0]) };
        let hand = if seen { couple::Visibility::Seen } else { couple::Visibility::Unseen };
        let visibility = [hand, couple::Visibility::Seen, couple::Visibility::Seen];
        let left = Couple { context, visibility, ..Couple::idle(Side::Left, at_ns) };
        [both(at_ns, left)]
    }

    #[test]
    fn a_hand_that_leaves_with_something_is_reported_once_and_so_is_its_return() {
        let mut visibility = visibility();
        assert_eq!(visibility.changes(&frame(0, true, true), &left(0, true, 5)), []);
        // The object stays in view without the hand, so the contact ends.
        assert_eq!(visibility.changes(&frame(S / 100, true, false), &left(S / 100, false, 0)), []);
        let gone = Change::HandLeft { side: Side::Left, touched: 5 };
        assert_eq!(visibility.changes(&frame(S, true, false), &left(S, false, 0)), [gone]);
        assert_eq!(visibility.changes(&frame(2 * S, true, false), &left(2 * S, false, 0)), []);
        let back = Change::HandBack { side: Side::Left };
        assert_eq!(visibility.changes(&frame(3 * S, true, true), &left(3 * S, true, 0)), [back]);
    }

    #[test]
    fn a_hand_that_has_let_go_may_leave() {
        let mut visibility = visibility();
        assert_eq!(visibility.changes(&frame(0, true, true), &left(0, true, 5)), []);
        assert_eq!(visibility.changes(&frame(S / 100, true, true), &left(S / 100, true, 0)), []);
        assert_eq!(visibility.changes(&frame(9 * S, true, false), &left(9 * S, false, 0)), []);
    }
}
