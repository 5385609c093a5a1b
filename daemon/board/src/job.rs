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
    /// What it looks like, as JPEG.
    pub picture: Option<Vec<u8>>,
}

impl Job {
    pub(crate) fn step(&self, number: u16) -> Option<&Step> {
        self.steps.get(usize::from(number))
    }

    /// Where the picture of a step is. Another job has other addresses.
    pub(crate) fn picture_of(&self, number: u16) -> String {
        format!("/step/{:016x}-{}.jpg", self.hash, u32::from(number) + 1)
    }

    /// The picture at this address.
    pub(crate) fn picture_at(&self, path: &str) -> Option<&[u8]> {
        let mut steps = (0..).zip(&self.steps);
        steps.find(|(number, _)| self.picture_of(*number) == path)?.1.picture.as_deref()
    }

    pub(crate) fn part(&self, id: u16) -> String {
        self.parts.get(&id).cloned().unwrap_or_else(|| id.to_string())
    }
}
