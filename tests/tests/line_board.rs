//! The pages of a running line, in a real browser.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::{Node, Stop};
use andon_record::store;
use andon_tests::browser::{Browser, Tab};
use andon_tests::line::{Line, Modbus, PATIENCE, Settings, Watcher, andond, ask, root, status};
use andon_tests::simulator::Flaw;
use rustix::process::Signal;
use serde_json::json;
use shm_schemas::RoleId;
use std::process::Command;
use std::time::{Duration, Instant};

const FULL_HD: [u32; 2] = [1920, 1080];
const TABLET: [u32; 2] = [800, 1280];
/// So high that a whole page is in a picture.
const WHOLE: [u32; 2] = [1920, 1600];
/// What is left of Full HD at 200 %.
const TWICE: [u32; 2] = [960, 540];

/// A line whose worker leaves out half of the strokes again and again, and that is ready.
fn at_work() -> (Line, Watcher, String) {
    let mut line = Line::new(Settings { flaw: Flaw::J1, ..Settings::live() });
    let port = line.board("enable = true\n");
    line.record("fault");
    let watcher = line.up();
    line.start("record");
    line.start_board();
    Modbus::connect_when_up(line.port).wait_for(status::READY);
    (line, watcher, format!("http://localhost:{port}"))
}

/// Whether the state of the worker's page is one of these words.
fn says(words: &[&str]) -> String {
    format!("{}.includes(document.querySelector('#view h1')?.textContent)", json!(words))
}

const IS_LOST: &str = "!document.getElementById('lost').hidden";
const IS_HEARD: &str = "document.getElementById('lost').hidden";

/// When the word of the worker's page changed, in milliseconds since 1970, and what was told beside it: the next piece may have begun when somebody asks.
const OBSERVE: &str = "
    window.words = [];
    new MutationObserver(() => {
        const word = document.querySelector('#view h1').textContent;
        if (window.words.at(-1)?.word !== word) {
            const told = document.querySelector('.told').innerText;
            window.words.push({ word, told, at: performance.timeOrigin + performance.now() });
        }
    }).observe(document.body, { subtree: true, childList: true });
    true";

/// When each row of the technician's list came, in milliseconds since 1970.
const OBSERVE_ROWS: &str = "
    window.came = {};
    new MutationObserver(() => {
        for (const { id } of document.querySelectorAll('#events tbody tr')) {
            window.came[id] ??= performance.timeOrigin + performance.now();
        }
    }).observe(document.body, { subtree: true, childList: true });
    true";

