//! The pages. Each is drawn whole on the server; a browser with scripts replaces what is new in it.

mod audit;
mod confirmed;
mod engineer;
mod event;
mod explain;
mod job;
mod look;
#[cfg(test)]
mod own_words;
mod picture;
mod plain;
mod plot;
mod shape;
mod shift;
mod state;
mod technician;
mod worker;

use crate::access::{Session, Visitor};
use crate::address::{Address, Page};
use crate::board::Board;
use crate::film::{Film, NoFilm};
use crate::html::Html;
use crate::words::Table;

pub(crate) use picture::drawn;
pub(crate) use plain::{kiosk, login, notice};
pub(crate) use state::state;

/// What changes on a page: elements with ids.
pub(crate) fn view(board: &Board, address: &Address) -> String {
    let mut html = Html::default();
    let (_, words) = board.words(address);
    match address.page {
        Page::Worker => worker::draw(&mut html, board, words),
        Page::Technician => technician::draw(&mut html, board, words, address),
        Page::Event => event::draw(&mut html, board, words, address),
        Page::Explain => (),
        Page::Engineer => engineer::draw(&mut html, board, words, address),
        Page::Job => job::draw(&mut html, board, words, address),
        Page::Look => look::draw(&mut html, board, words),
    }
    html.finish()
}

/// A page as a browser gets it; that of an event with its film, where somebody has looked for it.
pub(crate) fn whole(
    board: &Board,
    address: &Address,
    visitor: &Visitor,
    film: Option<&Result<Film, NoFilm>>,
) -> String {
    let (lang, words) = board.words(address);
    let mut html = Html::default();
    html.raw("<!DOCTYPE html><html lang=\"").text(lang).raw("\"><head><meta charset=\"utf-8\">");
    html.raw("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>");
    html.text(words.say("label.board")).raw(" ").text(&board.settings.station).raw("</title>");
    // What follows the script is for a page that did not get it: there it is a comment. Until one or the other has come the page is blank: nobody
    // reads what nothing keeps true.
    html.raw("<script src=\"/board.js\"></script>").raw(again(board, address.page)).raw("<!-- -->");
    html.raw("<link rel=\"stylesheet\" href=\"/board.css\">");
    html.raw(match address.page {
        Page::Event => "<script src=\"/player.js\" defer></script>",
        Page::Engineer => "<script src=\"/upload.js\" defer></script>",
        Page::Worker if address.sound == "on" => "<script src=\"/sound.js\" defer></script>",
        _ => "",
    });
    html.raw("</head><body class=\"");
    html.raw(if address.page == Page::Worker { "worker" } else { "technician" })
        .raw("\" data-events=\"")
        .text(&address.events())
        .raw("\">");
    lost(&mut html, words);
    match address.page {
        Page::Worker => worker::draw(&mut html, board, words),
        Page::Technician => technician::draw_whole(&mut html, board, words, address, visitor),
        Page::Event => event::draw_whole(&mut html, board, words, address, visitor, film),
        Page::Explain => explain::draw(&mut html, board, words, address),
        Page::Engineer => engineer::draw_whole(&mut html, board, words, address, visitor),
        Page::Job => job::draw_whole(&mut html, board, words, address, visitor),
        Page::Look => look::draw_whole(&mut html, board, words, address),
    }
    links(&mut html, board, (lang, words), address, visitor);
    html.raw("</body></html>\n");
    html.finish()
}

/// How a page without its script is loaded again: what is read from far soon, what is read from near seldom. Nobody loses what they are typing: those
/// to type in only while a task runs.
fn again(board: &Board, page: Page) -> &'static str {
    match page {
        Page::Worker => "<meta http-equiv=\"refresh\" content=\"3\">",
        Page::Technician => "<meta http-equiv=\"refresh\" content=\"30\">",
        Page::Engineer | Page::Job if engineer::is_running(board) => {
            "<meta http-equiv=\"refresh\" content=\"5\">"
        }
        Page::Event | Page::Explain | Page::Engineer | Page::Job | Page::Look => "",
    }
}

/// What a page shows by itself once it does not hear the board.
fn lost(html: &mut Html, words: &Table) {
    for (open, word, help) in [
        ("<div id=\"lost\" class=\"over\" role=\"alert\" hidden>", "label.lost", "label.lost_help"),
        (
            "<div id=\"elsewhere\" class=\"over\" role=\"alert\" hidden>",
            "label.elsewhere",
            "label.elsewhere_help",
        ),
    ] {
        html.raw(open).element("<p class=\"word long\">", words.say(word), "</p>");
        html.element("<p>", words.say(help), "</p></div>");
    }
}

/// The way to the other page and to the other languages, and in or out.
fn links(html: &mut Html, board: &Board, (own, words): (&str, &Table), address: &Address, visitor: &Visitor) {
    html.raw("<footer>");
    if !board.settings.is_look {
        html.raw("<nav aria-label=\"").text(words.say("label.pages")).raw("\">");
        let pages = [
            (Page::Worker, "label.worker"),
            (Page::Technician, "label.technician"),
            (Page::Engineer, "label.engineer"),
        ];
        // From where people work nothing leads to it.
        let count = if address.page == Page::Worker { 2 } else { 3 };
        for (page, key) in pages.into_iter().take(count) {
            html.raw("<a");
            link(html, &address.on(page).link(), words.say(key), page == address.page);
        }
        html.raw("</nav>");
    }
    languages(html, board, (own, words), address, Address::link);
    // Where there is the picture alone, nobody logs in.
    if !board.settings.is_look {
        door(html, words, address, visitor);
    }
    html.raw("</footer>");
}

/// The ways to the same page in the other languages, of which each has its own link.
fn languages(
    html: &mut Html,
    board: &Board,
    (own, words): (&str, &Table),
    address: &Address,
    to: fn(&Address) -> String,
) {
    html.raw("<nav aria-label=\"").text(words.say("label.languages")).raw("\">");
    for (code, name) in board.settings.tables.languages() {
        html.raw("<a lang=\"").text(code).raw("\" hreflang=\"").text(code).raw("\"");
        link(html, &to(&Address { lang: code.to_owned(), ..address.clone() }), name, code == own);
    }
    html.raw("</nav>");
}

/// The way in, or the name of who is in and the way out.
fn door(html: &mut Html, words: &Table, address: &Address, visitor: &Visitor) {
    let Some(session) = &visitor.session else {
        html.raw("<nav aria-label=\"").text(words.say("login.title")).raw("\">");
        html.link(&address.login(), words.say("login.enter")).raw("</nav>");
        return;
    };
    html.raw("<form class=\"out\" method=\"post\" action=\"/logout\">");
    token(html, session);
    plain::place(html, address);
    html.element("<span>", &session.login.name, "</span>");
    html.element("<button>", words.say("login.leave"), "</button></form>");
}

/// What says to the board that a form comes from a page of it.
fn token(html: &mut Html, session: &Session) {
    html.raw("<input type=\"hidden\" name=\"csrf\" value=\"").text(session.csrf.text()).raw("\">");
}

/// A link whose first tag is open.
fn link(html: &mut Html, to: &str, name: &str, is_here: bool) {
    html.raw(" href=\"").text(to).raw("\"");
    html.raw(if is_here { " aria-current=\"page\">" } else { ">" }).text(name).raw("</a>");
}
