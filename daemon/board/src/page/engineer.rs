//! What an engineer orders: teaching, the jobs of the station, and setting up the bench. On top is the task that runs, with what it asks.
//!
//! Forms in which somebody types stand apart from what is drawn anew. Buttons of lists belong to one form that has the token of the session.

use shm_schemas::{FILM_BYTES, PIECE_BYTES, PrintedState, RoleId, Showing};

use super::technician::{heads, is_silent, line, picture};
use super::{audit, plain, token};
use crate::access::Visitor;
use crate::address::{Address, Page};
use crate::board::Board;
use crate::desk::{KnownJob, Shown};
use crate::html::Html;
use crate::words::Table;

/// Where the markers for the calibration are printed, as `andond markers` does without an option, in metres.
const CORNERS: [&str; 4] = ["-0.25,-0.15", "0.25,-0.15", "0.25,0.15", "-0.25,0.15"];

/// Parts of a new station. One with more gets them in its file.
const PARTS: u32 = 6;

/// What changes.
pub(super) fn draw(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    line(html, board, words, address);
    task(html, board, words);
    jobs(html, board, words, address);
    films(html, board, words);
    files(html, board, words);
    audit::draw(html, board, words);
}

/// The whole page.
pub(super) fn draw_whole(
    html: &mut Html,
    board: &Board,
    words: &Table,
    address: &Address,
    visitor: &Visitor,
) {
    html.raw("<main>");
    line(html, board, words, address);
    if !board.settings.takes_orders {
        html.element("<p class=\"now check\">", words.say("engineer.off"), "</p>");
        audit::draw(html, board, words);
        html.raw("</main>");
        return;
    }
    order_form(html, address, visitor);
    task(html, board, words);
    jobs(html, board, words, address);
    teach(html, words, address, visitor);
    films(html, board, words);
    upload(html, board, words, address, visitor);
    html.element("<h2>", words.say("engineer.bench"), "</h2><div class=\"beside\"><div>");
    bench(html, words, address, visitor);
    station(html, board, address, visitor);
    files(html, board, words);
    html.raw("</div>");
    if board.settings.picture {
        picture(html, words, address);
    }
    html.raw("</div>");
    audit::draw(html, board, words);
    html.raw("</main>");
}

/// Whether a task runs.
pub(super) fn is_running(board: &Board) -> bool {
    board.desk.shown.as_ref().is_some_and(Shown::is_running)
}

/// The form of all buttons that stand in lists.
pub(super) fn order_form(html: &mut Html, address: &Address, visitor: &Visitor) {
    form(html, "id=\"order\" class=\"none\"", address, visitor);
    html.raw("</form>");
}

/// The beginning of a form of an order, with these attributes. Its caller ends it.
pub(super) fn form(html: &mut Html, attributes: &'static str, address: &Address, visitor: &Visitor) {
    html.raw("<form ").raw(attributes).raw(" method=\"post\" action=\"/engineer/order\">");
    if let Some(session) = &visitor.session {
        token(html, session);
    }
    plain::place(html, address);
}

/// A button of a list.
pub(super) fn button(html: &mut Html, name: &'static str, value: &str, text: &str) {
    html.raw("<button form=\"order\" name=\"").raw(name).raw("\" value=\"").text(value);
    html.element("\">", text, "</button>");
}

/// The task that runs, or has run last.
pub(super) fn task(html: &mut Html, board: &Board, words: &Table) {
    html.raw("<section id=\"task\">");
    let health = board.health_of(RoleId::Executor).filter(|health| !is_silent(health, board.now_ns));
    if health.is_none() {
        html.element("<p class=\"now check\">\u{25b2} ", words.say("engineer.unheard"), "</p>");
    }
    if let Some(shown) = &board.desk.shown {
        told(html, shown, words);
    }
    html.raw("</section>");
}

