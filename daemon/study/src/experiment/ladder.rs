//! What each rule gains: the outcomes of the second experiment on several folders side by side.

use super::second::Outcome;
use std::fmt;

/// For each folder its name and its outcomes, the same variations in each. `Display` prints it for people.
#[derive(Clone, Debug)]
pub struct Ladder(pub Vec<(String, Vec<Outcome>)>);

/// How to read the table.
const LEGEND: &str = "IU: accuracy of the IUs by the paper's protocol (two thirds of the correct executions at random, 10 rounds); right: correct jobs \
     that are OK; found: flawed jobs with an anomaly; J1: those whose polishing stops halfway, missed of all; nothing: the \
     correct executions have nothing in common.";

impl fmt::Display for Ladder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:32}", "rules")?;
        for (folder, _) in &self.0 {
            write!(f, " | {folder:34.34}")?;
        }
        write!(f, "\n{:32}", "")?;
        for _ in &self.0 {
            write!(f, " | {:>7} {:>7} {:>7} {:>10}", "IU", "right", "found", "J1 missed")?;
        }
        let rows = self.0.first().map_or(0, |(_, outcomes)| outcomes.len());
        for row in 0..rows {
            write!(f, "\n{:32}", self.0[0].1[row].variation.name)?;
            for (_, outcomes) in &self.0 {
                write_cells(f, &outcomes[row])?;
            }
        }
        write!(f, "\n{LEGEND}")
    }
}

fn write_cells(f: &mut fmt::Formatter<'_>, outcome: &Outcome) -> fmt::Result {
    let percent = |part: u32, all: u32| {
        if all == 0 {
            "none".to_owned()
        } else {
            format!("{:.1} %", 100.0 * f64::from(part) / f64::from(all))
        }
    };
    write!(
        f,
        " | {:>7} {:>7} {:>7} {:>10}",
        if outcome.ius.0.is_empty() {
            "nothing".to_owned()
        } else {
            format!("{:.1} %", 100.0 * outcome.ius.accuracy().0)
        },
        percent(outcome.correct_jobs_ok, outcome.correct_jobs),
        percent(outcome.flawed_jobs_found, outcome.flawed_jobs),
        if outcome.j1 == 0 { "none".to_owned() } else { format!("{} of {}", outcome.j1_missed, outcome.j1) }
    )
}
