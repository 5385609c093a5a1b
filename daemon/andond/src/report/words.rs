//! Verdicts as sentences for a technician.

use std::collections::HashMap;

use andon_core::couple::Context;
use andon_core::input::Side;
use andon_core::verdict::{BrokenOrder, Level, Note, OrderFault, Outcome, Reason, Verdict};
use andon_learn::job_file::JobFile;
use andon_learn::recording::NamedObject;

use crate::wire::verdict::measured_words;

/// Names of the objects, by id, and of the steps of the job, by the number of the activity.
#[derive(Clone, Debug, Default)]
pub struct Names {
    objects: HashMap<u16, String>,
    steps: Vec<Step>,
}

/// A step of the job: its name, and the contexts of its IUs as most runs have them.
#[derive(Clone, Debug, Default)]
struct Step {
    name: String,
    contexts: Vec<Context>,
}

impl Names {
    /// Names by id; an object without a name is called by its number.
    pub fn new(names: impl IntoIterator<Item = (u16, String)>) -> Self {
        Self { objects: names.into_iter().collect(), steps: Vec::new() }
    }

    /// The names of a job: its objects, and its steps, which are otherwise called by their numbers.
    pub fn of_job(job: &JobFile) -> Self {
        let step = |number: usize| Step { name: job.step_name(number), contexts: job.step_contexts(number) };
        let steps = (0..job.steps.len()).map(step).collect();
        Self { steps, ..Self::of_objects(&job.objects) }
    }

    /// The step that an activity of the job is, counted from 1.
    fn step(&self, activity: u16) -> String {
        let name = self.steps.get(usize::from(activity)).map(|step| format!(" ({})", step.name));
        format!("step {}{}", activity + 1, name.unwrap_or_default())
    }

    /// What was expected instead of what a verdict is about: another step, or another context within the nearest one.
    pub fn expected(&self, verdict: &Verdict) -> Option<String> {
        match (verdict.outcome, verdict.broken) {
            (Outcome::Anomaly, Some(BrokenOrder { fault, activity, .. })) => {
                matches!(fault, OrderFault::NotBegun | OrderFault::NotEnded).then(|| self.step(activity))
            }
            (Outcome::Anomaly, None) => {
                let nearest = verdict.nearest?;
                let contexts = self.steps.get(usize::from(nearest)).map(|step| &step.contexts);
                let context = contexts.zip(verdict.iu).and_then(|(all, iu)| all.get(usize::from(iu)));
                let other = context.filter(|context| **context != verdict.context);
                Some(other.map_or_else(|| self.step(nearest), |context| self.context(*context)))
            }
            _ => None,
        }
    }

    /// What came, in words; a job is more than a few words can say.
    pub fn got(&self, verdict: &Verdict) -> Option<String> {
        (verdict.level != Level::Job).then(|| self.context(verdict.context))
    }

    /// The names in the head of a recording, or in a job file.
    pub fn of_objects(objects: &[NamedObject]) -> Self {
        Self::new(objects.iter().map(|object| (object.shape.id, object.name.clone())))
    }

    /// The name of object `id`.
    pub fn object(&self, id: u16) -> String {
        self.objects
            .get(&id)
            .filter(|name| !name.is_empty())
            .cloned()
            .unwrap_or_else(|| format!("object {id}"))
    }

    /// A context in words: which object is in which hand, or at which other object.
    pub fn context(&self, context: Context) -> String {
        match context.0 {
            [0, 0, 0, 0] => "idle".into(),
            [0, 0, j, l] => format!("{} left at {}", self.object(j), self.object(l)),
            [_, j, _, 0] => format!("{} in hand", self.object(j)),
            [_, j, _, l] => format!("{} at {}", self.object(j), self.object(l)),
        }
    }
}

