//! Verdicts as sentences for a technician: what was expected and what came, by the names of parts and steps. People count from 1.

use andon_core::couple::Context;
use andon_core::input::Side;
use andon_core::verdict::{BrokenOrder, Level, Missing, Note, OrderFault, Outcome, Reason, Verdict};

use super::Names;
use crate::wire::verdict::measured_words;

/// The outcome as people read it.
pub const fn outcome_word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Ok => "ok",
        Outcome::Anomaly => "ANOMALY",
        Outcome::NotJudged => "NOT JUDGED",
    }
}

/// One line without its time: the hand, the outcome, what was judged, and why.
pub fn verdict_sentence(verdict: &Verdict, names: &Names) -> String {
    sentence(verdict, names, reason_text(verdict, names))
}

/// As [`verdict_sentence`], with this reason.
pub(super) fn sentence(verdict: &Verdict, names: &Names, why: Option<String>) -> String {
    let hand = verdict.side.map_or("", Side::name);
    let outcome = outcome_word(verdict.outcome);
    let why = why.map(|why| format!(": {why}")).unwrap_or_default();
    format!("{hand:5}  {outcome:10}  {}{why}", subject(verdict, names))
}

/// What is judged: the step, counted from 1, the IU in it, and what was done.
fn subject(verdict: &Verdict, names: &Names) -> String {
    let step = verdict.nearest.map_or("other step".to_owned(), |step| format!("step {}", step + 1));
    let done = || names.context(verdict.context);
    match (verdict.level, verdict.nearest) {
        (Level::Job, _) => "job".to_owned(),
        (Level::Activity, Some(nearest)) => names.step(nearest),
        (Level::Activity, None) => format!("{step} ({})", done()),
        (Level::Iu, _) => {
            let place = format!("{step} IU {}", verdict.iu.map_or(0, |iu| iu + 1));
            // What was done instead of something else is said with that.
            if is_instead(verdict) && instead(verdict, names).is_some() {
                place
            } else {
                format!("{place}: {}", done())
            }
        }
    }
}

/// Whether something else was done than was expected, which is more than that it was done otherwise.
pub fn is_instead(verdict: &Verdict) -> bool {
    verdict.outcome == Outcome::Anomaly
        && verdict.broken.is_none()
        && verdict.measured.is_none()
        && matches!(verdict.reason, Reason::WrongObject | Reason::WrongOrder)
}

/// The step that should have come and did not, or may not have.
pub(super) fn missing(verdict: &Verdict) -> Option<u16> {
    match verdict.broken {
        Some(BrokenOrder { fault: OrderFault::NotBegun, activity, .. }) => Some(activity),
        None if verdict.level == Level::Job
            && matches!(
                verdict.reason,
                Reason::NotCompleted | Reason::WrongObject | Reason::BeginningNotSeen
            ) =>
        {
            verdict.nearest
        }
        _ => None,
    }
}

/// Why, or what is to be looked at; `None` of what is simply right.
pub(super) fn reason_text(verdict: &Verdict, names: &Names) -> Option<String> {
    let measured = verdict.measured.map(|measured| measured_words(measured).to_string());
    let rule = rule_text(verdict, names);
    let why = match (verdict.outcome, rule, measured) {
        (Outcome::NotJudged, Some(rule), Some(measured)) => Some(format!("{rule}; measured: {measured}")),
        (_, rule, measured) => measured.or(rule),
    };
    // The fault of a job is that of one of its steps.
    let of_step = verdict.nearest.filter(|_| verdict.level == Level::Job && verdict.broken.is_none());
    let why = match (why, of_step) {
        (Some(why), Some(step)) if verdict.reason != Reason::NotCompleted => {
            Some(format!("{}: {why}", names.step(step)))
        }
        (why, _) => why,
    };
    let note = verdict.note.map(|note| format!("{}; was it right?", note_words(note, verdict.side)));
    match (why, note) {
        (Some(why), Some(note)) => Some(format!("{why}; {note}")),
        (why, note) => why.or(note),
    }
}

fn note_words(note: Note, side: Option<Side>) -> String {
    let other = match side {
        Some(Side::Right) => "right hand, shown with the left",
        Some(Side::Left) => "left hand, shown with the right",
        None => "a step with the other hand than shown",
    };
    match note {
        Note::Order => "in an order that was not shown",
        Note::Again => "a step done again, shown once",
        Note::OtherHand => other,
        Note::Step => "a step that was not shown, with parts of the job",
    }
    .to_owned()
}

