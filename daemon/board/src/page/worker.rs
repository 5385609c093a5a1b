//! What the worker sees, from three metres: the state in one word and one shape, the steps, and what was wrong.

use shm_schemas::Verdict;

use super::shape;
use super::state::{State, state};
use crate::board::Board;
use crate::html::Html;
use crate::told::Teller;
use crate::words::Table;

/// A word with more letters is written smaller, so that it stays on one line.
const SHORT: usize = 6;
/// One with more letters than this even more so.
const MIDDLE: usize = 8;

pub(super) fn draw(html: &mut Html, board: &Board, words: &Table) {
    let state = state(board);
    let (key, style) = state.keys();
    html.raw("<main id=\"view\" class=\"").text(style).raw("\">");
    head(html, board, words);
    let word = words.say(key);
    html.raw("<div class=\"state\" role=\"status\">").raw(shape::of(state)).raw("<h1 class=\"word");
    html.raw(size(word)).raw("\">").text(word).raw("</h1></div>");
    told(html, board, words, state);
    if !matches!(state, State::Stopped(_) | State::Starting) {
        steps(html, board, words);
    }
    html.raw("</main>");
}

/// The class of a word by its length.
fn size(word: &str) -> &'static str {
    let letters = word.chars().count();
    if letters <= SHORT {
        ""
    } else if letters <= MIDDLE {
        " middle"
    } else {
        " long"
    }
}

/// What the worker need not look at: the job, the part, and how many pieces there were today.
fn head(html: &mut Html, board: &Board, words: &Table) {
    html.raw("<header><p>").text(&board.settings.station);
    if !board.job.name.is_empty() {
        html.raw(" \u{b7} ").text(&board.job.name);
    }
    html.raw("</p>");
    let part =
        board.piece.part().or(board.judging.map(|judging| judging.part)).filter(|part| !part.is_none());
    if let Some(part) = part {
        html.element("<p class=\"part\">", &words.fill("label.part", &[("id", part.text())]), "</p>");
    }
    html.raw("<p class=\"pieces\">").text(words.say("label.today")).text(words.say("label.colon"));
    let counts = board.pieces;
    let kinds = [
        (counts.good, "\u{2713} ", "label.good"),
        (counts.faulty, "\u{2715} ", "label.faulty"),
        (counts.not_judged, "\u{25c7} ", "label.not_judged"),
    ];
    for (count, sign, key) in kinds {
        html.raw("<span>")
            .raw(sign)
            .raw("<b>")
            .text(&count.to_string())
            .raw("</b> ")
            .text(words.say(key))
            .raw("</span> ");
    }
    html.raw("</p></header>");
}

/// What is wrong, and what helps.
fn told(html: &mut Html, board: &Board, words: &Table, state: State) {
    html.raw("<div class=\"told\">");
    match (state.help(), board.piece.cause()) {
        (Some(help), _) => drop(html.element("<p class=\"help\">", words.say(&help), "</p>")),
        (None, Some(cause)) if state.tells() => fault(html, &Teller { words, job: &board.job }, cause),
        _ => (),
    }
    html.raw("</div>");
}

fn fault(html: &mut Html, teller: &Teller<'_>, cause: &Verdict) {
    let step = teller.step_of(cause).map(|step| format!("{step} \u{2013} ")).unwrap_or_default();
    html.raw("<p class=\"what\">").text(&step).text(&teller.fault(cause)).raw("</p><dl>");
    for (key, text) in teller.pairs(cause) {
        html.pair(teller.words.say(key), &text);
    }
    html.raw("</dl>");
}

/// The step now, and the one after it.
fn steps(html: &mut Html, board: &Board, words: &Table) {
    let count = u16::try_from(board.job.steps.len()).unwrap_or(u16::MAX);
    html.raw("<dl class=\"steps\">");
    for (key, step) in ["label.now", "label.next"].into_iter().zip(board.piece.steps(count)) {
        let known =
            step.and_then(|step| Some((step, board.job.step(step)?, board.job.step_name(step, words)?)));
        let Some((step, known, name)) = known else { continue };
        html.element("<div><dt>", words.say(key), "</dt><dd>");
        html.raw("<b class=\"number\">").text(&(u32::from(step) + 1).to_string()).raw("</b> ").text(&name);
        if known.picture.is_some() && board.settings.picture {
            html.raw("<img src=\"").text(&board.job.picture_of(step)).raw("\" alt=\"").text(&name).raw("\">");
        }
        html.raw("</dd></div>");
    }
    html.raw("</dl>");
}
