//! What the line has lost sight of: markers that stay hidden, and a hand that leaves the picture with work in it. It
//! explains, in a technician's words, why steps are then not judged.

use andon_core::couple::{Context, Couples};
use andon_core::input::{Frame, Side};

use crate::config::Config;
use crate::log::{code, log};

/// A marker that no hand works with is covered by arms all the time. None rests on it for so long.
const UNUSED_NS: u64 = 10_000_000_000;

/// What a technician should know.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Change {
    Covered { id: u16, hidden_s: f64 },
    Uncovered { id: u16 },
    HandLeft { side: Side, object: u16 },
    HandBack { side: Side },
}

/// When something was last seen, in nanoseconds of the source; `None` before the first time.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    newest_ns: Option<u64>,
    missed: bool,
}

impl Seen {
    fn note(&mut self, now_ns: u64) {
        self.newest_ns = Some(now_ns);
    }

    fn hidden_ns(&self, now_ns: u64) -> u64 {
        self.newest_ns.map_or(0, |newest_ns| now_ns.saturating_sub(newest_ns))
    }

    /// Whether it is missed from now on, which is told once.
    fn begins_to_be_missed(&mut self, is_missed: bool) -> bool {
        is_missed && !std::mem::replace(&mut self.missed, true)
    }

    /// Whether it was missed and is there again.
    fn is_back(&mut self, now_ns: u64) -> bool {
        self.hidden_ns(now_ns) == 0 && std::mem::take(&mut self.missed)
    }
}

/// Follows what is seen.
pub(super) struct Visibility {
    blind_ns: u64,
    objects: Vec<(u16, String, Seen)>,
    /// And what the hand touched when it was last seen.
    hands: [(Side, Seen, Option<u16>); 2],
}

impl Visibility {
    pub(super) fn new(config: &Config) -> Self {
        let object = |object: &crate::config::Object| (object.id, object.name.clone(), Seen::default());
        Self {
            blind_ns: u64::from(config.method.blind_ms) * 1_000_000,
            objects: config.objects.iter().map(object).collect(),
            hands: Side::ALL.map(|side| (side, Seen::default(), None)),
        }
    }

    /// Takes a frame and the couples that it gave, and logs what has changed.
    pub(super) fn look(&mut self, frame: &Frame, couples: &[Couples]) {
        for change in self.changes(frame, couples) {
            match change {
                Change::Covered { id, hidden_s } => {
                    let name = self.name(id);
                    log!(
                        code::MARKER_COVERED,
                        { object = id },
                        "the marker of {name} has not been seen for {hidden_s:.1} s"
                    );
                }
                Change::Uncovered { id } => {
                    let name = self.name(id);
                    log!(code::MARKER_BACK, { object = id }, "the marker of {name} is seen again");
                }
                Change::HandLeft { side, object } => {
                    let name = self.name(object);
                    log!(
                        code::HAND_OUT_OF_VIEW,
                        "the {} hand is out of sight and had touched {name}",
                        side.name()
                    );
                }
                Change::HandBack { side } => {
                    log!(code::HAND_BACK, "the {} hand is seen again", side.name());
                }
            }
        }
    }

    fn name(&self, id: u16) -> String {
        let found = self.objects.iter().find(|(object, ..)| *object == id);
        found.map_or_else(|| format!("object {id}"), |(_, name, _)| format!("{name} ({id})"))
    }

