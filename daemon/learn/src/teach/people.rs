//! Whether one person showed all the runs, and how much people differ here. They differ from each other more than each does from time to
//! time, so what one person does is less than what is right.

use super::sequence::Agreement;
use crate::folder::person_of;
use crate::run::{Iu, Run};
use crate::statistics::{chi_squared, mean};

/// How people differ, and how one person does from run to run: the standard deviation of the logarithm of the pace and of the length of
/// strokes.
const BETWEEN_PEOPLE: f64 = 0.14;
const BETWEEN_RUNS: f64 = 0.08;

/// How sure it must be that these people differ more than people in general do before they count for more.
const SURE: f64 = 0.9;

/// What the runs tell of the people who showed them.
#[derive(Clone, Copy, Debug)]
pub(super) struct People {
    /// How probable it is that one person showed all the runs: as the names of the files say it (`p<person>_...`), or else as the runs agree
    /// in their pace and in the length of their strokes; both may be expected where nothing is known.
    pub(super) one_person: f64,
    /// How many times as much as people in general they differ: 1 unless it is sure that it is more.
    pub(super) variety: f64,
}

impl People {
    /// Different ones, who differ as people in general do.
    pub(super) const IN_GENERAL: Self = Self { one_person: 0.0, variety: 1.0 };

    pub(super) fn of(runs: &[Run], agreement: &Agreement) -> Self {
        let pace = |iu: &Iu| Some(f64::from(iu.frames));
        let stroke = |iu: &Iu| iu.measures.stroke_m.map(f64::from);
        let deviations = [deviations(runs, agreement, &pace), deviations(runs, agreement, &stroke)];
        let people: Option<Vec<u32>> =
            agreement.used_runs(runs).iter().map(|run| person_of(&run.name)).collect();
        let one_person = match people {
            Some(people) => f64::from(people.iter().all(|person| *person == people[0])),
            None => 1.0 / (1.0 + (-deviations.iter().map(|them| evidence_of_one(them)).sum::<f64>()).exp()),
        };
        Self { one_person, variety: variety(&deviations) }
    }
}

/// The standard deviation of these deviations, as a multiple of that of people in general; 1 where chance may explain that it is more.
fn variety(deviations: &[Vec<f64>]) -> f64 {
    let freedom: usize = deviations.iter().map(|of_one| of_one.len().saturating_sub(1)).sum();
    let squares: f64 = deviations.iter().flatten().map(|deviation| deviation.powi(2)).sum();
    let in_general = BETWEEN_RUNS.powi(2) + BETWEEN_PEOPLE.powi(2);
    let ratio = squares / in_general;
    if ratio > chi_squared(freedom as f64, SURE) { (ratio / freedom as f64).sqrt() } else { 1.0 }
}

/// The logarithm of how much more probable these deviations are for one person than for a different one in each run.
fn evidence_of_one(deviations: &[f64]) -> f64 {
    let [one, many] = [BETWEEN_RUNS.powi(2), BETWEEN_RUNS.powi(2) + BETWEEN_PEOPLE.powi(2)];
    let freedom = deviations.len().saturating_sub(1) as f64;
    let squares: f64 = deviations.iter().map(|deviation| deviation.powi(2)).sum();
    freedom / 2.0 * (many / one).ln() - squares / 2.0 * (1.0 / one - 1.0 / many)
}

/// By how much each run exceeds the others in something, as the mean over the IUs in which it was measured, in its logarithm.
fn deviations(runs: &[Run], agreement: &Agreement, measured: &dyn Fn(&Iu) -> Option<f64>) -> Vec<f64> {
    let mut of_run: Vec<Vec<f64>> = vec![Vec::new(); runs.len()];
    for sequence in &agreement.sequences {
        for (index, _) in sequence.contexts.iter().enumerate().filter(|(_, context)| context.is_touch()) {
            let values: Vec<(usize, f64)> = sequence
                .well_shown(runs, index)
                .filter_map(|(run, iu)| Some((run, measured(iu)?.ln())))
                .collect();
            let centre = mean(&values.iter().map(|(_, value)| *value).collect::<Vec<_>>());
            for (run, value) in values {
                of_run[run].push(value - centre);
            }
        }
    }
    of_run.iter().filter(|values| !values.is_empty()).map(|values| mean(values)).collect()
}