#[test]
fn a_fault_on_a_film_a_board_that_is_killed_and_a_dead_line_are_said_and_the_page_comes_back_by_itself() {
    let mut line = Line::with_film("speed = \"file\"", "", &["-i", "p1_J1_r1.mp4"]);
    let port = line.board("enable = true\n");
    // A cold browser may take longer than the board calls a line that is not up one that starts.
    let mut browser = Browser::start();
    let tab = browser.open("data:text/html,warm", FULL_HD);
    line.start("steward");
    let mut watcher = Watcher::join(&line.station);
    line.start_board();
    browser.go(&tab, &format!("http://localhost:{port}/?lang=de"));
    browser.until(&tab, &says(&["STARTET"]));
    assert_eq!(browser.value(&tab, OBSERVE), json!(true));
    let list = browser.open(&format!("http://localhost:{port}/technician"), FULL_HD);
    assert_eq!(browser.value(&list, OBSERVE_ROWS), json!(true));
    line.start_all_but(&["steward"]);
    line.start("capture");

    browser.until(&tab, "window.words.some(({ word }) => word === 'FEHLER')");
    let told = browser.value(&tab, "window.words.find(({ word }) => word === 'FEHLER').told");
    let told = told.as_str().unwrap().to_owned();
    for words in ["Schritt 1: ", "zu wenige Hübe", "Erwartet", "Getan"] {
        assert!(told.contains(words), "{words} is not in {told}");
    }
    browser.keep(&tab, "worker-fault");
    // How long it took is a measurement, and no test asserts it.
    watcher.until("the fault", |watcher| watcher.verdicts.iter().any(|verdict| verdict.outcome == 2));
    let fault = watcher.verdicts.iter().find(|verdict| verdict.outcome == 2).unwrap();
    let (decided_ns, row) = (fault.decided_utc_ns, format!("window.came['e{}']", fault.stamp.id()));
    let shown =
        browser.value(&tab, "window.words.find(({ word }) => word === 'FEHLER').at").as_f64().unwrap();
    println!("the fault was shown {:.1} ms after it was decided", shown - decided_ns as f64 / 1e6);
    browser.until(&list, &format!("{row} > 0"));
    let listed = browser.value(&list, &row).as_f64().unwrap();
    println!("and was in the technician's list after {:.1} ms", listed - decided_ns as f64 / 1e6);

    line.role("board").kill();
    browser.until(&tab, IS_LOST);
    assert!(
        browser
            .value(&tab, "document.getElementById('lost').innerText")
            .as_str()
            .unwrap()
            .contains("KEINE VERBINDUNG")
    );
    browser.keep(&tab, "worker-lost");
    line.start("board");
    browser.until(&tab, IS_HEARD);
    browser.until(&tab, &says(&["LÄUFT", "FEHLER", "BEREIT", "GUT"]));
    assert_eq!(browser.value(&tab, "window.words.length > 0"), json!(true), "the page was not loaded again");

    let killed = browser.value(&tab, "performance.timeOrigin + performance.now()").as_f64().unwrap();
    line.role("judge").kill();
    browser.until(&tab, &says(&["KEINE PRÜFUNG"]));
    let dead = browser.value(&tab, "window.words.findLast(({ word }) => word === 'KEINE PRÜFUNG').at");
    println!(
        "that nothing is judged was shown {:.0} ms after the judge was killed",
        dead.as_f64().unwrap() - killed
    );
    browser.keep(&tab, "worker-dead");
    line.start("judge");
    browser.until(&tab, &says(&["LÄUFT", "FEHLER", "BEREIT", "GUT"]));
}

