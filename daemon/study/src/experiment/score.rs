//! From the verdicts on one execution to a score for each nominal IU and activity.
//!
//! The paper counts nominal IUs and activities whether they were carried out or not: a step that is missing counts as judged anomalous.
//! The release state `[0, 0, j, l]`, which the paper does not list in its second experiment, is counted with the IU that it follows.

use andon_core::couple::Context;
use andon_core::verdict::{Level, Outcome, Verdict};
use andon_learn::job_file::{JobFile, TaughtActivity, TaughtIu};

/// Which nominal activities and IUs of one execution were judged anomalous.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Score {
    /// One score per activity of the job, in the order of the job.
    pub(super) activities: Vec<ActivityScore>,
}

/// Whether one nominal activity and its IUs were judged anomalous.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ActivityScore {
    /// Whether the activity was.
    pub(super) is_accused: bool,
    /// Whether each of the IUs that are counted was.
    pub(super) accused_ius: Vec<bool>,
}

/// Scores one execution by its verdicts.
pub(super) fn score(job: &JobFile, verdicts: &[Verdict]) -> Score {
    let mut nominal: Vec<&TaughtActivity> = Vec::new();
    for taught in &job.activities {
        // The most common sequence of an activity comes first.
        if nominal.iter().all(|other| other.activity != taught.activity) {
            nominal.push(taught);
        }
    }
    Score { activities: nominal.into_iter().map(|taught| score_activity(taught, verdicts)).collect() }
}

fn score_activity(taught: &TaughtActivity, verdicts: &[Verdict]) -> ActivityScore {
    let indices = counted_indices(taught);
    let count = indices.last().map_or(0, |last| last + 1);
    let (mut was_judged, mut was_accused) = (vec![false; count], vec![false; count]);
    let mut activity_accused = None;
    for verdict in verdicts.iter().filter(|verdict| verdict.nearest == Some(taught.activity)) {
        match (verdict.level, verdict.outcome) {
            (Level::Activity, Outcome::Ok) => activity_accused = Some(activity_accused.unwrap_or(false)),
            (Level::Activity, Outcome::Anomaly) => activity_accused = Some(true),
            (Level::Iu, outcome) => {
                let Some(number) = verdict.iu else { continue };
                let index = indices[nominal_iu(taught, verdict.context, usize::from(number))];
                was_judged[index] = true;
                was_accused[index] |= outcome != Outcome::Ok;
            }
            (Level::Activity, Outcome::NotJudged) | (Level::Job, _) => {}
        }
    }
    let accused_ius =
        was_judged.iter().zip(was_accused).map(|(judged, accused)| accused || !judged).collect();
    ActivityScore { is_accused: activity_accused.unwrap_or(true), accused_ius }
}

/// For each IU of an activity its index among the counted ones. A release state has the index of the IU before it.
fn counted_indices(activity: &TaughtActivity) -> Vec<usize> {
    let mut count = 0;
    let index = |(number, iu): (usize, &TaughtIu)| {
        if iu.context.is_touch() || number == 0 {
            count += 1;
        }
        count - 1
    };
    activity.ius.iter().enumerate().map(index).collect()
}

/// The index of the IU that has this context and is nearest to this number; if there is none, the number itself.
fn nominal_iu(taught: &TaughtActivity, context: Context, number: usize) -> usize {
    let last = taught.ius.len() - 1;
    (0..=last)
        .filter(|&index| taught.ius[index].context == context)
        .min_by_key(|index| index.abs_diff(number))
        .unwrap_or(number.min(last))
}
