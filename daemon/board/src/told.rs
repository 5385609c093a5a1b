//! What is told of a verdict: the fault, what was expected, what came, what was not seen and what helps. People count steps from 1.

use shm_schemas::{
    HandCode, NO_INDEX, OrderFault, Verdict, VerdictLevel, VerdictMeasure, VerdictNote, VerdictOutcome,
    VerdictReason, decimals,
};

use crate::job::{Job, hand_key};
use crate::words::Table;

/// The same for every verdict with the same fault, so that they can be counted and looked for; `None` of what is simply right.
pub(crate) fn fault_key(verdict: &Verdict) -> Option<String> {
    let note = VerdictNote::try_from(verdict.note).unwrap_or(VerdictNote::None);
    let reason = VerdictReason::try_from(verdict.reason).unwrap_or(VerdictReason::Unknown);
    Some(match (reason, measure(verdict)) {
        (VerdictReason::None, None) if note == VerdictNote::None => return None,
        (VerdictReason::None, None) => format!("note.{}", note.name()),
        (_, Some(measure)) => {
            let side = if verdict.measured < verdict.shown_min { "below" } else { "above" };
            format!("fault.{}.{side}", measure.name())
        }
        (VerdictReason::NotCompleted, None) if level(verdict) == Some(VerdictLevel::Job) => {
            "fault.LeftOut".into()
        }
        (reason, None) => format!("fault.{}", reason.name()),
    })
}

/// How it came out, as the key of a word: what should be looked at is not simply right.
pub(crate) fn outcome_key(verdict: &Verdict) -> String {
    match verdict.outcome() {
        Ok(VerdictOutcome::Ok) if verdict.note != 0 => "outcome.note".to_owned(),
        outcome => format!("outcome.{}", outcome.map_or("not_judged", VerdictOutcome::name)),
    }
}

fn level(verdict: &Verdict) -> Option<VerdictLevel> {
    verdict.level().ok()
}

fn measure(verdict: &Verdict) -> Option<VerdictMeasure> {
    let measure = VerdictMeasure::try_from(verdict.measure).ok()?;
    (measure != VerdictMeasure::None && verdict.measured.is_finite()).then_some(measure)
}

/// What was measured, the minimum and the maximum that were shown, in units of the measure.
pub(crate) fn measures(verdict: &Verdict) -> Option<[f32; 3]> {
    measure(verdict).map(|_| [verdict.measured, verdict.shown_min, verdict.shown_max])
}

/// Tells of verdicts in one language, by the names of one job.
#[derive(Clone, Copy)]
pub(crate) struct Teller<'a> {
    pub(crate) words: &'a Table,
    pub(crate) job: &'a Job,
}

/// Expected, and what came instead.
type Pair = (String, String);

