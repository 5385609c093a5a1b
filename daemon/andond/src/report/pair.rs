//! What was expected and what came, as two phrases of one kind: two measures, two contexts or two steps.

use andon_core::verdict::{BrokenOrder, Level, Measure, Measured, OrderFault, Outcome, Reason, Verdict};

use super::Names;
use crate::wire::verdict::measured_words;

impl Names {
    /// What was expected where a verdict is given, and what came, in words of one kind. The first is `None` where nothing is known of it, and of a
    /// job that is right; the second where it was not seen.
    pub fn expected_and_got(&self, verdict: &Verdict) -> (Option<String>, Option<String>) {
        let (expected, got) = (self.taught(verdict), self.done(verdict));
        match (verdict.outcome, verdict.broken, verdict.measured) {
            (Outcome::Ok, ..) => (expected, got),
            (Outcome::NotJudged, ..) => (expected, None),
            (Outcome::Anomaly, Some(broken), _) => {
                let [expected, got] = self.order(broken, got.unwrap_or_default());
                (Some(expected), Some(got))
            }
            (Outcome::Anomaly, None, Some(measured)) => {
                let [expected, got] = measures(measured);
                (Some(expected), Some(got))
            }
            // The same step, or the same parts: how it was done is what differs.
            (Outcome::Anomaly, None, None) if expected == got => {
                let got = got.map(|got| format!("{got}, {}", otherwise(verdict)));
                (expected, got)
            }
            (Outcome::Anomaly, None, None) => (expected, got),
        }
    }

    /// What the job has there: the parts of an IU, the name of a step.
    fn taught(&self, verdict: &Verdict) -> Option<String> {
        let step = verdict.nearest?;
        if verdict.level != Level::Iu {
            return Some(self.step(step));
        }
        let context = self.nominal(step, verdict.iu).map(|context| self.context(context));
        // Of a job that is not known only the numbers are.
        let end = || (!self.steps().is_empty()).then(|| format!("the end of {}", self.step(step)));
        context.or_else(end)
    }

    /// What was done, as [`Self::taught`] says it.
    fn done(&self, verdict: &Verdict) -> Option<String> {
        match (verdict.level, verdict.nearest) {
            (Level::Activity | Level::Job, Some(step)) => Some(self.step(step)),
            (Level::Job, None) => None,
            _ => Some(self.context(verdict.context)),
        }
    }

    /// A step against the order that was shown.
    fn order(&self, BrokenOrder { fault, activity, .. }: BrokenOrder, own: String) -> [String; 2] {
        let other = self.step(activity);
        match fault {
            OrderFault::NotBegun => [other, own],
            OrderFault::NotEnded => {
                ["after", "before"].map(|word| format!("{own} {word} the end of {other}"))
            }
            OrderFault::TooLate => ["before", "after"].map(|word| format!("{own} {word} {other}")),
            OrderFault::Again => ["once", "again"].map(|word| format!("{other} {word}")),
        }
    }
}

/// How what was done differs from what was shown, where the parts and the step are the same.
fn otherwise(verdict: &Verdict) -> &'static str {
    match verdict.reason {
        Reason::WrongObject => "with another part",
        Reason::WrongOrder => "in another order",
        Reason::TooShort => "shorter than shown",
        Reason::TooLong => "longer than shown",
        Reason::NotCompleted if verdict.level == Level::Job => "left out",
        Reason::NotCompleted => "not completed",
        _ => "in a wrong motion",
    }
}

