//! What the codes of messages mean and what to do, in the words of `andond explain`.

use crate::address::{Address, Page};
use crate::board::Board;
use crate::code::Code;
use crate::html::Html;
use crate::words::Table;

/// One code where the address names it, and all of them beneath.
pub(super) fn draw(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    let codes = &board.settings.codes;
    html.raw("<main id=\"explain\"><h1>").text(words.say("label.codes")).raw("</h1>");
    if let Some(code) = address.code.parse().ok().and_then(|number| of_number(codes, number)) {
        html.element("<section class=\"now unjudged\"><h2>", code.name, " ");
        html.element("<small>", level(code, words), " \u{2013} </small>");
        group(html, code, words, ["<small", "</small></h2>"]);
        meaning(html, code, words, ["<p", "</p></section>"]);
        html.raw("<dl><div><dt>").text(words.say("label.remedy")).raw("</dt>");
        if code.remedy.is_empty() {
            html.element("<dd>", words.say("label.no_remedy"), "</dd>");
        } else {
            told(html, words, &format!("code.{}.do", code.number), code.remedy, ["<dd", "</dd>"]);
        }
        html.raw("</div></dl>");
    }
    for of_group in codes.chunk_by(|one, other| one.group == other.group) {
        html.raw("<section>");
        if let Some(code) = of_group.first() {
            group(html, code, words, ["<h2", "</h2>"]);
        }
        html.raw("<div class=\"wide\"><table><tbody>");
        for code in of_group {
            html.raw("<tr><th scope=\"row\">");
            link(html, code, address);
            html.element("</th><td>", level(code, words), "</td>");
            meaning(html, code, words, ["<td", "</td></tr>"]);
        }
        html.raw("</tbody></table></div></section>");
    }
    html.raw("</main>");
}

fn of_number(codes: &[Code], number: u32) -> Option<&Code> {
    codes.iter().find(|code| code.number == number)
}

/// A text of a code in the language of the page, or else in that of the log.
fn told(html: &mut Html, words: &Table, key: &str, english: &str, [open, close]: [&'static str; 2]) {
    match words.get(key) {
        Some(text) => html.raw(open).raw(">").text(text).raw(close),
        None => html.raw(open).raw(" lang=\"en\">").text(english).raw(close),
    };
}

fn meaning(html: &mut Html, code: &Code, words: &Table, around: [&'static str; 2]) {
    told(html, words, &format!("code.{}.means", code.number), code.meaning, around);
}

/// The hundreds of a code are its group.
fn group(html: &mut Html, code: &Code, words: &Table, around: [&'static str; 2]) {
    told(html, words, &format!("group.{}", code.number / 100), code.group, around);
}

fn level<'a>(code: &'a Code, words: &'a Table) -> &'a str {
    words.get(&format!("severity.{}", code.level)).unwrap_or(&code.level)
}

/// The name of a code, which leads to what is said of it.
fn link(html: &mut Html, code: &Code, address: &Address) {
    let to = Address { code: code.number.to_string(), ..address.on(Page::Explain) };
    html.link(&to.link(), code.name);
}

/// A code of the log with its meaning, which leads to what to do.
pub(super) fn short(html: &mut Html, board: &Board, words: &Table, address: &Address, number: u32) {
    if let Some(code) = of_number(&board.settings.codes, number) {
        link(html, code, address);
        meaning(html, code, words, [" <span", "</span>"]);
    }
}
