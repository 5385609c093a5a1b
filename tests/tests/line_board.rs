//! The pages of a running line, in a real browser.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::{Node, Stop};
use andon_tests::browser::{Browser, Tab};
use andon_tests::line::{Line, Modbus, PATIENCE, Settings, Watcher, andond, ask, free_port, status};
use andon_tests::simulator::Flaw;
use serde_json::json;
use shm_schemas::RoleId;
use std::net::TcpListener;
use std::process::Command;
use std::time::{Duration, Instant};

const FULL_HD: [u32; 2] = [1920, 1080];
const TABLET: [u32; 2] = [800, 1280];
/// So high that a whole page is in a picture.
const WHOLE: [u32; 2] = [1920, 1600];
/// What is left of Full HD at 200 %.
const TWICE: [u32; 2] = [960, 540];

/// Gives a line a board, and returns its port.
fn with_board(line: &Line) -> u16 {
    let port = free_port();
    line.reconfigure("[plc]\n", &format!("[board]\nenable = true\nport = {port}\n\n[plc]\n"));
    port
}

/// A line whose worker leaves out half of the strokes again and again, and that is ready.
fn at_work() -> (Line, Watcher, String) {
    let mut line = Line::new(Settings { flaw: Flaw::J1, ..Settings::live() });
    let port = with_board(&line);
    let watcher = line.up();
    line.start("board");
    line.wait_for_log("board", "AND-620", "");
    Modbus::connect_when_up(line.port).wait_for(status::READY);
    (line, watcher, format!("http://localhost:{port}"))
}

/// Keeps a picture of a page in this folder, if somebody asks for it, to be looked at.
fn keep(browser: &mut Browser, tab: &Tab, name: &str) {
    let Some(folder) = std::env::var_os("ANDON_SCREENSHOTS") else { return };
    let picture = browser.picture(tab);
    let path = std::path::Path::new(&folder).join(format!("{name}.b64"));
    std::fs::write(path, picture).unwrap();
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

#[test]
fn a_fault_on_a_film_a_board_that_is_killed_and_a_dead_line_are_said_and_the_page_comes_back_by_itself() {
    let mut line = Line::with_film("speed = \"file\"", "", &["-i", "p1_J1_r1.mp4"]);
    let port = with_board(&line);
    // A cold browser may take longer than the board calls a line that is not up one that starts.
    let mut browser = Browser::start();
    let tab = browser.open("data:text/html,warm", FULL_HD);
    line.start("steward");
    let mut watcher = Watcher::join(&line.station);
    line.start("board");
    line.wait_for_log("board", "AND-620", "");
    browser.go(&tab, &format!("http://localhost:{port}/?lang=de"));
    browser.until(&tab, &says(&["STARTET"]));
    assert_eq!(browser.value(&tab, OBSERVE), json!(true));
    line.start_all_but(&["steward"]);
    line.start("capture");

    browser.until(&tab, "window.words.some(({ word }) => word === 'FEHLER')");
    let told = browser.value(&tab, "window.words.find(({ word }) => word === 'FEHLER').told");
    let told = told.as_str().unwrap().to_owned();
    for words in ["Schritt 1: ", "zu wenige Hübe", "Erwartet", "Getan"] {
        assert!(told.contains(words), "{words} is not in {told}");
    }
    keep(&mut browser, &tab, "worker-fault");
    // How long it took is a measurement, and no test asserts it.
    watcher.until("the fault", |watcher| watcher.verdicts.iter().any(|verdict| verdict.outcome == 2));
    let decided_ns = watcher.verdicts.iter().find(|verdict| verdict.outcome == 2).unwrap().decided_utc_ns;
    let shown =
        browser.value(&tab, "window.words.find(({ word }) => word === 'FEHLER').at").as_f64().unwrap();
    println!("the fault was shown {:.1} ms after it was decided", shown - decided_ns as f64 / 1e6);

    line.role("board").kill();
    browser.until(&tab, IS_LOST);
    assert!(
        browser
            .value(&tab, "document.getElementById('lost').innerText")
            .as_str()
            .unwrap()
            .contains("KEINE VERBINDUNG")
    );
    keep(&mut browser, &tab, "worker-lost");
    line.start("board");
    browser.until(&tab, IS_HEARD);
    browser.until(&tab, &says(&["LÄUFT", "FEHLER", "BEREIT", "GUT"]));
    assert_eq!(browser.value(&tab, "window.words.length > 0"), json!(true), "the page was not loaded again");

    line.role("judge").kill();
    browser.until(&tab, &says(&["KEINE PRÜFUNG"]));
    keep(&mut browser, &tab, "worker-dead");
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
    keep(&mut browser, &tab, "technician");
    browser.resize(&tab, FULL_HD);

    // The fault is chosen in the form, and the address has it.
    let choose = "
        const faults = document.getElementById('fault');
        faults.value = 'fault.Strokes.below';
        faults.form.requestSubmit();
        true";
    assert_eq!(browser.value(&tab, choose), json!(true));
    browser.until(
        &tab,
        "location.search === '?fault=fault.Strokes.below' && document.readyState === 'complete'",
    );
    let only = "
        const rows = [...document.querySelectorAll('#events tbody tr')].map((row) => row.innerText);
        rows.length > 0 && rows.every((row) => row.includes('too few strokes') && /strokes\\s/.test(row))";
    assert_eq!(
        browser
            .value(&tab, &format!("(() => {{ {} }})()", only.replace("rows.length", "return rows.length"))),
        json!(true)
    );
    keep(&mut browser, &tab, "technician-filtered");

    // The link of the oldest row leads to it, whatever has happened since, and after a reload.
    let link = "[...document.querySelectorAll('#events td a')].at(-1).href";
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
        "location.search === '?fault=fault.Strokes.below' && document.readyState === 'complete'",
    );

    // Another language keeps the place as well.
    browser.go(&tab, &link);
    browser.value(&tab, "document.querySelector('footer a[href*=\"lang=fr\"]').click()");
    browser.until(&tab, &format!("document.documentElement.lang === 'fr' && {first}"));
}

