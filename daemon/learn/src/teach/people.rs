//! Whether one person showed all the runs, and how much people differ here. They differ from each other more than each does from time to
//! time, so what one person does is less than what is right.
//!
//! Where names say who showed a run (`p3_...`), they count. Who works by feel differs from run to run as people do, so that counts as one person.
//! Else pace, lengths of strokes and times at other parts are compared. With five runs of one simulated
//! person 23 of 198 right jobs of others were accused without this room, and 1 with it.
//!
//! Nobody knows how much the people of a job differ before they have shown it. So one person, and each answer of [`SEVERAL`], counts as much as it
//! makes probable what they showed. Of 756 right jobs of people of another simulator who differ twice as much as usual, 17 are accused. A test with
//! 99 % confidence in its place accused 40. Seven of them may be as alike as people in general by chance, and then nobody can tell. With each answer
//! as probable beforehand it is 13, but 5 of 90 rushed jobs more are called right among people who differ as usual.

use super::measures::PRIOR_BY_FEEL;
use super::sequence::{Agreement, MIN_RUNS, ShownIu};
use crate::recording::person_of;
use crate::run::{Iu, Run};
use crate::statistics::mean;

/// The variance of the logarithm of the pace and of the length of strokes. One person differs by 0.08 from run to run, and people by 0.14.
pub(super) const IN_GENERAL: f64 = 0.08 * 0.08 + 0.14 * 0.14;

/// The share of it that is between the runs of one person.
pub(super) const OF_ONE_PERSON: f64 = 0.08 * 0.08 / IN_GENERAL;

/// The variances that the people of a job may have, as multiples of that of people in general: they differ as these do, twice or three times as much.
/// More was never measured.
const SEVERAL: [f64; 3] = [1.0, 4.0, 9.0];

/// What the runs tell of the people who showed them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct People {
    /// How probable it is that one person showed all the runs.
    pub(super) one_person: f64,
    /// How many times as much as people in general they differ, if they are several: 1 or more.
    pub(super) variety: f64,
    /// With how many degrees of freedom that is known: infinite if they differ as people in general do.
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
        let shown = Self::who_showed(&deviations);
        let one_person = match people {
            Some(people) => f64::from(people.iter().all(|person| *person == people[0])),
            None if agreement.ius().any(|iu| iu.is_by_feel()) => 1.0,
            None => shown.one_person,
        };
        Self { one_person, ..shown }
    }

    /// Whether they rather differ twice as much as people in general than as much.
    pub(super) fn differ_more(self) -> bool {
        self.variety > 1.5
    }

    /// What these deviations of each run tell. Few runs do not tell that people differ more than others.
    fn who_showed(deviations: &[Vec<f64>]) -> Self {
        let runs = deviations.iter().map(Vec::len).max().unwrap_or_default();
        let several = if runs < MIN_RUNS { &SEVERAL[..1] } else { &SEVERAL };
        let log_likelihood =
            |variance| deviations.iter().map(|of_one| log_likelihood(of_one, variance)).sum::<f64>();
        let greatest = several.iter().map(|variance| log_likelihood(*variance)).fold(f64::MIN, f64::max);
        let beside_greatest = |variance: f64| (log_likelihood(variance) - greatest).exp();
        // Of a scale nobody knows, each is as much less probable as it is greater (Jeffreys 1946).
        let weight = |variance: f64| beside_greatest(variance) / variance.sqrt();
        let sum: f64 = several.iter().map(|variance| weight(*variance)).sum();
        let weighted: f64 = several.iter().map(|variance| weight(*variance) * variance).sum();
        let freedom = deviations.iter().map(|of_one| freedom(of_one)).sum::<f64>().max(1.0);
        Self {
            one_person: 1.0 / (1.0 + sum / beside_greatest(OF_ONE_PERSON)),
            variety: (weighted / sum).sqrt(),
            // What people in general differ by is known. What these differ by is an estimate.
            freedom: freedom / (1.0 - weight(1.0) / sum),
        }
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

/// The logarithm of how probable these deviations from their mean are with this variance, up to a term that is the same for all.
fn log_likelihood(deviations: &[f64], variance: f64) -> f64 {
    let squares: f64 = deviations.iter().map(|deviation| deviation.powi(2)).sum();
    -(freedom(deviations) * variance.ln() + squares / variance) / 2.0
}

fn freedom(deviations: &[f64]) -> f64 {
    deviations.len().saturating_sub(1) as f64
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
        let variety =
            |deviations: &[f64]| People::who_showed(&[deviations.to_vec(), deviations.to_vec()]).variety;
        assert!((1.0..1.1).contains(&variety(&spread(1.0))));
        assert!((1.2..1.9).contains(&variety(&spread(1.3))), "nobody knows");
        assert!((1.9..2.5).contains(&variety(&spread(2.0))));
        assert!((2.9..3.1).contains(&variety(&spread(9.0))), "more was never measured");
        let freedom = |deviation| People::who_showed(&[spread(deviation), spread(deviation)]).freedom;
        assert!(freedom(1.0) > 100.0 && (12.0..12.1).contains(&freedom(3.0)), "an estimate of 12");
        assert_eq!(variety(&[-9.0, 0.0, 9.0]), 1.0, "three runs show too little");
        assert_eq!(People::who_showed(&[]), People { one_person: 0.5, ..People::IN_GENERAL });
        let alike = People::who_showed(&[vec![0.0; 9999]]);
        assert!(alike.one_person == 1.0 && alike.variety == 1.0, "nothing overflows: {alike:?}");
    }

    #[test]
    fn people_who_are_alike_in_pace_and_strokes_by_chance_are_not_one_person_if_they_pause_as_people_do() {
        let one_person = |all: &[f64]| {
            People::who_showed(&all.iter().map(|deviation| spread(*deviation)).collect::<Vec<_>>()).one_person
        };
        let alike = OF_ONE_PERSON.sqrt();
        assert!(one_person(&[alike, alike]) > 0.95);
        assert!(one_person(&[alike, alike, alike]) > 0.99);
        assert!(one_person(&[0.6, 0.6]) > 0.5 && one_person(&[0.6, 0.6, 1.0]) < 0.05);
    }

    #[test]
    fn people_differ_as_much_as_all_that_is_measured_of_them_says() {
        let variety = |all: [f64; 3]| People::who_showed(&all.map(spread)).variety;
        assert!(variety([2.0, 2.0, 2.0]) > 1.95);
        // What is more in two measures and as usual in a third one is more likely chance.
        assert!(variety([1.5, 1.5, 0.9]) < variety([1.5, 1.5, 1.5]));
    }
}