impl Teller<'_> {
    /// The fault of a verdict; empty where there is none.
    pub(crate) fn fault(&self, verdict: &Verdict) -> String {
        fault_key(verdict).map(|key| self.words.say(&key).to_owned()).unwrap_or_default()
    }

    /// The step that a verdict is about.
    pub(crate) fn step_of(&self, verdict: &Verdict) -> Option<String> {
        (verdict.nearest != NO_INDEX).then(|| self.step(verdict, verdict.nearest))
    }

    /// A step by its number and its name; only by its number where the verdict belongs to another job than is in force.
    fn step(&self, verdict: &Verdict, step: u16) -> String {
        let number = self.words.fill("label.step", &[("number", &(u32::from(step) + 1).to_string())]);
        let known = Some(step).filter(|_| verdict.model_hash == self.job.hash);
        let name = known.and_then(|step| self.job.step_name(step, self.words));
        name.map_or(number.clone(), |name| [&number, self.words.say("label.colon"), &name].concat())
    }

    /// What was expected and what came, what was not seen and what helps, as far as there is something: each with the key of its word.
    pub(crate) fn pairs(&self, verdict: &Verdict) -> Vec<(&'static str, String)> {
        let (expected, got) = self.expected_and_got(verdict).unzip();
        let texts = [expected, got, self.missing(verdict), self.help(verdict)];
        let keys = ["label.expected", "label.got", "label.missing", "label.help"];
        keys.into_iter().zip(texts).filter_map(|(key, text)| Some((key, text?))).collect()
    }

    /// What was measured, and what was shown.
    pub(crate) fn measured(&self, verdict: &Verdict) -> Option<Pair> {
        let measure = measure(verdict)?;
        let amounts = Amounts::new(measure, verdict, self.words);
        let key = format!("unit.{}", measure.name());
        let unit = |n: String| self.words.fill(&key, &[("n", &n)]);
        Some((unit(amounts.shown()), unit(amounts.measured())))
    }

    /// What was expected and what came, where more is to be said than the fault.
    pub(crate) fn expected_and_got(&self, verdict: &Verdict) -> Option<Pair> {
        if verdict.outcome() == Ok(VerdictOutcome::NotJudged) {
            return None;
        }
        self.measured(verdict)
            .or_else(|| self.broken(verdict))
            .or_else(|| self.unfinished(verdict))
            .or_else(|| self.instead(verdict))
    }

    /// An order that was broken.
    fn broken(&self, verdict: &Verdict) -> Option<Pair> {
        let fault = OrderFault::try_from(verdict.broken).ok().filter(|fault| *fault != OrderFault::None)?;
        let (own, other) = (self.step_of(verdict)?, self.step(verdict, verdict.broken_activity));
        let fill = |key, values: &[(&str, &str)]| self.words.fill(key, values);
        let before =
            |first: &str, second: &str| fill("order.before", &[("first", first), ("second", second)]);
        Some(match fault {
            OrderFault::NotEnded => (fill("order.finish", &[("step", &other)]), own),
            OrderFault::TooLate => (before(&own, &other), before(&other, &own)),
            OrderFault::Again => {
                (fill("order.once", &[("step", &other)]), fill("order.again", &[("step", &other)]))
            }
            OrderFault::NotBegun | OrderFault::None => (before(&other, &own), own),
        })
    }

    /// A job without a step, or a step without its end.
    fn unfinished(&self, verdict: &Verdict) -> Option<Pair> {
        if VerdictReason::try_from(verdict.reason) != Ok(VerdictReason::NotCompleted) {
            return None;
        }
        let step = self.step_of(verdict)?;
        Some(match level(verdict) {
            Some(VerdictLevel::Job) => (step.clone(), self.words.fill("order.without", &[("step", &step)])),
            _ => (
                self.words.fill("order.whole", &[("step", &step)]),
                self.words.say("order.broken_off").to_owned(),
            ),
        })
    }

    /// Other parts, or the other hand.
    fn instead(&self, verdict: &Verdict) -> Option<Pair> {
        let is_other = matches!(
            VerdictReason::try_from(verdict.reason),
            Ok(VerdictReason::WrongObject | VerdictReason::WrongOrder)
        );
        let known = self.job.step(verdict.nearest).filter(|_| verdict.model_hash == self.job.hash);
        let shown = *known?.contexts.get(usize::from(verdict.iu))?;
        let got = verdict.x_c;
        if !is_other || level(verdict) != Some(VerdictLevel::Iu) || shown == got {
            return None;
        }
        let is_other_hand = shown[1..] == got[1..];
        let say = |context| if is_other_hand { self.with_hand(context) } else { self.context(context) };
        Some((say(shown), say(got)))
    }

    /// What is in a hand, and at what.
    fn context(&self, [hand, part, _, other]: [u16; 4]) -> String {
        let key = match (hand, part, other) {
            (_, 0, _) => return self.words.say("context.idle").to_owned(),
            (0, _, _) => "context.left_at",
            (_, _, 0) => "context.in_hand",
            _ => "context.at",
        };
        self.words.fill(key, &[("part", &self.job.part(part)), ("other", &self.job.part(other))])
    }

    fn with_hand(&self, context: [u16; 4]) -> String {
        self.words.fill(hand_key(context[0]), &[("what", &self.context(context))])
    }

    /// What was not seen, and for how long.
    pub(crate) fn missing(&self, verdict: &Verdict) -> Option<String> {
        let what = match VerdictReason::try_from(verdict.reason).ok()? {
            VerdictReason::HandNotSeen => match HandCode::try_from(verdict.missing_hand) {
                Ok(HandCode::Right) => self.words.say("missing.right").to_owned(),
                Ok(HandCode::Left) => self.words.say("missing.left").to_owned(),
                _ => self.words.say("missing.hands").to_owned(),
            },
            VerdictReason::ObjectNotSeen => {
                self.words.fill("missing.part", &[("part", &self.job.part(verdict.missing_object))])
            }
            VerdictReason::FramesMissing | VerdictReason::TooFewFrames => {
                self.words.say("missing.pictures").to_owned()
            }
            _ => return None,
        };
        let seconds = verdict.missing_s.is_finite().then(|| number(verdict.missing_s, 1, self.words));
        Some(match seconds {
            Some(seconds) => self.words.fill("missing.for", &[("what", &what), ("n", &seconds)]),
            None => what,
        })
    }

    /// What a person can do about what was not seen.
    pub(crate) fn help(&self, verdict: &Verdict) -> Option<String> {
        let key = format!("help.{}", VerdictReason::try_from(verdict.reason).ok()?.name());
        let part = self.job.part(verdict.missing_object);
        self.words.has(&key).then(|| self.words.fill(&key, &[("part", &part)]))
    }
}

