//! The first lines of the report: whether the job can be used, why, and what to do.

use super::Doubt;
use andon_core::couple::Context;

/// One sentence, then, for each doubt, what to do about it. `used` of `runs` runs were learnt from; `words` puts a context into words.
pub(in crate::teach) fn summary(
    used: usize,
    runs: usize,
    doubts: &[Doubt],
    words: &dyn Fn(Context) -> String,
) -> Vec<String> {
    let Some((first, others)) = doubts.split_first() else { return vec![usable(used, runs)] };
    let mut lines = vec![format!("not usable, because {}.", first.sentence(words))];
    lines.push(format!("  What to do: {}.", first.remedy()));
    for doubt in others {
        lines.push(format!("  And {}.", doubt.sentence(words)));
        lines.push(format!("  What to do: {}.", doubt.remedy()));
    }
    lines
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
