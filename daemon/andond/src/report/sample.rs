//! A job of two steps and a verdict on it, for the tests of what people read and see.

use andon_core::couple::Context;
use andon_core::input::Side;
use andon_core::verdict::{Level, Missing, Outcome, Reason, Verdict};

use super::Names;

const STEPS: [(&str, &[[u16; 4]]); 2] = [
    ("polish", &[[1, 5, 0, 0], [1, 5, 5, 6], [1, 5, 0, 0]]),
    ("measure", &[[1, 6, 0, 0], [1, 6, 6, 3], [0, 0, 6, 3]]),
];

/// The names of its parts and steps.
pub(crate) fn names() -> Names {
    let objects = [(5, "polisher"), (6, "brick"), (3, "meter")];
    Names::new(objects.map(|(id, name)| (id, name.to_owned()))).with_steps(&STEPS)
}

/// The second IU of the first step, and wrong.
pub(crate) fn wrong(reason: Reason) -> Verdict {
    Verdict {
        level: Level::Iu,
        outcome: Outcome::Anomaly,
        reason,
        side: Some(Side::Right),
        nearest: Some(0),
        activity: 0,
        iu: Some(1),
        context: Context([1, 5, 5, 6]),
        distance: None,
        threshold: None,
        captured_percent: None,
        seen_percent: None,
        missing: Missing::default(),
        measured: None,
        broken: None,
        note: None,
        early: false,
        began_ns: 0,
        ended_ns: 1_000_000_000,
        decided_ns: 1_250_000_000,
    }
}
