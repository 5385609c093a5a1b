//! The order of a job in words, with the evidence that it depends on.

use super::either_first;
use super::relation::chance_of_one_order;
use crate::job_file::{JobFile, Relation, RelationKind};
use std::collections::BTreeSet;
use std::fmt;

/// The name of each step, and the sentences about it: its laws and what is only usual.
pub(super) fn steps(job: &JobFile) -> impl Iterator<Item = (String, Vec<String>)> {
    (0..job.steps.len()).map(|number| (job.step_name(number), sentences(job, number)))
}

fn sentences(job: &JobFile, number: usize) -> Vec<String> {
    let step = &job.steps[number];
    let mut sentences = Vec::new();
    if !step.is_required {
        sentences.push(format!("optional: {} of the runs have it", step.runs));
    }
    if step.allows_insertions {
        sentences.push("the runs have only these contacts in common: others may come in between".to_owned());
    }
    if either_first::is_in(job, number) {
        let sentence = "either hand may be the first one there: it is right without its first IU, too";
        sentences.push(sentence.to_owned());
    }
    if !step.completes.is_empty() {
        let earlier = step.completes.iter().map(|index| job.activities[usize::from(*index)].activity);
        let earlier: BTreeSet<u16> = earlier.collect();
        let steps: Vec<String> = earlier.iter().map(|number| (number + 1).to_string()).collect();
        sentences.push(format!(
            "required where {} ends early: the other runs do both in one",
            steps.join(" and ")
        ));
    }
    if step.is_once {
        sentences.push("only once: its place in the order is law".to_owned());
    }
    let direct = step.after.iter().filter(|relation| !is_implied(job, number, relation));
    sentences.extend(direct.map(|relation| {
        let Relation { activity, kind, runs, gap_s } = relation;
        let evidence = format!("as in all {runs} runs, {gap_s:.1} s later");
        match kind {
            RelationKind::Begin => format!("law: after {} has begun, {evidence}", activity + 1),
            RelationKind::End => format!("law: after {} has ended, {evidence}", activity + 1),
            RelationKind::Usual => {
                format!("usually after {}, {evidence}; another order is noted, no anomaly", activity + 1)
            }
        }
    }));
    sentences
}

fn is_implied(job: &JobFile, number: usize, relation: &Relation) -> bool {
    let has = |later: usize, earlier: u16| {
        job.steps[later].after.iter().any(|other| other.activity == earlier && other.kind == relation.kind)
    };
    let between = usize::from(relation.activity) + 1..number;
    between.into_iter().any(|other| has(number, other as u16) && has(other, relation.activity))
}

/// Prints the steps for people, who count from 1, with how many runs the order depends on.
pub(super) fn write(job: &JobFile, runs: usize, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    for (number, (name, sentences)) in (1..).zip(steps(job)) {
        writeln!(f, "step {number}: {name}")?;
        sentences.iter().try_for_each(|sentence| writeln!(f, "    {sentence}"))?;
    }
    match runs {
        _ if job.steps.len() < 2 => Ok(()),
        1 => writeln!(f, "one run shows no order: any order of the steps is accepted"),
        runs => writeln!(
            f,
            "chance that two unrelated steps come in the same order in all {runs} runs: {:.0} %",
            100.0 * chance_of_one_order(runs)
        ),
    }
}
