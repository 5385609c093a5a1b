//! What is written beside and below the picture: the steps, what was expected, what came, what the hands do, and what is hidden.

use andon_core::couple::{Couple, Visibility};
use andon_core::input::Side;
use andon_core::verdict::{Level, Outcome, Verdict};

use super::canvas::{AMBER, BLUE, Canvas, Colour, GREEN, GREY, RED, WHITE};
use super::steps::{State, Step, Steps};
use crate::report::{Cause, Names, has_contact, is_instead};

/// The width of the panel and the height of the strip, in pixels.
pub(super) const WIDTH: usize = 470;
pub(super) const STRIP: usize = 96;

/// Space at the edges, in pixels.
const EDGE: f32 = 18.0;
/// Height of a step in the list, in pixels.
const ROW: f32 = 62.0;
/// The width of a letter at scale 1, in pixels: that of most of OpenCV's letters.
const LETTER: f64 = 17.0;

/// How many lines of a sentence the panel has room for.
const MAX_LINES: usize = 5;

/// Scales of the letters: about 25, 18 and 15 pixels high.
const LARGE: f64 = 1.0;
const NORMAL: f64 = 0.75;
const SMALL: f64 = 0.62;

/// Writes the list of steps, the newest fault and the result.
pub(super) fn draw_steps(canvas: &mut Canvas, steps: &Steps, names: &Names) -> opencv::Result<()> {
    let [left, bottom] = canvas.picture_end();
    let x = left + EDGE;
    let mut y = 44.0;
    canvas.text([x, y], "steps of the job", NORMAL, GREY)?;
    y += 14.0;
    // The lower half belongs to the faults.
    let room = (((bottom - 300.0) / ROW).max(1.0)) as usize;
    let first = first_shown(&steps.steps, room);
    for (index, step) in steps.steps.iter().enumerate().skip(first).take(room) {
        draw_step(canvas, [x, y], index, step)?;
        y += ROW;
    }
    if steps.steps.len() > room {
        let words = format!("{} to {} of {}", first + 1, first + room, steps.steps.len());
        canvas.text([x, y + 18.0], &words, SMALL, GREY)?;
    }
    let y = (y + 60.0).max(bottom - 240.0);
    match (&steps.fault, &steps.job) {
        (Some(fault), job) => draw_fault(canvas, [x, y], fault, job.as_ref(), names),
        (None, Some(_)) => canvas.text([x, y], "JOB RIGHT", LARGE, GREEN),
        (None, None) => Ok(()),
    }
}

/// The first step of the list that is shown, so that the one that runs is.
fn first_shown(steps: &[Step], room: usize) -> usize {
    let at = steps.iter().rposition(|step| step.state != State::Coming).unwrap_or(0);
    (at + 1).saturating_sub(room)
}

fn draw_step(canvas: &mut Canvas, [x, y]: [f32; 2], index: usize, step: &Step) -> opencv::Result<()> {
    let colour = colour_of(step.state, WHITE);
    let letters = letters(WIDTH as f32 - 2.0 * EDGE, NORMAL);
    let name = format!("{}  {}", index + 1, step.name);
    canvas.text([x, y + 24.0], &shortened(&name, letters), NORMAL, colour)?;
    // One bar for each IU: how far the step has come.
    let count = step.ius.len().max(1) as f32;
    let width = (WIDTH as f32 - 2.0 * EDGE - 90.0) / count;
    for (iu, state) in step.ius.iter().enumerate() {
        let at = [x + 34.0 + width * iu as f32, y + 34.0];
        canvas.bar(at, [width - 5.0, 9.0], colour_of(*state, [80, 70, 70]))?;
    }
    let done = step.ius.iter().filter(|state| matches!(state, State::Judged(_))).count();
    let words = format!("{done}/{}", step.ius.len());
    canvas.text([x + WIDTH as f32 - 2.0 * EDGE - 48.0, y + 44.0], &words, SMALL, GREY)
}

fn draw_fault(
    canvas: &mut Canvas,
    [x, mut y]: [f32; 2],
    Cause { verdict: fault, why }: &Cause,
    job: Option<&Verdict>,
    names: &Names,
) -> opencv::Result<()> {
    let (colour, word) = match (fault.outcome, job.map(|job| job.outcome)) {
        (_, Some(Outcome::Anomaly)) => (RED, "JOB WRONG"),
        (_, Some(Outcome::NotJudged)) => (AMBER, "JOB NOT JUDGED"),
        (Outcome::Anomaly, _) => (RED, "WRONG"),
        _ => (AMBER, "NOT JUDGED"),
    };
    canvas.text([x, y], word, LARGE, colour)?;
    let step = fault.nearest.map(|step| names.step(step)).unwrap_or_default();
    let when = format!("at {:.1} s  {step}", fault.decided_ns as f64 / 1e9);
    let room = WIDTH as f32 - 2.0 * EDGE;
    y += 34.0;
    canvas.text([x, y], &shortened(&when, letters(room, SMALL)), SMALL, WHITE)?;
    // Both are few words where something was measured, or other parts were taken; all else takes a sentence.
    let is_short = fault.measured.is_some() || (fault.level == Level::Iu && is_instead(fault));
    let rows = match names.expected_and_got(fault) {
        (Some(expected), Some(got)) if is_short => vec![("expected", expected), ("got", got)],
        _ => vec![("", why.clone())],
    };
    for (word, words) in rows {
        let indent = if word.is_empty() { 0.0 } else { 118.0 };
        y += 36.0;
        canvas.text([x, y], word, SMALL, GREY)?;
        for (row, line) in wrapped(&words, letters(room - indent, NORMAL)).iter().take(MAX_LINES).enumerate()
        {
            y += if row > 0 { 28.0 } else { 0.0 };
            canvas.text([x + indent, y], line, NORMAL, WHITE)?;
        }
    }
    Ok(())
}

