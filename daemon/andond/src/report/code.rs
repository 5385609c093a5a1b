//! The code of the log that belongs to a verdict: the same in the log of `judge` and on the board.

use andon_core::verdict::{Level, Outcome, Reason, Verdict};
use andon_host::log::{Code, code};

/// The code, if it is one that a technician reads of: right contacts and steps are none of that.
pub(crate) fn code_of(verdict: &Verdict) -> Option<&'static Code> {
    match (verdict.outcome, verdict.level) {
        (Outcome::Ok, Level::Job) => Some(&code::JOB_OK),
        (Outcome::Ok, Level::Activity) if verdict.note.is_some() => Some(&code::NOTE),
        (Outcome::Ok, Level::Iu | Level::Activity) => None,
        (Outcome::Anomaly, Level::Job) => Some(&code::JOB_ANOMALY),
        (Outcome::Anomaly, Level::Iu | Level::Activity) => Some(&code::ACTIVITY_ANOMALY),
        (Outcome::NotJudged, _) => match verdict.reason {
            Reason::Overload | Reason::FramesMissing | Reason::TooFewFrames => Some(&code::OVERLOAD),
            _ => Some(&code::NOT_JUDGED),
        },
    }
}
