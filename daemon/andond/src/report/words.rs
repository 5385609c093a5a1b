//! Verdicts as sentences for a technician.

use std::collections::HashMap;

use andon_core::couple::Context;
use andon_core::input::Side;
use andon_core::verdict::{Level, Outcome, Reason, Verdict};
use andon_learn::recording::NamedObject;

/// Names of the objects, by id.
#[derive(Clone, Debug, Default)]
pub struct Names(HashMap<u16, String>);

impl Names {
    /// Names by id; an object without a name is called by its number.
    pub fn new(names: impl IntoIterator<Item = (u16, String)>) -> Self {
        Self(names.into_iter().collect())
    }

    /// The names in the head of a recording, or in a job file.
    pub fn of_objects(objects: &[NamedObject]) -> Self {
        Self::new(objects.iter().map(|object| (object.shape.id, object.name.clone())))
    }

    /// The name of object `id`.
    pub fn object(&self, id: u16) -> String {
        self.0.get(&id).filter(|name| !name.is_empty()).cloned().unwrap_or_else(|| format!("object {id}"))
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
    if let Some(why) = because(verdict) {
        line += &format!(": {why}");
    }
    if verdict.early {
        line += ", decided early";
    }
    line
}

fn because(verdict: &Verdict) -> Option<String> {
    let near =
        verdict.nearest.map(|nearest| format!(" of nominal activity {}", nearest + 1)).unwrap_or_default();
    Some(match verdict.reason {
        Reason::None => return None,
        Reason::WrongObject => "this object does not belong here".into(),
        Reason::WrongOrder => "not now: it belongs elsewhere in the job".into(),
        Reason::Motion => match (verdict.distance, verdict.threshold) {
            (Some(distance), Some(threshold)) => {
                format!("not the motion{near}, distance {distance:.2} over {threshold:.2}")
            }
            _ => format!("not the motion{near}"),
        },
        Reason::TooShort => format!("cut short against the demonstrations{near}"),
        Reason::TooLong => format!("longer than in any demonstration{near}"),
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

#[cfg(test)]
mod tests {
    use super::*;

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
            early: true,
            began_ns: 0,
            ended_ns: 1_000_000_000,
            decided_ns: 1_250_000_000,
        };
        assert_eq!(
            verdict_sentence(&verdict, &names),
            "   1.25 s  right  ANOMALY     activity 1 IU 2 (polisher at brick): not the motion of nominal activity 1, \
             distance 3.50 over 2.25, decided early"
        );
    }

    #[test]
    fn an_object_without_a_name_is_called_by_its_number() {
        assert_eq!(Names::default().context(Context([0, 0, 6, 3])), "object 6 left at object 3");
    }
}
