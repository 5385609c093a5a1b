//! How a board is come by and lost: a demo ends with one, a network is cut, and a line has none.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::{Node, Stop};
use andon_tests::browser::Browser;
use andon_tests::line::{Killed, Line, Modbus, Settings, andond, root, status};
use andon_tests::simulator::Flaw;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::json;
use shm_schemas::{Health, Judging, RoleId, Verdict};
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

const FULL_HD: [u32; 2] = [1920, 1080];

#[test]
fn a_demo_with_a_board_shows_what_ran_and_plays_on_until_it_is_asked_to_stop() {
    let [clips, folder] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    std::os::unix::fs::symlink(root().join("tests/footage/p1_J1_r1.mp4"), clips.path().join("p1_J1_r1.mp4"))
        .unwrap();
    let demo = Command::new(andond())
        .args(["demo", "--board", "--speed", "max", "--clips"])
        .arg(clips.path())
        .current_dir(root())
        .env("TMPDIR", folder.path())
        .env_remove("ANDON_CONFIG")
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut demo = Killed(demo);
    let (mut lines, mut text) = (BufReader::new(demo.0.stdout.take().unwrap()).lines(), String::new());
    let last = lines.by_ref().map_while(Result::ok).find(|line| {
        text.push_str(line);
        line.contains(" for the worker")
    });
    let address = last.as_deref().and_then(|last| last.split_whitespace().next()).unwrap_or_default();
    assert!(address.starts_with("http://localhost:"), "{text}");
    assert!(text.contains("1 of 1 clips judged rightly"), "{text}");

    let mut browser = Browser::start();
    let tab = browser.open(&format!("{address}technician?fault=fault.Strokes.below"), FULL_HD);
    // What ran before anybody looked, with its clip.
    let row = "[...document.querySelectorAll('#events tbody tr')].at(-1)";
    browser.until(&tab, &format!("Boolean({row}?.innerText.includes('too few strokes'))"));
    browser.until(&tab, &format!("Boolean({row}?.innerText.includes('\u{25b6}'))"));
    browser.until(&tab, "document.getElementById('picture').naturalWidth > 0");
    browser.value(&tab, &format!("{row}.querySelector('a[href^=\"/technician/event\"]').click()"));
    browser.until(&tab, "document.getElementById('frame')?.naturalWidth > 0");
    browser.go(&tab, address);
    browser.until(&tab, "document.querySelector('#view h1')?.textContent === 'WORKING'");

    kill_process(Pid::from_raw(demo.0.id() as i32).unwrap(), Signal::INT).unwrap();
    assert_eq!(demo.0.wait().unwrap().code(), Some(0));
    browser.until(&tab, "!document.getElementById('lost').hidden");
    // ONNX Runtime leaves a file of its own there.
    let left = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
    let left: Vec<_> = left.filter(|name| name.to_string_lossy().starts_with("andon-")).collect();
    assert!(left.is_empty(), "{left:?}");
}

/// How many more readers the channels of the judge and of the roles' health, and that of the frames, take.
fn places(line: &Line) -> [usize; 4] {
    let stop = Stop::new().unwrap();
    let node = Node::open(&line.station, RoleId::Tool, Duration::from_millis(100), &stop).unwrap();
    [
        std::iter::from_fn(|| node.reader::<Verdict>().ok()).collect::<Vec<_>>().len(),
        std::iter::from_fn(|| node.reader::<Judging>().ok()).collect::<Vec<_>>().len(),
        std::iter::from_fn(|| node.reader::<Health>().ok()).collect::<Vec<_>>().len(),
        std::iter::from_fn(|| node.frame_reader().ok()).collect::<Vec<_>>().len(),
    ]
}

