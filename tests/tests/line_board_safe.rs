//! The board of a running line on a network: TLS, logins, and the first thing that can be done on it.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::browser::Browser;
use andon_tests::line::{Line, Modbus, PATIENCE, Settings, Watcher, andond, status};
use andon_tests::simulator::Flaw;
use rustix::process::Signal;
use serde_json::json;
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

const FULL_HD: [u32; 2] = [1920, 1080];
const TABLET: [u32; 2] = [800, 1280];

const PASSWORD: &str = "correct horse";

/// Gives a line a board that other machines reach, with files of its own, and returns its port.
fn on_the_network(line: &Line) -> u16 {
    line.board(
        "enable = true\nbind = \"0.0.0.0\"\ncertificate = \"board.pem\"\nkey = \"board.key\"\nlogins = \"logins.toml\"\n",
    )
}

/// Runs `andond board`; the password comes on the standard input.
fn board(line: &Line, arguments: &[&str]) -> Output {
    line.command_told("board", arguments, PASSWORD)
}

fn done(line: &Line, arguments: &[&str]) -> String {
    let output = board(line, arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// A line whose worker leaves out half of the strokes again and again, that is ready and has a board on the network.
fn at_work() -> (Line, Watcher, u16) {
    let mut line = Line::new(Settings { flaw: Flaw::J1, ..Settings::live() });
    let port = on_the_network(&line);
    done(&line, &["certificate"]);
    done(&line, &["login", "maria", "--role", "technician"]);
    done(&line, &["login", "paul", "--role", "worker"]);
    let watcher = line.up();
    line.start("board");
    line.wait_for_log("board", "AND-620", "https://");
    Modbus::connect_when_up(line.port).wait_for(status::READY);
    (line, watcher, port)
}

/// Who has said what, as the journal has it.
fn audit(line: &Line) -> String {
    let output = line.command("history", &["--audit", "--csv"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_technician_logs_in_says_that_a_verdict_was_wrong_and_logs_out() {
    let (line, mut watcher, port) = at_work();
    watcher.until("a piece", |watcher| watcher.verdicts.iter().any(|verdict| verdict.level == 3));
    let mut browser = Browser::start_with(&["--ignore-certificate-errors"]);
    let tab = browser.open(&format!("https://localhost:{port}/technician?lang=de"), FULL_HD);
    browser.until(&tab, "location.pathname === '/login'");
    for (size, name) in [(FULL_HD, "login"), (TABLET, "login-tablet")] {
        browser.resize(&tab, size);
        browser.keep(&tab, name);
    }
    browser.resize(&tab, FULL_HD);
    browser.log_in(&tab, "maria", "wrong horse");
    browser.until(&tab, "document.body.innerText.includes('Name oder Passwort ist falsch')");
    browser.keep(&tab, "login-wrong");
    line.wait_for_log("board", "AND-626", "127.0.0.1");
    // A worker does not see it.
    browser.log_in(&tab, "paul", PASSWORD);
    browser.until(&tab, "location.pathname === '/' && document.querySelector('#view h1') !== null");
    browser.go(&tab, &format!("https://localhost:{port}/technician?lang=de"));
    browser.until(&tab, "document.body.innerText.includes('Mit einer anderen anmelden')");
    browser.log_in(&tab, "maria", PASSWORD);
    browser.until(&tab, "location.pathname + location.search === '/technician?lang=de'");
    line.wait_for_log("board", "AND-625", "");
    browser.until(&tab, "document.querySelectorAll('#events tbody tr').length > 1");
    // No script reads the token of the session, and the policy has no exception.
    assert_eq!(browser.value(&tab, "document.cookie"), json!(""));

    let row = browser.value(&tab, "document.querySelector('#events tbody tr').id");
    let row = row.as_str().unwrap().to_owned();
    let cell = format!("document.querySelector('#{row} .confirm')");
    for (button, said) in [("wrong", "✕ falsch"), ("wrong", "✕ falsch"), ("right", "✓ richtig")] {
        // What is said already has no button; a form that was open meanwhile can send it all the same.
        let click = format!(
            "(() => {{
                window.isOld = true;
                const form = document.getElementById('confirm');
                const value = {}.slice(1);
                const button = Object.assign(document.createElement('button'), {{ name: {}, value }});
                (({cell}.querySelector('[name={button}]')) ?? form.appendChild(button)).click();
                return true;
            }})()",
            json!(row),
            json!(button)
        );
        assert_eq!(browser.value(&tab, &click), json!(true));
        let shown = format!("!window.isOld && {cell}?.innerText.includes({})", json!(said));
        browser.until(&tab, &shown);
        assert_eq!(browser.value(&tab, "location.pathname + location.search"), json!("/technician?lang=de"));
    }
    for (size, name) in [(FULL_HD, "technician-confirmed"), (TABLET, "technician-confirmed-tablet")] {
        browser.resize(&tab, size);
        let wide = "document.documentElement.scrollWidth <= innerWidth";
        assert_eq!(browser.value(&tab, wide), json!(true), "{name}");
        browser.value(
            &tab,
            &format!("document.getElementById('{row}').scrollIntoView({{ block: 'center' }}); true"),
        );
        browser.keep(&tab, name);
    }
    let kept = audit(&line);
    let said: Vec<&str> = kept.lines().filter(|entry| entry.contains("login maria")).collect();
    let of = |was: &str| said.iter().filter(|entry| entry.contains(&format!("work that was {was}"))).count();
    assert_eq!((of("wrong"), of("right")), (1, 1), "{kept}");
    assert!(said.iter().any(|entry| entry.contains(&format!("of {} was", &row[1..]))), "{kept}");
    assert!(kept.contains("login maria may log in to the board as technician"), "{kept}");
    // What is said by a command is shown as well.
    let id = kept.split("verdict ").nth(1).unwrap().split(' ').next().unwrap().to_owned();
    let output = line.command("confirm", &[&id, "wrong"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    browser.until(&tab, &format!("{cell}?.innerText.includes('✕ falsch')"));

    assert_eq!(browser.value(&tab, "document.querySelector('form.out button').click(); true"), json!(true));
    browser.until(&tab, "location.pathname === '/login'");
    browser.go(&tab, &format!("https://localhost:{port}/technician"));
    browser.until(&tab, "location.pathname === '/login'");
}

#[test]
fn by_the_keyboard_alone_somebody_logs_in_and_says_that_a_verdict_was_wrong_and_a_second_browser_shows_it() {
    let (_line, mut watcher, port) = at_work();
    watcher.until("a piece", |watcher| watcher.verdicts.iter().any(|verdict| verdict.level == 3));
    let mut browsers = [0, 1].map(|_| Browser::start_with(&["--ignore-certificate-errors"]));
    let page = format!("https://localhost:{port}/technician?lang=");
    let [one, other] = &mut browsers;
    let [own, theirs] = [one.open(&format!("{page}en"), FULL_HD), other.open(&format!("{page}de"), TABLET)];
    one.until(&own, "document.activeElement.id === 'name'");
    one.write(&own, "maria");
    one.press(&own, "Tab", 9);
    one.write(&own, PASSWORD);
    one.press(&own, "Enter", 13);
    one.until(&own, "location.pathname + location.search === '/technician?lang=en'");
    other.log_in(&theirs, "maria", PASSWORD);
    for (browser, tab) in [(&mut *one, &own), (&mut *other, &theirs)] {
        browser.until(tab, "document.querySelectorAll('#events tbody tr').length > 1");
    }
    // The list goes on meanwhile, and the focus stays where it is.
    one.tab_to(&own, "document.activeElement.name === 'wrong'");
    let verdict = one.value(&own, "document.activeElement.value").as_str().unwrap().to_owned();
    one.value(&own, "window.isOld = true");
    one.press(&own, "Enter", 13);
    let cell = format!("document.querySelector('#e{verdict} .confirm')?.innerText");
    one.until(&own, &format!("!window.isOld && {cell}?.includes('✕ wrong')"));
    other.until(&theirs, &format!("{cell}?.includes('✕ falsch') && {cell}.includes('maria')"));
    // The page of the event, and back.
    let link = format!(
        "document.activeElement.getAttribute('href')?.includes('/technician/event?lang=en&at={verdict}')"
    );
    one.tab_to(&own, &link);
    one.press(&own, "Enter", 13);
    one.until(&own, "document.querySelector('#verdict .confirm')?.innerText.includes('✕ wrong')");
    one.tab_to(&own, "document.activeElement.closest('main > .turns') !== null");
    one.press(&own, "Enter", 13);
    one.until(&own, &format!("location.pathname === '/technician' && location.hash === '#e{verdict}'"));
    one.tab_to(&own, "document.activeElement.closest('form.out') !== null");
    one.press(&own, "Enter", 13);
    one.until(&own, "location.pathname === '/login'");
    other.until(&theirs, "location.pathname === '/technician' && document.getElementById('lost').hidden");
}

#[test]
fn who_follows_a_link_to_an_event_logs_in_sees_its_film_says_it_was_wrong_and_sees_nothing_after_the_logout()
{
    let mut line = Line::with_film("speed = \"file\"", "", &["-i", "p1_J1_r1.mp4"]);
    let port = on_the_network(&line);
    done(&line, &["certificate"]);
    done(&line, &["login", "maria", "--role", "technician"]);
    line.record("fault");
    let mut watcher = line.launch_recorded();
    line.start("board");
    line.wait_for_log("board", "AND-620", "https://");
    line.start("capture");
    watcher.until("the fault", |watcher| watcher.verdicts.iter().any(|verdict| verdict.outcome == 2));
    let fault = watcher.verdicts.iter().find(|verdict| verdict.outcome == 2).unwrap().stamp.id();
    line.wait_for_log("record", "AND-411", "");
    line.roles.retain(|role| role.role != "capture");
    // What it has begun is whole when it has ended.
    line.role("record").signal(Signal::TERM);
    line.role("record").wait();

    let event = format!("/technician/event?lang=de&at={}-{}", fault.epoch, fault.seq);
    let mut browser = Browser::start_with(&["--ignore-certificate-errors"]);
    let tab = browser.open(&format!("https://localhost:{port}{event}"), FULL_HD);
    browser.until(&tab, "location.pathname === '/login' && document.readyState === 'complete'");
    assert_eq!(browser.faults(&tab, ""), [""; 0], "the login");
    browser.log_in(&tab, "maria", PASSWORD);
    browser.until(&tab, &format!("location.pathname + location.search === {}", json!(event)));
    browser.until(&tab, "document.getElementById('frame')?.naturalWidth > 0");
    assert_eq!(browser.value(&tab, "document.querySelector('form.out span').textContent"), json!("maria"));
    for (size, name) in [([1920, 2400], "event-login"), (TABLET, "event-login-tablet")] {
        browser.resize(&tab, size);
        assert_eq!(browser.faults(&tab, ""), [""; 0], "{name}");
        browser.keep(&tab, name);
    }
    let download = "fetch(document.querySelector('a[download]').href).then((answer) => answer.headers.get('content-disposition'))";
    assert_eq!(browser.value(&tab, download), json!("attachment"));
    // It is said here as well, and the film stays at its picture.
    browser.value(&tab, "document.getElementById('previous').click()");
    browser.until(&tab, "new URLSearchParams(location.search).has('frame')");
    let place = browser.value(&tab, "window.isOld = true; location.pathname + location.search");
    browser.value(&tab, "document.querySelector('#verdict [name=wrong]').click()");
    let said = "!window.isOld && document.querySelector('#verdict .confirm')?.innerText.includes('✕ falsch')";
    browser.until(&tab, said);
    assert_eq!(browser.value(&tab, "location.pathname + location.search"), place);
    assert_eq!(browser.value(&tab, "document.querySelector('#verdict [name=wrong]')"), json!(null));
    let kept = audit(&line);
    let wrong = format!("of {}-{} was on work that was wrong", fault.epoch, fault.seq);
    assert!(kept.contains("login maria") && kept.contains(&wrong), "{kept}");
    browser.value(&tab, "document.querySelector('form.out button').click()");
    browser.until(&tab, "location.pathname === '/login'");
    for name in ["frame.svg", "one.mcap"] {
        let status = format!(
            "fetch('/technician/film/{name}?frame=0&at={}-{}').then((answer) => answer.status)",
            fault.epoch, fault.seq
        );
        assert_eq!(browser.value(&tab, &status), json!(401), "{name}");
    }
}

#[test]
fn a_kiosk_comes_in_by_its_link_and_goes_on_after_the_board_was_killed_and_a_removed_one_is_out() {
    let (mut line, _watcher, port) = at_work();
    let told = done(&line, &["kiosk", "screen"]);
    let link = told.lines().find(|line| line.starts_with("https://")).unwrap().to_owned();
    assert!(link.starts_with(&format!("https://localhost:{port}/kiosk?token=")), "{link}");
    let mut browser = Browser::start_with(&["--ignore-certificate-errors"]);
    let tab = browser.open("data:text/html,warm", FULL_HD);
    // The board looks once a second whether there are other logins.
    let until = Instant::now() + PATIENCE;
    loop {
        browser.go(&tab, &link);
        if browser.is(&tab, "document.querySelector('main') !== null") {
            break;
        }
        assert!(Instant::now() < until, "the link leads nowhere");
        std::thread::sleep(Duration::from_millis(200));
    }
    browser.until(
        &tab,
        "location.pathname + location.search === '/' && document.querySelector('#view h1') !== null && typeof hear === 'function'",
    );
    browser.keep(&tab, "kiosk");
    line.role("board").kill();
    browser.until(&tab, "!document.getElementById('lost').hidden");
    line.start("board");
    browser.until(&tab, "document.getElementById('lost').hidden");
    done(&line, &["remove", "screen"]);
    browser.until(&tab, "location.pathname === '/login'");
    let kept = audit(&line);
    assert!(
        kept.contains("kiosk screen may show the worker's page") && kept.contains("screen was removed"),
        "{kept}"
    );
    assert!(!kept.contains(link.split_once('=').unwrap().1), "the token is in no trail");
}

#[test]
fn a_board_without_what_makes_it_safe_does_not_listen_on_a_network_and_says_what_is_missing() {
    let mut line = Line::new(Settings::live());
    let port = on_the_network(&line);
    line.start("steward");
    line.start("journal");
    line.wait_for_log("journal", "writing to", "");
    let refused = |missing: &str, remedy: &str| {
        let run = ["run", "board", "--as-given", "--config"];
        let role = Command::new(andond()).args(run).arg(line.config()).output().unwrap();
        let said = String::from_utf8_lossy(&role.stderr).into_owned();
        assert_eq!(role.status.code(), Some(78), "{said}");
        assert!(said.contains("AND-624") && said.contains(missing) && said.contains(remedy), "{said}");
        let check = line.command("check", &[]);
        let said = String::from_utf8_lossy(&check.stderr).into_owned();
        assert!(!check.status.success() && said.contains(missing) && said.contains(remedy), "{said}");
        assert!(std::net::TcpStream::connect(("127.0.0.1", port)).is_err());
    };
    refused("board.certificate: ", "`andond board certificate` makes it");
    done(&line, &["certificate"]);
    refused("no login in it", "andond board login NAME --role engineer");
    done(&line, &["login", "maria", "--role", "engineer"]);
    let key = fs::read(line.path("board.key")).unwrap();
    fs::write(line.path("board.key"), "no key").unwrap();
    refused("no private key", "andond board certificate --force");
    fs::write(line.path("board.key"), key).unwrap();
    for name in ["board.key", "board.pem", "logins.toml"] {
        assert_eq!(fs::metadata(line.path(name)).unwrap().permissions().mode() & 0o777, 0o600, "{name}");
    }
    // Without the key the configuration itself is wrong, and names what helps.
    line.reconfigure("certificate = \"board.pem\"\nkey = \"board.key\"\n", "");
    let check = line.command("check", &[]);
    let said = String::from_utf8_lossy(&check.stderr).into_owned();
    assert!(said.contains("board.bind") && said.contains("andond board certificate"), "{said}");
}

#[test]
fn logins_are_made_changed_listed_and_removed_by_commands_and_nothing_wrong_is_kept() {
    let line = Line::new(Settings::live());
    on_the_network(&line);
    done(&line, &["login", "maria", "--role", "technician"]);
    done(&line, &["login", "maria", "--role", "engineer"]);
    done(&line, &["kiosk", "screen"]);
    let listed = done(&line, &["logins"]);
    let words: Vec<Vec<&str>> = listed.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(words, [["maria", "engineer"], ["screen", "kiosk"]]);
    for (arguments, remedy) in [
        (["remove", "nobody"].as_slice(), "andond board logins"),
        (&["login", "maria lopez", "--role", "worker"], "letters, digits, dots"),
        (&["kiosk", ""], "letters, digits, dots"),
    ] {
        let output = board(&line, arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(64) && said.contains(remedy), "{said}");
    }
    done(&line, &["remove", "maria"]);
    done(&line, &["remove", "screen"]);
    assert_eq!(done(&line, &["logins"]), "");
    assert!(!fs::read_to_string(line.path("logins.toml")).unwrap().contains("maria"));
    done(&line, &["certificate"]);
    let again = board(&line, &["certificate"]);
    assert!(String::from_utf8_lossy(&again.stderr).contains("--force"));
    // What the journal does not keep is not done.
    let before = fs::read(line.path("logins.toml")).unwrap();
    fs::rename(line.path("journal.sqlite"), line.path("aside")).unwrap();
    fs::create_dir(line.path("journal.sqlite")).unwrap();
    assert!(!board(&line, &["login", "eve", "--role", "engineer"]).status.success());
    assert_eq!(fs::read(line.path("logins.toml")).unwrap(), before);
    fs::remove_dir(line.path("journal.sqlite")).unwrap();
    fs::rename(line.path("aside"), line.path("journal.sqlite")).unwrap();
    let kept = audit(&line);
    assert!(!kept.contains(PASSWORD) && kept.contains("maria was removed from the logins"), "{kept}");
}

#[test]
fn a_file_of_logins_that_cannot_be_read_lets_nobody_in_and_says_so() {
    let (line, _watcher, _) = at_work();
    fs::write(line.path("logins.toml"), "no logins").unwrap();
    line.wait_for_log("board", "AND-627", "make the logins again");
}