fn broken_words(broken: BrokenOrder, verdict: &Verdict, names: &Names) -> String {
    let BrokenOrder { fault, activity, runs } = broken;
    let other = names.step(activity);
    // A job has no place of its own: it names the step that broke the order.
    let own = verdict.nearest.filter(|_| verdict.level == Level::Job);
    let own = own.map(|step| format!("{} ", names.step(step))).unwrap_or_default();
    let all = if runs == 1 { "the one run".to_owned() } else { format!("all {runs} runs") };
    match fault {
        OrderFault::NotBegun => format!("{own}came before {other}; shown after it in {all}"),
        OrderFault::NotEnded => {
            format!("{own}began before {other} had ended; shown after its end in {all}")
        }
        OrderFault::TooLate => format!("{own}came after {other}; shown before it in {all}"),
        OrderFault::Again if own.is_empty() => format!("done again; shown once in {all}"),
        OrderFault::Again => format!("{other} done again; shown once in {all}"),
    }
}

/// The rule that decided.
fn rule_text(verdict: &Verdict, names: &Names) -> Option<String> {
    Some(match verdict.reason {
        Reason::None => return None,
        Reason::WrongObject | Reason::WrongOrder => match (verdict.broken, instead(verdict, names)) {
            (Some(broken), _) => broken_words(broken, verdict, names),
            (None, Some(instead)) => instead,
            (None, None) if verdict.reason == Reason::WrongObject => "unexpected part".to_owned(),
            (None, None) => "wrong order: this step belongs elsewhere in the job".to_owned(),
        },
        Reason::Motion => match (verdict.distance, verdict.threshold) {
            (Some(distance), Some(threshold)) => {
                format!(
                    "the motion differs from what was shown (distance {distance:.2}, at most {threshold:.2})"
                )
            }
            _ => "the motion differs from what was shown".to_owned(),
        },
        Reason::TooShort => "shorter than in any run that was shown".to_owned(),
        Reason::TooLong => "longer than in any run that was shown".to_owned(),
        Reason::NotCompleted if verdict.level == Level::Job => match verdict.nearest {
            Some(nearest) => format!("ended without {}", names.step(nearest)),
            None => "ended before its last step".to_owned(),
        },
        Reason::NotCompleted => "ended before its last IU".to_owned(),
        Reason::Unknown => "nothing to compare it with".to_owned(),
        Reason::MarkerTwice => match verdict.missing.object {
            Some(object) => format!("marker {object} ({}) is in view twice", names.object(object)),
            None => "a marker is in view twice".to_owned(),
        },
        Reason::Passing => "it cannot be told whether its parts touched".to_owned(),
        Reason::Overload => "it lasted longer than can be compared".to_owned(),
        Reason::BeginningNotSeen => "its beginning was not seen".to_owned(),
        Reason::BrokenOff => "it was not watched to its end".to_owned(),
        Reason::Blind
        | Reason::HandNotSeen
        | Reason::ObjectNotSeen
        | Reason::FramesMissing
        | Reason::TooFewFrames => missing_words(verdict, names),
    })
}

/// What was missing, and how much of it.
fn missing_words(verdict: &Verdict, names: &Names) -> String {
    // It may go on when an early verdict on an IU is given.
    let least = if verdict.early && verdict.level == Level::Iu { "at least " } else { "" };
    let time = |seconds: f32| format!(" for {least}{seconds:.1} s");
    let time = verdict.missing.seconds.map(time).unwrap_or_default();
    match (verdict.reason, verdict.missing) {
        (Reason::HandNotSeen, Missing { hand: Some(hand), .. }) => {
            format!("the {} hand was not seen{time}", hand.name())
        }
        (Reason::HandNotSeen, _) => "parts moved and no hand was seen at them".to_owned(),
        (Reason::ObjectNotSeen, Missing { object: Some(object), .. }) => {
            format!("{} was not seen{time}", names.the(object))
        }
        (Reason::FramesMissing, _) => format!("no frame that shows the bench came{time}"),
        (Reason::TooFewFrames, Missing { captured_percent: Some(percent), needed_percent, .. }) => {
            match needed_percent.filter(|needed| percent < *needed) {
                Some(needed) => format!("only {percent} of 100 frames came, and the job needs {needed}"),
                None => format!("only {percent} of 100 frames came, too few to be sure"),
            }
        }
        (Reason::TooFewFrames, _) => "too few frames came".to_owned(),
        _ => "too little of it was seen".to_owned(),
    }
}

