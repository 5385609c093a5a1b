//! Measures the rules on many seeds, without files.

use super::Outcome;
use andon_core::config::Method;
use andon_core::job::LocalCost;
use andon_core::verdict::{self, Level, Verdict};
use andon_learn::run::Run;
use andon_learn::teach::{TeachOptions, teach};
use andon_study::analysis::{report, selection};
use andon_study::experiment::{self as learn, Split, Table, Variation};
use andon_study::folder::{Labelled, label};
use andon_tests::simulator::{self, Expected, Flaw, Noise, Recorded};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::Path;

/// Encodes and segments recordings.
fn labelled(recorded: Vec<Recorded>, method: &Method) -> Result<Vec<Labelled>, Box<dyn std::error::Error>> {
    let one = |recorded: Recorded| {
        let name = format!("{}.tracks.jsonl", recorded.name);
        let (person, what, repetition) = label(&name).ok_or("a simulated recording has no label")?;
        let run = Run::new(&name, "", &recorded.recording, method)?;
        Ok(Labelled { person, what, repetition, run })
    };
    recorded.into_iter().map(one).collect()
}

/// Experiment 2 with every variation under both splits, over all seeds.
pub(super) fn experiment_2(seeds: RangeInclusive<u64>) -> Outcome {
    let method = Method::default();
    let splits = [Split::Random, Split::LeavePersonOut];
    let mut total: Vec<learn::Outcome> = Vec::new();
    let (mut correct, mut all) = (0, 0);
    for seed in seeds {
        let recorded = simulator::experiment_2(seed, Noise::default());
        let truths: Vec<_> = recorded.iter().map(|one| one.truth.labels.contexts()).collect();
        let runs = labelled(recorded, &method)?;
        for (one, truth) in runs.iter().zip(&truths) {
            let found: Vec<_> = one.run.activities.iter().map(|activity| activity.contexts()).collect();
            all += 1;
            correct += u32::from(found == *truth);
            if found != *truth {
                eprintln!("seed {seed} {}: found {found:?}, expected {truth:?}", one.run.name);
            }
        }
        let outcomes =
            learn::experiment_2(&runs, &method, &Variation::ladder(method.bins), &splits, seed, &mut |_| {})?;
        if total.is_empty() {
            total = outcomes;
        } else {
            total.iter_mut().zip(outcomes).for_each(|(total, outcome)| add(total, outcome));
        }
    }
    println!("segmentation is correct in {correct} of {all} executions");
    println!("{}", Table(total));
    Ok(())
}

/// Adds the rounds of another seed to those of the same variation and split.
fn add(total: &mut learn::Outcome, outcome: learn::Outcome) {
    total.ius.0.extend(outcome.ius.0);
    total.activities.0.extend(outcome.activities.0);
    total.accused_in_j2 += outcome.accused_in_j2;
    total.correct_jobs += outcome.correct_jobs;
    total.correct_jobs_ok += outcome.correct_jobs_ok;
    total.flawed_jobs += outcome.flawed_jobs;
    total.flawed_jobs_found += outcome.flawed_jobs_found;
    total.j1 += outcome.j1;
    total.j1_missed += outcome.j1_missed;
}

/// Experiment 1 with each seed and every local cost.
pub(super) fn experiment_1(seeds: RangeInclusive<u64>, folder: &Path) -> Outcome {
    let method = Method::default();
    for seed in seeds {
        let runs = labelled(simulator::experiment_1(seed, Noise::default()), &method)?;
        let bins = method.bins;
        for cost in [LocalCost::Normalised { bins }, LocalCost::Ordinal, LocalCost::Circular { bins }] {
            let result = learn::experiment_1(&runs, &method, cost, seed, &mut |_| {})?;
            println!("seed {seed}, {cost:?}\n{result}\n");
            let selection = selection(&runs, &method, cost);
            let source = format!("seed {seed}, {cost:?}");
            let report =
                report(&result.analysis, result.drilling.as_ref(), selection.as_ref(), None, &source)?;
            let folder = folder.join(format!("{seed}_{}", cost.name()));
            std::fs::create_dir_all(&folder)?;
            std::fs::write(folder.join("index.html"), &report.page)?;
            report.files.iter().try_for_each(|(name, text)| std::fs::write(folder.join(name), text))?;
        }
    }
    Ok(())
}

/// The default rules on every flaw of the floor, taught by this number of correct runs of other people.
pub(super) fn floor(seeds: RangeInclusive<u64>, demonstrations: usize) -> Outcome {
    let method = Method::default();
    let mut counts: BTreeMap<Flaw, BTreeMap<&str, u32>> = BTreeMap::new();
    for seed in seeds {
        let (taught, tested): (Vec<_>, Vec<_>) = labelled(simulator::floor(seed, Noise::default()), &method)?
            .into_iter()
            .partition(|one| one.what == "taught");
        let taught: Vec<Run> = taught.into_iter().take(demonstrations).map(|one| one.run).collect();
        let (job, _) = teach(&taught, &TeachOptions::new("floor", "", method))?;
        for one in tested {
            let Some(flaw) = Flaw::ALL.into_iter().find(|flaw| flaw.name() == one.what) else { continue };
            let verdicts = one.run.judge(&job)?;
            let found = summary(&verdicts);
            let is_expected = match flaw.expected() {
                Expected::Ok => found == OK,
                Expected::Anomaly => found == ANOMALY,
                Expected::NotOk => found != OK,
            };
            if !is_expected {
                eprintln!("seed {seed} {}: {found}", one.run.name);
            }
            let name = if is_expected { "as expected" } else { found };
            *counts.entry(flaw).or_default().entry(name).or_default() += 1;
        }
    }
    for (flaw, counts) in counts {
        println!("{:18} {:10} {counts:?}", flaw.name(), format!("{:?}", flaw.expected()));
    }
    Ok(())
}

const OK: &str = "OK";
const ANOMALY: &str = "anomaly";
const NOT_JUDGED: &str = "not judged";

/// What the verdicts say of the whole job.
fn summary(verdicts: &[Verdict]) -> &'static str {
    let job_is =
        |outcome| verdicts.iter().any(|verdict| verdict.level == Level::Job && verdict.outcome == outcome);
    let is_judged = verdicts.iter().all(|verdict| verdict.outcome != verdict::Outcome::NotJudged);
    if job_is(verdict::Outcome::Anomaly) {
        ANOMALY
    } else if job_is(verdict::Outcome::Ok) && is_judged {
        OK
    } else {
        NOT_JUDGED
    }
}