/// One line: the time, the hand, the outcome, what was judged, and why.
pub fn verdict_sentence(verdict: &Verdict, names: &Names) -> String {
    let activity = verdict.activity + 1;
    let context = || names.context(verdict.context);
    let level = match verdict.level {
        Level::Iu => format!("activity {activity} IU {} ({})", verdict.iu.map_or(0, |iu| iu + 1), context()),
        Level::Activity => format!("activity {activity} ({})", context()),
        Level::Job => "job".to_string(),
    };
    let hand = verdict.side.map_or("", Side::name);
    let outcome = match verdict.outcome {
        Outcome::Ok => "ok",
        Outcome::Anomaly => "ANOMALY",
        Outcome::NotJudged => "NOT JUDGED",
    };
    let mut line = format!("{:7.2} s  {hand:5}  {outcome:10}  {level}", verdict.decided_ns as f64 / 1e9);
    if let Some(why) = because(verdict, names) {
        line += &format!(": {why}");
    }
    if let Some(note) = verdict.note {
        line += &format!("; not shown before: {}, was it right?", note_words(note));
    }
    if verdict.early {
        line += ", decided early";
    }
    line
}

const fn note_words(note: Note) -> &'static str {
    match note {
        Note::Order => "this order",
        Note::Again => "the same step again",
        Note::OtherHand => "the other hand",
        Note::Step => "a step with these parts",
    }
}

fn broken_words(BrokenOrder { fault, activity, runs }: BrokenOrder, names: &Names) -> String {
    let other = names.step(activity);
    match fault {
        OrderFault::NotBegun => {
            format!("it began before {other} had begun; in all {runs} runs it came after")
        }
        OrderFault::NotEnded => {
            format!("it began before {other} had ended; in all {runs} runs it came after")
        }
        OrderFault::TooLate => format!("it began after {other}; in all {runs} runs it came before"),
        OrderFault::Again => format!("{other} was done already; in all {runs} runs it came once"),
    }
}

/// Why: the rule, or the measure that says it better.
fn because(verdict: &Verdict, names: &Names) -> Option<String> {
    let measured = verdict.measured.map(|measured| measured_words(measured).to_string());
    match (verdict.outcome, rule(verdict, names), measured) {
        (Outcome::NotJudged, Some(rule), Some(measured)) => Some(format!("{rule}; measured: {measured}")),
        (_, rule, measured) => measured.or(rule),
    }
}

/// The rule that decided.
fn rule(verdict: &Verdict, names: &Names) -> Option<String> {
    let near =
        verdict.nearest.map(|nearest| format!(" of nominal activity {}", nearest + 1)).unwrap_or_default();
    let instead = names.expected(verdict).map(|other| format!(", expected {other}")).unwrap_or_default();
    Some(match verdict.reason {
        Reason::None => return None,
        Reason::WrongObject => format!("this object does not belong here{instead}"),
        Reason::WrongOrder => match verdict.broken {
            Some(broken) => broken_words(broken, names),
            None => format!("not now: it belongs elsewhere in the job{instead}"),
        },
        Reason::Motion => match (verdict.distance, verdict.threshold) {
            (Some(distance), Some(threshold)) => {
                format!("{}: distance {distance:.2} over {threshold:.2}", motion_words(&near))
            }
            _ => motion_words(&near),
        },
        Reason::TooShort => format!("cut short against the demonstrations{near}"),
        Reason::TooLong => format!("longer than in any demonstration{near}"),
        Reason::NotCompleted if verdict.level == Level::Job => match verdict.nearest {
            Some(nearest) => format!("ended without {}", names.step(nearest)),
            None => "ended before its last step".into(),
        },
        Reason::NotCompleted => "ended before its last part".into(),
        Reason::Unknown => "nothing to compare it with".into(),
        Reason::Blind => "the hand or the part was out of sight for too long".into(),
        Reason::Overload => match verdict.captured_percent {
            Some(percent) if percent < 100 => {
                format!("only {percent} of 100 frames came, fewer than the job needs")
            }
            Some(_) => "it lasted longer than can be compared".into(),
            None => "fewer frames came than the job needs, or a step was too long".into(),
        },
    })
}

