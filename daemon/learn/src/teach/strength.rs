//! How strong each rule of a job is. Every run that is shown is right, so a rule is law only as far as no run contradicts it that was left out.

use andon_core::couple::Context;
use andon_core::verdict::{Level, Measure, OrderFault, Outcome, Reason, Verdict};
use std::collections::BTreeMap;

/// A step of a job, whatever its number there is. The hand and the object that it begins with, and how many steps before it begin so.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct StepKey {
    pub(super) opening: [u16; 2],
    /// The number of earlier steps with the same opening.
    pub(super) nth: usize,
}

/// A rule of a job that a run can break.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rule {
    /// The step has these IUs, and no others.
    Sequence(StepKey),
    /// No job is complete without the step.
    Required(StepKey),
    /// The step comes no second time.
    Once(StepKey),
    /// One step comes before the other one; in whichever order.
    Order(StepKey, StepKey),
    /// The motion of the IUs of the step with this context.
    Motion(StepKey, Context),
    /// What these IUs measure.
    Measure(StepKey, Context, Measure),
}

/// How much of a rule is left: by how many steps its bound is wider than people in general and these runs say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Strength(u8);

/// What a bound is widened by each time that a run that was left out still lies beyond it. In smaller steps each run costs more judgements. Where one
/// run of seven made strokes of 8.7 cm against a bound of 8.4 cm, one step was enough.
const WIDENING_STEP: f64 = 1.25;

impl Strength {
    /// As strong as what is known of people in general and these runs make it.
    pub(super) const GENERAL: Self = Self(0);

    /// It is no law. A bound that is widened by one step more would mean nothing: half or twice as much as the runs show would be right.
    pub(super) const NONE: Self = Self(5);

    /// How much wider a bound is than the runs make it.
    pub(super) fn wider(self) -> f64 {
        WIDENING_STEP.powi(self.0.into())
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Strengths(BTreeMap<Rule, Strength>);

impl Strengths {
    pub(super) fn of(&self, rule: Rule) -> Strength {
        self.0.get(&rule).copied().unwrap_or_default()
    }

    pub(super) fn is_law(&self, rule: Rule) -> bool {
        self.of(rule) == Strength::GENERAL
    }

    /// A run that was left out breaks the rule. Whether that makes it any weaker.
    pub(super) fn weaken(&mut self, rule: Rule) -> bool {
        let before = self.of(rule);
        let after = match rule {
            Rule::Motion(..) | Rule::Measure(..) => Strength(before.0 + 1).min(Strength::NONE),
            _ => Strength::NONE,
        };
        self.0.insert(rule, after);
        after != before
    }

    /// The rules that are weaker than in general.
    pub(super) fn weakened(&self) -> impl Iterator<Item = (Rule, Strength)> {
        self.0.iter().map(|(rule, strength)| (*rule, *strength))
    }
}

impl StepKey {
    /// The context of the hand with the object alone.
    pub(super) fn context(self) -> Context {
        Context([self.opening[0], self.opening[1], 0, 0])
    }
}

impl Rule {
    /// The rule of the job with these steps that this verdict says is broken, if it says so and there is one.
    pub(super) fn broken_by(verdict: &Verdict, steps: &[StepKey]) -> Option<Self> {
        if verdict.outcome != Outcome::Anomaly {
            return None;
        }
        let step = *steps.get(usize::from(verdict.nearest?))?;
        if let Some(broken) = verdict.broken {
            let other = *steps.get(usize::from(broken.activity))?;
            let is_again = broken.fault == OrderFault::Again;
            return Some(if is_again {
                Self::Once(step)
            } else {
                Self::Order(step.min(other), step.max(other))
            });
        }
        let context = by_hand_of(verdict.context, step);
        match (verdict.level, verdict.reason, verdict.measured) {
            (Level::Iu, _, Some(measured)) => Some(Self::Measure(step, context, measured.measure)),
            (Level::Iu, Reason::Motion, None) => Some(Self::Motion(step, context)),
            (Level::Iu, Reason::TooLong | Reason::TooShort, None) => {
                Some(Self::Measure(step, context, Measure::Duration))
            }
            (Level::Iu, Reason::WrongObject | Reason::WrongOrder, None) => Some(Self::Sequence(step)),
            (Level::Activity, Reason::NotCompleted, _) => Some(Self::Sequence(step)),
            (Level::Job, Reason::NotCompleted, _) => Some(Self::Required(step)),
            _ => None,
        }
    }
}

/// The context as the hand of this step has it.
fn by_hand_of(context: Context, step: StepKey) -> Context {
    let Context([hand, rest @ ..]) = context;
    if hand == 0 { context } else { Context([step.opening[0], rest[0], rest[1], rest[2]]) }
}