fn told(html: &mut Html, shown: &Shown, words: &Table) {
    let (style, sign, key) = match shown.state {
        PrintedState::Done => ("good", "\u{2713} ", "done"),
        PrintedState::Failed | PrintedState::Refused => ("fault", "\u{2715} ", "failed"),
        PrintedState::Stopped => ("unjudged", "\u{25a0} ", "stopped"),
        PrintedState::Begun | PrintedState::Line => ("quiet", "\u{25b6} ", "running"),
    };
    html.raw("<h2 class=\"now ").raw(style).raw("\">").raw(sign);
    html.text(words.say(&format!("task.{}", shown.kind.name())));
    html.raw(if shown.name.is_empty() { "" } else { " " }).text(&shown.name);
    html.text(words.say("label.colon"));
    html.element("<b>", words.say(&format!("engineer.{key}")), "</b>");
    html.element(" <small>", &shown.who, "</small></h2>");
    if shown.is_running() {
        html.raw("<p class=\"keys\">");
        if let Some(showing) = shown.showing {
            html.element("<strong>", words.say(&format!("show.{}", showing.name())), "</strong>");
            for (word, key) in answers(showing) {
                let value = format!("{}/{word}", showing.name());
                button(html, "answer", &value, words.say(key));
            }
        }
        button(html, "do", "stop", words.say("engineer.stop"));
        html.raw("</p>");
    }
    html.raw("<pre lang=\"en\" tabindex=\"0\">");
    for line in &shown.lines {
        html.text(line).raw("<br>");
    }
    html.raw("</pre>");
    if shown.lines.iter().any(|line| line.contains('`')) {
        html.element("<small>", words.say("engineer.commands"), "</small>");
    }
}

/// What can be answered, and how it is called.
fn answers(showing: Showing) -> &'static [(&'static str, &'static str)] {
    match showing {
        Showing::Run => &[("", "show.end"), ("d", "show.again"), ("q", "show.give_up")],
        Showing::Keep => {
            &[("k", "show.keep_it"), ("d", "show.drop"), ("t", "show.teach"), ("q", "show.give_up")]
        }
    }
}

fn jobs(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    html.element("<section id=\"jobs\"><h2>", words.say("engineer.jobs"), "</h2>");
    let jobs = &board.desk.known.jobs;
    if jobs.is_empty() {
        html.element("<p>", words.say("engineer.no_jobs"), "</p></section>");
        return;
    }
    html.raw("<div class=\"wide\"><table><thead><tr>");
    heads(html, words, &["job", "number", "taught", "runs", "steps", "use"]);
    html.raw("</tr></thead><tbody>");
    for job in jobs {
        self::job(html, board, words, address, job);
    }
    html.raw("</tbody></table></div></section>");
}

fn job(html: &mut Html, board: &Board, words: &Table, address: &Address, job: &KnownJob) {
    let own = Address { at: job.name.clone(), ..address.on(Page::Job) };
    html.raw("<tr><th scope=\"row\">").link(&own.link(), &job.name);
    if job.title != job.name && job.fault.is_empty() {
        html.element(" <small>", &job.title, "</small>");
    }
    html.raw("</th>");
    if !job.fault.is_empty() {
        html.element("<td colspan=\"5\" lang=\"en\">\u{25b2} ", &job.fault, "</td></tr>");
        return;
    }
    let numbers = [job.number.to_string(), job.version.date.clone(), job.version.runs.to_string()];
    for cell in numbers.iter().chain([&job.version.steps.to_string()]) {
        html.element("<td>", cell, "</td>");
    }
    html.raw("<td>");
    if is_in_force(board, &job.version.hash) {
        html.element("\u{2713} ", words.say("engineer.in_force"), "");
    } else {
        button(html, "load", &job.name, words.say("engineer.load"));
    }
    html.raw("</td></tr>");
}

/// Whether the line judges by this version.
pub(super) fn is_in_force(board: &Board, hash: &str) -> bool {
    board
        .judging
        .is_some_and(|judging| judging.model_hash != 0 && format!("{:016x}", judging.model_hash) == hash)
}

