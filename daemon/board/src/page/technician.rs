//! What the technician looks up: how the line and its roles are, and what has happened, newest first.

use std::collections::BTreeSet;

use shm_schemas::{Health, RoleId, RoleState, Verdict, VerdictLevel};

use super::state::{State, state};
use super::{confirmed, explain, plot, shift};
use crate::access::Visitor;
use crate::address::{Address, Page};
use crate::board::Board;
use crate::html::Html;
use crate::told::{Teller, fault_key, measures, number, outcome_key};
use crate::words::Table;

/// What is told of each event.
const COLUMNS: [&str; 10] =
    ["time", "outcome", "level", "step_column", "fault", "measured", "shown", "part_id", "clip", "confirmed"];

/// The levels of events, each with the key of its word.
const LEVELS: [(&str, &str); 3] = [("job", "level.job"), ("activity", "level.activity"), ("iu", "level.iu")];

/// Events on one page.
const SHOWN: usize = 100;

/// A role that has no deadline of its own is silent after this time: it gives two signs of life per second.
const SILENT_NS: u64 = 2_000_000_000;

/// The number of the code that says that there is no job.
const NO_JOB: u32 = 311;

/// What changes.
pub(super) fn draw(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    line(html, board, words, address);
    shift::draw(html, board, words, address);
    roles(html, board, words, address);
    events(html, board, words, address);
}

/// The whole page. The choice of a fault stands apart from the list, so that nobody loses it while the list changes. The picture is asked for by the
/// browser, one after the other.
pub(super) fn draw_whole(
    html: &mut Html,
    board: &Board,
    words: &Table,
    address: &Address,
    visitor: &Visitor,
) {
    html.raw("<main>");
    line(html, board, words, address);
    html.raw("<div class=\"beside\">");
    if board.settings.picture {
        picture(html, words, address);
    }
    shift::draw(html, board, words, address);
    html.raw("</div>");
    roles(html, board, words, address);
    filter(html, board, words, address);
    confirmed::form(html, address, visitor);
    events(html, board, words, address);
    html.raw("</main>");
}

/// The state of the line in a sentence.
pub(super) fn line(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    let state = state(board);
    let (key, style) = state.keys();
    html.raw("<section id=\"line\"><h1>")
        .text(words.say("label.station"))
        .raw(" ")
        .text(&board.settings.station);
    html.raw("</h1><p class=\"now ").text(style).raw("\"><b>").text(words.say(key)).raw("</b> ");
    if let Some(key) = state.help() {
        html.text(words.say(&key)).raw(" ");
    }
    if let Some((role, ill)) = board.cause {
        html.text(&words.fill(ill.key(), &[("role", role.name())]));
    }
    html.raw("</p>");
    if state == State::NoJob {
        html.raw("<p class=\"turns\">");
        if address.page != Page::Engineer {
            html.link(&address.on(Page::Engineer).link(), words.say("label.engineer")).raw(" ");
        }
        explain::short(html, board, words, address, NO_JOB);
        html.raw("</p>");
    }
    if !board.job.name.is_empty() {
        html.raw("<p>").text(words.say("label.job")).raw(" ").text(&board.job.name);
        html.element(" <code>", &format!("{:016x}", board.job.hash), "</code></p>");
    }
    html.raw("</section>");
}

pub(super) fn picture(html: &mut Html, words: &Table, address: &Address) {
    html.raw("<figure><img id=\"picture\" src=\"/picture.svg?lang=").text(&address.lang).raw("\" alt=\"");
    html.text(words.say("picture.alt")).raw("\" data-none=\"").text(words.say("picture.none")).raw("\">");
    html.element("<figcaption>", words.say("picture.legend"), "</figcaption></figure>");
}

