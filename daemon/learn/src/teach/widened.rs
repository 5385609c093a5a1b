//! What leaving one run out has changed, in words.

use super::leave_one_out::LeftOut;
use super::sequence::MIN_ALIKE;
use super::statement::Statement;
use super::strength::{Rule, StepKey, Strength};
use crate::distribution::Distribution;
use crate::statistics::at_most;
use andon_core::couple::Context;

/// How sure the stated maximum of the rate of false alarms is.
const CONFIDENCE: f64 = 0.95;

/// What leaving one run out has shown of a job with these steps that `used` runs teach, a sentence each. `words` puts a context into words.
pub(super) fn sentences(
    used: usize,
    left_out: Option<&LeftOut>,
    steps: &[StepKey],
    words: &dyn Fn(Context) -> String,
) -> Vec<Statement> {
    let Some(LeftOut { strengths, rejected_before, rejected, shown }) = left_out else {
        return vec![format!(
            "{used} run{} cannot show what another right run would be rejected for. From {MIN_ALIKE} runs on each is judged by what the others teach. \
             Until then whatever differs more than people in general is an anomaly, and any order of the steps is right",
            if used == 1 { "" } else { "s" }
        )
        .into()];
    };
    let mut sentences: Vec<Statement> = vec![rate(used, rejected).into()];
    let changed = rejected_before.iter().filter(|run| !rejected.contains(run)).count();
    if changed > 0 {
        sentences.push(format!(
            "{changed} of them would have been, had every rule been as strict as people in general allow ({}); so these rules give way:",
            rejected_before.join(", ")
        ).into());
    }
    let number = |step: StepKey| Some(1 + steps.iter().position(|other| *other == step)?);
    let line = |(rule, strength)| {
        let text = format!("  {}", rule_words(rule, strength, &number, words)?);
        let of_rule = shown.iter().filter(|((broken, _), _)| *broken == rule);
        Some(Statement {
            text,
            shown: of_rule.map(|((_, run), lies)| (Some(run.clone()), lies.clone())).collect(),
        })
    };
    sentences.extend(strengths.weakened().filter_map(line));
    sentences
}

/// How many right jobs would be rejected, as leaving one out has measured it.
fn rate(used: usize, rejected: &[String]) -> String {
    let most = 100.0 * at_most(rejected.len(), used, CONFIDENCE);
    let sure = format!(
        "with so few runs that promises no more than that at most {most:.0} of 100 right jobs are ({:.0} % sure)",
        100.0 * CONFIDENCE
    );
    match rejected.len() {
        0 => format!("none of your {used} runs is rejected by a job that the others teach: {sure}"),
        count => format!(
            "{count} of your {used} runs {} rejected by a job that the others teach ({}): {sure}; show more runs like these, from other people",
            if count == 1 { "is" } else { "are" },
            rejected.join(", ")
        ),
    }
}

fn rule_words(
    rule: Rule,
    strength: Strength,
    number: &dyn Fn(StepKey) -> Option<usize>,
    words: &dyn Fn(Context) -> String,
) -> Option<String> {
    let extent = match strength {
        Strength::GENERAL => return None,
        Strength::NONE => "no law, because the runs contradict it",
        _ => &format!("{:.1} times as wide", strength.wider()),
    };
    Some(match rule {
        Rule::Sequence(step) => format!("step {}: other contacts may come in between", number(step)?),
        Rule::Required(step) => format!("step {}: not required", number(step)?),
        Rule::Once(step) => format!("step {}: it may come again", number(step)?),
        Rule::Order(one, other) => format!("steps {} and {}: in either order", number(one)?, number(other)?),
        Rule::Motion(step, context) => {
            format!("step {} ({}): motion, {extent}", number(step)?, words(context))
        }
        Rule::Measure(step, context, measure) => {
            format!(
                "step {} ({}): {}, {extent}",
                number(step)?,
                words(context),
                Distribution::name(Some(measure))
            )
        }
    })
}