/// What is typed to teach a job.
fn teach(html: &mut Html, words: &Table, address: &Address, visitor: &Visitor) {
    html.element("<section id=\"teach\"><h2>", words.say("engineer.teach"), "</h2>");
    form(html, "id=\"teaching\" class=\"order\"", address, visitor);
    html.element("<label for=\"job\">", words.say("engineer.name"), "</label>");
    html.raw("<input id=\"job\" name=\"job\" required maxlength=\"56\" pattern=\"[A-Za-z0-9][A-Za-z0-9_\\-]*\" autocapitalize=\"none\">");
    html.element("<small>", words.say("engineer.name_help"), "</small>");
    html.element("<label for=\"count\">", words.say("engineer.count"), "</label>");
    html.raw("<input id=\"count\" name=\"count\" type=\"number\" min=\"1\" max=\"50\" value=\"5\">");
    check(html, "force", words.say("engineer.force"));
    check(html, "pictures", words.say("engineer.pictures"));
    html.element("<button name=\"do\" value=\"live\">", words.say("engineer.show"), "</button>");
    html.raw("</form></section>");
}

/// The recordings that there are, to choose from. They belong to the form above them.
fn films(html: &mut Html, board: &Board, words: &Table) {
    html.raw("<section id=\"films\"><fieldset form=\"teaching\" class=\"order\"><legend>");
    html.text(words.say("engineer.films")).raw("</legend>");
    if board.desk.known.films.is_empty() {
        let none = words.fill("engineer.no_films", &[("folder", &board.settings.films)]);
        html.element("<p>", &none, "</p>");
    }
    for film in &board.desk.known.films {
        html.raw("<label class=\"tick\"><input form=\"teaching\" type=\"checkbox\" name=\"film\" value=\"");
        html.text(film).raw("\">").text(film).raw("</label>");
    }
    // Only recordings can be added.
    html.raw("<label class=\"tick\"><input form=\"teaching\" type=\"checkbox\" name=\"add\" value=\"1\">");
    html.text(words.say("engineer.add")).raw("</label>");
    html.element(
        "<button form=\"teaching\" name=\"do\" value=\"films\">",
        words.say("engineer.learn"),
        "</button>",
    );
    html.raw("</fieldset></section>");
}

/// One more recording, from the disk of whoever looks at the page. Its script sends it.
fn upload(html: &mut Html, board: &Board, words: &Table, address: &Address, visitor: &Visitor) {
    let by_hand = words.fill("upload.by_hand", &[("folder", &board.settings.films)]);
    html.element("<noscript><p>", &by_hand, "</p></noscript>");
    let most = (FILM_BYTES >> 20).to_string();
    let size = words.fill("upload.size", &[("n", &most)]);
    html.raw("<form id=\"upload\" class=\"order\" hidden data-piece=\"").text(&PIECE_BYTES.to_string());
    html.raw("\" data-most=\"").text(&FILM_BYTES.to_string()).raw("\" data-size=\"").text(&size);
    for (attribute, key) in [
        ("\" data-done=\"", "upload.done"),
        ("\" data-failed=\"", "upload.failed"),
        ("\" data-stopped=\"", "upload.stopped"),
        ("\" data-lost=\"", "upload.lost"),
    ] {
        html.raw(attribute).text(words.say(key));
    }
    html.raw("\">");
    if let Some(session) = &visitor.session {
        token(html, session);
    }
    plain::place(html, address);
    html.element("<label for=\"recording\">", words.say("upload.choose"), "</label>");
    html.raw("<input id=\"recording\" type=\"file\" accept=\"video/*\" required>");
    html.element("<small>", &size, "</small>");
    html.element("<button>", words.say("upload.send"), "</button>");
    html.element("<button type=\"button\" hidden>", words.say("engineer.stop"), "</button>");
    html.raw("<output id=\"sent\" role=\"status\"></output></form>");
}

pub(super) fn check(html: &mut Html, name: &'static str, text: &str) {
    html.raw("<label class=\"tick\"><input type=\"checkbox\" name=\"").raw(name).raw("\" value=\"1\">");
    html.text(text).raw("</label>");
}

