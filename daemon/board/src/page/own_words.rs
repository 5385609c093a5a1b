//! Whatever a page says by itself comes from the table of its language: here in one in which every text stands in brackets.
#![allow(clippy::unwrap_used)]

use shm_schemas::{
    JudgePhase, Judging, Printed, PrintedState, RoleId, Showing, Task, TaskKind, VerdictMeasure,
    VerdictReason,
};

use super::{login, notice, view, whole};
use crate::access::{Rank, Refused, Session, Visitor};
use crate::address::{Address, Page};
use crate::audited::Audited;
use crate::board::{Board, Settings};
use crate::code::Code;
use crate::desk::{Known, KnownJob, Measured, Version};
use crate::film::{Film, NoFilm};
use crate::html::Html;
use crate::job::{Job, Step};
use crate::line::{Ill, Line, Stop};
use crate::look::Finding;
use crate::sample::{settings, wrong};
use crate::words::Tables;

/// What a person or a command has given a name has this one.
const NAME: &str = "zz";

/// Names that are the same in every language, and units.
const NAMES: [&str; 6] = [NAME, "AND", "judge", "s", "toml", "mcap"];

/// Attributes that people read or hear.
const READ: [&str; 12] = [
    "alt",
    "aria-label",
    "aria-valuetext",
    "data-done",
    "data-failed",
    "data-lost",
    "data-none",
    "data-pause",
    "data-play",
    "data-size",
    "data-stopped",
    "title",
];

/// What a page says that stands neither in brackets nor where it is marked to be of another language.
fn own(page: &str) -> Vec<String> {
    let mut open: Vec<(&str, bool)> = Vec::new();
    let mut own = Vec::new();
    for part in page.split('<').skip(1) {
        let (tag, text) = part.split_once('>').unwrap();
        let name = tag.split([' ', '/']).next().unwrap();
        let is_foreign = open.last().is_some_and(|(_, is_foreign)| *is_foreign);
        if let Some(closed) = tag.strip_prefix('/') {
            assert_eq!(open.pop().map(|(name, _)| name), Some(closed), "{page}");
        } else if !["!DOCTYPE", "!--", "meta", "link", "input", "img", "br"].contains(&name)
            && !tag.ends_with('/')
        {
            let lang = tag.split_once(" lang=\"").map(|(_, rest)| rest.split('"').next().unwrap());
            open.push((name, lang.map_or(is_foreign, |lang| lang != Tables::BRACKETS)));
        }
        if !open.last().is_some_and(|(_, is_foreign)| *is_foreign) {
            let attributes =
                READ.iter().filter_map(|name| tag.split_once(&format!(" {name}=\""))?.1.split('"').next());
            own.extend(attributes.chain([text]).filter(|text| !is_given(text)).map(str::to_owned));
        }
    }
    own
}

/// Whether a text is of the table, a name or a number.
fn is_given(text: &str) -> bool {
    let mut depth = 0;
    let mut outside = String::new();
    for character in text.replace("&#39;", "'").chars() {
        match character {
            '\u{27e6}' => depth += 1,
            '\u{27e7}' => depth -= 1,
            other if depth == 0 => outside.push(other),
            _ => (),
        }
    }
    outside
        .split(|character: char| !character.is_alphabetic())
        .all(|word| word.is_empty() || NAMES.contains(&word))
}

fn printed(kind: TaskKind, state: PrintedState, showing: Option<Showing>) -> Printed {
    let mut task = Task { number: u64::from(kind.code()), kind: kind.code(), ..Task::default() };
    assert!(task.say(NAME, NAME, ""));
    let showing = showing.map_or(0, Showing::code);
    let mut printed = Printed { state: state.code(), showing, ..Printed::default() };
    printed.of(&task);
    printed.say("in English");
    printed
}