/// What was measured and what was shown, as people read numbers.
struct Amounts<'a> {
    measure: VerdictMeasure,
    /// What was measured, the minimum and the maximum that were shown.
    values: [f32; 3],
    decimals: usize,
    words: &'a Table,
}

impl<'a> Amounts<'a> {
    fn new(measure: VerdictMeasure, verdict: &Verdict, words: &'a Table) -> Self {
        let (scale, least) = match measure {
            VerdictMeasure::Duration => (1.0, 1),
            VerdictMeasure::Strokes | VerdictMeasure::Direction | VerdictMeasure::None => (1.0, 0),
            _ => (100.0, 0),
        };
        let values = [verdict.measured, verdict.shown_min, verdict.shown_max].map(|value| scale * value);
        Self { measure, values, decimals: decimals(values, least), words }
    }

    fn number(&self, value: f32) -> String {
        number(value, self.decimals, self.words)
    }

    fn measured(&self) -> String {
        self.number(self.values[0])
    }

    fn shown(&self) -> String {
        let [_, min, max] = self.values.map(|value| self.number(value));
        let is_most = [VerdictMeasure::Direction, VerdictMeasure::Place, VerdictMeasure::LateralDeviation]
            .contains(&self.measure);
        match is_most {
            true => self.words.fill("range.most", &[("max", &max)]),
            false if min == max => max,
            false => self.words.fill("range.between", &[("min", &min), ("max", &max)]),
        }
    }
}