/// `near` names the activity that comes nearest, if there is one.
fn motion_words(near: &str) -> String {
    if near.is_empty() { "the motion differs".into() } else { format!("the motion differs from that{near}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_core::verdict::{Measure, Measured};

    #[test]
    fn a_sentence_names_the_parts_the_rule_and_the_figures() {
        let names = Names::new([(5, "polisher".to_string()), (6, "brick".to_string())]);
        let verdict = Verdict {
            level: Level::Iu,
            outcome: Outcome::Anomaly,
            reason: Reason::Motion,
            side: Some(Side::Right),
            nearest: Some(0),
            activity: 0,
            iu: Some(1),
            context: Context([1, 5, 5, 6]),
            distance: Some(3.5),
            threshold: Some(2.25),
            captured_percent: Some(100),
            measured: None,
            broken: None,
            note: None,
            early: true,
            began_ns: 0,
            ended_ns: 1_000_000_000,
            decided_ns: 1_250_000_000,
        };
        assert_eq!(
            verdict_sentence(&verdict, &names),
            "   1.25 s  right  ANOMALY     activity 1 IU 2 (polisher at brick): the motion differs from that of nominal activity 1: \
             distance 3.50 over 2.25, decided early"
        );
        let strokes = Measured { measure: Measure::Strokes, value: 4.0, shown_min: 6.0, shown_max: 6.0 };
        let short = Verdict { reason: Reason::TooShort, measured: Some(strokes), early: false, ..verdict };
        let start = "   1.25 s  right  ANOMALY     activity 1 IU 2 (polisher at brick): ";
        assert_eq!(verdict_sentence(&short, &names), format!("{start}4 strokes, shown 6 to 6"));
        let unjudged = Verdict { outcome: Outcome::NotJudged, reason: Reason::Blind, ..short };
        assert_eq!(
            verdict_sentence(&unjudged, &names),
            "   1.25 s  right  NOT JUDGED  activity 1 IU 2 (polisher at brick): the hand or the part was out of sight for too \
             long; measured: 4 strokes, shown 6 to 6"
        );
        let broken = BrokenOrder { fault: OrderFault::NotEnded, activity: 0, runs: 6 };
        let contexts = vec![Context([2, 5, 0, 0]), Context([2, 5, 5, 6])];
        let names = Names { steps: vec![Step { name: "left hand: box".to_string(), contexts }], ..names };
        let order = Verdict {
            level: Level::Activity,
            reason: Reason::WrongOrder,
            broken: Some(broken),
            early: false,
            ..verdict
        };
        assert_eq!(
            verdict_sentence(&order, &names),
            "   1.25 s  right  ANOMALY     activity 1 (polisher at brick): it began before step 1 (left hand: box) had ended; \
             in all 6 runs it came after"
        );
        let elsewhere = Verdict { level: Level::Iu, reason: Reason::WrongObject, broken: None, ..order };
        assert_eq!(
            verdict_sentence(&Verdict { context: Context([1, 9, 0, 0]), ..elsewhere }, &names),
            "   1.25 s  right  ANOMALY     activity 1 IU 2 (object 9 in hand): this object does not belong here, expected \
             polisher at brick"
        );
        let ended = Verdict { level: Level::Job, reason: Reason::NotCompleted, iu: None, ..elsewhere };
        assert_eq!(
            verdict_sentence(&ended, &names),
            "   1.25 s  right  ANOMALY     job: ended without step 1 (left hand: box)"
        );
        assert_eq!(
            (names.expected(&ended).as_deref(), names.got(&ended)),
            (Some("step 1 (left hand: box)"), None)
        );
        let noted = Verdict {
            level: Level::Job,
            outcome: Outcome::Ok,
            reason: Reason::None,
            note: Some(Note::Again),
            ..order
        };
        let noted = Verdict { side: None, broken: None, ..noted };
        assert_eq!(
            verdict_sentence(&noted, &names),
            "   1.25 s         ok          job; not shown before: the same step again, was it right?"
        );
    }

    #[test]
    fn an_object_without_a_name_is_called_by_its_number() {
        assert_eq!(Names::default().context(Context([0, 0, 6, 3])), "object 6 left at object 3");
    }
}
