//! The camera's picture, with what is seen and what is assumed drawn into it, and what is not seen beneath it.
//!
//! It is one file, so that the lines are always those of their picture: an SVG with the JPEG in it. Names are text of the page's language.

use std::fmt::Write as _;

use base64ct::{Base64, Encoding as _};

use crate::address::Address;
use crate::board::Board;
use crate::html::Html;
use crate::picture::{Picture, Thing, Visibility, What};
use crate::words::Table;

/// Letters in one line beneath the picture: each is at most three fifths as wide as it is high, and Chinese ones are as wide as high.
const LETTERS: usize = 40;
/// The height of a letter, as a share of the picture's width.
const LETTER: u32 = 42;

const LIGHT: &str = "#7ee08a";
const AMBER: &str = "#ffd400";

/// The picture as a browser gets it.
pub(crate) fn drawn(board: &Board, address: &Address, picture: &Picture) -> String {
    let (_, words) = board.words(address);
    let [width, height] = picture.size;
    let letter = (width / LETTER).max(8);
    let unseen = unseen(board, words, picture).map_or(Vec::new(), |words| lines(&words));
    let edge = if unseen.is_empty() { 0 } else { letter / 2 };
    let below = (unseen.len() as u32 * letter * 3).div_ceil(2) + edge;
    let mut html = Html::default();
    html.raw("<svg xmlns=\"http://www.w3.org/2000/svg\" font-family=\"sans-serif\" fill=\"none\" stroke-linecap=\"round\" viewBox=\"0 0 ");
    html.text(&format!("{width} {}", height + below)).raw("\" font-size=\"").text(&letter.to_string());
    html.raw("\"><rect width=\"100%\" height=\"100%\" fill=\"#17191c\"/><image width=\"")
        .text(&width.to_string());
    html.raw("\" height=\"").text(&height.to_string()).raw("\" href=\"data:image/jpeg;base64,");
    html.text(&Base64::encode_string(&picture.jpeg)).raw("\"/>");
    for thing in &picture.things {
        outline(&mut html, thing, width);
    }
    for thing in &picture.things {
        name(&mut html, board, words, thing, letter);
    }
    for (line, row) in unseen.iter().zip(1..) {
        let y = height + row * letter * 3 / 2;
        html.raw("<text fill=\"#fff\" x=\"")
            .text(&(letter / 2).to_string())
            .raw("\" y=\"")
            .text(&y.to_string());
        html.element("\">", line, "</text>");
    }
    html.raw("</svg>");
    html.finish()
}

/// What a thing is called.
fn name_of(board: &Board, words: &Table, what: What) -> String {
    match what {
        What::RightHand => words.say("missing.right").to_owned(),
        What::LeftHand => words.say("missing.left").to_owned(),
        What::Part(id) => board.job.part(id),
    }
}

/// Full lines around what is seen, and dashes around what is assumed; both have a dark edge.
fn outline(html: &mut Html, thing: &Thing, width: u32) {
    let mut path = String::new();
    for [[from_x, from_y], [to_x, to_y]] in &thing.lines {
        // Writing to a `String` cannot fail.
        let _ = write!(path, "M{from_x:.0} {from_y:.0}L{to_x:.0} {to_y:.0}");
    }
    let thick = (width / 320).max(1);
    for (colour, thick) in [("#111", 2 * thick), (colour_of(thing), thick)] {
        html.raw("<path d=\"")
            .text(&path)
            .raw("\" stroke=\"")
            .raw(colour)
            .raw("\" stroke-width=\"")
            .text(&thick.to_string());
        if thing.visibility == Visibility::Assumed {
            html.raw("\" stroke-dasharray=\"").text(&format!("{} {}", 3 * thick, 4 * thick));
        }
        html.raw("\"/>");
    }
}

fn colour_of(thing: &Thing) -> &'static str {
    if thing.visibility == Visibility::Seen { LIGHT } else { AMBER }
}

/// The name above a thing, with the word for what is only assumed.
fn name(html: &mut Html, board: &Board, words: &Table, thing: &Thing, letter: u32) {
    if thing.lines.is_empty() {
        return;
    }
    let least =
        |axis: usize| thing.lines.iter().flatten().map(|point| point[axis]).fold(f32::INFINITY, f32::min);
    let [x, y] = [0, 1].map(least);
    let mut text = name_of(board, words, thing.what);
    if thing.visibility == Visibility::Assumed {
        text = words.fill("picture.name", &[("what", &text)]);
    }
    let place = |at: f32, least: u32| format!("{:.0}", at.max(least as f32));
    html.raw("<text paint-order=\"stroke\" stroke=\"#111\" stroke-width=\"").text(&(letter / 4).to_string());
    html.raw("\" fill=\"").raw(colour_of(thing)).raw("\" x=\"").text(&place(x, 0));
    html.raw("\" y=\"").text(&place(y - letter as f32 / 2.0, letter)).element("\">", &text, "</text>");
}

/// What is not seen, in words; nothing where nobody has said what there is.
fn unseen(board: &Board, words: &Table, picture: &Picture) -> Option<String> {
    if picture.things.is_empty() {
        return None;
    }
    let things = picture.things.iter().filter(|thing| thing.visibility == Visibility::Unseen);
    let names: Vec<String> = things.map(|thing| name_of(board, words, thing.what)).collect();
    Some(match names.as_slice() {
        [] => words.say("picture.all_seen").to_owned(),
        names => {
            let names = names.join(", ");
            [words.say("label.missing"), words.say("label.colon"), &names].concat()
        }
    })
}

/// Text in lines, broken at blanks.
fn lines(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.is_empty() || line.chars().count() + word.chars().count() < LETTERS => {
                line.push_str(if line.is_empty() { "" } else { " " });
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
    use crate::address::Page;
    use crate::sample::{job, settings};

    #[test]
    fn what_is_seen_has_full_lines_what_is_assumed_dashes_and_what_is_not_seen_stands_beneath() {
        let mut board = Board::new(settings());
        board.job(job());
        let thing = |what, visibility, lines| Thing { what, visibility, lines };
        let line = vec![[[10.0, 20.0], [30.0, 20.0]]];
        let picture = Picture {
            jpeg: vec![0; 3],
            size: [640, 480],
            things: vec![
                thing(What::Part(5), Visibility::Seen, line.clone()),
                thing(What::Part(6), Visibility::Assumed, line),
                thing(What::LeftHand, Visibility::Unseen, Vec::new()),
            ],
        };
        let address = Address::new(Page::Technician, "lang=de");
        let drawn = drawn(&board, &address, &picture);
        assert!(drawn.contains("data:image/jpeg;base64,AAAA\""), "{drawn}");
        assert_eq!(drawn.matches("stroke-dasharray").count(), 2, "{drawn}");
        for text in [">polisher</text>", ">brick (vermutet)</text>", ">Nicht gesehen: linke Hand</text>"] {
            assert!(drawn.contains(text), "{text} is not in {drawn}");
        }
        let all_seen = Picture { things: picture.things[..1].to_vec(), ..picture };
        assert!(super::drawn(&board, &address, &all_seen).contains(">Alles gesehen</text>"));
    }
}
