//! An event: its verdict in words, the measure against what was shown, and the pictures around it as a film.
//!
//! Who may say so says here as well whether it was right. A browser without scripts goes from picture to picture by links, and chooses one by the form. With scripts the film plays.

use std::fmt::Write as _;

use shm_schemas::Verdict;

use super::{confirmed, explain, plot, technician};
use crate::access::Visitor;
use crate::address::{Address, Page};
use crate::board::Board;
use crate::film::{Film, NoFilm};
use crate::html::Html;
use crate::told::{Teller, measures, number, outcome_key};
use crate::words::Table;

/// What may change of it.
pub(super) fn draw(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    html.raw("<section id=\"verdict\">");
    match board.event(&address.at) {
        Some(verdict) => told(html, board, words, address, verdict),
        None => drop(html.element("<h1>", words.say("clip.unknown"), "</h1>")),
    }
    html.raw("</section>");
}

/// The whole page. Without a film, because nobody has looked for one, it says nothing of it.
pub(super) fn draw_whole(
    html: &mut Html,
    board: &Board,
    words: &Table,
    address: &Address,
    visitor: &Visitor,
    film: Option<&Result<Film, NoFilm>>,
) {
    html.raw("<main><p class=\"turns\"><a href=\"");
    let list = address.on(Page::Technician);
    html.text(&list.link()).raw("#e").text(&address.at).element("\">", words.say("clip.list"), "</a></p>");
    confirmed::form(html, address, visitor);
    html.raw("<div class=\"event\">");
    draw(html, board, words, address);
    match film {
        Some(Ok(film)) => clip(html, words, address, film),
        Some(Err(none)) => drop(html.element("<section><p>", words.say(none.key()), "</p></section>")),
        None => (),
    }
    html.raw("</div></main>");
}

fn told(html: &mut Html, board: &Board, words: &Table, address: &Address, verdict: &Verdict) {
    let teller = Teller { words, job: &board.job };
    let outcome = outcome_key(verdict);
    html.raw("<h1 class=\"now ").text(style(&outcome)).raw("\">").raw(technician::sign(&outcome));
    html.text(words.say(&outcome));
    let fault = Some(teller.fault(verdict)).filter(|fault| !fault.is_empty());
    for text in fault.into_iter().chain(teller.step_of(verdict)) {
        html.raw(" \u{2013} ").text(&text);
    }
    html.raw("</h1><dl>");
    let mut pairs = teller.pairs(verdict);
    pairs.push(("label.time", (board.settings.local_time)(verdict.decided_utc_ns)));
    if !verdict.part.is_none() {
        pairs.push(("label.part_id", verdict.part.text().to_owned()));
    }
    for (key, text) in pairs {
        html.pair(words.say(key), &text);
    }
    html.element("<div><dt>", words.say("label.confirmed"), "</dt><dd class=\"confirm\">");
    confirmed::draw(html, board, words, address, verdict);
    html.raw("</dd></div></dl>");
    if let Some(values) = measures(verdict) {
        html.element("<figure class=\"measure\"><figcaption>", words.say("clip.measure"), "</figcaption>");
        plot::measure(html, values);
        html.raw("</figure>");
    }
    if let Some(code) = (board.settings.code_of)(verdict) {
        html.raw("<p>");
        explain::short(html, board, words, address, code);
        html.raw("</p>");
    }
}

/// The style of an outcome, as the worker's page has it.
fn style(outcome: &str) -> &'static str {
    match outcome {
        "outcome.ok" => "good",
        "outcome.anomaly" => "fault",
        "outcome.note" => "check",
        _ => "unjudged",
    }
}

fn clip(html: &mut Html, words: &Table, address: &Address, film: &Film) {
    html.element("<section id=\"clip\"><h2>", words.say("label.clip"), "</h2>");
    if film.times_ms.is_empty() {
        html.element("<p>", words.say("clip.no_pictures"), "</p>");
    } else {
        player(html, words, address, film);
    }
    html.raw("<p class=\"turns\"><a download href=\"/technician/film/").text(&film.clip).raw("?at=");
    html.text(&address.at).raw("\">").text(words.say("clip.download")).raw("</a> ");
    html.element("<code>", &film.clip, "</code></p>");
    html.raw("</section>");
}