/// A measure that is out of its bounds: what was shown and what came, each with its unit.
fn measures(measured: Measured) -> [String; 2] {
    let words = measured_words(measured).to_string();
    let (got, shown) = words.split_once(", shown ").unwrap_or((&words, ""));
    match measured.measure {
        Measure::Strokes => [format!("{shown} strokes"), got.to_owned()],
        Measure::Direction => [format!("{shown} degrees"), got.to_owned()],
        // The length of the way is in parentheses there.
        Measure::Path => {
            let got = got.split_once(" (").map_or(got, |(off, _)| off);
            [format!("a path of {}", shown.trim_end_matches(')')), got.to_owned()]
        }
        Measure::Duration | Measure::StrokeLength | Measure::LateralDeviation | Measure::Place => {
            [shown.to_owned(), got.to_owned()]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample::{names, wrong};
    use andon_core::couple::Context;

    #[track_caller]
    fn says(verdict: Verdict, expected: &str, got: &str) {
        let pair = names().expected_and_got(&verdict);
        // An empty text stands for nothing.
        let some = |words: &str| (!words.is_empty()).then(|| words.to_owned());
        assert_eq!(pair, (some(expected), some(got)));
    }

    #[test]
    fn of_an_iu_both_are_what_is_done_with_which_parts() {
        let iu = wrong(Reason::WrongObject);
        says(Verdict { context: Context([1, 5, 5, 3]), ..iu }, "polisher at brick", "polisher at meter");
        says(Verdict { iu: Some(7), ..iu }, "the end of step 1 (polish)", "polisher at brick");
        says(Verdict { nearest: None, ..iu }, "", "polisher at brick");
        let as_shown = |reason, got: &str| says(wrong(reason), "polisher at brick", got);
        as_shown(Reason::Motion, "polisher at brick, in a wrong motion");
        as_shown(Reason::TooShort, "polisher at brick, shorter than shown");
        as_shown(Reason::TooLong, "polisher at brick, longer than shown");
        says(Verdict { outcome: Outcome::Ok, ..iu }, "polisher at brick", "polisher at brick");
        says(Verdict { outcome: Outcome::NotJudged, ..iu }, "polisher at brick", "");
    }

    #[test]
    fn of_an_activity_and_a_job_both_are_steps() {
        let activity = |reason| Verdict { level: Level::Activity, iu: None, ..wrong(reason) };
        let job = |reason| Verdict { level: Level::Job, side: None, ..activity(reason) };
        says(activity(Reason::WrongObject), "step 1 (polish)", "step 1 (polish), with another part");
        says(activity(Reason::NotCompleted), "step 1 (polish)", "step 1 (polish), not completed");
        says(job(Reason::NotCompleted), "step 1 (polish)", "step 1 (polish), left out");
        says(Verdict { nearest: None, ..activity(Reason::WrongObject) }, "", "polisher at brick");
        says(Verdict { nearest: None, ..job(Reason::NotCompleted) }, "", "");
        let broken = |fault, expected: &str, got: &str| {
            let broken = Some(BrokenOrder { fault, activity: 0, runs: 5 });
            for verdict in [activity(Reason::WrongOrder), job(Reason::WrongOrder)] {
                says(Verdict { nearest: Some(1), broken, ..verdict }, expected, got);
            }
        };
        broken(OrderFault::NotBegun, "step 1 (polish)", "step 2 (measure)");
        broken(
            OrderFault::NotEnded,
            "step 2 (measure) after the end of step 1 (polish)",
            "step 2 (measure) before the end of step 1 (polish)",
        );
        broken(
            OrderFault::TooLate,
            "step 2 (measure) before step 1 (polish)",
            "step 2 (measure) after step 1 (polish)",
        );
        broken(OrderFault::Again, "step 1 (polish) once", "step 1 (polish) again");
    }

    #[test]
    fn of_a_measure_both_are_figures_with_their_unit() {
        let says = |measure, value, [shown_min, shown_max]: [f32; 2], expected: &str, got: &str| {
            let measured = Some(Measured { measure, value, shown_min, shown_max });
            says(Verdict { measured, ..wrong(Reason::TooShort) }, expected, got);
        };
        says(Measure::Strokes, 3.0, [6.0, 6.0], "6 strokes", "3 strokes");
        says(Measure::Duration, 2.1, [4.8, 5.4], "4.8 to 5.4 s", "2.1 s");
        says(Measure::Path, 1.04, [0.49, 0.54], "a path of 49 to 54 cm", "25 cm off the shown path");
    }
}