fn roles(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    html.element(
        "<section id=\"roles\"><h2>",
        words.say("label.roles"),
        "</h2><div class=\"wide\"><table><thead><tr>",
    );
    heads(html, words, &["role", "state"]);
    for column in ["rate", "losses", "refused", "typical", "slow"] {
        html.element("<th scope=\"col\" class=\"number\">", words.say(&format!("label.{column}")), "</th>");
    }
    heads(html, words, &["message"]);
    html.raw("</tr></thead><tbody>");
    for role in &board.settings.roles {
        self::role(html, board, words, address, *role);
    }
    html.raw("</tbody></table></div><p class=\"turns\">");
    html.link(&address.on(Page::Explain).link(), words.say("label.codes")).raw("</p></section>");
}

pub(super) fn heads(html: &mut Html, words: &Table, columns: &[&str]) {
    for column in columns {
        html.element("<th scope=\"col\">", words.say(&format!("label.{column}")), "</th>");
    }
}

fn role(html: &mut Html, board: &Board, words: &Table, address: &Address, role: RoleId) {
    let health = board.health_of(role).filter(|health| !is_silent(health, board.now_ns));
    let state = health.and_then(|health| RoleState::try_from(health.state).ok());
    let works = matches!(state, Some(RoleState::Running | RoleState::Finished));
    html.raw(if works { "<tr><th scope=\"row\">" } else { "<tr class=\"ill\"><th scope=\"row\">" })
        .text(role.name())
        .element(" <small>", words.say(&format!("part_of_line.{}", role.name())), "</small>");
    let word = format!("role.{}", state.map_or("Silent", RoleState::name));
    html.raw("</th><td>").raw(if works { "" } else { "\u{25b2} " }).text(words.say(&word)).raw("</td>");
    for cell in health.map_or(UNKNOWN.map(str::to_owned), |health| numbers(health, words)) {
        html.element("<td class=\"number\">", &cell, "</td>");
    }
    html.raw("<td>");
    explain::short(html, board, words, address, health.map_or(0, |health| health.last_error));
    html.raw("</td></tr>");
}

/// What a role that is silent says of its numbers.
const UNKNOWN: [&str; 5] = ["\u{2013}"; 5];

/// The numbers of a role, in the order of their columns.
fn numbers(health: &Health, words: &Table) -> [String; 5] {
    let milliseconds = |microseconds: u32| number(f64::from(microseconds) / 1e3, 1, words);
    [
        number(health.rate_hz, 1, words),
        health.losses.to_string(),
        health.refused.to_string(),
        milliseconds(health.p50_us),
        milliseconds(health.p99_us),
    ]
}

pub(super) fn is_silent(health: &Health, now_ns: u64) -> bool {
    let deadline_ns = SILENT_NS.max(u64::from(health.deadline_ms) * 1_000_000);
    now_ns.saturating_sub(health.stamp.sent_ns) > deadline_ns
}

/// The faults that the events have, to choose from.
fn filter(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    let asked = Some(address.fault.clone()).filter(|key| words.has(key));
    let keys: BTreeSet<String> = board.events.iter().filter_map(fault_key).chain(asked).collect();
    html.raw("<form id=\"filter\" action=\"/technician\">");
    let all = std::iter::once(("", words.say("label.all"), ""));
    let faults = keys.iter().map(|key| (key.as_str(), words.say(key), ""));
    html.select("fault", words.say("label.fault"), &address.fault, all.clone().chain(faults));
    let levels = LEVELS.map(|(level, key)| (level, words.say(key), ""));
    html.select("level", words.say("label.level"), &address.level, all.chain(levels));
    html.element(
        "<label class=\"pick\">",
        words.say("label.part_id"),
        " <input id=\"part\" name=\"part\" maxlength=\"32\"",
    );
    html.raw(" pattern=\"[A-Za-z0-9._\\-]*\" value=\"").text(&address.part).raw("\"></label>");
    if !address.lang.is_empty() {
        html.raw("<input type=\"hidden\" name=\"lang\" value=\"").text(&address.lang).raw("\">");
    }
    html.element("<button>", words.say("label.show"), "</button></form>");
}

