//! A job of two steps and a verdict on it, for the tests of what people read.

use std::net::{IpAddr, Ipv4Addr};

use shm_schemas::{Verdict, VerdictLevel, VerdictOutcome, VerdictReason};

use crate::board::Settings;
use crate::job::{Job, Step};

/// What a board is given.
pub(crate) fn settings() -> Settings {
    Settings::new("bench1", IpAddr::V4(Ipv4Addr::LOCALHOST), 9465)
}

/// Polish with the polisher (5) at the brick (6), then measure the brick at the meter (3).
pub(crate) fn job() -> Job {
    let step = |name: &str, contexts: &[[u16; 4]]| Step {
        name: name.to_owned(),
        contexts: contexts.to_vec(),
        picture: None,
    };
    Job {
        hash: 7,
        name: "polish and measure".to_owned(),
        parts: [(5, "polisher"), (6, "brick"), (3, "meter")].map(|(id, name)| (id, name.to_owned())).into(),
        steps: vec![
            step("polish", &[[1, 5, 0, 0], [1, 5, 5, 6], [1, 5, 0, 0]]),
            step("measure", &[[1, 6, 0, 0], [1, 6, 6, 3], [0, 0, 6, 3]]),
        ],
    }
}

/// An anomaly of the second IU of the first step.
pub(crate) fn wrong(reason: VerdictReason) -> Verdict {
    Verdict {
        level: VerdictLevel::Iu.code(),
        outcome: VerdictOutcome::Anomaly.code(),
        reason: reason.code(),
        model_hash: job().hash,
        nearest: 0,
        activity: 0,
        iu: 1,
        x_c: [1, 5, 5, 6],
        ..Verdict::NONE
    }
}

/// A verdict that is right.
pub(crate) fn right(level: VerdictLevel, nearest: u16) -> Verdict {
    Verdict { level: level.code(), outcome: VerdictOutcome::Ok.code(), nearest, ..wrong(VerdictReason::None) }
}
