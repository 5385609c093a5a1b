//! Which IUs of a folder are compared.

use crate::folder::Labelled;
use andon_core::couple::Context;
use andon_learn::job_file::context_words;
use andon_learn::recording::object_name;
use andon_learn::run::{Iu, Run};
use std::collections::BTreeMap;

/// The six representative IUs of the paper's first experiment (IV-A): label, name of the runs, index of the IU in the activity.
const OF_PAPER: [(&str, &str, usize); 6] = [
    ("grasp the profile", "measuring", 0),
    ("put the profile in the box", "boxing", 1),
    ("put the profile at the meter", "measuring", 1),
    ("assemble profile and corner", "assembly", 1),
    ("disassemble profile and corner", "disassembly", 0),
    ("polish the brick", "polishing", 1),
];

/// One kind of IU, found by its position in the runs of one name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kind {
    /// The name that people use for it.
    pub label: String,
    /// The runs that have it, by the middle part of their names.
    pub what: String,
    /// Index of the activity in the run, from 0.
    pub activity: usize,
    /// Index of the IU in the activity, from 0.
    pub iu: usize,
    /// The context that it must have; `None` if it may have any.
    pub context: Option<Context>,
}

impl Kind {
    /// The kinds of a folder. The paper's six if their activities are there, else every IU with a hand in the most common sequence of contexts of
    /// each name.
    pub fn of(all: &[Labelled]) -> Vec<Self> {
        let has = |what: &str| all.iter().any(|one| one.what == what);
        if OF_PAPER.iter().all(|(_, what, _)| has(what)) { Self::of_paper() } else { Self::of_names(all) }
    }

    /// The paper's six.
    pub fn of_paper() -> Vec<Self> {
        let kind = |(label, what, iu): (&str, &str, usize)| Self {
            label: label.to_owned(),
            what: what.to_owned(),
            activity: 0,
            iu,
            context: None,
        };
        OF_PAPER.into_iter().map(kind).collect()
    }

    fn of_names(all: &[Labelled]) -> Vec<Self> {
        let mut names: BTreeMap<&str, Vec<&Run>> = BTreeMap::new();
        for one in all {
            names.entry(&one.what).or_default().push(&one.run);
        }
        let has_several_names = names.len() > 1;
        let mut kinds = Vec::new();
        for (what, runs) in names {
            for (activity, iu, context) in most_common(&runs) {
                let words = context_words(context, |id| object_name(&runs[0].objects, id));
                let label = if has_several_names { format!("{what}: {words}") } else { words };
                kinds.push(Self { label, what: what.to_owned(), activity, iu, context: Some(context) });
            }
        }
        kinds
    }

    /// The IU of this kind in a run, if the run has one.
    pub fn find<'a>(&self, run: &'a Run) -> Option<&'a Iu> {
        let iu = run.activities.get(self.activity)?.ius.get(self.iu)?;
        let fits = self.context.is_none_or(|context| iu.context == context) && iu.context.is_touch();
        fits.then_some(iu)
    }
}

/// The IUs with a hand in the most common sequence of contexts. Each is the index of the activity, the index of the IU in it, and the context. Ties
/// go to the last sequence in the order of contexts.
fn most_common(runs: &[&Run]) -> Vec<(usize, usize, Context)> {
    let sequence =
        |run: &Run| -> Vec<Vec<Context>> { run.activities.iter().map(|one| one.contexts()).collect() };
    let mut counts: BTreeMap<Vec<Vec<Context>>, usize> = BTreeMap::new();
    for run in runs {
        *counts.entry(sequence(run)).or_default() += 1;
    }
    let common = counts.into_iter().max_by_key(|(_, count)| *count).map(|(sequence, _)| sequence);
    let ius = |(activity, contexts): (usize, Vec<Context>)| {
        contexts.into_iter().enumerate().map(move |(iu, context)| (activity, iu, context))
    };
    let all = common.into_iter().flatten().enumerate().flat_map(ius);
    all.filter(|(_, _, context)| context.is_touch()).collect()
}
