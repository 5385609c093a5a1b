//! Whether one person showed all the runs, and how much people differ here. They differ from each other more than each does from time to
//! time, so what one person does is less than what is right.
//!
//! Where names say who showed a run (`p3_...`), they count. Who works by feel differs from run to run as people do, so that counts as one person.
//! Else pace, lengths of strokes and times at other parts are compared. With five runs of one simulated
//! person 23 of 198 right jobs of others were accused without this room, and 1 with it.
//!
//! People who differ more than chance explains (1 %) count as varied as they may be at most (90 %). Runs that stand out are not learnt from, so
//! the spread is underestimated. Of 140 right jobs of people of another simulator who differ twice as much as usual, 12 are accused, and 25 were
//! without this; of 140 of those who differ three times as much 5, and 34 (seeds 7001 to 7005).

use super::measures::PRIOR_BY_FEEL;
use super::sequence::{Agreement, MIN_RUNS, ShownIu};
use crate::recording::person_of;
use crate::run::{Iu, Run};
use crate::statistics::{chi_squared, mean};

/// The variance of the logarithm of the pace and of the length of strokes. One person differs by 0.08 from run to run, and people by 0.14.
pub(super) const IN_GENERAL: f64 = 0.08 * 0.08 + 0.14 * 0.14;

/// The share of it that is between the runs of one person.
pub(super) const OF_ONE_PERSON: f64 = 0.08 * 0.08 / IN_GENERAL;

/// How sure it must be that these people differ more than people in general do before they count for more. People in general are taken for such ones
/// by chance as seldom as that. Their bounds then let half of the faults pass that they would find.
const CONFIDENCE: f64 = 0.99;

/// The upper confidence bound of the variance ratio that people who do differ more are taken to have. Runs that stand out are not learnt from, so
/// that what is left is more alike than people are. Of groups who differ three times as much, the accepted ones seem to differ 2.2 times as much.
const UPPER_CONFIDENCE: f64 = 0.9;

/// How many times as much as people in general others may be taken to differ: more was never measured. A few runs of which one is far off would seem
/// to show more, and no bound would be left. Halved or doubled, 5 or 3 of 70 jobs differ, and no verdict.
const MAX_VARIETY: f64 = 3.0;

/// What the runs tell of the people who showed them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct People {
    /// How probable it is that one person showed all the runs.
    pub(super) one_person: f64,
    /// How many times as much as people in general they differ at most: 1 unless it is sure that it is more.
    pub(super) variety: f64,
    /// How many degrees of freedom tell the variety; infinite where it is 1.
    pub(super) freedom: f64,
}

impl People {
    /// Different ones, who differ as people in general do.
    pub(super) const IN_GENERAL: Self = Self { one_person: 0.0, variety: 1.0, freedom: f64::INFINITY };

    /// `rate_hz` is the frame rate of the grid.
    pub(super) fn of(runs: &[Run], agreement: &Agreement, rate_hz: f32) -> Self {
        let in_general = IN_GENERAL.sqrt();
        let pace = |iu: &Iu| Some(iu.worked_frames().into());
        let stroke = |iu: &Iu| iu.measures.stroke_m.map(f64::from);
        let border = border_frames(rate_hz);
        let time = |iu: &Iu| Some(beyond_border(iu.worked_frames(), border));
        let deviations = [
            deviations(runs, agreement, in_general, &|iu| !iu.is_timed(), &pace),
            // Where the hand goes back once by chance, how far tells nothing of a person.
            deviations(runs, agreement, in_general, &ShownIu::is_repeated, &stroke),
            deviations(runs, agreement, PRIOR_BY_FEEL, &ShownIu::is_timed, &time),
        ];
        let people: Option<Vec<u32>> =
            agreement.used_runs(runs).iter().map(|run| person_of(&run.name)).collect();
        let one_person = match people {
            Some(people) => f64::from(people.iter().all(|person| *person == people[0])),
            None if agreement.ius().any(|iu| iu.is_by_feel()) => 1.0,
            None => 1.0 / (1.0 + (-deviations.iter().map(|them| evidence_of_one(them)).sum::<f64>()).exp()),
        };
        let (variety, freedom) = variety(&deviations);
        Self { one_person, variety, freedom }
    }
}

/// How many frames an IU lasts beside its way in and out of the contact, which takes `border`; at least one.
pub(super) fn beyond_border(frames: u32, border: f64) -> f64 {
    (f64::from(frames) - border).max(1.0)
}

/// Contacts begin and end by distance: for 0.2 s the parts are on their way in and out of one.
pub(super) fn border_frames(rate_hz: f32) -> f64 {
    0.2 * f64::from(rate_hz)
}