/// Writes what the hands do, and what of it is not seen.
pub(super) fn draw_strip(
    canvas: &mut Canvas,
    couples: &[Couple],
    lost: &[String],
    names: &Names,
) -> opencv::Result<()> {
    let [right, top] = canvas.picture_end();
    let acting: Vec<&Couple> = couples.iter().filter(|couple| has_contact(couple.context)).collect();
    let has_lost_hand = lost.iter().any(|what| what.ends_with("hand"));
    let now = match acting.as_slice() {
        [] if has_lost_hand => "no hand is seen".to_owned(),
        [] => "no part is touched".to_owned(),
        acting => acting.iter().map(|couple| now_words(couple, names)).collect::<Vec<_>>().join(", "),
    };
    let room = right + WIDTH as f32 - 2.0 * EDGE;
    canvas.text([EDGE, top + 38.0], &shortened(&now, letters(room, NORMAL)), NORMAL, WHITE)?;
    let unseen = unseen_words(&acting, lost, names);
    canvas.text([EDGE, top + 76.0], &shortened(&unseen, letters(room, SMALL)), SMALL, AMBER)
}

fn now_words(couple: &Couple, names: &Names) -> String {
    let hand = match couple.side {
        Side::Right => "right hand",
        Side::Left => "left hand",
    };
    format!("{hand}: {}", names.context(couple.context))
}

/// A sentence on what is not seen, and what is assumed of it.
fn unseen_words(acting: &[&Couple], lost: &[String], names: &Names) -> String {
    let mut assumed: Vec<String> = Vec::new();
    let mut unseen: Vec<String> = lost.to_vec();
    let mut is_unmeasured = false;
    for couple in acting {
        let [_, j, _, l] = couple.context.0;
        let hand = format!("{} hand", couple.side.name());
        let parts =
            [hand].into_iter().chain([j, l].map(|id| if id == 0 { String::new() } else { names.object(id) }));
        for (part, visibility) in parts.zip(couple.visibility).filter(|(part, _)| !part.is_empty()) {
            match visibility {
                Visibility::Assumed if !assumed.contains(&part) => assumed.push(part),
                Visibility::Unseen if !unseen.contains(&part) => unseen.push(part),
                _ => (),
            }
        }
        is_unmeasured |= couple.motion.is_none();
    }
    // The method still assumes for a while what is not drawn any more.
    assumed.retain(|part| !unseen.contains(part));
    let mut sentences = Vec::new();
    if !assumed.is_empty() {
        sentences.push(format!("hidden, and assumed to be where it is drawn: {}", assumed.join(", ")));
    }
    if !unseen.is_empty() {
        sentences.push(format!("not seen: {}", unseen.join(", ")));
    }
    if is_unmeasured {
        sentences.push("the motion is not measured".to_owned());
    }
    sentences.join("; ")
}

fn colour_of(state: State, coming: Colour) -> Colour {
    match state {
        State::Coming => coming,
        State::Running => BLUE,
        State::Judged(Outcome::Ok) => GREEN,
        State::Judged(Outcome::Anomaly) => RED,
        State::Judged(Outcome::NotJudged) => AMBER,
    }
}

/// How many letters fit.
fn letters(room: f32, scale: f64) -> usize {
    (f64::from(room) / (LETTER * scale)) as usize
}

/// What does not fit ends with dots.
fn shortened(text: &str, letters: usize) -> String {
    if text.chars().count() <= letters {
        return text.to_owned();
    }
    text.chars().take(letters.saturating_sub(3)).collect::<String>() + "..."
}

/// Breaks a sentence between words.
fn wrapped(sentence: &str, letters: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in sentence.split(' ') {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= letters => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_core::couple::Context;

    fn names() -> Names {
        Names::new([(5, "polisher".to_string()), (6, "brick".to_string())])
    }

    #[test]
    fn the_strip_says_what_is_assumed_not_seen_and_not_measured_and_no_ids() {
        let couple = Couple {
            context: Context([1, 5, 5, 6]),
            motion: None,
            visibility: [Visibility::Seen, Visibility::Assumed, Visibility::Unseen],
            ..Couple::idle(Side::Right, 0)
        };
        assert_eq!(now_words(&couple, &names()), "right hand: polisher at brick");
        assert_eq!(
            unseen_words(&[&couple], &["left hand".to_owned()], &names()),
            "hidden, and assumed to be where it is drawn: polisher; not seen: left hand, brick; the motion is not measured"
        );
        assert_eq!(
            unseen_words(&[&couple], &["polisher".to_owned()], &names()),
            "not seen: polisher, brick; the motion is not measured"
        );
        let seen = Couple { visibility: [Visibility::Seen; 3], motion: Some(Default::default()), ..couple };
        assert_eq!(unseen_words(&[&seen], &[], &names()), "");
    }

    #[test]
    fn a_long_sentence_loses_no_word_and_no_line_is_wider_than_the_panel() {
        let sentence = "came before step 1 (polisher at brick); shown after it in all 5 runs";
        let lines = wrapped(sentence, 24);
        assert!(lines.len() > 1 && lines.iter().all(|line| line.len() <= 24), "{lines:?}");
        assert_eq!(lines.join(" "), sentence);
        assert_eq!(shortened("polisher at brick", 12), "polisher ...");
    }
}