#[test]
fn events_are_listed_newest_first_and_a_deep_link_a_reload_and_the_back_button_keep_their_place() {
    let (_line, mut watcher, board) = at_work();
    watcher.until("two pieces", |watcher| {
        watcher.verdicts.iter().filter(|verdict| verdict.level == 3).count() > 1
    });
    let mut browser = Browser::start();
    let tab = browser.open(&format!("{board}/technician"), FULL_HD);
    browser.until(&tab, "document.querySelectorAll('#events tbody tr').length > 2");
    browser.until(&tab, "document.querySelectorAll('#roles .ill').length === 0");
    browser.until(&tab, "document.querySelectorAll('#shift .chart .bar').length > 0");
    browser.until(&tab, "document.querySelector('.pareto a').href.includes('fault=fault.Strokes.below')");
    let times = browser.value(
        &tab,
        "[...document.querySelectorAll('#events td:first-child')].map((cell) => cell.textContent)",
    );
    let times: Vec<String> = serde_json::from_value(times).unwrap();
    assert!(times.is_sorted_by(|newer, older| newer >= older), "{times:?}");
    browser.resize(&tab, WHOLE);
    browser.keep(&tab, "technician");
    browser.resize(&tab, FULL_HD);

    // What is drawn anew stays in its place. Where what has the focus goes, what is beside it gets the focus.
    browser
        .value(&tab, "window.row = document.querySelector('#roles tbody tr'); window.told = row.innerText");
    browser.until(&tab, "row.innerText !== told");
    assert_eq!(browser.value(&tab, "row.isConnected"), json!(true));
    let goes = "
        document.querySelector('#events tbody a').focus();
        show('<section id=events><p><a href=/technician>beside</a></p></section>');
        document.activeElement.innerText";
    assert_eq!(browser.value(&tab, goes), json!("beside"));
    // A tick stays with what was ticked, although something else comes before it.
    let ticked = "
        const box = (film) => `<label><input type=checkbox name=film value=${film}></label>`;
        show(`<section id=events>${box('b')}</section>`);
        document.querySelector('[value=b]').checked = true;
        show(`<section id=events>${box('a')}${box('b')}</section>`);
        [...document.querySelectorAll('[name=film]:checked')].map((box) => box.value).join()";
    assert_eq!(
        browser.value(&tab, &format!("(() => {{ {} }})()", ticked.replace("[...", "return [..."))),
        json!("b")
    );

    // The fault is chosen in the form, and the address has it.
    let choose = "
        const faults = document.getElementById('fault');
        faults.value = 'fault.Strokes.below';
        faults.form.requestSubmit();
        true";
    assert_eq!(browser.value(&tab, choose), json!(true));
    browser.until(
        &tab,
        "location.search === '?fault=fault.Strokes.below&level=&part=' && document.readyState === 'complete'",
    );
    let only = "
        const rows = [...document.querySelectorAll('#events tbody tr')].map((row) => row.innerText);
        rows.length > 0 && rows.every((row) => row.includes('too few strokes') && /strokes\\s/.test(row))";
    assert_eq!(
        browser
            .value(&tab, &format!("(() => {{ {} }})()", only.replace("rows.length", "return rows.length"))),
        json!(true)
    );
    browser.keep(&tab, "technician-filtered");

    // The link of the oldest row leads to it, whatever has happened since, and after a reload.
    let link = "[...document.querySelectorAll('#events td:first-child a')].at(-1).href";
    let link = browser.value(&tab, link).as_str().unwrap().to_owned();
    assert!(link.contains("fault=fault.Strokes.below") && link.contains("at="), "{link}");
    let row = link.split_once('#').unwrap().1.to_owned();
    let first = format!("document.querySelector('#events tbody tr').id === {}", json!(row));
    browser.go(&tab, &link);
    browser.until(&tab, &first);
    assert_eq!(browser.value(&tab, "document.querySelector('tr:target') !== null"), json!(true));
    // The old page is complete as well until the new one has come.
    browser.value(&tab, "window.isOld = true; setTimeout(() => location.reload()); true");
    browser.until(&tab, &format!("!window.isOld && document.readyState === 'complete' && {first}"));
    browser.value(&tab, "history.back()");
    browser.until(
        &tab,
        "location.search === '?fault=fault.Strokes.below&level=&part=' && document.readyState === 'complete'",
    );

    // A line without a camera has clips without pictures.
    browser.go(&tab, &format!("{board}/technician?fault=fault.Strokes.below"));
    let clip = "[...document.querySelectorAll('#events a[href^=\"/technician/event\"]')].find((link) => link.textContent.startsWith('\u{25b6}'))";
    browser.until(&tab, &format!("Boolean({clip})"));
    browser.value(&tab, &format!("{clip}.click()"));
    browser.until(
        &tab,
        "document.body.innerText.includes('The clip has no pictures: only what was detected was recorded.')",
    );
    assert_eq!(browser.value(&tab, "document.getElementById('player')"), json!(null));

    // Another language keeps the place as well.
    browser.go(&tab, &link);
    browser.value(&tab, "document.querySelector('footer a[href*=\"lang=fr\"]').click()");
    browser.until(&tab, &format!("document.documentElement.lang === 'fr' && {first}"));
}

/// Sets a page by `before` and looks what is wrong with it for people who see little, use the keyboard, or wear gloves.
fn assert_accessible(browser: &mut Browser, tab: &Tab, before: &str, what: &str) {
    let faults = browser.faults(tab, before);
    assert!(faults.is_empty(), "{what}: {faults:#?}");
}

