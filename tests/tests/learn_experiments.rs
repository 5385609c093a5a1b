//! The paper's two experiments on simulated people: the method finds what the paper found, and the default rules give fewer false alarms.
#![allow(clippy::unwrap_used)]

use andon_core::config::Method;
use andon_core::job::LocalCost;
use andon_learn::run::Run;
use andon_study::analysis::{report, selection};
use andon_study::cluster::Table;
use andon_study::experiment::{Confusion, Ladder, Outcome, Split, Variation, experiment_1, experiment_2};
use andon_study::folder::{self, Labelled, Naming};
use andon_tests::environment;
use andon_tests::rate::Rate;
use andon_tests::simulator::{self, Noise, Recorded, save};
use std::path::PathBuf;

/// A seed that played no part in the choice of the rules, where people do not matter. What is counted is drawn.
const SEED: u64 = 2001;

/// Number of people in the first experiment: a few show the clusters, and need a tenth of the time of all ten.
const PEOPLE: u32 = 4;

/// Number of activities in the second experiment.
const ACTIVITIES: u32 = 70;

/// Writes recordings as track files, and reads them like the folder of a user.
fn through_files(recorded: &[Recorded]) -> Vec<Labelled> {
    let folder = tempfile::tempdir().unwrap();
    save(folder.path(), recorded).unwrap();
    let recordings = folder::recordings(folder.path(), &Naming::Standard).unwrap();
    let read = |(path, (person, what, repetition)): (PathBuf, folder::Label)| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let run = Run::read(&name, &std::fs::read(&path).unwrap(), &Method::default()).unwrap();
        Labelled { person, what, repetition, run }
    };
    recordings.files.into_iter().map(read).collect()
}

fn outcome(variation: Variation, split: Split) -> Outcome {
    let seed = environment::seed();
    let all = through_files(&simulator::experiment_2(seed, Noise::default()));
    let method = Method::default();
    experiment_2(&all, &method, &[variation], &[split], seed, &mut |_| {}).unwrap().remove(0)
}

fn default_rules() -> Variation {
    Variation::ladder(Method::default().bins).pop().unwrap()
}

#[test]
fn simulated_executions_are_segmented_as_their_scripts_intend() {
    let recorded = simulator::experiment_2(SEED, Noise::default());
    let intended: Vec<_> = recorded
        .iter()
        .map(|one| (format!("{}.tracks.jsonl", one.name), one.truth.labels.contexts()))
        .collect();
    for one in through_files(&recorded) {
        let found: Vec<_> = one.run.activities.iter().map(|activity| activity.contexts()).collect();
        let (_, intended) = intended.iter().find(|(name, _)| *name == one.run.name).unwrap();
        assert_eq!(found, *intended, "{}", one.run.name);
    }
}

#[test]
fn the_protocol_counts_1050_ius_and_420_activities_of_which_140_are_wrong() {
    let outcome = outcome(Variation::paper(Method::default().bins), Split::Random);
    let count = |Confusion { true_negative, false_positive, false_negative, true_positive }| {
        (true_negative + false_positive, false_negative + true_positive)
    };
    assert_eq!(count(outcome.ius.sum()), (910, 140));
    assert_eq!(count(outcome.activities.sum()), (280, 140));
}

/// The paper's normalised cost, with a threshold that accepts right jobs, does not see that the polishing stops halfway; the measures do. With the
/// paper's own threshold it depends on who is drawn. With seed 2631 0 of 70 were missed, and 26 of 70 right jobs were accused.
#[test]
fn the_paper_s_normalised_cost_misses_j1_and_the_default_rules_none_in_one_table_for_several_folders() {
    let bins = Method::default().bins;
    let normalised = Variation::with_cost(Variation::ladder(bins), LocalCost::Normalised { bins });
    let without_measures =
        normalised.into_iter().take_while(|rules| rules.name != "+ bounds of measures").last();
    let of_rules = |variation: Variation| outcome(variation, Split::Random);
    let [paper, default] = [without_measures.unwrap(), default_rules()].map(of_rules);
    assert_eq!((paper.j1, default.j1), (70, 70));
    let missed = |outcome: &Outcome| Rate::new(outcome.j1_missed as usize, 70);
    missed(&paper).expect_at_least(0.3, "J1 missed by the normalised cost");
    missed(&default).expect_at_most(0.01, "J1 missed by the default rules");
    let folder = |name: &str| (name.to_owned(), vec![paper.clone(), default.clone()]);
    let table = Ladder(vec![folder("one bench"), folder("another bench")]).to_string();
    assert_eq!(table.matches(&format!("{} of 70", paper.j1_missed)).count(), 2, "{table}");
    assert_eq!(table.lines().count(), 5, "{table}");
}