#[test]
fn worker_and_technician_read_their_language_and_no_other() {
    let mut line = Line::new(Settings { flaw: Flaw::J1, ..Settings::live() });
    let port = line.board("enable = true\n");
    let mut watcher = line.up();
    line.start_board();
    watcher.until("a fault", |watcher| watcher.verdicts.iter().any(|verdict| verdict.outcome == 2));
    let mut browser = Browser::start();
    let tab = browser.open("about:blank#", FULL_HD);
    for (lang, step, role, remedy) in [
        (
            "de",
            "polisher an brick",
            "urteilt",
            "Das Produkt ansehen; `andond history --nok` zeigt die Schritte",
        ),
        ("es", "polisher en brick", "juzga", "Mire el producto; `andond history --nok` muestra los pasos"),
        (
            "fr",
            "polisher sur brick",
            "juge",
            "Regarder le produit ; `andond history --nok` montre les étapes",
        ),
        ("zh", "polisher在brick处", "判定", "检查产品；`andond history --nok` 显示各步骤"),
    ] {
        for (page, text) in [
            ("/?", step),
            ("/technician?", step),
            ("/technician?", role),
            ("/technician/explain?code=305&", remedy),
        ] {
            browser.go(&tab, &format!("http://localhost:{port}{page}lang={lang}"));
            browser.until(&tab, &format!("document.body.innerText.includes({})", json!(text)));
            let foreign = "[...document.querySelectorAll('main [lang]')].map((element) => element.innerText)";
            assert_eq!(browser.value(&tab, foreign), json!([]), "{lang} {page}");
            browser.keep(
                &tab,
                &format!("language-{lang}-{}", page.trim_matches(['/', '?']).replace(['/', '?'], "-")),
            );
        }
    }
}

#[test]
fn what_only_the_rules_of_axe_find_is_a_fault_of_a_page() {
    let mut browser = Browser::start();
    let page = |list: &str| {
        format!(
            "data:text/html,<!DOCTYPE html><html lang=en><title>A page</title><main><h1>A page</h1>{list}</main>"
        )
    };
    let tab = browser.open(&page("<ul><li>one</ul>"), FULL_HD);
    assert_eq!(browser.faults(&tab, ""), [""; 0]);
    browser.go(&tab, &page("<ul><p>one</ul>"));
    let faults = browser.faults(&tab, "");
    assert!(matches!(faults.as_slice(), [fault] if fault.starts_with("axe: list")), "{faults:?}");
}

#[test]
fn a_line_without_a_board_pays_for_none_also_where_its_role_runs() {
    let mut line = Line::new(Settings::live());
    let port = line.board("");
    let _watcher = line.up();
    let before = places(&line);
    assert!(before.iter().all(|places| *places > 0), "{before:?}");
    line.start("board");
    line.wait_for_log("board", "AND-621", "");
    assert_eq!(places(&line), before, "it reads something");
    assert!(TcpStream::connect(("127.0.0.1", port)).is_err(), "it listens");
    // It is there as it was told to be, and the line is ready with it.
    Modbus::connect_when_up(line.port).wait_for(status::READY);
}

#[test]
fn a_board_that_stood_still_while_a_picture_was_wanted_shows_the_next_one() {
    let mut line = Line::with_film("speed = \"file\"", "", &["-i", "p1_J1_r1.mp4"]);
    let port = line.board("enable = true\n");
    // Without `perceive` nobody says what is in a picture, and each waits for that.
    for role in ["steward", "capture", "board"] {
        line.start(role);
    }
    line.wait_for_log("board", "AND-620", "");
    let mut browser = Browser::start();
    let tab = browser.open(&format!("http://localhost:{port}/technician"), FULL_HD);
    browser.until(&tab, "document.getElementById('picture').naturalWidth > 0");
    for _ in 0..20 {
        // Meanwhile more frames come than a reader may hold.
        for (signal, ms) in [(Signal::STOP, 150), (Signal::CONT, 50)] {
            line.role("board").signal(signal);
            std::thread::sleep(Duration::from_millis(ms));
        }
    }
    browser.value(&tab, "window.first = document.getElementById('picture').src");
    browser.until(&tab, "document.getElementById('picture').src !== window.first");
    assert_eq!(line.role("board").ended(), None, "{}", line.log("board"));
}

#[test]
fn a_page_that_did_not_get_its_script_or_its_style_is_loaded_again_by_itself() {
    let mut line = Line::new(Settings::live());
    let port = line.board("enable = true\n");
    let _watcher = line.up();
    line.start_board();
    let mut browser = Browser::start();
    let tab = browser.open("data:text/html,warm", FULL_HD);
    let is_whole = "!window.isOld && typeof hear === 'function' && document.getElementById('lost').hidden
        && getComputedStyle(document.getElementById('lost')).position === 'fixed'";
    for (part, is_missing) in [
        ("/board.js", "typeof hear === 'undefined'"),
        ("/board.css", "getComputedStyle(document.getElementById('lost')).position !== 'fixed'"),
    ] {
        browser.block(&tab, &[part]);
        browser.go(&tab, &format!("http://localhost:{port}/"));
        browser.until(&tab, &format!("document.querySelector('#view h1') !== null && {is_missing}"));
        browser.until(&tab, "window.isOld = true");
        browser.block(&tab, &[]);
        browser.until(&tab, is_whole);
    }
}