/// The smallest contrast of visible texts with what lies behind them, and where that is, by the formula of WCAG 2.
const CONTRAST: &str = r#"
(() => {
    const channels = (color) => color.match(/[\d.]+/g).map(Number);
    const part = (value) => (value /= 255) <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
    const luminance = ([r, g, b]) => 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
    const behind = (element) => {
        for (; element; element = element.parentElement) {
            const color = channels(getComputedStyle(element).backgroundColor);
            if (color.length < 4 || color[3] > 0) return color;
        }
        return [255, 255, 255];
    };
    let least = { contrast: 21, text: "" };
    const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let text = texts.nextNode(); text; text = texts.nextNode()) {
        const element = text.parentElement;
        if (!text.data.trim() || !element.checkVisibility()) continue;
        const pair = [channels(getComputedStyle(element).color), behind(element)].map(luminance).sort();
        const contrast = (pair[1] + 0.05) / (pair[0] + 0.05);
        if (contrast < least.contrast) least = { contrast, text: text.data };
    }
    return least;
})()"#;

/// Sets a page by `before`, and looks at it before the server can set it anew.
fn assert_contrast(browser: &mut Browser, tab: &Tab, before: &str, what: &str) {
    let least = browser.value(tab, &format!("(() => {{ {before}; return {}; }})()", CONTRAST.trim()));
    assert!(least["contrast"].as_f64().unwrap() >= 4.5, "{what}: {least}");
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
        assert_contrast(&mut browser, &tab, &set, style);
    }
    browser.until(&tab, &says(&["WORKING"]));
    keep(&mut browser, &tab, "worker-quiet");
    browser.resize(&tab, TABLET);
    keep(&mut browser, &tab, "worker-quiet-tablet");
    browser.resize(&tab, FULL_HD);
    for lang in ["de", "en", "es", "fr", "zh"] {
        browser.go(&tab, &format!("{board}/?lang={lang}"));
        browser
            .until(&tab, "['fault', 'quiet', 'stopped'].includes(document.getElementById('view').className)");
        for (size, name) in [(FULL_HD, "1080p"), (TABLET, "tablet"), (TWICE, "twice")] {
            browser.resize(&tab, size);
            let wide = "document.documentElement.scrollWidth <= innerWidth";
            assert_eq!(browser.value(&tab, wide), json!(true), "{lang} {name}");
            keep(&mut browser, &tab, &format!("worker-{lang}-{name}"));
        }
        browser.resize(&tab, FULL_HD);
    }
    // No text is left without a word in any language.
    let raw = "/(label|state|fault|unit|order|context)\\.[A-Za-z]/.test(document.body.innerText)";
    assert_eq!(browser.value(&tab, raw), json!(false));

    for page in ["/", "/technician"] {
        browser.go(&tab, &format!("{board}{page}"));
        assert_contrast(&mut browser, &tab, "", page);
        let mut stops = std::collections::BTreeSet::new();
        for _ in 0..12 {
            browser.press(&tab, "Tab", 9);
            let focused = "document.activeElement.outerHTML.slice(0, 60)";
            stops.insert(browser.value(&tab, focused).to_string());
        }
        assert!(stops.len() >= 7, "{page}: {stops:?}");
        // With gloves: at 96 dots per inch 15 mm are 56 pixels.
        let small = "[...document.querySelectorAll('footer a')].filter((link) => link.getBoundingClientRect().height < 56 || link.getBoundingClientRect().width < 56).length";
        assert_eq!(browser.value(&tab, small), json!(0), "{page}");
    }
    for size in [TABLET, TWICE] {
        browser.resize(&tab, size);
        assert_eq!(
            browser.value(&tab, "document.documentElement.scrollWidth <= innerWidth"),
            json!(true),
            "{size:?}"
        );
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
    let port = with_board(&line);
    line.start("steward");
    line.start_all_but(&["steward"]);
    line.start("capture");
    line.start("board");
    line.wait_for_log("board", "AND-620", "");
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
        keep(&mut browser, &tab, name);
    }
    browser.go(&tab, &format!("http://localhost:{port}/"));
    let until = Instant::now() + PATIENCE;
    while places(&line) < free {
        assert!(Instant::now() < until, "frames are read although nobody looks");
        std::thread::sleep(Duration::from_millis(500));
    }
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
    keep(&mut browser, &windows[0], "worker-elsewhere");
    browser.value(&windows[0], "document.body.dispatchEvent(new Event('pointerdown', { bubbles: true }))");
    browser.until(&windows[0], is_watched);
    browser.until(&windows[1], "!document.getElementById('elsewhere').hidden");
    // Something more can still be loaded.
    browser.go(&windows[0], &format!("{board}/technician"));
    browser.until(&windows[0], "document.querySelectorAll('#roles tbody tr').length > 0");
}

#[test]
fn a_board_without_its_port_or_its_words_says_so() {
    let mut line = Line::new(Settings::live());
    let port = with_board(&line);
    line.start("steward");
    let taken = TcpListener::bind(("127.0.0.1", port)).unwrap();
    line.start("board");
    line.wait_for_log("board", "AND-622", "choose another board.port");
    drop(taken);
    line.start("board");
    line.wait_for_log("board", "AND-620", "");
    line.reconfigure("[board]\n", "[board]\nlanguage = \"tlh\"\n");
    let run = ["run", "board", "--as-given", "--config"];
    let output = Command::new(andond()).args(run).arg(line.config()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(78), "{said}");
    assert!(said.contains("AND-623") && said.contains("there are de, en, es, fr, zh"), "{said}");
}
