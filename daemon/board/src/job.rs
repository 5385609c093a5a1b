//! The job in force, as far as people are told of it.

use std::collections::HashMap;

/// A job: its name, what its parts are called, and its steps in their order. Without a job, only the parts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Job {
    /// Its hash, which verdicts have; 0 where there is none.
    pub hash: u64,
    /// Its name.
    pub name: String,
    /// The names of the parts, by their ids.
    pub parts: HashMap<u16, String>,
    /// The steps.
    pub steps: Vec<Step>,
}

/// A step of a job.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Step {
    /// Its name.
    pub name: String,
    /// The contexts of its IUs, as most runs have them.
    pub contexts: Vec<[u16; 4]>,
}

impl Job {
    pub(crate) fn step(&self, number: u16) -> Option<&Step> {
        self.steps.get(usize::from(number))
    }

    pub(crate) fn part(&self, id: u16) -> String {
        self.parts.get(&id).cloned().unwrap_or_else(|| id.to_string())
    }
}
