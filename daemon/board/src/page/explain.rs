//! What the codes of messages mean and what to do, in the words of `andond explain`.

use crate::address::{Address, Page};
use crate::board::Board;
use crate::code::Code;
use crate::html::Html;
use crate::words::Table;

/// One code where the address names it, and all of them beneath. The texts are in the language of the log.
pub(super) fn draw(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    let codes = &board.settings.codes;
    html.raw("<main id=\"explain\"><h1>").text(words.say("label.codes")).raw("</h1>");
    if let Some(code) = address.code.parse().ok().and_then(|number| of_number(codes, number)) {
        html.element("<section lang=\"en\" class=\"now unjudged\"><h2>", code.name, " ");
        html.element("<small>", &code.level, "</small> ").element("<small>", code.group, "</small></h2>");
        html.element("<p>", code.meaning, "</p></section>");
        html.raw("<dl><div><dt>").text(words.say("label.remedy")).raw("</dt><dd");
        if code.remedy.is_empty() {
            html.raw(">").text(words.say("label.no_remedy"));
        } else {
            html.raw(" lang=\"en\">").text(code.remedy);
        }
        html.raw("</dd></div></dl>");
    }
    for group in codes.chunk_by(|one, other| one.group == other.group) {
        let title = group.first().map_or("", |code| code.group);
        html.element("<section lang=\"en\"><h2>", title, "</h2><div class=\"wide\"><table><tbody>");
        for code in group {
            html.raw("<tr><th scope=\"row\">");
            link(html, code, address);
            html.element("</th><td>", &code.level, "</td>");
            html.element("<td>", code.meaning, "</td></tr>");
        }
        html.raw("</tbody></table></div></section>");
    }
    html.raw("</main>");
}

fn of_number(codes: &[Code], number: u32) -> Option<&Code> {
    codes.iter().find(|code| code.number == number)
}

/// The name of a code, which leads to what is said of it.
fn link(html: &mut Html, code: &Code, address: &Address) {
    let to = Address { code: code.number.to_string(), ..address.on(Page::Explain) };
    html.raw("<a href=\"").text(&to.link()).element("\">", code.name, "</a>");
}

/// A code of the log with its meaning, which is in the language of the log, and leads to what to do.
pub(super) fn short(html: &mut Html, board: &Board, address: &Address, number: u32) {
    if let Some(code) = of_number(&board.settings.codes, number) {
        html.raw("<span lang=\"en\">");
        link(html, code, address);
        html.raw(" ").text(code.meaning).raw("</span>");
    }
}