    fn changes(&mut self, frame: &Frame, couples: &[Couples]) -> Vec<Change> {
        let now_ns = frame.captured_ns;
        let mut changes = Vec::new();
        let touched = |id: u16| {
            let holds = |context: Context| context.0[1] == id || context.0[3] == id;
            couples.iter().flat_map(|couples| &couples.hands).any(|couple| holds(couple.context))
        };
        for (id, _, seen) in &mut self.objects {
            if frame.objects.iter().any(|object| object.id == *id) {
                seen.note(now_ns);
            }
            let hidden_ns = seen.hidden_ns(now_ns);
            let is_missed = hidden_ns > UNUSED_NS || hidden_ns > self.blind_ns && touched(*id);
            if seen.is_back(now_ns) {
                changes.push(Change::Uncovered { id: *id });
            } else if seen.begins_to_be_missed(is_missed) {
                changes.push(Change::Covered { id: *id, hidden_s: hidden_ns as f64 / 1e9 });
            }
        }
        for (side, seen, held) in &mut self.hands {
            if frame.hands.iter().any(|hand| hand.side == *side) {
                seen.note(now_ns);
            }
            for couple in couples
                .iter()
                .map(|couples| &couples.hands[side.index()])
                .filter(|couple| couple.is_hand_seen())
            {
                *held = Some(couple.context).filter(|context| context.is_touch()).map(|context| context.0[1]);
            }
            let object = held.filter(|_| seen.hidden_ns(now_ns) > self.blind_ns);
            if seen.is_back(now_ns) {
                changes.push(Change::HandBack { side: *side });
            } else if seen.begins_to_be_missed(object.is_some())
                && let Some(object) = object
            {
                changes.push(Change::HandLeft { side: *side, object });
            }
        }
        changes
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use andon_core::couple::{Couple, Sight};
    use andon_core::input::{Hand, Object};

    const S: u64 = 1_000_000_000;

    fn both(at_ns: u64, left: Couple) -> Couples {
        Couples {
            captured_ns: at_ns,
            known_ns: at_ns,
            is_captured: true,
            has_moved_unseen: false,
            hands: [Couple::idle(Side::Right, at_ns), left],
        }
    }

    fn visibility() -> Visibility {
        let object = crate::config::Object { id: 5, name: "cup".into(), ..crate::config::Object::default() };
        let config = Config { objects: vec![object], ..Config::default() };
        assert!(u64::from(config.method.blind_ms) * 1_000_000 < S, "the times below are longer than that");
        Visibility::new(&config)
    }

    fn frame(at_ns: u64, object: bool, hand: bool) -> Frame {
        let mut frame = Frame { captured_ns: at_ns, ..Frame::default() };
        if object {
            let pose = Object { id: 5, position: [0.0; 3], orientation: [1.0, 0.0, 0.0, 0.0] };
            frame.objects.push(pose).unwrap();
        }
        if hand {
            let zero = [0.0; 3];
            let hand =
                Hand { side: Side::Left, score: 1.0, wrist: zero, middle_knuckle: zero, tips: [zero; 3] };
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
    fn a_marker_that_is_hidden_while_a_hand_works_with_it_is_told_once_and_so_is_its_return() {
        let mut visibility = visibility();
        assert_eq!(visibility.changes(&frame(0, true, true), &touch(0)), []);
        assert_eq!(visibility.changes(&frame(S / 100, false, true), &touch(0)), [], "a moment is normal");
        let covered = Change::Covered { id: 5, hidden_s: 1.0 };
        assert_eq!(visibility.changes(&frame(S, false, true), &touch(S)), [covered]);
        assert_eq!(visibility.changes(&frame(2 * S, false, true), &touch(2 * S)), []);
        assert_eq!(
            visibility.changes(&frame(3 * S, true, true), &touch(3 * S)),
            [Change::Uncovered { id: 5 }]
        );
        assert_eq!(visibility.changes(&frame(4 * S, true, true), &touch(4 * S)), []);
    }

    #[test]
    fn a_marker_that_nobody_works_with_is_told_only_when_it_stays_hidden() {
        let mut visibility = visibility();
        assert_eq!(visibility.changes(&frame(0, true, false), &[]), []);
        assert_eq!(visibility.changes(&frame(9 * S, false, false), &[]), [], "an arm over it");
        let covered = Change::Covered { id: 5, hidden_s: 11.0 };
        assert_eq!(visibility.changes(&frame(11 * S, false, false), &[]), [covered]);
    }

    #[test]
    fn what_was_never_there_is_not_missed() {
        assert_eq!(visibility().changes(&frame(99 * S, false, false), &touch(S)), []);
    }

    /// The left hand, seen, touches this object, or nothing where it is 0.
    fn left(at_ns: u64, seen: bool, object: u16) -> [Couples; 1] {
        let context = if object == 0 { Context::IDLE } else { Context([2, object, 0, 0]) };
        let hand = if seen { Sight::Seen } else { Sight::Unseen };
        let sight = [hand, Sight::Seen, Sight::Seen];
        let left = Couple { context, sight, ..Couple::idle(Side::Left, at_ns) };
        [both(at_ns, left)]
    }

    #[test]
    fn a_hand_that_leaves_with_something_is_told_once_and_so_is_its_return() {
        let mut visibility = visibility();
        assert_eq!(visibility.changes(&frame(0, true, true), &left(0, true, 5)), []);
        // What it carried is seen to go, so the contact ends.
        assert_eq!(visibility.changes(&frame(S / 100, true, false), &left(S / 100, false, 0)), []);
        let gone = Change::HandLeft { side: Side::Left, object: 5 };
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