#[test]
fn pages_are_readable_in_every_state_size_and_language_with_the_keyboard_and_without_scripts() {
    let (_line, mut watcher, board) = at_work();
    watcher.until("a fault", |watcher| watcher.verdicts.iter().any(|verdict| verdict.outcome == 2));
    let mut browser = Browser::start();
    let tab = browser.open(&format!("{board}/"), FULL_HD);
    browser.until(&tab, &says(&["FAULT"]));
    for style in ["quiet", "fault", "check", "unjudged", "good", "stopped"] {
        let set = format!("document.getElementById('view').className = '{style}'");
        assert_accessible(&mut browser, &tab, &set, style);
    }
    browser.until(&tab, &says(&["WORKING"]));
    browser.keep(&tab, "worker-quiet");
    browser.resize(&tab, TABLET);
    browser.keep(&tab, "worker-quiet-tablet");
    browser.resize(&tab, FULL_HD);
    for lang in ["de", "en", "es", "fr", "zh"] {
        browser.go(&tab, &format!("{board}/?lang={lang}"));
        browser
            .until(&tab, "['fault', 'quiet', 'stopped'].includes(document.getElementById('view').className)");
        for (size, name) in [(FULL_HD, "1080p"), (TABLET, "tablet"), (TWICE, "twice")] {
            browser.resize(&tab, size);
            assert_accessible(&mut browser, &tab, "", &format!("{lang} {name}"));
            browser.keep(&tab, &format!("worker-{lang}-{name}"));
        }
        browser.resize(&tab, FULL_HD);
    }
    // No text is left without a word in any language.
    let raw = "/(label|state|fault|unit|order|context)\\.[A-Za-z]/.test(document.body.innerText)";
    assert_eq!(browser.value(&tab, raw), json!(false));

    for page in ["/", "/technician", "/technician/explain?code=306&lang=de"] {
        browser.go(&tab, &format!("{board}{page}"));
        for size in [TABLET, TWICE, FULL_HD] {
            browser.resize(&tab, size);
            assert_accessible(&mut browser, &tab, "", &format!("{page} {size:?}"));
        }
        let stops = if page == "/" { 6 } else { 12 };
        let lost = browser.faults_of_focus(&tab, stops);
        assert!(lost.is_empty(), "{page}: {lost:#?}");
    }

    // A browser that runs no scripts reads what the server has drawn.
    let port = board.rsplit(':').next().unwrap().parse().unwrap();
    for (page, text) in [("/", "Expected"), ("/technician", "too few strokes")] {
        until_drawn(port, page, text);
    }
}