#[test]
fn a_cost_for_all_rules_leaves_no_two_rules_alike() {
    let cost = LocalCost::Normalised { bins: 8 };
    let all = Variation::with_cost(Variation::ladder(8), cost);
    assert_eq!(all.len(), Variation::ladder(8).len() - 2, "the rows that change the cost alone");
}

#[test]
fn where_contexts_differ_candidates_drop_out_and_the_right_one_remains() {
    let mut recorded = simulator::experiment_1(SEED, Noise::default());
    recorded.retain(|one| folder::label(&format!("{}.tracks.jsonl", one.name)).unwrap().0 <= PEOPLE);
    let method = Method::default();
    let found = selection(&through_files(&recorded), &method, LocalCost::Circular { bins: method.bins });
    let found = found.unwrap();
    let (remaining, dropped): (Vec<_>, Vec<_>) =
        found.candidates.iter().partition(|candidate| candidate.dropped.is_none());
    assert_eq!(remaining.len(), 1, "{found:?}");
    assert!(found.run.contains(&remaining[0].name), "{} is {}", found.run, remaining[0].name);
    // Boxing, measuring and assembly begin with the same profile in the same hand.
    let later = dropped.iter().filter(|candidate| candidate.dropped.is_some_and(|(time, _)| time > 0.0));
    assert_eq!(later.count(), 2, "{found:?}");
}

#[test]
fn the_default_rules_miss_nothing_and_reach_the_target_with_new_people_and_with_known_ones() {
    for split in [Split::Random, Split::LeavePersonOut] {
        let outcome = outcome(default_rules(), split);
        let (ius, activities) = (outcome.ius.sum(), outcome.activities.sum());
        let as_they_are = |of: Confusion| of.true_positive + of.true_negative;
        let all = as_they_are(activities) + activities.false_positive + activities.false_negative;
        // A random split judges each activity several times, by jobs that share most of their runs. That is one case, not several.
        let times = (all / ACTIVITIES).max(1);
        let once = |count: u32| ((count + times / 2) / times) as usize;
        let rate = |count, all| Rate::new(once(count), once(all));
        let found = |of: Confusion| rate(of.true_positive, of.true_positive + of.false_negative);
        found(ius).expect_at_least(0.99, &format!("{split:?}: wrong IUs found"));
        found(activities).expect_at_least(0.99, &format!("{split:?}: wrong activities found"));
        // In a J2 the hand puts the brick down before it has gone its way, which the paper counts as right.
        let wrong = ius.false_positive - outcome.accused_in_j2;
        let right = as_they_are(ius);
        rate(right, right + wrong).expect_at_least(0.99, &format!("{split:?}: IUs judged as they are"));
        let name = format!("{split:?}: activities judged as they are");
        rate(as_they_are(activities), all).expect_at_least(0.98, &name);
    }
}

/// For each kind of IU, the clusters that have at least one of its executions.
fn clusters(table: &Table) -> Vec<Vec<usize>> {
    let of_kind = |counts: &Vec<usize>| (0..counts.len()).filter(|&cluster| counts[cluster] > 0).collect();
    table.counts.iter().map(of_kind).collect()
}

#[test]
fn boxing_measuring_and_assembly_are_one_motion_in_three_of_five_contexts() {
    let mut recorded = simulator::experiment_1(SEED, Noise::default());
    recorded.retain(|one| folder::label(&format!("{}.tracks.jsonl", one.name)).unwrap().0 <= PEOPLE);
    let all = through_files(&recorded);
    let method = Method::default();
    let cost = LocalCost::Circular { bins: method.bins };
    let one = experiment_1(&all, &method, cost, SEED, &mut |_| {}).unwrap();
    for found in &one.segmentation {
        assert_eq!(found.wrong, Vec::<String>::new(), "{}", found.what);
    }
    let (motion, context) = (one.analysis.motion_table(), one.analysis.context_table());
    assert_eq!(one.analysis.motion.k, 4);
    assert_eq!(clusters(&motion), [[0], [1], [1], [1], [2], [3]]);
    assert_eq!(clusters(&context), [[0], [1], [2], [3], [3], [4]]);
    // The layout of drill and brick makes no difference, compared with the differences between other interactions.
    let drilling = one.drilling.as_ref().unwrap();
    assert!((drilling.other_layout - drilling.same_layout).abs() < 0.1 * drilling.other_kinds);
    let selection = selection(&all, &method, cost);
    let report =
        report(&one.analysis, one.drilling.as_ref(), selection.as_ref(), None, "four people").unwrap();
    // The page fetches nothing: the only address in it is the name of SVG.
    let page = report.page.replace("http://www.w3.org/2000/svg", "");
    assert!(!page.contains("://") && !page.contains("src=") && !page.contains("href="));
    assert_eq!(
        report.page.matches("<svg").count(),
        11,
        "two matrices, the elbow, drilling, candidates, six kinds"
    );
}
