//! From the verdicts on one execution to what was said of each nominal IU and activity.
//!
//! The paper counts nominal IUs and activities, done or not: a step that is missing is accused by its absence. The release
//! state `[0, 0, j, l]`, which the paper does not list in its second experiment, is counted with the IU that it follows.

use crate::job_file::{JobFile, TaughtActivity};
use andon_core::couple::Context;
use andon_core::verdict::{Kind, Verdict};

/// What was said of one execution: for each nominal activity, for each of its IUs, whether it was accused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Score {
    /// For each activity of the job in order: accused, and which of its IUs.
    pub activities: Vec<(bool, Vec<bool>)>,
}

/// Which IUs of an activity are counted: the place of each in the count.
fn places(activity: &TaughtActivity) -> Vec<usize> {
    let mut next = 0;
    let place = |(number, iu): (usize, &crate::job_file::TaughtIu)| {
        if iu.context.0[0] != 0 || number == 0 {
            next += 1;
        }
        next - 1
    };
    activity.ius.iter().enumerate().map(place).collect()
}

/// What the verdicts say of each nominal activity and IU.
pub fn score(job: &JobFile, verdicts: &[Verdict]) -> Score {
    let mut nominal: Vec<&TaughtActivity> = Vec::new();
    for taught in &job.activities {
        // The most common sequence of an activity comes first.
        if nominal.iter().all(|other| other.activity != taught.activity) {
            nominal.push(taught);
        }
    }
    let activities = nominal.into_iter().map(|taught| {
        let places = places(taught);
        let mut heard = vec![false; places.last().map_or(0, |last| last + 1)];
        let mut accused = heard.clone();
        let mut activity = None;
        for verdict in verdicts.iter().filter(|verdict| verdict.nearest == Some(taught.activity)) {
            match verdict.kind {
                Kind::ActivityOk => activity = Some(activity.unwrap_or(false)),
                Kind::ActivityAnomaly => activity = Some(true),
                Kind::IuOk | Kind::IuAnomaly | Kind::NotJudged => {
                    let Some(number) = verdict.iu else { continue };
                    let place = places[nominal_iu(taught, verdict.context, usize::from(number))];
                    heard[place] = true;
                    accused[place] |= verdict.kind != Kind::IuOk;
                }
                Kind::JobOk | Kind::JobAnomaly => {}
            }
        }
        let ius = heard.iter().zip(accused).map(|(heard, accused)| accused || !heard).collect();
        (activity.unwrap_or(true), ius)
    });
    Score { activities: activities.collect() }
}

/// The IU of the nominal activity that has this context and is nearest to this number; without one, the number itself.
fn nominal_iu(taught: &TaughtActivity, context: Context, number: usize) -> usize {
    let last = taught.ius.len() - 1;
    (0..=last)
        .filter(|&place| taught.ius[place].context == context)
        .min_by_key(|place| place.abs_diff(number))
        .unwrap_or(number.min(last))
}
