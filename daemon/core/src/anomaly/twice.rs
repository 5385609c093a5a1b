//! A marker that is in view twice: which of the two is its object is not guessed, and what was not judged for that says so.

use super::Event;
use crate::verdict::{Missing, Outcome, Reason, Verdict};

/// When no marker was in view twice for so long, somebody has taken the other print away, in nanoseconds.
const GONE_NS: u64 = 2_000_000_000;

/// Of the time that an object was not seen, its marker was in view twice for this share, but for a few frames, in seconds.
const SHARE: f32 = 0.5;
const SLACK_S: f32 = 0.1;

/// The object whose marker was in view twice last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Twice {
    object: u16,
    began_ns: u64,
    newest_ns: u64,
}

impl Twice {
    /// Takes what the couples of this time say; `object` is 0 where no marker is in view twice.
    pub(super) fn follow(before: Option<Self>, object: u16, now_ns: u64) -> Option<Self> {
        match before {
            _ if object == 0 => before,
            Some(before) if before.object == object && now_ns.saturating_sub(before.newest_ns) < GONE_NS => {
                Some(Self { newest_ns: now_ns, ..before })
            }
            _ => Some(Self { object, began_ns: now_ns, newest_ns: now_ns }),
        }
    }

    /// The same event, with this as the reason of a verdict that was not given because of it.
    pub(super) fn named(twice: Option<Self>, event: Event) -> Event {
        match (event, twice) {
            (Event::Verdict(verdict), Some(twice)) if twice.explains(&verdict) => Event::Verdict(Verdict {
                reason: Reason::MarkerTwice,
                missing: Missing { object: Some(twice.object), ..verdict.missing },
                ..verdict
            }),
            (event, _) => event,
        }
    }

    fn explains(&self, verdict: &Verdict) -> bool {
        let is_meant = match verdict.reason {
            // Another cause may have hidden it for most of the time.
            Reason::ObjectNotSeen => {
                let is_it = verdict.missing.object.is_none_or(|object| object == self.object);
                let lasted_ns = self.newest_ns.saturating_sub(self.began_ns.max(verdict.began_ns));
                let unseen_s = verdict.missing.seconds.unwrap_or(0.0);
                is_it && lasted_ns as f32 / 1e9 + SLACK_S >= SHARE * unseen_s
            }
            Reason::BeginningNotSeen => self.began_ns <= verdict.began_ns,
            Reason::Blind | Reason::Unknown => true,
            _ => false,
        };
        verdict.outcome == Outcome::NotJudged && is_meant && self.newest_ns >= verdict.began_ns
    }
}
