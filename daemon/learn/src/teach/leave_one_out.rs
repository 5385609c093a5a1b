//! Leaving one run out decides what is law. Every run that is shown is right, so a job accepts each run that it was not taught by, if the others
//! taught it. Whatever rule rejects a run that was left out is made weaker until it does not, or is no law. It holds for pairs, sequences, what is
//! required, order, measures and motions alike.
//!
//! The job of the others is taught from the beginning, with where they meet and which pairs count for them. Its verdicts name the rules that are
//! broken ([`Rule::broken_by`]). The first one is weakened in the jobs of all others as well, until no run breaks a rule that can be made weaker. Who asks
//! for a stricter job lets one run, or any number of them, contradict a rule that stays.
//!
//! Of 30 right runs of simulated work by feel 9 were accepted and 21 accused without this. With it 26 are accepted and 3 accused.

use super::sequence::MIN_ALIKE;
use super::strength::{Rule, Strength, Strengths};
use super::threshold::Memory;
use super::{TeachOptions, TeachReport, Teaching};
use crate::distribution::Distribution;
use crate::run::Run;
use andon_core::verdict::Outcome;
use rayon::prelude::*;
use std::collections::BTreeMap;

#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct LeftOut {
    /// How much is left of each rule.
    pub(super) strengths: Strengths,
    /// The names of the runs that the others reject while all rules are as strong as in general.
    pub(super) rejected_before: Vec<String>,
    /// The names of those that they reject although nothing more can be made weaker.
    pub(super) rejected: Vec<String>,
    /// Where a run that was left out lay among the others in what rejected it first, by the rule and its name.
    pub(super) shown: BTreeMap<(Rule, String), Distribution>,
}

struct Fold<'a> {
    left_out: &'a Run,
    others: Teaching<'a>,
}

struct Rejection {
    name: String,
    /// The first rule that it breaks of those that can be made weaker, with where it lies. Later differences may follow from it. A run that has a
    /// step, with one contact more, does not show that it can be left out. `None` if the others teach no job, or it does something else that they do
    /// not know.
    broken: Option<(Rule, Option<Distribution>)>,
}

/// Tries each of these runs with the job that the others teach; `None` of fewer than [`MIN_ALIKE`].
pub(super) fn tried(runs: &[&Run], options: &TeachOptions) -> Option<LeftOut> {
    if runs.len() < MIN_ALIKE {
        return None;
    }
    let made: Vec<Option<Fold<'_>>> =
        (0..runs.len()).into_par_iter().map(|index| Fold::new(runs, index, options)).collect();
    let untaught: Vec<String> =
        made.iter().zip(runs).filter(|(fold, _)| fold.is_none()).map(|(_, run)| run.name.clone()).collect();
    let mut folds: Vec<Fold<'_>> = made.into_iter().flatten().collect();
    let mut strengths = Strengths::default();
    let mut rejected_before = None;
    let mut shown = BTreeMap::new();
    loop {
        let rejections: Vec<Rejection> =
            folds.par_iter_mut().filter_map(|fold| fold.rejection(&strengths)).collect();
        let names: Vec<String> = rejections
            .iter()
            .map(|rejection| rejection.name.clone())
            .chain(untaught.iter().cloned())
            .collect();
        rejected_before.get_or_insert_with(|| names.clone());
        let mut contradicted: BTreeMap<Rule, usize> = BTreeMap::new();
        for Rejection { name, broken } in rejections {
            let Some((rule, lies)) = broken else { continue };
            *contradicted.entry(rule).or_default() += 1;
            if let Some(lies) = lies {
                shown.entry((rule, name)).or_insert(lies);
            }
        }
        contradicted.retain(|_, runs| *runs >= options.strictness.contradictions());
        let weaker = contradicted.into_keys().filter(|rule| strengths.weaken(*rule)).count();
        if weaker == 0 {
            return Some(LeftOut {
                strengths,
                rejected_before: rejected_before.unwrap_or_default(),
                rejected: names,
                shown,
            });
        }
    }
}

impl<'a> Fold<'a> {
    /// `None` if nothing can be learnt of how the others meet.
    fn new(runs: &[&'a Run], index: usize, options: &'a TeachOptions) -> Option<Self> {
        let others = runs.iter().enumerate().filter(|(other, _)| *other != index);
        let mut others = Teaching::new(others.map(|(_, run)| (*run).clone()).collect(), options);
        others.find_contacts().ok()?;
        Some(Self { left_out: runs[index], others })
    }

    /// What rejects the run that was left out, if anything does.
    fn rejection(&mut self, strengths: &Strengths) -> Option<Rejection> {
        let name = self.left_out.name.clone();
        let before = std::mem::take(&mut self.others.agreement.sequences);
        self.others.strengths = strengths.clone();
        self.others.agree();
        if self.others.agreement.sequences != before {
            self.others.memory = Memory::default();
        }
        if self.others.learn().is_err() {
            return Some(Rejection { name, broken: None });
        }
        let Teaching { report: TeachReport { job, .. }, agreement, .. } = &self.others;
        let verdicts = self.left_out.judge(job).unwrap_or_default();
        let broken = verdicts.iter().find_map(|verdict| {
            let rule = Rule::broken_by(verdict, &agreement.keys)?;
            (strengths.of(rule) != Strength::NONE).then(|| (rule, Distribution::of_verdict(job, verdict)))
        });
        let is_accused = verdicts.iter().any(|verdict| verdict.outcome == Outcome::Anomaly);
        is_accused.then_some(Rejection { name, broken })
    }
}
