//! What people say of verdicts: that they were right, or wrong.

use std::collections::HashMap;

use andon_http::Later;
use shm_schemas::MessageId;

use crate::address::Address;
use crate::board::Board;

/// Requests that wait for the line.
pub(crate) const WAITING: usize = 16;

/// What was said is kept for so many verdicts: the pages show fewer.
const MOST: usize = 4096;

/// What a person says of the work that a verdict is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Was {
    /// It was right.
    Right,
    /// It was wrong.
    Wrong,
}

impl Was {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Right, Self::Wrong];

    /// Its word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Wrong => "wrong",
        }
    }
}

/// What somebody asks the line to keep.
#[derive(Debug)]
pub struct Asked {
    /// The name of the login.
    pub login: String,
    /// The verdict.
    pub verdict: MessageId,
    /// What is said of it.
    pub was: Was,
    pub(crate) address: Address,
    pub(crate) later: Later,
}

/// What became of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// It is on disk.
    Kept,
    /// The journal has no such verdict, or not any more.
    Gone,
    /// The journal does not answer.
    Unkept,
}

/// What was said of each verdict last, and by whom.
#[derive(Debug, Default)]
pub(crate) struct Confirmations(HashMap<MessageId, (Was, String)>);

impl Confirmations {
    pub(crate) fn of(&self, verdict: MessageId) -> Option<(Was, &str)> {
        self.0.get(&verdict).map(|(was, who)| (*was, who.as_str()))
    }
}

impl Board {
    /// What somebody has said of a verdict.
    pub fn confirmed(&mut self, verdict: MessageId, was: Was, who: &str) {
        if self.confirmations.0.len() >= MOST {
            let shown: Vec<MessageId> = self.events.iter().map(|event| event.stamp.id()).collect();
            self.confirmations.0.retain(|id, _| shown.contains(id));
        }
        self.confirmations.0.insert(verdict, (was, who.to_owned()));
        self.version += 1;
        self.news += 1;
    }
}