/// A number as people read it in this language.
pub(crate) fn number(value: impl Into<f64>, decimals: usize, words: &Table) -> String {
    format!("{:.decimals$}", value.into()).replace('.', words.say("decimal"))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::sample::{self, wrong};
    use crate::words::Tables;

    fn told(verdict: &Verdict, language: &str) -> (String, Option<Pair>) {
        let (tables, job) = (Tables::shipped(), sample::job());
        let teller = Teller { words: tables.get(language).unwrap(), job: &job };
        (teller.fault(verdict), teller.expected_and_got(verdict))
    }

    fn pair(expected: &str, got: &str) -> Option<Pair> {
        Some((expected.to_owned(), got.to_owned()))
    }

    #[test]
    fn a_measure_is_told_beside_what_was_shown_and_looks_different_from_it() {
        let of = |measure: VerdictMeasure, measured, shown_min, shown_max| Verdict {
            measure: measure.code(),
            measured,
            shown_min,
            shown_max,
            ..wrong(VerdictReason::TooShort)
        };
        let strokes = of(VerdictMeasure::Strokes, 4.0, 6.0, 6.0);
        assert_eq!(told(&strokes, "en"), ("too few strokes".to_owned(), pair("6 strokes", "4 strokes")));
        let duration = of(VerdictMeasure::Duration, 5.44, 4.8, 5.41);
        assert_eq!(told(&duration, "de"), ("zu langsam".to_owned(), pair("4,80 bis 5,41 s", "5,44 s")));
        let place = of(VerdictMeasure::Place, 0.12, 0.0, 0.031);
        assert_eq!(told(&place, "fr").1, pair("jusqu'à 3 cm d'écart", "12 cm d'écart"));
    }

    #[test]
    fn other_parts_another_hand_and_another_order_are_told_by_names() {
        let part = Verdict { x_c: [1, 5, 5, 3], ..wrong(VerdictReason::WrongObject) };
        assert_eq!(
            told(&part, "en"),
            ("wrong part".to_owned(), pair("polisher at brick", "polisher at meter"))
        );
        let hand = Verdict { x_c: [2, 5, 5, 6], ..wrong(VerdictReason::WrongObject) };
        assert_eq!(
            told(&hand, "es").1,
            pair("polisher en brick, mano derecha", "polisher en brick, mano izquierda")
        );
        let order = Verdict {
            level: VerdictLevel::Activity.code(),
            nearest: 1,
            broken: OrderFault::NotBegun.code(),
            broken_activity: 0,
            ..wrong(VerdictReason::WrongOrder)
        };
        assert_eq!(
            told(&order, "en").1,
            pair("first Step 1: polish, then Step 2: measure", "Step 2: measure")
        );
        let left_out =
            Verdict { level: VerdictLevel::Job.code(), nearest: 1, ..wrong(VerdictReason::NotCompleted) };
        assert_eq!(
            told(&left_out, "en"),
            ("left out".to_owned(), pair("Step 2: measure", "without Step 2: measure"))
        );
        let of_another_job = Verdict { model_hash: 8, ..order };
        assert_eq!(told(&of_another_job, "en").1, pair("first Step 1, then Step 2", "Step 2"));
    }

    #[test]
    fn what_was_not_seen_is_named_with_what_helps_and_accuses_nobody() {
        let unseen = Verdict {
            outcome: VerdictOutcome::NotJudged.code(),
            missing_object: 6,
            missing_s: 2.34,
            ..wrong(VerdictReason::ObjectNotSeen)
        };
        let (tables, job) = (Tables::shipped(), sample::job());
        let teller = Teller { words: tables.get("de").unwrap(), job: &job };
        assert_eq!(teller.missing(&unseen).as_deref(), Some("brick, 2,3 s"));
        let help = teller.help(&unseen).unwrap();
        assert_eq!(help, "Marker von brick reinigen und nicht verdecken. Zurücktreten.");
        assert_eq!(teller.expected_and_got(&unseen), None);
    }

    #[test]
    fn a_right_verdict_has_no_fault_and_a_note_is_one_to_look_at() {
        let right = Verdict { outcome: VerdictOutcome::Ok.code(), ..wrong(VerdictReason::None) };
        assert_eq!((fault_key(&right), outcome_key(&right).as_str()), (None, "outcome.ok"));
        let note = Verdict { note: VerdictNote::Again.code(), ..right };
        assert_eq!(
            (fault_key(&note).as_deref(), outcome_key(&note).as_str()),
            (Some("note.Again"), "outcome.note")
        );
    }
}
