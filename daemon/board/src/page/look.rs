//! What `andond look` shows: the picture, and what to improve. Its sentences are in the language of the log.

use crate::address::Address;
use crate::board::Board;
use crate::html::Html;
use crate::words::Table;

/// What changes.
pub(super) fn draw(html: &mut Html, board: &Board, words: &Table) {
    html.raw("<section id=\"findings\"><h2>").text(words.say("look.title")).raw("</h2>");
    html.element("<p lang=\"en\">", &board.look.source, "</p><table><tbody>");
    for finding in &board.look.findings {
        let (row, sign, key) = match finding.is_good {
            true => ("<tr><td class=\"ok\">", "\u{2713} ", "look.good"),
            false => ("<tr class=\"ill\"><td class=\"note\">", "\u{25b2} ", "look.improve"),
        };
        html.raw(row).raw(sign).text(words.say(key)).raw("</td>");
        html.element("<th scope=\"row\" lang=\"en\">", &finding.about, "</th>");
        html.element("<td lang=\"en\">", &finding.sentence, "</td></tr>");
    }
    html.raw("</tbody></table></section>");
}

pub(super) fn draw_whole(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    html.element("<main><h1>", &board.settings.station, "</h1><div class=\"beside\">");
    html.raw("<figure><img id=\"picture\" src=\"/picture.svg?lang=").text(&address.lang).raw("\" alt=\"");
    html.text(words.say("picture.alt")).raw("\" data-none=\"").text(words.say("picture.none"));
    html.raw("\"></figure>");
    draw(html, board, words);
    html.raw("</div></main>");
}
