//! The experiments on many seeds, in memory.

use super::Outcome;
use andon_core::config::Method;
use andon_core::job::LocalCost;
use andon_core::verdict::{Kind, Verdict};
use andon_learn::analysis::report;
use andon_learn::experiment::{self as learn, Split, Table, Variation};
use andon_learn::folder::{Labelled, label};
use andon_learn::run::Run;
use andon_learn::teach::{TeachOptions, teach};
use andon_tests::simulator::{self, Expected, Flaw, Noise, Recorded};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::Path;

/// Encodes and segments what was recorded.
fn labelled(recorded: Vec<Recorded>, method: &Method) -> Result<Vec<Labelled>, Box<dyn std::error::Error>> {
    let one = |recorded: Recorded| {
        let name = format!("{}.tracks.jsonl", recorded.name);
        let (person, what, repetition) = label(&name).ok_or("a simulated recording has no label")?;
        let run = Run::new(&name, "", &recorded.recording, method)?;
        Ok(Labelled { person, what, repetition, run })
    };
    recorded.into_iter().map(one).collect()
}

/// Experiment 2 with every rule under both splits, all seeds together.
pub(super) fn experiments(seeds: RangeInclusive<u64>) -> Outcome {
    let method = Method::default();
    let splits = [Split::Random, Split::LeavePersonOut];
    let mut all = Vec::new();
    let (mut right, mut segmented) = (0, 0);
    for seed in seeds.clone() {
        let recorded = simulator::experiment_2(seed, Noise::default());
        let truths: Vec<_> = recorded.iter().map(|one| one.truth.labels.contexts()).collect();
        let runs = labelled(recorded, &method)?;
        for (one, truth) in runs.iter().zip(&truths) {
            let found: Vec<_> = one.run.activities.iter().map(|activity| activity.contexts()).collect();
            segmented += 1;
            right += u32::from(found == *truth);
            if found != *truth {
                eprintln!("seed {seed} {}: {found:?} in place of {truth:?}", one.run.name);
            }
        }
        let outcomes = learn::experiment_2(&runs, &method, &Variation::ladder(), &splits, seed, &mut |_| {})?;
        all.push(outcomes);
    }
    println!("segmentation right in {right} of {segmented} executions");
    println!("{}", Table::of_many(&all));
    Ok(())
}

/// Experiment 1 on each seed, with both local costs.
pub(super) fn experiment_1(seeds: RangeInclusive<u64>, folder: &Path) -> Outcome {
    let method = Method::default();
    for seed in seeds {
        let runs = labelled(simulator::experiment_1(seed, Noise::default()), &method)?;
        for cost in [LocalCost::Ordinal, LocalCost::Circular { bins: method.bins }] {
            let one = learn::experiment_1(&runs, &method, cost, seed, &mut |_| {})?;
            println!("seed {seed}, {cost:?}\n{one}\n");
            let report = report(&one.analysis, one.drilling.as_ref(), &format!("seed {seed}, {cost:?}"))?;
            report.save(&folder.join(format!(
                "{seed}_{}",
                if cost == LocalCost::Ordinal { "ordinal" } else { "circular" }
            )))?;
        }
    }
    Ok(())
}

/// The default rules on every flaw of the floor: taught by so many correct runs of other people.
pub(super) fn floor(seeds: RangeInclusive<u64>, demonstrations: usize) -> Outcome {
    let method = Method::default();
    let mut counts: BTreeMap<Flaw, BTreeMap<&str, u32>> = BTreeMap::new();
    for seed in seeds {
        let runs = labelled(simulator::floor(seed, Noise::default()), &method)?;
        let taught: Vec<Run> = runs
            .iter()
            .filter(|one| one.what == "taught")
            .take(demonstrations)
            .map(|one| one.run.clone())
            .collect();
        let (job, _) = teach(&taught, &TeachOptions::new("floor", "", method))?;
        for one in runs.iter().filter(|one| one.what != "taught") {
            let Some(flaw) = Flaw::ALL.into_iter().find(|flaw| flaw.word() == one.what) else { continue };
            let verdicts =
                job.with_job(|lent| one.run.judge(lent, &method)).map_err(|unusable| unusable.to_string())?;
            let said = said(&verdicts);
            let fits = match flaw.expected() {
                Expected::Right => said == "right",
                Expected::Anomaly => said == "anomaly",
                Expected::NotOk => said != "right",
            };
            if !fits {
                eprintln!("seed {seed} {}: {said}", one.run.name);
            }
            *counts.entry(flaw).or_default().entry(if fits { "as expected" } else { said }).or_default() += 1;
        }
    }
    for (flaw, counts) in counts {
        println!("{:18} {:10} {counts:?}", flaw.word(), format!("{:?}", flaw.expected()));
    }
    Ok(())
}

fn said(verdicts: &[Verdict]) -> &'static str {
    let any = |kind| verdicts.iter().any(|verdict| verdict.kind == kind);
    if any(Kind::JobAnomaly) {
        "anomaly"
    } else if any(Kind::JobOk) && !any(Kind::NotJudged) {
        "right"
    } else {
        "not judged"
    }
}
