//! The outcomes of the second experiment as a table, next to the paper's own.

use super::confusion::Rounds;
use super::second::Outcome;
use std::fmt;

/// The paper's table (IV-B): level, true and false negatives and positives, then mean and standard deviation of the accuracy in percent.
const PAPER: [(&str, [u32; 4], [f64; 2]); 2] =
    [("IU", [858, 52, 0, 140], [95.0, 2.7]), ("activity", [252, 44, 0, 124], [89.5, 5.1])];

/// What readers need to know about the paper's table.
const REMARK: &str = "The paper's activity table has 124 actual positives, but its protocol gives 140 (14 flawed jobs with one wrong \
activity each, 10 rounds). This table follows the protocol.";

/// Why a round could not be taught.
const NOTHING: &str = "the correct executions have nothing in common";

/// Of rules that do not use the points at which the recordings say that objects are touched.
const CONTACT_REGIONS: &str = "No recording says where its objects are touched: hands and objects meet where the training executions show it.\n";

/// The table of the second experiment, with one row per outcome. `Display` prints it for people.
#[derive(Clone, Debug)]
pub struct Table(pub Vec<Outcome>);

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [ius, activities] = PAPER;
        self.write_level(f, ius, |outcome| &outcome.ius)?;
        self.write_level(f, activities, |outcome| &outcome.activities)?;
        writeln!(f, "whole jobs and J2")?;
        for outcome in self.0.iter().filter(|outcome| !outcome.ius.0.is_empty()) {
            let (name, split) = (outcome.variation.name, outcome.split.name());
            write!(
                f,
                "  {name:34} {split:14} {} of {} correct jobs are OK; {} of {} flawed ones are found; {} of {} J1 are missed; {} of the false positives among the \
                 IUs are in a J2",
                outcome.correct_jobs_ok,
                outcome.correct_jobs,
                outcome.flawed_jobs_found,
                outcome.flawed_jobs,
                outcome.j1_missed,
                outcome.j1,
                outcome.accused_in_j2
            )?;
            match outcome.untaught {
                0 => writeln!(f)?,
                rounds => writeln!(f, "; in {rounds} more rounds {NOTHING}")?,
            }
        }
        if self.0.iter().any(|outcome| outcome.variation.finds_contact_regions) {
            f.write_str(CONTACT_REGIONS)?;
        }
        f.write_str(REMARK)
    }
}

impl Table {
    fn write_level(
        &self,
        f: &mut fmt::Formatter<'_>,
        (level, paper_counts, paper_accuracy): (&str, [u32; 4], [f64; 2]),
        rounds: impl Fn(&Outcome) -> &Rounds,
    ) -> fmt::Result {
        writeln!(f, "{level} level")?;
        writeln!(
            f,
            "  {:34} {:14} {:>7} {:>7} {:>7} {:>7}  accuracy",
            "rules", "split", "TN", "FP", "FN", "TP"
        )?;
        write_row(f, "the paper's own table", "random", paper_counts, paper_accuracy)?;
        for outcome in &self.0 {
            let rounds = rounds(outcome);
            if rounds.0.is_empty() {
                let why = if outcome.untaught > 0 { NOTHING } else { "there is one person only" };
                writeln!(f, "  {:34} {:14} {why}", outcome.variation.name, outcome.split.name())?;
                continue;
            }
            let sum = rounds.sum();
            let counts = [sum.true_negative, sum.false_positive, sum.false_negative, sum.true_positive];
            let (mean, deviation) = rounds.accuracy();
            let accuracy = [100.0 * mean, 100.0 * deviation];
            write_row(f, outcome.variation.name, outcome.split.name(), counts, accuracy)?;
        }
        Ok(())
    }
}

fn write_row(
    f: &mut fmt::Formatter<'_>,
    name: &str,
    split: &str,
    [tn, fp, fn_, tp]: [u32; 4],
    [mean, deviation]: [f64; 2],
) -> fmt::Result {
    writeln!(f, "  {name:34} {split:14} {tn:>7} {fp:>7} {fn_:>7} {tp:>7}  {mean:.2} % +- {deviation:.2}")
}
