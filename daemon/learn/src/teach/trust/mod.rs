//! Whether the runs can be trusted. Nobody checks a job again once it is taught, so a demonstration that is not what it is taken for must be noticed
//! here.
//!
//! A [`Doubt`] speaks against learning from the runs. It accuses nobody: it is a sentence with the figure and with what to do, and whoever
//! knows better teaches all the same. What was not seen of a run ([`Occluded`](super::Occluded)) is not learnt, and the rest of the run is.

mod order;
mod outlier;
mod twice;

pub use outlier::Outlier;
pub(super) use twice::without_copies;

use super::options::TeachOptions;
use super::sequence::Agreement;
use crate::job_file::context_words;
use crate::recording::object_name;
use crate::run::Run;
use andon_core::config::Method;

/// The least frame rate of a run, as a share of that of the grid. Jobs were taught by five simulated people (three seeds) at 30 frames per second and
/// thinned evenly. From every second frame they found 12 of 12 `J1` of other people, and from every third frame 3 of 12. The motion is then measured
/// in so few places that any motion is near it. The frames of a real camera come a little late now and then, hence not 0.5.
const MIN_SHARE: f64 = 0.45;

/// What speaks against learning from the runs, and what to do about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubt {
    /// What speaks against them, as a sentence without its full stop.
    pub sentence: String,
    /// What to do about it, as a sentence without its full stop.
    pub remedy: String,
    /// The demonstration that is not like the others, if it is about one.
    pub outlier: Option<Outlier>,
}

impl Doubt {
    fn new(sentence: String, remedy: String) -> Self {
        Self { sentence, remedy, outlier: None }
    }

    /// That a demonstration is not like the others; `figures` says in what.
    fn of(outlier: Outlier, figures: &str) -> Self {
        let run = &outlier.run;
        Self {
            sentence: format!("{run} is not like the others: {figures}"),
            remedy: format!(
                "look at {run}: leave it out if it is not correct; if it is, show more runs like it"
            ),
            outlier: Some(outlier),
        }
    }
}

/// The names with the verb, in the singular for one of them.
fn names(names: &[String], [has, have]: [&str; 2]) -> String {
    format!("{} {}", names.join(", "), if names.len() == 1 { has } else { have })
}

#[derive(Debug)]
pub(super) struct Odd {
    pub(super) doubts: Vec<Doubt>,
    /// Demonstrations that stand out where that changes nothing that the others prove: was it right?
    pub(super) questions: Vec<Outlier>,
    /// Demonstrations in which there is only a pause.
    pub(super) pauses: Vec<Outlier>,
}

/// That runs have so few frames that their motion is not known.
pub(super) fn too_few_frames(runs: &[Run], method: &Method) -> Option<Doubt> {
    let [grid_hz, min_hz] = [1.0, MIN_SHARE].map(|share| share * f64::from(method.rate_hz));
    let rates = runs.iter().map(|run| (run.name.clone(), run.captured_rate_hz()));
    let (slow, rates): (Vec<String>, Vec<f64>) = rates.filter(|(_, rate)| *rate < min_hz).unzip();
    let (least_hz, enough_hz) = (rates.into_iter().min_by(f64::total_cmp)?, 0.5 * grid_hz);
    Some(Doubt::new(
        format!(
            "{} too few frames ({least_hz:.0} per second, {enough_hz:.0} are enough) to tell one motion from another",
            names(&slow, ["has", "have"])
        ),
        format!(
            "record at {enough_hz:.0} frames per second or more: more light for a shorter exposure, a faster camera or machine"
        ),
    ))
}

/// That so few runs agree that the job would be one that most of them do not show.
fn few_agree(used: usize, runs: usize) -> Option<Doubt> {
    let agree = if used == 1 { "agrees" } else { "agree" };
    (2 * used < runs || used == 1 && runs > 1).then(|| {
        Doubt::new(
            format!("only {used} of {runs} runs {agree} in their steps"),
            "look at the runs that were left out, below, and show at least as many again of the right kind"
                .to_owned(),
        )
    })
}

/// What stands out among these runs, once it is known what they have in common.
pub(super) fn odd_runs(runs: &[Run], agreement: &Agreement, options: &TeachOptions) -> Odd {
    let words = |context| context_words(context, |id| object_name(&runs[0].objects, id));
    let kept = agreement.used_runs(runs);
    // Whoever says that the order does not matter has seen that it differs.
    let has_order = options.order_matters != Some(false);
    let order = has_order.then(|| order::odd_one(&kept, agreement, &words)).flatten();
    let (pauses, odd): (Vec<_>, Vec<_>) =
        outlier::of_runs(runs, agreement, options).into_iter().partition(|outlier| outlier.is_pause);
    let (odd, questions): (Vec<_>, Vec<_>) = odd.into_iter().partition(|outlier| outlier.is_law_of_others);
    let odd = odd.into_iter().map(|outlier| {
        let figures = outlier.figures(&words);
        Doubt::of(outlier, &figures)
    });
    let doubts = few_agree(kept.len(), runs.len()).into_iter().chain(order).chain(odd).collect();
    Odd { doubts, questions, pauses }
}