/// The film at one of its pictures. The times are read by the script, in milliseconds.
fn player(html: &mut Html, words: &Table, address: &Address, film: &Film) {
    let last = film.times_ms.len() - 1;
    let at = address.frame.parse().unwrap_or_else(|_| film.decided()).min(last);
    let mut times = String::new();
    for time_ms in &film.times_ms {
        // Writing to a `String` cannot fail.
        let _ = write!(times, "{time_ms} ");
    }
    let of = |frame: usize| Address { frame: frame.to_string(), ..address.clone() };
    html.raw("<div id=\"player\" data-times=\"").text(times.trim_end()).raw("\" data-frames=\"");
    html.text(&Address { frame: String::new(), ..address.clone() }.picture()).raw("\" data-decimal=\"");
    html.text(words.say("decimal")).raw("\"><figure><img id=\"frame\" src=\"").text(&of(at).picture());
    html.raw("\" alt=\"").text(words.say("clip.frame")).raw("\"><figcaption>");
    html.text(words.say("picture.legend"))
        .raw("</figcaption></figure><p id=\"frame_lost\" role=\"alert\" hidden>");
    html.text(words.say("clip.lost")).raw("</p><form action=\"/technician/event\">");
    let step = |html: &mut Html, id: &'static str, to: usize, sign: &'static str, key: &str| {
        html.raw("<a class=\"button\" id=\"").raw(id).raw("\" href=\"").text(&of(to).link()).raw("\">");
        html.raw(sign).text(words.say(key)).raw("</a>");
    };
    step(html, "previous", at.saturating_sub(1), "|\u{25c0} ", "clip.previous");
    html.raw("<button type=\"button\" id=\"play\" hidden data-play=\"\u{25b6} ").text(words.say("clip.play"));
    html.raw("\" data-pause=\"\u{2016} ").text(words.say("clip.pause")).raw("\">\u{25b6} ");
    html.text(words.say("clip.play")).raw("</button>");
    step(html, "next", (at + 1).min(last), "\u{25b6}| ", "clip.next");
    hidden(html, "at", &address.at);
    hidden(html, "lang", &address.lang);
    hidden(html, "fault", &address.fault);
    html.raw("<label for=\"slide\">").text(words.say("clip.seconds")).raw("</label> ");
    html.raw("<input type=\"range\" id=\"slide\" name=\"frame\" min=\"0\" max=\"").text(&last.to_string());
    html.raw("\" value=\"").text(&at.to_string()).raw("\" aria-valuetext=\"");
    let seconds = seconds(film.times_ms[at], words);
    html.text(&seconds).raw("\"><output id=\"second\" for=\"slide\">").text(&seconds).raw("</output>");
    html.element("<button id=\"go\">", words.say("label.show"), "</button></form></div>");
}

fn hidden(html: &mut Html, name: &'static str, value: &str) {
    if !value.is_empty() {
        html.raw("<input type=\"hidden\" name=\"").raw(name).raw("\" value=\"").text(value).raw("\">");
    }
}

/// Seconds from the verdict on, with their sign.
fn seconds(time_ms: i64, words: &Table) -> String {
    let sign = if time_ms < 0 { "\u{2212}" } else { "+" };
    format!("{sign}{} s", number(time_ms.unsigned_abs() as f64 / 1e3, 2, words))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::sample::{job, settings, wrong};
    use shm_schemas::{VerdictMeasure, VerdictReason};

    fn board() -> Board {
        let mut board = Board::new(settings());
        board.job(job());
        let mut fault = Verdict {
            measure: VerdictMeasure::Strokes.code(),
            measured: 4.0,
            shown_min: 6.0,
            shown_max: 7.0,
            ..wrong(VerdictReason::TooShort)
        };
        (fault.stamp.epoch, fault.stamp.seq) = (17, 4);
        board.verdict(&fault);
        board
    }

    fn drawn(query: &str, film: Option<&Result<Film, NoFilm>>) -> String {
        let (board, address) = (board(), Address::new(Page::Event, query));
        let mut html = Html::default();
        draw_whole(&mut html, &board, board.words(&address).1, &address, &Visitor::default(), film);
        html.finish()
    }

    #[test]
    fn an_event_is_told_in_words_with_its_film_at_the_picture_of_the_address() {
        let film = Film { clip: "one.mcap".to_owned(), times_ms: vec![-40, 0, 1500] };
        let page = drawn("at=17-4&lang=de&fault=fault.Strokes.below", Some(&Ok(film.clone())));
        for text in [
            "\u{2715} FEHLER \u{2013} zu wenige Hübe \u{2013} Schritt 1: polish",
            "<dd>6 bis 7 Hübe</dd>",
            "class=\"plot\"",
            "data-times=\"-40 0 1500\"",
            "src=\"/technician/film/frame.svg?lang=de&amp;fault=fault.Strokes.below&amp;at=17-4&amp;frame=1\"",
            "href=\"/technician/event?lang=de&amp;fault=fault.Strokes.below&amp;at=17-4&amp;frame=2\"",
            "aria-valuetext=\"+0,00 s\"",
            "href=\"/technician/film/one.mcap?at=17-4\"",
            "href=\"/technician?lang=de&amp;fault=fault.Strokes.below&amp;at=17-4#e17-4\"",
        ] {
            assert!(page.contains(text), "{text} is not in {page}");
        }
        let last = drawn("at=17-4&frame=99", Some(&Ok(film.clone())));
        assert!(last.contains("value=\"2\" aria-valuetext=\"+1.50 s\""), "{last}");
        let empty = drawn("at=17-4", Some(&Ok(Film { times_ms: Vec::new(), ..film })));
        assert!(empty.contains("only what was detected") && !empty.contains("id=\"player\""), "{empty}");
    }

    #[test]
    fn what_is_not_there_is_said() {
        for (query, film, text) in [
            ("at=17-5", None, "not known here"),
            ("at=17-4", Some(Err(NoFilm::NoClip)), "No clip shows this event"),
            ("at=17-4", Some(Err(NoFilm::Unreadable)), "cannot be read"),
        ] {
            let page = drawn(query, film.as_ref());
            assert!(page.contains(text) && !page.contains("id=\"clip\""), "{page}");
        }
    }
}