/// Waits until a page as the server draws it has this text: between two pieces nothing may be told.
fn until_drawn(port: u16, page: &str, text: &str) {
    let deadline = Instant::now() + PATIENCE;
    loop {
        let drawn = ask(port, &format!("GET {page} HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n"));
        if drawn.contains(text) {
            return;
        }
        assert!(Instant::now() < deadline, "{text} is not in {drawn}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// How many more readers the channel `frame` takes.
fn places(line: &Line) -> usize {
    let stop = Stop::new().unwrap();
    let node = Node::open(&line.station, RoleId::Tool, Duration::from_millis(100), &stop).unwrap();
    let readers: Vec<_> = std::iter::from_fn(|| node.frame_reader().ok()).collect();
    readers.len()
}

#[test]
fn the_technician_sees_the_picture_with_what_is_seen_in_it_and_nobody_reads_frames_without_one() {
    let mut line = Line::with_film("speed = \"file\"", "", &["-i", "p1_J1_r1.mp4"]);
    let port = line.board("enable = true\n");
    line.start("steward");
    line.start_all_but(&["steward"]);
    line.start("capture");
    line.start_board();
    Modbus::connect_when_up(line.port).wait_for(status::READY);
    let free = places(&line);
    let mut browser = Browser::start();
    let tab = browser.open(&format!("http://localhost:{port}/technician"), FULL_HD);
    browser.until(&tab, "document.getElementById('picture').naturalWidth > 0");
    assert_eq!(places(&line) + 1, free, "the board reads");
    let text = "fetch('/picture.svg?lang=fr').then((answer) => answer.text())";
    browser.until(&tab, &format!("{text}.then((text) => text.includes('>main droite</text>'))"));
    browser.until(&tab, &format!("{text}.then((text) => text.includes('base64,/9j/'))"));
    // Another one comes by itself.
    browser.value(&tab, "window.first = document.getElementById('picture').src");
    browser.until(&tab, "document.getElementById('picture').src !== window.first");
    browser.until(&tab, "document.querySelectorAll('#events tbody tr').length > 0");
    for (size, name) in [(WHOLE, "technician-picture"), (TABLET, "technician-picture-tablet")] {
        browser.resize(&tab, size);
        browser.keep(&tab, name);
    }
    browser.go(&tab, &format!("http://localhost:{port}/"));
    let until = Instant::now() + PATIENCE;
    while places(&line) < free {
        assert!(Instant::now() < until, "frames are read although nobody looks");
        std::thread::sleep(Duration::from_millis(500));
    }
}

/// A line that has recorded a fault on a film and is at its end, with its board.
fn recorded() -> (Line, u16) {
    let mut line = Line::with_film("speed = \"file\"", "", &["-i", "p1_J1_r1.mp4"]);
    let port = line.board("enable = true\n");
    line.record("fault");
    let _watcher = line.launch_recorded();
    line.start_board();
    line.start("capture");
    line.wait_for_log("record", "AND-411", "");
    line.roles.retain(|role| role.role != "capture");
    // What it has begun is whole when it has ended.
    line.role("record").signal(Signal::TERM);
    line.role("record").wait();
    (line, port)
}

const FRAME_IS_SHOWN: &str = "document.getElementById('frame').naturalWidth > 0";
const IS_AT_EVENT: &str = "location.pathname === '/technician/event' && document.readyState === 'complete' && document.getElementById('frame').naturalWidth > 0";

/// Whether the film is at this picture, as a JavaScript expression.
fn is_at(frame: &str) -> String {
    format!(
        "new URLSearchParams(location.search).get('frame') === String({frame}) && slide.value === String({frame}) && {FRAME_IS_SHOWN}"
    )
}

#[test]
fn an_event_leads_to_its_film_which_steps_and_plays_and_keeps_its_place_until_its_recording_is_removed() {
    let (mut line, port) = recorded();
    let board = format!("http://localhost:{port}");
    let mut browser = Browser::start();
    let tab = browser.open(&format!("{board}/technician?fault=fault.Strokes.below"), FULL_HD);
    let link = "document.querySelector('#events tbody a[href^=\"/technician/event\"]')";
    browser.until(&tab, &format!("{link}?.textContent.startsWith('\u{25b6}')"));
    let list = browser.value(&tab, "location.href");
    browser.value(&tab, &format!("{link}.click()"));
    browser.until(&tab, IS_AT_EVENT);
    let second = browser.value(&tab, "document.getElementById('second').textContent");
    assert_eq!(second, json!("+0.00 s"), "the picture that was decided on");
    let told =
        browser.value(&tab, "document.getElementById('verdict').innerText").as_str().unwrap().to_owned();
    for words in ["FAULT", "too few strokes", "Expected", "Done", "AND-305"] {
        assert!(told.contains(words), "{words} is not in {told}");
    }
    for (size, name) in [([1920, 2400], "event"), (TABLET, "event-tablet"), (TWICE, "event-twice")] {
        browser.resize(&tab, size);
        assert_accessible(&mut browser, &tab, "", name);
        browser.keep(&tab, name);
    }
    browser.resize(&tab, FULL_HD);
    let lost = browser.faults_of_focus(&tab, 8);
    assert!(lost.is_empty(), "{lost:#?}");

    // By keyboard and by touch, one picture after the other.
    let first = browser.value(&tab, "Number(slide.value)").as_u64().unwrap();
    browser.value(&tab, "document.getElementById('previous').click()");
    browser.until(&tab, &is_at(&(first - 1).to_string()));
    browser.value(&tab, "document.getElementById('slide').focus()");
    browser.press(&tab, "ArrowLeft", 37);
    browser.until(&tab, &is_at(&(first - 2).to_string()));
    browser.value(&tab, "window.isOld = true; setTimeout(() => location.reload()); true");
    browser.until(
        &tab,
        &format!(
            "!window.isOld && document.readyState === 'complete' && {}",
            is_at(&(first - 2).to_string())
        ),
    );
    // A board that starts again has it from the journal and the recordings.
    line.role("board").kill();
    browser.until(&tab, IS_LOST);
    line.start("board");
    browser.until(&tab, IS_HEARD);
    browser.value(&tab, "window.isOld = true; setTimeout(() => location.reload()); true");
    browser.until(&tab, &format!("!window.isOld && {IS_AT_EVENT} && {}", is_at(&(first - 2).to_string())));
    // It plays, stops where somebody stops it, and goes on to its end.
    browser.value(&tab, "document.getElementById('play').click()");
    browser.until(&tab, &format!("Number(slide.value) > {}", first + 5));
    browser.value(&tab, "document.getElementById('play').click()");
    browser.until(&tab, &is_at("slide.value"));
    browser.value(&tab, "document.getElementById('play').click()");
    browser.until(&tab, &is_at("slide.max"));
    // Without scripts the next picture is a link.
    let of = |frame: u64| {
        let drawn = format!(
            "fetch('/technician/event' + location.search.replace(/frame=\\d+/, 'frame={frame}')).then((answer) => answer.text())"
        );
        format!(
            "{drawn}.then((page) => page.includes('frame={}\"') && page.includes('&amp;frame={}\"'))",
            frame,
            frame + 1
        )
    };
    assert_eq!(browser.value(&tab, &of(3)), json!(true));
    browser.value(&tab, "history.back()");
    browser.until(&tab, &format!("location.href === {list} && document.readyState === 'complete'"));

    // The recording comes as it is, and the code is explained as `andond explain` does.
    browser.value(&tab, &format!("{link}.click()"));
    browser.until(&tab, IS_AT_EVENT);
    let name = browser.value(&tab, "document.querySelector('#clip code').textContent");
    let name = name.as_str().unwrap();
    let recording = line.recordings().into_iter().find(|path| path.ends_with(name)).unwrap();
    let download = "fetch(document.querySelector('a[download]').href).then(async (answer) => [answer.headers.get('content-disposition'), (await answer.arrayBuffer()).byteLength, answer.url])";
    let download = browser.value(&tab, download);
    assert_eq!(download[0], json!("attachment"));
    assert_eq!(download[1], json!(recording.metadata().unwrap().len()));
    assert!(download[2].as_str().unwrap().contains(&format!("/{name}?")), "{download}");
    browser.value(&tab, "document.querySelector('#verdict a').click()");
    browser.until(&tab, "location.pathname === '/technician/explain' && document.readyState === 'complete'");
    let said = Command::new(andond()).args(["explain", "305"]).output().unwrap();
    let said = String::from_utf8(said.stdout).unwrap();
    let remedy = said.rsplit_once("what to do:").unwrap().1.trim();
    let shown = browser.value(&tab, "document.getElementById('explain').innerText");
    assert!(shown.as_str().unwrap().contains(remedy), "{remedy} is not in {shown}");
    browser.resize(&tab, WHOLE);
    browser.keep(&tab, "explain");
    browser.resize(&tab, FULL_HD);

    // What was removed or damaged is said, on the page that is open and on a new one.
    browser.value(&tab, "history.back()");
    browser.until(&tab, IS_AT_EVENT);
    for lang in ["de", "zh"] {
        browser.value(&tab, &format!("document.querySelector('footer a[hreflang={lang}]').click()"));
        browser.until(&tab, &format!("document.documentElement.lang === '{lang}' && {IS_AT_EVENT}"));
        assert_accessible(&mut browser, &tab, "", lang);
        browser.keep(&tab, &format!("event-{lang}"));
    }
    browser.value(&tab, "document.querySelector('footer a[hreflang=en]').click()");
    browser.until(&tab, &format!("document.documentElement.lang === 'en' && {IS_AT_EVENT}"));
    let whole = std::fs::read(&recording).unwrap();
    std::fs::write(&recording, b"no recording").unwrap();
    let drawn = "fetch(location.href).then((answer) => answer.text())";
    browser.until(&tab, &format!("{drawn}.then((page) => page.includes('cannot be read'))"));
    std::fs::write(&recording, whole).unwrap();
    browser.until(&tab, &format!("{drawn}.then((page) => page.includes('id=\"player\"'))"));
    store::remove(&recording).unwrap();
    browser.value(&tab, "slide.value = 0; slide.dispatchEvent(new Event('input'))");
    browser.until(&tab, "!document.getElementById('frame_lost').hidden");
    browser.keep(&tab, "event-removed");
    let gone = "fetch(document.querySelector('a[download]').href).then((answer) => answer.status)";
    assert_eq!(browser.value(&tab, gone), json!(404));
    browser.value(&tab, "location.reload()");
    browser.until(&tab, "document.body.innerText.includes('No clip shows this event')");
    for lang in ["de", "zh"] {
        browser.go(&tab, &format!("{board}/technician/explain?code=305&lang={lang}"));
        browser.keep(&tab, &format!("explain-{lang}"));
    }
}

#[test]
fn a_fault_is_heard_where_the_address_asks_for_it_and_nowhere_else() {
    let (_line, _watcher, board) = at_work();
    let mut browser = Browser::start();
    let tab = browser.open(&format!("{board}/"), TABLET);
    assert_eq!(browser.value(&tab, "document.querySelector('script[src=\"/sound.js\"]')"), json!(null));
    browser.go(&tab, &format!("{board}/?sound=on"));
    let count = "
        window.tones = 0;
        const { start } = OscillatorNode.prototype;
        OscillatorNode.prototype.start = function (...when) { window.tones += 1; start.apply(this, when); };
        true";
    assert_eq!(browser.value(&tab, count), json!(true));
    // No browser lets a page sound that nobody has touched.
    browser.press(&tab, "Tab", 9);
    browser.until(&tab, "window.tones >= 2");
    let links = "[...document.querySelectorAll('footer a')].every((link) => link.href.includes('sound=on'))";
    assert_eq!(browser.value(&tab, links), json!(true), "another page keeps it");
}

#[test]
fn the_worker_sees_a_step_with_its_picture_where_teach_was_asked_to_keep_one() {
    let mut line = Line::with_film("speed = \"file\"", "", &["-i", "p1_none_r1.mp4"]);
    let port = line.board("enable = true\n");
    let shipped = root().join("config/jobs/polish-and-measure.toml");
    line.reconfigure(&format!("job = {shipped:?}"), "job = \"job.toml\"");
    let job = line.path("job.toml");
    let films: Vec<String> = ["p1_none_r1.mp4", "p2_none_r1.mp4"]
        .map(|name| root().join("tests/footage").join(name).to_str().unwrap().to_owned())
        .into();
    let config = line.config();
    let teach = |more: &[&str]| {
        let mut arguments: Vec<&str> = films.iter().map(String::as_str).collect();
        arguments.extend(["--force", "--out", job.to_str().unwrap()]);
        arguments.extend(more);
        let output =
            Command::new(andond()).args(["teach", "--config"]).arg(&config).args(arguments).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    // A job is there before the station is.
    std::fs::copy(&shipped, &job).unwrap();
    let pictures = || {
        let names = std::fs::read_dir(job.parent().unwrap()).unwrap().map(|entry| entry.unwrap().file_name());
        names.filter(|name| name.to_string_lossy().contains(".step-")).count()
    };
    assert!(teach(&["--pictures"]).contains("pictures: of 2 of 2 steps"));
    assert_eq!(pictures(), 2);
    line.start("steward");
    line.start_all_but(&["steward"]);
    line.start("capture");
    line.start_board();
    let mut browser = Browser::start();
    let tab = browser.open(&format!("http://localhost:{port}/"), FULL_HD);
    browser.until(&tab, "[...document.querySelectorAll('.steps img')].filter((picture) => picture.naturalWidth > 0).length === 2");
    assert_accessible(&mut browser, &tab, "", "steps");
    for (size, name) in
        [(FULL_HD, "worker-steps"), (TABLET, "worker-steps-tablet"), (TWICE, "worker-steps-twice")]
    {
        browser.resize(&tab, size);
        browser.keep(&tab, name);
    }
    // Nothing of people is left of a job that was taught again without.
    assert!(teach(&[]).contains("pictures: none; those of the job before were removed"));
    assert_eq!(pictures(), 0);
}

#[test]
fn the_sixth_window_of_a_browser_is_watched_and_the_oldest_says_so_and_comes_back_by_a_touch() {
    let (_line, _watcher, board) = at_work();
    let mut browser = Browser::start();
    let is_watched = "document.getElementById('lost').hidden && document.getElementById('elsewhere').hidden";
    let windows: Vec<Tab> = (0..6)
        .map(|_| {
            let window = browser.open(&format!("{board}/"), TABLET);
            browser.until(&window, is_watched);
            window
        })
        .collect();
    browser.until(&windows[0], "!document.getElementById('elsewhere').hidden");
    browser.keep(&windows[0], "worker-elsewhere");
    browser.value(&windows[0], "document.body.dispatchEvent(new Event('pointerdown', { bubbles: true }))");
    browser.until(&windows[0], is_watched);
    browser.until(&windows[1], "!document.getElementById('elsewhere').hidden");
    // Something more can still be loaded.
    browser.go(&windows[0], &format!("{board}/technician"));
    browser.until(&windows[0], "document.querySelectorAll('#roles tbody tr').length > 0");
}
