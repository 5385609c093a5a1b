//! IUs of which too little was seen. They are not learnt from: what is missing would become part of the reference.

use crate::run::{Iu, Run};
use crate::teach::sequence::Sequence;
use andon_core::couple::Context;

/// A demonstration of an IU that was not learnt from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Blind {
    /// The run's name.
    pub run: String,
    /// Index of the activity in the job, from 0.
    pub activity: u16,
    /// Index of the IU in the activity, from 0.
    pub iu: usize,
    /// The context of the IU.
    pub context: Context,
}

impl Sequence {
    /// All demonstrations of an IU, each with the index of its run.
    fn all_shown<'a>(&'a self, runs: &'a [Run], iu: usize) -> impl Iterator<Item = (usize, &'a Iu)> {
        self.shown.iter().filter_map(move |&(run, activity)| {
            let activity = &runs[run].activities[activity];
            Some((run, &activity.ius[*self.indices(activity).get(iu)?]))
        })
    }

    /// The demonstrations of an IU from which it can be learnt, each with the index of its run. A release state is judged by its context
    /// alone, so every one of them will do.
    pub(in crate::teach) fn well_shown<'a>(
        &'a self,
        runs: &'a [Run],
        iu: usize,
    ) -> impl Iterator<Item = (usize, &'a Iu)> {
        self.all_shown(runs, iu).filter(|(_, iu)| iu.is_well_seen || iu.context.is_release())
    }

    /// The demonstrations of an IU that are not learnt from.
    pub(in crate::teach) fn blind<'a>(
        &'a self,
        runs: &'a [Run],
        index: usize,
    ) -> impl Iterator<Item = Blind> {
        let blind = move |(run, iu): (usize, &Iu)| Blind {
            run: runs[run].name.clone(),
            activity: self.activity,
            iu: index,
            context: iu.context,
        };
        let is_blind = |(_, iu): &(usize, &Iu)| !iu.is_well_seen && !iu.context.is_release();
        self.all_shown(runs, index).filter(is_blind).map(blind)
    }
}
