//! Pages that show nothing of the station: the way in, and what a person must know.

use super::languages;
use crate::access::Refused;
use crate::address::{Address, Page};
use crate::board::Board;
use crate::html::Html;
use crate::words::Table;

/// Asks for a name and a password, and says first why somebody was not let in.
pub(crate) fn login(board: &Board, address: &Address, refused: Option<Refused>) -> String {
    plain(board, address, "", |html, words| {
        html.element("<h1>", words.say("login.title"), "</h1>");
        if board.access.has_no_logins() {
            html.element("<p class=\"now quiet\">", words.say("login.none"), "<br><code lang=\"en\">");
            html.raw("andond board login NAME --role engineer</code></p>");
        }
        if let Some(refused) = refused {
            let seconds = if let Refused::Wait(seconds) = refused { seconds } else { 0 };
            let said = words.fill(refused.key(), &[("n", &seconds.to_string())]);
            html.element("<p class=\"now check\" role=\"alert\">", &said, "</p>");
        }
        html.raw("<form class=\"login\" method=\"post\" action=\"/login\"><label for=\"name\">");
        html.text(words.say("login.name"));
        html.raw("</label><input id=\"name\" name=\"name\" autocomplete=\"username\" autocapitalize=\"none\" required autofocus maxlength=\"32\">");
        html.element("<label for=\"password\">", words.say("login.password"), "</label>");
        html.raw("<input id=\"password\" name=\"password\" type=\"password\" autocomplete=\"current-password\" required maxlength=\"256\">");
        place(html, address);
        html.element("<button>", words.say("login.enter"), "</button></form></main>");
        // A screen at the bench has no other way back.
        html.raw("<footer><nav aria-label=\"").text(words.say("label.pages")).raw("\">");
        html.link(&address.on(Page::Worker).link(), words.say("label.worker")).raw("</nav>");
        languages(html, board, board.words(address), address, Address::login);
        html.raw("</footer>");
    })
}

/// Says one thing, and why in the words of the line, and leads back.
pub(crate) fn notice(board: &Board, address: &Address, key: &str, why: &str) -> String {
    plain(board, address, "", |html, words| {
        html.element("<div class=\"now check\" role=\"alert\"><h1>", words.say(key), "</h1>");
        if !why.is_empty() {
            html.element("<p lang=\"en\">", why, "</p>");
        }
        html.raw("</div>");
        html.raw("<p class=\"turns\">").link(&address.link(), words.say("confirm.back")).raw("</p></main>");
    })
}

/// Leads a screen to the worker's page.
pub(crate) fn kiosk(board: &Board) -> String {
    let lead = "<meta http-equiv=\"refresh\" content=\"0; url=/\">";
    plain(board, &Address::default(), lead, |html, words| {
        html.raw("<p class=\"turns\">").link("/", words.say("label.worker")).raw("</p></main>");
    })
}

/// What a form has to come back to.
pub(super) fn place(html: &mut Html, address: &Address) {
    for (name, value) in address.pairs() {
        html.raw("<input type=\"hidden\" name=\"").text(name).raw("\" value=\"").text(value).raw("\">");
    }
}

fn plain(
    board: &Board,
    address: &Address,
    head: &'static str,
    draw: impl FnOnce(&mut Html, &Table),
) -> String {
    let (lang, words) = board.words(address);
    let mut html = Html::default();
    html.raw("<!DOCTYPE html><html lang=\"").text(lang).raw("\"><head><meta charset=\"utf-8\">");
    html.raw("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>");
    html.text(words.say("label.board")).raw("</title><link rel=\"stylesheet\" href=\"/board.css\">");
    html.raw(head).raw("</head><body class=\"technician plain\"><main>");
    draw(&mut html, words);
    html.raw("</body></html>\n");
    html.finish()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::access::{Logins, Rank};
    use crate::sample::settings;

    #[test]
    fn a_login_leads_back_to_the_workers_page_and_says_how_one_is_made_while_nobody_has_one() {
        let mut board = Board::new(settings());
        let address = Address::new(Page::Engineer, "lang=de");
        let page = login(&board, &address, None);
        assert!(page.contains("<a href=\"/?lang=de\">Werker</a>"), "{page}");
        assert!(page.contains("andond board login NAME --role engineer"), "{page}");
        let mut logins = Logins::default();
        logins.add("eva", Rank::Engineer, "correct horse").unwrap();
        board.logins(logins);
        assert!(!login(&board, &address, None).contains("andond board login"));
    }
}