/// The standard deviation that these deviations come from at most, as a multiple of that of people in general, and its degrees of freedom. 1 where
/// chance may explain that it is more.
fn variety(deviations: &[Vec<f64>]) -> (f64, f64) {
    let runs = deviations.iter().map(Vec::len).max().unwrap_or_default();
    let freedom = deviations.iter().map(|of_one| of_one.len().saturating_sub(1)).sum::<usize>() as f64;
    let squares: f64 = deviations.iter().flatten().map(|deviation| deviation.powi(2)).sum();
    if runs >= MIN_RUNS && squares > chi_squared(freedom, CONFIDENCE) {
        ((squares / chi_squared(freedom, 1.0 - UPPER_CONFIDENCE)).sqrt().min(MAX_VARIETY), freedom)
    } else {
        (1.0, f64::INFINITY)
    }
}

/// The logarithm of how much more probable these deviations are for one person than for a different one in each run.
fn evidence_of_one(deviations: &[f64]) -> f64 {
    let freedom = deviations.len().saturating_sub(1) as f64;
    let squares: f64 = deviations.iter().map(|deviation| deviation.powi(2)).sum();
    -freedom / 2.0 * OF_ONE_PERSON.ln() - squares / 2.0 * (1.0 / OF_ONE_PERSON - 1.0)
}

/// By how much each run exceeds the others in something, as the mean over the IUs in which it was measured. It is of its logarithm, as a multiple of
/// the standard deviation of people in general. `tells` is whether that tells anything of people where this is done.
fn deviations(
    runs: &[Run],
    agreement: &Agreement,
    in_general: f64,
    tells: &dyn Fn(&ShownIu) -> bool,
    measured: &dyn Fn(&Iu) -> Option<f64>,
) -> Vec<f64> {
    let mut of_run: Vec<Vec<f64>> = vec![Vec::new(); runs.len()];
    for iu in agreement.ius().filter(|iu| iu.context.is_touch() && tells(iu)) {
        let values: Vec<(usize, f64)> =
            iu.ius(runs).filter_map(|(run, iu)| Some((run, measured(iu)?.ln()))).collect();
        let centre = mean(&values.iter().map(|(_, value)| *value).collect::<Vec<_>>());
        for (run, value) in values {
            of_run[run].push((value - centre) / in_general);
        }
    }
    of_run.iter().filter(|values| !values.is_empty()).map(|values| mean(values)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seven deviations with this standard deviation.
    fn spread(deviation: f64) -> Vec<f64> {
        let scale = deviation * (6.0_f64 / 28.0).sqrt();
        (-3..=3).map(|step| scale * f64::from(step)).collect()
    }

    #[test]
    fn who_differs_more_counts_as_such_from_four_runs_on_and_up_to_three_times() {
        assert_eq!(variety(&[spread(1.0), spread(1.0)]), (1.0, f64::INFINITY));
        let (twice, freedom) = variety(&[spread(2.0), spread(2.0)]);
        assert!((2.0..3.0).contains(&twice) && freedom == 12.0, "{twice} {freedom}");
        assert_eq!(variety(&[spread(9.0)]), (MAX_VARIETY, 6.0));
        assert_eq!(variety(&[vec![-9.0, 0.0, 9.0]]), (1.0, f64::INFINITY), "three runs show too little");
    }

    #[test]
    fn people_who_are_alike_in_pace_and_strokes_by_chance_are_not_one_person_if_they_pause_as_people_do() {
        let evidence = |all: &[f64]| all.iter().map(|one| evidence_of_one(&spread(*one))).sum::<f64>();
        let alike = OF_ONE_PERSON.sqrt();
        assert!(evidence(&[alike, alike]) > 3.0);
        assert!(evidence(&[alike, alike, alike]) > 5.0);
        assert!(evidence(&[0.6, 0.6]) > 0.0 && evidence(&[0.6, 0.6, 1.0]) < -3.0);
    }

    #[test]
    fn people_differ_as_much_at_most_as_all_that_is_measured_of_them_says() {
        let (twice, freedom) = variety(&[spread(2.0), spread(2.0), spread(2.0)]);
        // Chi-squared with 18 degrees of freedom exceeds 10.865 in 90 %.
        assert!((twice - 2.0 * (18.0_f64 / 10.865).sqrt()).abs() < 1e-3 && freedom == 18.0, "{twice}");
        // What is more in two measures and as usual in a third one is chance.
        assert!(variety(&[spread(1.5), spread(1.5)]).0 > 1.0);
        for usual in [[1.5, 1.5, 0.9].map(spread), [const { Vec::new() }; 3]] {
            assert_eq!(variety(&usual), (1.0, f64::INFINITY));
        }
    }
}