/// What was done, and what was expected instead.
fn instead(verdict: &Verdict, names: &Names) -> Option<String> {
    let step = verdict.nearest?;
    // Which parts were meant is said of the IU.
    if verdict.level != Level::Iu {
        let is_part = verdict.reason == Reason::WrongObject;
        let fault = if is_part { "wrong part used" } else { "wrong step done" };
        return Some(fault.to_owned());
    }
    let (got, shown) = (verdict.context, names.nominal(step, verdict.iu));
    if shown == Some(got) {
        return None;
    }
    Some(match (got.0, shown.map(|shown| shown.0)) {
        // The same parts in the other hand.
        ([hand, a, b, c], Some([shown, d, e, f])) if [a, b, c] == [d, e, f] && hand != shown => {
            let of = |hand: u16| if hand == Side::Left as u16 { Side::Left } else { Side::Right };
            format!("{}, {} hand; shown with the {}", names.context(got), of(hand).name(), of(shown).name())
        }
        ([1 | 2, part, 0, 0], Some([1 | 2, other, 0, 0])) => {
            format!("took {}; expected {}", names.the(part), names.the(other))
        }
        ([1 | 2, part, _, at @ (1..)], Some([1 | 2, shown, _, place @ (1..)])) if part == shown => {
            format!("{} at {}; expected at {}", names.the(part), names.the(at), names.the(place))
        }
        _ => format!("{}; expected {}", names.context(got), names.expected_and_got(verdict).0?),
    })
}

impl Names {
    /// What went wrong in a step, without figures, so that the same fault has the same words; `None` of what is right.
    pub fn fault(&self, verdict: &Verdict) -> Option<String> {
        use andon_core::verdict::Measure;
        let kind = match (verdict.reason, verdict.measured.map(|of| (of.measure, of.value < of.shown_min))) {
            (Reason::None, _) => return None,
            (_, Some((Measure::Duration, true))) => "too short",
            (_, Some((Measure::Duration, false))) => "too long",
            (_, Some((Measure::Strokes, true))) => "too few strokes",
            (_, Some((Measure::Strokes, false))) => "too many strokes",
            (_, Some((Measure::StrokeLength, true))) => "strokes too short",
            (_, Some((Measure::StrokeLength, false))) => "strokes too long",
            (_, Some((Measure::Path, _))) => "wrong path",
            (_, Some((Measure::LateralDeviation, _))) => "off the straight path",
            (_, Some((Measure::Direction, _))) => "wrong direction",
            (_, Some((Measure::Place, _))) => "wrong place",
            (Reason::WrongObject, _) => "wrong part",
            (Reason::WrongOrder, _) => "wrong order",
            (Reason::Motion, _) => "wrong motion",
            (Reason::TooShort, _) => "too short",
            (Reason::TooLong, _) => "too long",
            (Reason::NotCompleted, _) if verdict.level == Level::Job => "left out",
            (Reason::NotCompleted, _) => "not completed",
            (Reason::Unknown, _) => "nothing to compare it with",
            (Reason::Blind, _) => "too little seen",
            (Reason::Overload, _) => "lasted too long to compare",
            (Reason::HandNotSeen, _) => "hand not seen",
            (Reason::ObjectNotSeen, _) => "part not seen",
            (Reason::BeginningNotSeen, _) => "beginning not seen",
            (Reason::BrokenOff, _) => "not watched to its end",
            (Reason::FramesMissing, _) => "no frames for a while",
            (Reason::TooFewFrames, _) => "too few frames",
            (Reason::Passing, _) => "contact of parts not certain",
            (Reason::MarkerTwice, _) => "marker in view twice",
        };
        Some(match verdict.nearest {
            Some(step) => format!("{}: {kind}", self.step(step)),
            None => kind.to_owned(),
        })
    }
}

/// Whether a context says that a hand has something.
pub fn has_contact(context: Context) -> bool {
    context.0 != [0; 4]
}