#[test]
fn a_board_without_its_port_or_its_words_says_so() {
    let mut line = Line::new(Settings::live());
    let port = line.board("enable = true\n");
    line.start("steward");
    let taken = TcpListener::bind(("127.0.0.1", port)).unwrap();
    line.start("board");
    line.wait_for_log("board", "AND-622", "choose another board.port");
    drop(taken);
    line.start_board();
    line.reconfigure("[board]\n", "[board]\nlanguage = \"tlh\"\n");
    let run = ["run", "board", "--as-given", "--config"];
    let output = Command::new(andond()).args(run).arg(line.config()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(78), "{said}");
    assert!(said.contains("AND-623") && said.contains("there are de, en, es, fr, zh"), "{said}");
}

/// A network between browsers and a board.
struct Network {
    port: u16,
    is_cut: Arc<AtomicBool>,
}

impl Network {
    fn before(board: u16) -> Self {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let network = Self { port: listener.local_addr().unwrap().port(), is_cut: Arc::default() };
        let is_cut = Arc::clone(&network.is_cut);
        std::thread::spawn(move || {
            for near in listener.incoming().map_while(Result::ok) {
                let Ok(far) = TcpStream::connect(("127.0.0.1", board)) else { continue };
                for (from, to) in [(&near, &far), (&far, &near)] {
                    let (from, to) = (from.try_clone().unwrap(), to.try_clone().unwrap());
                    let is_cut = Arc::clone(&is_cut);
                    std::thread::spawn(move || carry(from, to, &is_cut));
                }
            }
        });
        network
    }
}

/// Carries bytes until the network is cut. Then nothing comes through any more, not even the end, and nobody is told.
fn carry(mut from: TcpStream, mut to: TcpStream, is_cut: &AtomicBool) {
    let (mut bytes, mut is_dead) = (vec![0; 65_536], false);
    loop {
        let count = from.read(&mut bytes).unwrap_or_default();
        is_dead |= is_cut.load(Ordering::Relaxed);
        if count == 0 {
            break;
        }
        if !is_dead && to.write_all(&bytes[..count]).is_err() {
            break;
        }
    }
    if !is_dead {
        let _ = to.shutdown(Shutdown::Both);
    }
}

#[test]
fn pages_behind_a_network_that_is_cut_say_so_and_come_back_by_themselves_with_what_happened_meanwhile() {
    let mut line = Line::new(Settings { flaw: Flaw::J1, ..Settings::live() });
    let port = line.board("enable = true\nhosts = [\"bench1\"]\n");
    let mut watcher = line.up();
    line.start_board();
    let network = Network::before(port);
    let through = format!("--host-resolver-rules=MAP bench1:{port} 127.0.0.1:{}", network.port);
    let mut browser = Browser::start_with(&[&through]);
    let tabs = ["/", "/technician?lang=fr"]
        .map(|page| browser.open(&format!("http://bench1:{port}{page}"), FULL_HD));
    watcher.until("a piece", |watcher| watcher.verdicts.iter().any(|verdict| verdict.level == 3));
    let is_lost = "!document.getElementById('lost').hidden";
    let newest = "document.querySelector('#events tbody tr')?.id";
    browser.until(&tabs[1], &format!("Boolean({newest})"));
    for tab in &tabs {
        browser.until(tab, "document.getElementById('lost').hidden");
        browser.value(tab, "window.isOld = true");
    }

    network.is_cut.store(true, Ordering::Relaxed);
    for tab in &tabs {
        browser.until(tab, is_lost);
    }
    let before = browser.value(&tabs[1], newest);
    let seen = watcher.verdicts.len();
    watcher
        .until("the next piece", |watcher| watcher.verdicts[seen..].iter().any(|verdict| verdict.level == 3));
    assert_eq!(browser.value(&tabs[1], newest), before, "what is shown is what came before");
    assert_eq!(browser.value(&tabs[0], is_lost), json!(true));

    network.is_cut.store(false, Ordering::Relaxed);
    for tab in &tabs {
        browser.until(tab, "document.getElementById('lost').hidden && window.isOld");
    }
    browser.until(&tabs[1], &format!("{newest} !== {before}"));
}
