//! The first lines of the report: whether the job can be used, why, and what to do.

use super::{Doubt, Outlier};
use crate::distribution::Distribution;
use crate::teach::statement::Statement;
use andon_core::couple::Context;

/// One sentence, then, for each doubt, what to do about it. `used` of `runs` runs were learnt from; `words` puts a context into words, and `lies` says
/// where a demonstration lies among the others.
pub(in crate::teach) fn summary(
    used: usize,
    runs: usize,
    doubts: &[Doubt],
    words: &dyn Fn(Context) -> String,
    lies: &dyn Fn(&Outlier) -> Distribution,
) -> Vec<Statement> {
    if doubts.is_empty() {
        return vec![usable(used, runs).into()];
    }
    let begins = ["not usable, because"].into_iter().chain(std::iter::repeat("  And"));
    let lines = |(begins, doubt): (&str, &Doubt)| {
        let lies = if let Doubt::Outlier(outlier) = doubt { Some(lies(outlier)) } else { None };
        let sentence = Statement::of_run(format!("{begins} {}.", doubt.sentence(words)), lies);
        [sentence, format!("  What to do: {}.", doubt.remedy()).into()]
    };
    begins.zip(doubts).flat_map(lines).collect()
}

fn usable(used: usize, runs: usize) -> String {
    match (used, runs) {
        (1, _) => "usable with care, because one run shows neither in which order the work may be done nor how much correct runs \
             differ: any order is accepted, and the thresholds are a guess from the spread of other people."
            .to_owned(),
        _ if used == runs => {
            format!("usable, because the {runs} runs agree in all their steps and none of them stands out.")
        }
        _ => format!(
            "usable, because {used} of {runs} runs agree in all their steps and none of these stands out; the rest was left out."
        ),
    }
}