pub(super) fn name_of(verdict: &Verdict) -> String {
    verdict.stamp.id().to_string()
}

fn events(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    let is_wanted = |event: &&Verdict| {
        (address.fault.is_empty() || fault_key(event).as_deref() == Some(&address.fault))
            && (address.level.is_empty() || event.level().is_ok_and(|level| level.name() == address.level))
            && (address.part.is_empty() || event.part.text() == address.part)
    };
    let is_before = |event: &&Verdict| !address.at.is_empty() && name_of(event) != address.at;
    let mut wanted = board.events.iter().skip_while(is_before).filter(is_wanted).peekable();
    html.element("<section id=\"events\"><h2>", words.say("label.events"), "</h2>");
    if wanted.peek().is_none() {
        html.element("<p>", words.say("label.none"), "</p>");
    } else {
        html.raw("<div class=\"wide\"><table><thead><tr>");
        heads(html, words, &COLUMNS);
        html.raw("</tr></thead><tbody>");
        for verdict in wanted.by_ref().take(SHOWN) {
            event(html, board, words, address, verdict);
        }
        html.raw("</tbody></table></div>");
    }
    let rest = wanted.peek().map(|next| name_of(next));
    turns(html, words, address, rest);
    html.raw("</section>");
}

/// The way to older events, and back to the newest.
fn turns(html: &mut Html, words: &Table, address: &Address, older: Option<String>) {
    html.raw("<p class=\"turns\">");
    let mut link = |at: String, key: &str| {
        html.link(&Address { at, ..address.clone() }.link(), words.say(key)).raw(" ");
    };
    if !address.at.is_empty() {
        link(String::new(), "label.newest");
    }
    if let Some(at) = older {
        link(at, "label.older");
    }
    html.raw("</p>");
}

fn event(html: &mut Html, board: &Board, words: &Table, address: &Address, verdict: &Verdict) {
    let teller = Teller { words, job: &board.job };
    let name = name_of(verdict);
    html.raw("<tr id=\"e").text(&name).raw("\"><td><a href=\"");
    html.text(&Address { at: name.clone(), ..address.clone() }.link()).raw("#e").text(&name).raw("\">");
    html.text(&(board.settings.local_time)(verdict.decided_utc_ns)).raw("</a></td>");
    let outcome = outcome_key(verdict);
    html.raw("<td class=\"")
        .text(outcome.trim_start_matches("outcome."))
        .raw("\">")
        .raw(sign(&outcome))
        .text(words.say(&outcome));
    let level = verdict.level().map_or("", VerdictLevel::name);
    html.element("</td><td>", words.say(&format!("level.{level}")), "</td>");
    let (shown, measured) = teller.measured(verdict).or_else(|| teller.expected_and_got(verdict)).unzip();
    let measured = measured.or_else(|| teller.missing(verdict));
    for cell in [teller.step_of(verdict), Some(teller.fault(verdict)), measured] {
        html.element("<td>", &cell.unwrap_or_default(), "</td>");
    }
    html.element("<td>", &shown.unwrap_or_default(), " ");
    if let Some(values) = measures(verdict) {
        plot::measure(html, values);
    }
    html.element("</td><td>", verdict.part.text(), "</td>");
    let has_clip = board.clips.show(verdict.stamp.id());
    html.raw("<td><a href=\"").text(&Address { at: name, ..address.on(Page::Event) }.link()).raw("\">");
    html.raw(if has_clip { "\u{25b6}\u{a0}" } else { "" });
    html.text(words.say(if has_clip { "label.clip" } else { "label.look" })).raw("</a></td>");
    html.raw("<td class=\"confirm\">");
    confirmed::draw(html, board, words, address, verdict);
    html.raw("</td></tr>");
}

