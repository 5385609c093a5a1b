//! The table at the end: what each clip shows, what was said of it, and whether this machine kept up.

use std::fmt;
use std::path::Path;

use andon_core::couple::Unseen;
use andon_core::verdict::{Level, Outcome, Verdict};

use super::channels::Received;
use crate::report::Names;
use crate::wire;

/// One clip.
pub(super) struct Row {
    clip: String,
    expected: Option<Outcome>,
    said: Option<Outcome>,
    /// What was wrong or not judged, in words; empty where all was right.
    because: String,
    /// How many frames per second were processed.
    managed_hz: f32,
}

impl Row {
    /// `rate_hz` is that of the method.
    pub(super) fn new(clip: &Path, received: &Received, names: &Names, rate_hz: f32) -> Self {
        let verdicts: Vec<Verdict> = received.verdicts.iter().filter_map(wire::verdict::read).collect();
        let couples = received.couples.iter().map(wire::couples::read);
        let captured = couples.filter(|couples| !couples.lacks(Unseen::FRAME)).count();
        let said = said(&verdicts);
        Self {
            clip: clip.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            expected: expected(clip),
            said: said.map(|job| job.outcome),
            because: said.and_then(|job| names.fault(job)).unwrap_or_default(),
            managed_hz: rate_hz * captured as f32 / received.couples.len().max(1) as f32,
        }
    }

    fn is_right(&self) -> Option<bool> {
        let said = self.said.filter(|said| *said != Outcome::NotJudged)?;
        Some(said == self.expected?)
    }
}

/// What a clip shows by its name, `p<person>_<what>_r<repetition>`: a correct run is called `none`. `None` for other names.
fn expected(clip: &Path) -> Option<Outcome> {
    let name = clip.file_stem()?.to_str()?;
    let (person, rest) = name.split_once('_')?;
    let (what, repetition) = rest.rsplit_once('_')?;
    let is_number = |text: &str, letter| text.strip_prefix(letter).is_some_and(|n| n.parse::<u32>().is_ok());
    let is_named = is_number(person, 'p') && is_number(repetition, 'r');
    is_named.then_some(if what == "none" { Outcome::Ok } else { Outcome::Anomaly })
}

/// What was said of the jobs in a clip: an anomaly in one of them is one of the clip. `None` where no job was seen.
fn said(verdicts: &[Verdict]) -> Option<&Verdict> {
    let job =
        |outcome| verdicts.iter().find(|verdict| verdict.level == Level::Job && verdict.outcome == outcome);
    [Outcome::Anomaly, Outcome::NotJudged, Outcome::Ok].into_iter().find_map(job)
}

/// A machine that manages this share of the frames loses none that matters.
const LOSSLESS: f32 = 0.95;

/// All clips.
pub(super) struct Summary<'a> {
    pub(super) rows: Vec<Row>,
    /// How many frames per second the method has, and how many the job needs.
    pub(super) rate_hz: f32,
    pub(super) needed_hz: f32,
    /// The page to read next.
    pub(super) pages: &'a Path,
}

impl fmt::Display for Summary<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.rows.iter().map(|row| row.clip.len()).max().unwrap_or_default().max(4);
        writeln!(f, "{:width$}  expected  said        right       frames/s  because", "clip")?;
        for row in &self.rows {
            let right = match (row.is_right(), row.expected) {
                (Some(true), _) => "yes",
                (Some(false), _) => "NO",
                (None, None) => "-",
                (None, Some(_)) => "not judged",
            };
            let [expected, said] = [row.expected, row.said].map(word);
            let line = format!(
                "{:width$}  {expected:8}  {said:10}  {right:10}  {:8.1}  {}",
                row.clip, row.managed_hz, row.because
            );
            writeln!(f, "{}", line.trim_end())?;
        }
        writeln!(f, "\n{}", self.sentence())?;
        let slowest = self.rows.iter().map(|row| row.managed_hz).fold(f32::INFINITY, f32::min);
        // Where frames are lost unevenly, a step may lack some although there are enough of them on the whole.
        if slowest < self.needed_hz || (slowest < LOSSLESS * self.rate_hz && self.unjudged() > 0) {
            writeln!(
                f,
                "this machine manages {slowest:.1} of {:.0} frames per second, and the job needs {:.1} in every step: steps with fewer are not \
                 judged. `--speed max` plays the clips without losing any",
                self.rate_hz, self.needed_hz
            )?;
        }
        writeln!(
            f,
            "\nnext: `andond demo --annotate FOLDER` draws what was seen and said on the clips; your own parts:"
        )?;
        writeln!(f, "      {}, \"Ten minutes to a job of your own\"", self.pages.display())
    }
}

