//! Markers that are in view twice: which of two is its object is not guessed, and what was not judged for that says so.

use super::Event;
use crate::capacity::TWINS;
use crate::verdict::{Missing, Outcome, Reason, Verdict};

/// When no marker was in view twice for so long, somebody has taken the other print away, in nanoseconds. Halved or doubled, 18 or 2 of 3,700 drawn
/// streams differ.
const REMOVED_NS: u64 = 2_000_000_000;

/// Of the time that an object was not seen, its marker was in view twice for this share, but for so many seconds. The share halved or doubled, 2 or 1 of
/// 3,700 drawn streams differ. Without the seconds two of the five tests of markers in view twice fail.
const MIN_TWICE_SHARE: f32 = 0.5;
const SLACK_S: f32 = 0.1;

/// The objects whose markers are or were in view twice.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Twice {
    twins: [Option<Twin>; TWINS],
}

/// An object whose marker is or was in view twice.
#[derive(Clone, Copy, Debug)]
struct Twin {
    object: u16,
    began_ns: u64,
    newest_ns: u64,
}

impl Twice {
    /// Takes the objects whose markers are in view twice at this time.
    pub(super) fn follow(&mut self, objects: impl Iterator<Item = u16>, now_ns: u64) {
        for object in objects {
            let new = Twin { object, began_ns: now_ns, newest_ns: now_ns };
            match self.twins.iter_mut().flatten().find(|twin| twin.object == object) {
                Some(twin) if now_ns.saturating_sub(twin.newest_ns) < REMOVED_NS => twin.newest_ns = now_ns,
                Some(twin) => *twin = new,
                None => self.add(new),
            }
        }
    }

    /// Adds one: where there is no place left, in that of the one that was not seen for longest.
    fn add(&mut self, new: Twin) {
        let place = self.twins.iter_mut().min_by_key(|place| place.map(|twin| twin.newest_ns));
        place.into_iter().for_each(|place| *place = Some(new));
    }

    /// The same event, with the marker in view twice as the reason where it is one. It is that of the missing object, or else the newest.
    pub(super) fn named(&self, event: Event) -> Event {
        let Event::Verdict(verdict) = event else { return event };
        let twins = self.twins.iter().flatten().filter(|twin| twin.explains(&verdict));
        let Some(twin) = twins.max_by_key(|twin| twin.began_ns) else { return event };
        let missing = Missing { object: Some(twin.object), ..verdict.missing };
        Event::Verdict(Verdict { reason: Reason::MarkerTwice, missing, ..verdict })
    }
}

impl Twin {
    fn explains(&self, verdict: &Verdict) -> bool {
        let is_meant = match verdict.reason {
            // Another cause may have hidden it for most of the time.
            Reason::ObjectNotSeen => {
                let is_it = verdict.missing.object.is_none_or(|object| object == self.object);
                let lasted_ns = self.newest_ns.saturating_sub(self.began_ns.max(verdict.began_ns));
                let unseen_s = verdict.missing.seconds.unwrap_or(0.0);
                is_it && lasted_ns as f32 / 1e9 + SLACK_S >= MIN_TWICE_SHARE * unseen_s
            }
            Reason::BeginningNotSeen => self.began_ns <= verdict.began_ns,
            Reason::Blind | Reason::Unknown => true,
            _ => false,
        };
        verdict.outcome == Outcome::NotJudged && is_meant && self.newest_ns >= verdict.began_ns
    }
}
