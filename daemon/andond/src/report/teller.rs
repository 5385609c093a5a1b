//! Verdicts one after the other: one line per fault, and what follows from it indented beneath.

use std::io::{self, Write};

use andon_core::verdict::{Level, Note, Outcome, Verdict};
use anstyle::{AnsiColor, Style};

use super::Names;
use super::instead::Instead;
use super::words::{is_instead, reason_text, sentence, verdict_sentence};

/// What has been told of the job that is under way.
#[derive(Debug, Default)]
pub struct Teller {
    faults: Vec<Fault>,
    /// The steps that have come, right or wrong.
    done: Vec<u16>,
    /// The first step that is not part of the job.
    instead: Option<Instead>,
    /// The fault that the last line is about.
    last: Option<usize>,
}

#[derive(Debug)]
struct Fault {
    verdict: Verdict,
    when: String,
}

impl Fault {
    /// Of an IU in which something else was done than was expected, its step and both; only its own verdict knows them.
    fn other_parts(&self, names: &Names) -> Option<String> {
        let verdict = Some(&self.verdict).filter(|of| of.level == Level::Iu && is_instead(of))?;
        Some(format!("{}: {}", names.step(verdict.nearest?), reason_text(verdict, names)?))
    }
}

/// What a verdict that is not right is about.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    /// The fault, or what could not be judged: the verdict itself, or an earlier one if it only says what follows from that.
    pub verdict: Verdict,
    /// Why that one is as it is, in words.
    pub why: String,
}

/// One line of text, and how it looks on a terminal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextLine {
    /// The text; it begins with the time.
    pub text: String,
    /// Its colour, if it has one.
    pub style: Style,
}

impl TextLine {
    /// Writes the line in its colour; a stream that shows none takes that away.
    ///
    /// # Errors
    /// Those of the stream.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let Self { text, style } = self;
        writeln!(out, "{style}{text}{style:#}")
    }
}

impl Teller {
    /// The line of the next verdict. `when` is its time as people read it there: of the day on a running line, in seconds on a recording.
    pub fn tell(&mut self, when: &str, verdict: &Verdict, names: &Names) -> TextLine {
        let cause = self.faults.iter().position(|fault| follows(verdict, &fault.verdict));
        let fault = cause.map(|index| &self.faults[index]);
        // A job has a time of its own, unless it ends with its fault.
        let has_time = |fault: &Fault| verdict.level == Level::Job && fault.when != when;
        let is_beneath = cause.is_some() && cause == self.last && !fault.is_some_and(has_time);
        let text = match fault {
            Some(_) if is_beneath => {
                format!("{:width$}{}", "", so(verdict, names), width = when.chars().count() + 23)
            }
            Some(fault) => {
                let then = fault.when.trim_start();
                let sentence = match fault.other_parts(names) {
                    Some(why) => sentence(verdict, names, Some(why)),
                    None => self.sentence(when, verdict, names),
                };
                let what = if verdict.outcome == Outcome::Anomaly { "the fault" } else { "what was missing" };
                let because = format!("job, for {what} at {then}: ");
                format!("{when}  {}", sentence.replacen("job: ", &because, 1))
            }
            None => format!("{when}  {}", self.sentence(when, verdict, names)),
        };
        if self.instead.is_none() {
            self.instead = self.next(verdict, names).and_then(|step| Instead::new(when, verdict, step));
        }
        if verdict.level == Level::Activity {
            self.done.extend(verdict.nearest);
        }
        self.last = cause;
        if verdict.outcome != Outcome::Ok && cause.is_none() {
            self.last = Some(self.faults.len());
            self.faults.push(Fault { verdict: *verdict, when: when.to_owned() });
        }
        if verdict.level == Level::Job {
            *self = Self::default();
        }
        TextLine { text, style: style(verdict) }
    }

    /// What the next verdict is about; `None` of one that is right. It is to be asked before the verdict is told.
    pub fn cause(&self, verdict: &Verdict, names: &Names) -> Option<Cause> {
        let known = self.faults.iter().find(|fault| follows(verdict, &fault.verdict));
        let about = known.map_or(*verdict, |fault| fault.verdict);
        let missed = self.instead.as_ref().and_then(|instead| instead.missed(&about, names));
        let why = missed.or_else(|| reason_text(&about, names)).unwrap_or_default();
        (verdict.outcome != Outcome::Ok).then_some(Cause { verdict: about, why })
    }

    /// The sentence of a verdict, with what was done instead of a step of the job and what was expected.
    fn sentence(&self, when: &str, verdict: &Verdict, names: &Names) -> String {
        if let Some(why) = self.instead.as_ref().and_then(|instead| instead.missed(verdict, names)) {
            return sentence(verdict, names, Some(why));
        }
        let Some(step) = self.next(verdict, names) else { return verdict_sentence(verdict, names) };
        let instead = Instead::new(when, verdict, step).and_then(|instead| instead.noted(names));
        match instead {
            Some(why) => sentence(verdict, names, Some(why)),
            None => format!("{} Next would be {}.", verdict_sentence(verdict, names), names.step(step)),
        }
    }

    /// Which step would have been next, where one came that is not part of the job.
    fn next(&self, verdict: &Verdict, names: &Names) -> Option<u16> {
        let is_other = verdict.note == Some(Note::Step) && verdict.level == Level::Activity;
        (0..names.steps().len() as u16).find(|step| is_other && !self.done.contains(step))
    }
}

/// Whether a verdict only says what another one has said of a part of it.
fn follows(verdict: &Verdict, fault: &Verdict) -> bool {
    let is_part = match (fault.level, verdict.level) {
        (Level::Iu, Level::Activity) => (fault.side, fault.activity) == (verdict.side, verdict.activity),
        (Level::Iu | Level::Activity, Level::Job) => true,
        _ => false,
    };
    // What was missing may have been so for longer at the end.
    let missing = |verdict: &Verdict| (verdict.missing.hand, verdict.missing.object);
    let of = |verdict: &Verdict| (verdict.outcome, verdict.reason, missing(verdict), verdict.broken);
    // A measure may be known more exactly at the end.
    let measure = |verdict: &Verdict| verdict.measured.map(|measured| measured.measure);
    is_part
        && verdict.outcome != Outcome::Ok
        && of(fault) == of(verdict)
        && measure(fault) == measure(verdict)
}

/// What follows for the step or the job.
fn so(verdict: &Verdict, names: &Names) -> String {
    let what = match (verdict.level, verdict.nearest) {
        (Level::Job, _) => "the job".to_owned(),
        (_, Some(step)) => names.step(step),
        (_, None) => "the step".to_owned(),
    };
    match verdict.outcome {
        Outcome::NotJudged => format!("so {what} is not judged"),
        _ => format!("so {what} is wrong"),
    }
}

/// Red for an anomaly, yellow for what was not judged or should be looked at, green for a job that is right.
fn style(verdict: &Verdict) -> Style {
    let colour = match verdict.outcome {
        Outcome::Anomaly => AnsiColor::Red,
        Outcome::NotJudged => AnsiColor::Yellow,
        Outcome::Ok if verdict.note.is_some() => AnsiColor::Yellow,
        Outcome::Ok if verdict.level == Level::Job => AnsiColor::Green,
        Outcome::Ok => return Style::new(),
    };
    Style::new().fg_color(Some(colour.into()))
}