/// A board with something of all that an engineer's pages show.
fn board() -> Board {
    let name = || NAME.to_owned();
    let code = Code {
        number: 311,
        name: "AND-311",
        level: "WARN".into(),
        group: "english",
        meaning: "english",
        remedy: "english",
    };
    let mut board = Board::new(Settings {
        tables: Tables::in_brackets(),
        station: name(),
        takes_orders: true,
        films: name(),
        roles: vec![RoleId::Judge],
        codes: vec![code],
        code_of: |_| Some(311),
        ..settings()
    });
    let step =
        Step { name: String::new(), contexts: vec![[1, 5, 0, 0], [1, 5, 5, 6]], picture: Some(Vec::new()) };
    let names = Job { hash: 7, name: name(), parts: [(5, name()), (6, name())].into(), steps: vec![step] };
    let version =
        |hash: &str| Version { hash: hash.into(), date: "1".into(), runs: 5, steps: 1, has_report: true };
    let measures = [VerdictMeasure::Duration, VerdictMeasure::Strokes, VerdictMeasure::Path];
    let measured = measures.map(|measure| Measured {
        step: 0,
        iu: 0,
        measure,
        values: vec![1.0, 2.0],
        right: [1.0, 2.0],
    });
    let job = KnownJob {
        name: name(),
        title: name(),
        version: version("0"),
        names: names.clone(),
        runs: vec![name()],
        measured: [measured.to_vec(), vec![Measured { iu: 1, ..measured[0].clone() }]].concat(),
        earlier: vec![version("1")],
        has_report: true,
        ..KnownJob::default()
    };
    let damaged = KnownJob {
        name: "zz.zz".into(),
        fault: "in English".into(),
        earlier: vec![version("2")],
        ..KnownJob::default()
    };
    board.known(Known {
        jobs: vec![job, damaged],
        films: vec![name()],
        stations: vec![name()],
        has_markers: true,
        has_seen: true,
        has_calibrated: true,
    });
    board.job(names);
    board.look(
        NAME,
        [true, false]
            .map(|is_good| Finding { is_good, about: "English".into(), sentence: "English".into() })
            .into(),
    );
    board.audited(vec![Audited {
        who: name(),
        kind: "task".into(),
        what: "in English".into(),
        ..Audited::default()
    }]);
    board
}

const ASKED: &str = "at=zz&lang=qq&code=311";

fn pages(board: &Board, visitor: &Visitor) -> Vec<String> {
    let mut pages = Vec::new();
    for page in [Page::Worker, Page::Technician, Page::Explain, Page::Engineer, Page::Job, Page::Look] {
        let address = Address { may_confirm: visitor.session.is_some(), ..Address::new(page, ASKED) };
        pages.extend([view(board, &address), whole(board, &address, visitor, None)]);
    }
    for at in ["zz.zz", "0-0"] {
        pages.push(whole(board, &Address::new(Page::Job, &format!("at={at}&lang=qq")), visitor, None));
    }
    let film = Film { clip: "zz.mcap".into(), times_ms: vec![0, 40] };
    for film in [
        Ok(film),
        Ok(Film { clip: NAME.into(), ..Film::default() }),
        Err(NoFilm::NoClip),
        Err(NoFilm::Unreadable),
    ] {
        pages.push(whole(board, &Address::new(Page::Event, "at=0-0&lang=qq"), visitor, Some(&film)));
    }
    pages
}

#[test]
fn whatever_a_page_says_by_itself_is_of_its_language() {
    let mut board = board();
    let visitor = Visitor { rank: Some(Rank::Engineer), session: Some(Session::sample(NAME)), pass: None };
    let address = Address::new(Page::Engineer, ASKED);
    let mut drawn = vec![login(&board, &address, None), login(&board, &address, Some(Refused::Wait(3)))];
    let notices = ["refused", "off", "too_much", "unheard"];
    drawn.extend(notices.map(|key| notice(&board, &address, &format!("engineer.{key}"), "in English")));
    drawn.extend(pages(&board, &Visitor::default()));
    board.verdict(&wrong(VerdictReason::WrongOrder));
    board.judging(&Judging { phase: JudgePhase::NoJob.code(), ..Judging::default() });
    board.line(Line::NoJob, None);
    for kind in TaskKind::ALL
        .iter()
        .copied()
        .filter(|kind| !matches!(kind, TaskKind::Answer | TaskKind::Stop | TaskKind::Film))
    {
        for state in [PrintedState::Begun, PrintedState::Done, PrintedState::Failed, PrintedState::Stopped] {
            board.printed(&printed(kind, state, None));
            drawn.push(view(&board, &address));
        }
    }
    for showing in Showing::ALL {
        board.printed(&printed(TaskKind::TeachLive, PrintedState::Line, Some(*showing)));
        drawn.push(view(&board, &address));
    }
    board.line(Line::Stopped(Stop::Role), Some((RoleId::Judge, Ill::Silent)));
    drawn.extend(pages(&board, &visitor));
    board.settings.takes_orders = false;
    drawn.extend(pages(&board, &visitor));
    for page in drawn {
        assert_eq!(own(&page), [""; 0], "{page}");
    }
}

#[test]
fn a_text_that_is_of_no_table_is_found_wherever_it_stands() {
    let table = Tables::in_brackets();
    let words = table.get(Tables::BRACKETS).unwrap();
    let mut html = Html::default();
    html.element(
        "<p title=\"",
        words.say("label.job"),
        "\">zz 3 s</p><p lang=\"en\" title=\"this\">and this</p>",
    );
    assert_eq!(own(&html.finish()), [""; 0]);
    assert_eq!(own("<p>Jobs<b lang=\"en\">this</b> there</p>"), ["Jobs", " there"]);
    assert_eq!(own("<img src=\"a\" alt=\"A picture\">"), ["A picture"]);
}