impl Summary<'_> {
    fn unjudged(&self) -> usize {
        self.rows.iter().filter(|row| row.said.is_none_or(|said| said == Outcome::NotJudged)).count()
    }

    /// What came of the clips, in a sentence.
    fn sentence(&self) -> String {
        let count = |is: fn(&Row) -> bool| self.rows.iter().filter(|row| is(row)).count();
        let known = count(|row| row.expected.is_some());
        let right = count(|row| row.is_right() == Some(true));
        let accused = count(|row| row.is_right() == Some(false) && row.expected == Some(Outcome::Ok));
        let missed = count(|row| row.is_right() == Some(false) && row.expected == Some(Outcome::Anomaly));
        let unjudged = self.unjudged();
        let all = if right == known && known > 0 { "All is as it should be: " } else { "" };
        format!(
            "{all}{right} of {known} clips judged rightly; correct ones accused: {accused}, faulty ones called right: {missed}, \
             not judged: {unjudged}."
        )
    }
}

fn word(outcome: Option<Outcome>) -> &'static str {
    match outcome {
        Some(Outcome::Ok) => "ok",
        Some(Outcome::Anomaly) => "ANOMALY",
        Some(Outcome::NotJudged) => "NOT JUDGED",
        None => "-",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(clip: &str, said: Option<Outcome>, managed_hz: f32) -> Row {
        let because = if said == Some(Outcome::Ok) { "" } else { "step 1: too few strokes" };
        Row {
            clip: clip.into(),
            expected: expected(Path::new(clip)),
            said,
            because: because.into(),
            managed_hz,
        }
    }

    #[test]
    fn the_table_says_what_was_expected_what_was_said_and_what_the_machine_managed() {
        let rows = vec![
            row("p1_none_r1.mp4", Some(Outcome::Ok), 29.5),
            row("p1_none_r2.mp4", Some(Outcome::Anomaly), 29.5),
            row("p2_wrong_object_r1.mp4", Some(Outcome::NotJudged), 7.5),
            row("mine.mp4", Some(Outcome::Ok), 29.5),
        ];
        let text =
            Summary { rows, rate_hz: 30.0, needed_hz: 10.0, pages: Path::new("README.md") }.to_string();
        let lines: Vec<String> =
            text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
        assert_eq!(
            lines[1..],
            [
                "p1_none_r1.mp4 ok ok yes 29.5",
                "p1_none_r2.mp4 ok ANOMALY NO 29.5 step 1: too few strokes",
                "p2_wrong_object_r1.mp4 ANOMALY NOT JUDGED not judged 7.5 step 1: too few strokes",
                "mine.mp4 - ok - 29.5",
                "",
                "1 of 3 clips judged rightly; correct ones accused: 1, faulty ones called right: 0, not judged: 1.",
                "this machine manages 7.5 of 30 frames per second, and the job needs 10.0 in every step: steps with fewer are not judged. \
                 `--speed max` plays the clips without losing any",
                "",
                "next: `andond demo --annotate FOLDER` draws what was seen and said on the clips; your own parts:",
                "README.md, \"Ten minutes to a job of your own\"",
            ]
        );
    }

    #[test]
    fn a_machine_that_keeps_up_is_not_spoken_of_and_one_that_loses_frames_unevenly_is() {
        let said = |outcome, managed_hz| {
            let rows = vec![row("p1_none_r1.mp4", Some(outcome), managed_hz)];
            Summary { rows, rate_hz: 30.0, needed_hz: 10.0, pages: Path::new("README.md") }.to_string()
        };
        assert!(!said(Outcome::Ok, 29.5).contains("this machine"));
        assert!(!said(Outcome::NotJudged, 29.5).contains("this machine"));
        assert!(said(Outcome::NotJudged, 12.5).contains("this machine manages 12.5 of 30"));
    }
}
