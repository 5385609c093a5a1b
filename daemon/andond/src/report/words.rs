//! Verdicts as sentences for a technician.

use std::collections::HashMap;

use andon_core::couple::Context;
use andon_core::verdict::{Kind, Reason, Verdict};

use super::json::{is_job, side_name};

/// Names of the objects, by id.
#[derive(Clone, Debug, Default)]
pub struct Names(HashMap<u16, String>);

impl Names {
    /// Names by id; what has none is called by its number.
    pub fn new(names: impl IntoIterator<Item = (u16, String)>) -> Self {
        Self(names.into_iter().collect())
    }

    /// What object `id` is called.
    pub fn object(&self, id: u16) -> String {
        self.0.get(&id).filter(|name| !name.is_empty()).cloned().unwrap_or_else(|| format!("object {id}"))
    }

    /// What happens in a context.
    pub fn context(&self, context: Context) -> String {
        match context.0 {
            [0, 0, 0, 0] => "idle".into(),
            [0, 0, j, l] => format!("{} left at {}", self.object(j), self.object(l)),
            [_, j, _, 0] => format!("{} in hand", self.object(j)),
            [_, j, _, l] => format!("{} at {}", self.object(j), self.object(l)),
        }
    }
}

/// Whether the cord is pulled.
pub fn is_anomaly(verdict: &Verdict) -> bool {
    matches!(verdict.kind, Kind::IuAnomaly | Kind::ActivityAnomaly | Kind::JobAnomaly)
}

/// One line: time, what, how it came out and why.
pub fn verdict_sentence(verdict: &Verdict, names: &Names) -> String {
    let level = match (is_job(verdict), verdict.iu) {
        (true, _) => "job".to_string(),
        (false, Some(iu)) => {
            format!("activity {} IU {} ({})", verdict.activity + 1, iu + 1, names.context(verdict.context))
        }
        (false, None) => format!("activity {} ({})", verdict.activity + 1, names.context(verdict.context)),
    };
    let hand = verdict.side.map_or("", side_name);
    let outcome = match verdict.kind {
        Kind::IuOk | Kind::ActivityOk | Kind::JobOk => "ok",
        Kind::IuAnomaly | Kind::ActivityAnomaly | Kind::JobAnomaly => "ANOMALY",
        Kind::NotJudged => "NOT JUDGED",
    };
    let mut line = format!("{:7.2} s  {hand:5}  {outcome:10}  {level}", verdict.decided_ns as f64 / 1e9);
    if let Some(why) = because(verdict) {
        line += &format!(": {why}");
    }
    if verdict.early {
        line += ", said early";
    }
    line
}

fn because(verdict: &Verdict) -> Option<String> {
    let near =
        verdict.nearest.map(|nearest| format!(" of nominal activity {}", nearest + 1)).unwrap_or_default();
    Some(match verdict.reason {
        Reason::None => return None,
        Reason::WrongObject => "this object has no place here".into(),
        Reason::WrongOrder => "not now: its place is elsewhere in the job".into(),
        Reason::Motion => match (verdict.distance, verdict.threshold) {
            (Some(distance), Some(threshold)) => {
                format!("not the motion{near}, distance {distance:.2} over {threshold:.2}")
            }
            _ => format!("not the motion{near}"),
        },
        Reason::TooShort => format!("cut short against the demonstrations{near}"),
        Reason::TooLong => format!("longer than in any demonstration{near}"),
        Reason::NotCompleted => "ended before its last part".into(),
        Reason::Unknown => "it could not be told".into(),
        Reason::Blind => "the hand or the part was out of sight for too long".into(),
        Reason::Overload => "more came than fits the memory that is set aside".into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_core::input::Side;

    #[test]
    fn a_sentence_names_the_parts_the_rule_and_the_figures() {
        let names = Names::new([(5, "polisher".to_string()), (6, "brick".to_string())]);
        let verdict = Verdict {
            kind: Kind::IuAnomaly,
            reason: Reason::Motion,
            side: Some(Side::Right),
            nearest: Some(0),
            activity: 0,
            iu: Some(1),
            context: Context([1, 5, 5, 6]),
            distance: Some(3.5),
            threshold: Some(2.25),
            early: true,
            began_ns: 0,
            ended_ns: 1_000_000_000,
            decided_ns: 1_250_000_000,
        };
        assert_eq!(
            verdict_sentence(&verdict, &names),
            "   1.25 s  right  ANOMALY     activity 1 IU 2 (polisher at brick): not the motion of nominal activity 1, \
             distance 3.50 over 2.25, said early"
        );
    }

    #[test]
    fn an_object_without_a_name_is_called_by_its_number() {
        assert_eq!(Names::default().context(Context([0, 0, 6, 3])), "object 6 left at object 3");
    }
}
