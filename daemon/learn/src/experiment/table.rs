//! The second experiment's outcome as a table, beside the paper's own.

use super::confusion::Rounds;
use super::two::{Outcome, Split};
use std::fmt;

/// The paper's table (IV-B): true negatives, false positives, false negatives, true positives, accuracy and its deviation in percent.
const PAPER: [(&str, [u32; 4], [f64; 2]); 2] =
    [("IU", [858, 52, 0, 140], [95.0, 2.7]), ("activity", [252, 44, 0, 124], [89.5, 5.1])];

/// What has to be known to read the paper's table.
const REMARK: &str = "The paper's activity table has 124 actual positives; its protocol makes 140 (14 flawed jobs with one wrong \
activity each, 10 rounds). Here they are counted by the protocol.";

/// A row: what one variation reached under one split.
#[derive(Clone, Debug)]
struct Row {
    name: &'static str,
    split: Split,
    levels: [Rounds; 2],
    accused_in_j2: u32,
    jobs: (u32, u32),
}

/// The table of the second experiment: a row for each variation and split.
#[derive(Clone, Debug)]
pub struct Table(Vec<Row>);

impl Table {
    /// The table of one experiment.
    pub fn new(outcomes: &[Outcome]) -> Self {
        Self(outcomes.iter().map(Row::from).collect())
    }

    /// The table of the same experiment with different people: the rounds of all of them.
    pub fn of_many(experiments: &[Vec<Outcome>]) -> Self {
        let mut rows: Vec<Row> = Vec::new();
        for (place, outcome) in experiments.iter().flat_map(|outcomes| outcomes.iter().enumerate()) {
            let next = Row::from(outcome);
            match rows.get_mut(place) {
                None => rows.push(next),
                Some(row) => {
                    for (rounds, more) in row.levels.iter_mut().zip(next.levels) {
                        rounds.0.extend(more.0);
                    }
                    row.accused_in_j2 += next.accused_in_j2;
                    row.jobs = (row.jobs.0 + next.jobs.0, row.jobs.1 + next.jobs.1);
                }
            }
        }
        Self(rows)
    }
}

impl From<&Outcome> for Row {
    fn from(outcome: &Outcome) -> Self {
        Self {
            name: outcome.variation.name,
            split: outcome.split,
            levels: [outcome.ius.clone(), outcome.activities.clone()],
            accused_in_j2: outcome.accused_in_j2,
            jobs: outcome.jobs,
        }
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (level, (word, paper, accuracy)) in PAPER.into_iter().enumerate() {
            writeln!(f, "{word} level")?;
            writeln!(
                f,
                "  {:34} {:14} {:>7} {:>7} {:>7} {:>7}  accuracy",
                "rules", "split", "right", "accused", "missed", "found"
            )?;
            line(f, "the paper's own table", "random", paper, accuracy)?;
            for row in &self.0 {
                let rounds = &row.levels[level];
                let sum = rounds.sum();
                let counts = [sum.true_negative, sum.false_positive, sum.false_negative, sum.true_positive];
                let (mean, deviation) = rounds.accuracy();
                line(f, row.name, row.split.word(), counts, [100.0 * mean, 100.0 * deviation])?;
            }
        }
        writeln!(f, "whole jobs and J2")?;
        for row in &self.0 {
            writeln!(
                f,
                "  {:34} {:14} {} of {} correct jobs are JobOk; {} of the accused IUs are in a J2",
                row.name,
                row.split.word(),
                row.jobs.0,
                row.jobs.1,
                row.accused_in_j2
            )?;
        }
        f.write_str(REMARK)
    }
}

fn line(
    f: &mut fmt::Formatter<'_>,
    name: &str,
    split: &str,
    [right, accused, missed, found]: [u32; 4],
    [mean, deviation]: [f64; 2],
) -> fmt::Result {
    writeln!(
        f,
        "  {name:34} {split:14} {right:>7} {accused:>7} {missed:>7} {found:>7}  {mean:.2} % +- {deviation:.2}"
    )
}

impl Split {
    /// A word for it.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::LeavePersonOut => "person out",
        }
    }
}
