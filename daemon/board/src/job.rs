//! The job in force, as far as people are told of it.

use std::collections::HashMap;

use shm_schemas::HandCode;

use crate::words::Table;

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
    /// The name that a person has given it; empty where nobody has.
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

    /// What a step is called: as a person has named it, or else by what is done with which parts.
    pub(crate) fn step_name(&self, number: u16, words: &Table) -> Option<String> {
        let step = self.step(number)?;
        Some(if step.name.is_empty() { self.proposed_name(step, number, words) } else { step.name.clone() })
    }

    fn proposed_name(&self, step: &Step, number: u16, words: &Table) -> String {
        let Some(&[hand, part, ..]) = step.contexts.first() else {
            return words.fill("label.step", &[("number", &(u32::from(number) + 1).to_string())]);
        };
        let mut others: Vec<String> = Vec::new();
        for &[_, _, _, other] in step.contexts.iter().filter(|context| context[0] != 0 && context[3] != 0) {
            let other = self.part(other);
            if !others.contains(&other) {
                others.push(other);
            }
        }
        let key = if others.is_empty() { "context.in_hand" } else { "context.at" };
        let values = [("part", self.part(part)), ("other", others.join(words.say("label.comma")))];
        let what = words.fill(key, &values.each_ref().map(|(name, value)| (*name, value.as_str())));
        let hands = self.steps.iter().filter_map(|step| step.contexts.first());
        match hands.map(|context| context[0]).any(|other| other != hand) {
            true => words.fill(hand_key(hand), &[("what", &what)]),
            false => what,
        }
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

/// The key of what is done with a hand.
pub(crate) const fn hand_key(hand: u16) -> &'static str {
    if hand == HandCode::Left.code() as u16 { "context.left" } else { "context.right" }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::sample;
    use crate::words::Tables;

    #[test]
    fn a_step_that_nobody_has_named_is_called_in_the_language_of_the_page_by_what_is_done_with_which_parts() {
        let (tables, mut job) = (Tables::shipped(), sample::job());
        let named = |job: &Job, code| job.step_name(0, tables.get(code).unwrap()).unwrap();
        assert_eq!(named(&job, "de"), "polish");
        job.steps.iter_mut().for_each(|step| step.name.clear());
        assert_eq!(named(&job, "en"), "polisher at brick");
        assert_eq!(named(&job, "es"), "polisher en brick");
        // Where both hands have steps, the hand is said.
        job.steps[1].contexts[0][0] = 2;
        assert_eq!(named(&job, "de"), "polisher an brick, rechte Hand");
        job.steps[0].contexts = vec![[2, 5, 0, 0]];
        job.steps[1].contexts[0][0] = 1;
        assert_eq!(named(&job, "fr"), "polisher en main, main gauche");
        job.steps[0].contexts.clear();
        assert_eq!((named(&job, "zh").as_str(), job.step_name(2, tables.english())), ("步骤 1", None));
    }
}