/// The outcome as a sign, beside its word and its colour.
pub(super) fn sign(outcome: &str) -> &'static str {
    match outcome {
        "outcome.ok" => "\u{2713} ",
        "outcome.anomaly" => "\u{2715} ",
        "outcome.note" => "\u{25b3} ",
        _ => "\u{25c7} ",
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::board::Settings;
    use crate::code::Code;
    use crate::line::{Ill, Line, Stop};
    use crate::page::view;
    use crate::sample::{settings, wrong};
    use crate::words::Tables;
    use shm_schemas::{JudgePhase, Judging, PartId, VerdictReason};

    #[test]
    fn a_line_without_a_job_says_so_in_every_language_and_leads_to_where_one_is_taught_and_explained() {
        let code = Code { number: 311, name: "AND-311", meaning: "no job is selected", ..Code::default() };
        let mut board = Board::new(Settings { codes: vec![code], ..settings() });
        board.judging(&Judging { phase: JudgePhase::NoJob.code(), ..Judging::default() });
        board.line(Line::NoJob, None);
        assert!(board.has_no_job());
        for (code, _) in board.settings.tables.languages() {
            let words = board.settings.tables.get(code).unwrap();
            let shows = |page: Page, text: &str| {
                let drawn = view(&board, &Address::new(page, &format!("lang={code}")));
                assert!(drawn.contains(&text.replace('\'', "&#39;")), "{code}: {text} is not in {drawn}");
            };
            for page in [Page::Worker, Page::Technician, Page::Engineer] {
                shows(page, words.say("state.NoJob"));
            }
            shows(Page::Worker, words.say("stop.NoJob"));
            shows(Page::Technician, words.say("stop.NoJob"));
            shows(Page::Technician, &format!("<p class=\"turns\"><a href=\"/engineer?lang={code}\">"));
            shows(Page::Technician, "AND-311</a> <span");
        }
        board.line(Line::Stopped(Stop::Role), Some((RoleId::Perceive, Ill::Silent)));
        let drawn = view(&board, &Address::new(Page::Technician, ""));
        assert!(drawn.contains("perceive gives no sign of life"), "{drawn}");
        assert!(drawn.contains("NOT WATCHING") && !drawn.contains("class=\"turns\"><a href=\"/engineer"));
    }

    #[test]
    fn events_are_limited_to_a_fault_a_level_and_a_part() {
        let mut board = Board::new(settings());
        for (seq, level, part) in
            [(1, VerdictLevel::Iu, "A-1"), (2, VerdictLevel::Job, "A-1"), (3, VerdictLevel::Job, "A-2")]
        {
            let mut fault = Verdict {
                level: level.code(),
                part: PartId::new(part.as_bytes()).unwrap(),
                ..wrong(VerdictReason::Motion)
            };
            fault.stamp.seq = seq;
            board.verdict(&fault);
        }
        let rows = |query: &str| {
            let drawn = view(&board, &Address::new(Page::Technician, query));
            [1, 2, 3].map(|seq| drawn.contains(&format!("<tr id=\"e0-{seq}\">")))
        };
        assert_eq!(rows("fault=&level=&part="), [true; 3]);
        assert_eq!(rows("level=job"), [false, true, true]);
        assert_eq!(rows("part=A-1"), [true, true, false]);
        assert_eq!(rows("level=job&part=A-1&fault=fault.Motion"), [false, true, false]);
        assert_eq!(rows("fault=fault.TooShort"), [false; 3]);
    }

    #[test]
    fn numbers_of_a_role_are_written_as_in_the_language_of_the_page() {
        let health = Health { rate_hz: 29.97, losses: 3, p50_us: 1500, p99_us: 12_345, ..Health::default() };
        let tables = Tables::shipped();
        let told = |language| numbers(&health, tables.get(language).unwrap());
        assert_eq!(told("en"), ["30.0", "3", "0", "1.5", "12.3"]);
        assert_eq!(told("de"), ["30,0", "3", "0", "1,5", "12,3"]);
    }
}