/// One of several inputs that are called by their number: how its id begins, the key of its label and the number; then its attributes and its value.
pub(super) fn numbered(
    html: &mut Html,
    words: &Table,
    (id, key, number): (&'static str, &str, u32),
    attributes: &'static str,
    value: &str,
) {
    let number = number.to_string();
    html.raw("<label for=\"").raw(id).text(&number).raw("\">");
    html.text(&words.fill(key, &[("number", &number)])).raw("</label><input id=\"").raw(id).text(&number);
    html.raw("\" ").raw(attributes).raw(" value=\"").text(value).raw("\">");
}

/// Markers, the camera's picture, and the calibration.
fn bench(html: &mut Html, words: &Table, address: &Address, visitor: &Visitor) {
    html.raw("<p class=\"keys\">");
    button(html, "do", "markers", words.say("engineer.markers"));
    button(html, "do", "look", words.say("engineer.look"));
    html.raw("</p><details><summary>").text(words.say("engineer.calibrate")).raw("</summary>");
    form(html, "class=\"order\"", address, visitor);
    html.element("<p>", words.say("engineer.calibrate_help"), "</p>");
    html.element("<label for=\"side\">", words.say("engineer.side"), "</label>");
    html.raw("<input id=\"side\" name=\"side\" value=\"0.04\" inputmode=\"decimal\" maxlength=\"8\">");
    for (number, corner) in (1..).zip(CORNERS) {
        let marker = ("m", "engineer.marker", number);
        numbered(html, words, marker, "name=\"marker\" maxlength=\"24\"", &format!("={corner}"));
    }
    html.element("<p>", words.say("engineer.calibrate_counts"), "</p>");
    html.element("<button name=\"do\" value=\"calibrate\">", words.say("engineer.calibrate"), "</button>");
    html.raw("</form></details>");
}

/// The file of a new station.
fn station(html: &mut Html, board: &Board, address: &Address, visitor: &Visitor) {
    let (own, words) = board.words(address);
    html.raw("<details><summary>").text(words.say("engineer.new")).raw("</summary>");
    form(html, "class=\"order\"", address, visitor);
    html.element("<p>", words.say("engineer.new_help"), "</p>");
    html.element("<label for=\"station\">", words.say("engineer.station"), "</label>");
    html.raw("<input id=\"station\" name=\"station\" required maxlength=\"16\" pattern=\"[a-z0-9\\-]+\" autocapitalize=\"none\">");
    html.element("<label for=\"camera\">", words.say("engineer.camera"), "</label>");
    html.raw("<input id=\"camera\" name=\"camera\" value=\"/dev/video0\" maxlength=\"24\">");
    let shipped = board.settings.tables.shipped_languages();
    let languages = shipped.map(|(code, name)| (code, name, code));
    html.select("language", words.say("engineer.language"), own, languages);
    for number in 1..=PARTS {
        numbered(html, words, ("p", "engineer.part", number), "name=\"part\" maxlength=\"40\"", "");
    }
    html.element("<button name=\"do\" value=\"new\">", words.say("engineer.new"), "</button>");
    html.raw("</form></details>");
}

/// What the commands have made for the bench.
fn files(html: &mut Html, board: &Board, words: &Table) {
    let known = &board.desk.known;
    html.raw("<section id=\"made\"><p class=\"turns\">");
    for (is_there, open, key) in [
        (known.has_markers, "<a href=\"/engineer/made/markers.pdf\">", "engineer.print"),
        (known.has_seen && board.settings.picture, "<a href=\"/engineer/made/seen.jpg\">", "engineer.seen"),
        (
            known.has_calibrated && board.settings.picture,
            "<a href=\"/engineer/made/calibrated.jpg\">",
            "engineer.calibrated",
        ),
    ] {
        if is_there {
            html.element(open, words.say(key), "</a> ");
        }
    }
    for station in &known.stations {
        html.raw("<a href=\"/engineer/made/station.toml?at=").text(station).raw("\">");
        html.text(station).raw(".toml</a> ");
    }
    html.raw("</p></section>");
}
