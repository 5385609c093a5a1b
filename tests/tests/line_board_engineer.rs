//! A person who has never seen a shell: from a station without a job to one that judges, on the board alone, in a real browser.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_ipc::{Node, Reader};
use andon_learn::job_file::JobFile;
use andon_perception::Dictionary;
use andon_tests::browser::{Browser, Tab};
use andon_tests::line::{Line, NOISE, PATIENCE, Settings, Watcher, root, save_runs, stand_in};
use andon_tests::simulator::Flaw;
use rustix::process::Signal;
use serde_json::json;
use shm_schemas::{Detections, RoleId, Verdict};
use std::fs;
use std::time::{Duration, Instant};

const FULL_HD: [u32; 2] = [1920, 1080];
const WHOLE: [u32; 2] = [1920, 2400];
const TABLET: [u32; 2] = [800, 1280];
/// Full HD at 200 %.
const TWICE: [u32; 2] = [960, 540];
const PASSWORD: &str = "correct horse";

/// The markers of the bench, from the left near the worker and round, each with its place in metres.
const CORNERS: [(u16, [f64; 2]); 4] =
    [(46, [-0.25, -0.15]), (47, [0.25, -0.15]), (48, [0.25, 0.15]), (49, [-0.25, 0.15])];

/// Starts a station without a job, which these roles belong to besides. It has a board on this machine, recordings, and a login for each rank.
fn start(mut line: Line, besides: &[&'static str]) -> (Line, Watcher, String) {
    let text = fs::read_to_string(line.config()).unwrap();
    line.reconfigure(text.lines().find(|row| row.starts_with("job = ")).unwrap(), "jobs = \"jobs\"");
    let port =
        line.board("enable = true\nlogins = \"logins.toml\"\n\n[executor]\nenable = true\npath = \"made\"\n");
    fs::create_dir_all(line.path("made/films")).unwrap();
    save_runs(&line.path("made/films"));
    for (name, role) in [("eva", "engineer"), ("tom", "technician")] {
        let output = line.command_told("board", &["login", name, "--role", role], PASSWORD);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let watcher = if text.contains("[record]") { line.launch_recorded() } else { line.launch() };
    for role in besides.iter().chain(&["executor", "board"]) {
        line.start(role);
    }
    line.wait_for_log("board", "AND-620", "");
    // It makes the folders.
    line.wait_for_log("executor", "AND-629", "");
    (line, watcher, format!("http://localhost:{port}"))
}

/// Who stands at the bench and sees whether somebody works.
struct Bench {
    node: Node,
    seen: Reader<Detections>,
}

impl Bench {
    fn new(line: &Line) -> Self {
        let node = stand_in(line, RoleId::Tool);
        let seen = node.reader().unwrap();
        Self { node, seen }
    }

    fn until_somebody_works(&mut self) {
        while self.next_hands() == 0 {}
    }

    /// A hand may be hidden for a moment.
    fn until_nobody_works(&mut self) {
        let mut without_hands = 0;
        while without_hands < 30 {
            without_hands = if self.next_hands() == 0 { without_hands + 1 } else { 0 };
        }
    }

    /// How many hands the next picture has.
    fn next_hands(&mut self) -> u32 {
        let until = Instant::now() + PATIENCE;
        loop {
            if let Some(seen) = self.seen.take().unwrap() {
                return seen.hands_len;
            }
            assert!(Instant::now() < until, "nothing is seen");
            self.node.wait(&mut [&mut self.seen], Duration::from_millis(50)).unwrap();
        }
    }
}

/// Logs in as an engineer.
fn enter(browser: &mut Browser, address: &str) -> Tab {
    let tab = browser.open(address, FULL_HD);
    browser.log_in(&tab, "eva", PASSWORD);
    browser.until(&tab, "document.getElementById('count') !== null");
    tab
}

/// Waits for a right piece.
fn judges(watcher: &mut Watcher) {
    watcher.until("a right piece", |watcher| {
        watcher.verdicts.iter().any(|verdict| (verdict.level, verdict.outcome) == (3, 1))
    });
}

/// A grey picture of 640 by 480 pixels, as PGM: a camera looks straight down on the markers of the bench.
fn bench() -> Vec<u8> {
    const PX_PER_M: f64 = 1050.0;
    const MODULE_PX: usize = 7;
    let mut pixels = vec![170_u8; 640 * 480];
    for (id, [x, y]) in CORNERS {
        let pattern = Dictionary::default().pattern(id).unwrap();
        let quiet = pattern.modules + 2;
        let half = (quiet * MODULE_PX) as f64 / 2.0;
        let [left, top] =
            [320.0 + PX_PER_M * x - half, 240.0 - PX_PER_M * y - half].map(|edge| edge as usize);
        for (row, column) in
            (0..quiet * MODULE_PX).flat_map(|row| (0..quiet * MODULE_PX).map(move |at| (row, at)))
        {
            let [down, right] =
                [row, column].map(|at| (at / MODULE_PX).checked_sub(1).filter(|at| *at < pattern.modules));
            let is_black =
                down.zip(right).is_some_and(|(down, right)| pattern.black[down * pattern.modules + right]);
            pixels[(top + row) * 640 + left + column] = if is_black { 30 } else { 220 };
        }
    }
    [&b"P5\n640 480\n255\n"[..], &pixels].concat()
}

/// Presses a button once it is there. A page that is drawn anew has another one of its name.
fn press(browser: &mut Browser, tab: &Tab, button: &str) {
    browser.until(tab, &format!("document.querySelector('{button}') !== null"));
    let click = format!("window.isOld = true; document.querySelector('{button}').click(); true");
    browser.value(tab, &click);
    browser.until(tab, "!window.isOld && document.readyState === 'complete'");
}

/// Waits until the task says how it has ended.
fn ends(browser: &mut Browser, tab: &Tab, class: &str) {
    browser.until(tab, &format!("document.querySelector('#task h2.{class}') !== null"));
}

/// Lets the worker show a run, until there is something to be learned from it.
fn complete(browser: &mut Browser, tab: &Tab) {
    let is_asked = "document.querySelector('button[value=\"keep/k\"]') !== null";
    while browser.value(tab, is_asked) != json!(true) {
        std::thread::sleep(Duration::from_secs(5));
        press(browser, tab, "button[value=\"run/\"]");
        browser
            .until(tab, &format!("{is_asked} || document.querySelector('button[value=\"run/\"]') !== null"));
    }
}

/// Looks at the page as people see it, and at what is wrong with it.
fn look(browser: &mut Browser, tab: &Tab, name: &str) {
    let open = "document.querySelectorAll('details').forEach(details => details.open = true)";
    for (size, of) in [(TABLET, "-tablet"), (TWICE, "-twice"), (WHOLE, "")] {
        browser.resize(tab, size);
        assert_eq!(browser.faults(tab, open), [""; 0], "{name}{of}");
        browser.keep(tab, &format!("{name}{of}"));
    }
    browser.resize(tab, FULL_HD);
}

#[test]
fn an_engineer_without_a_shell_teaches_a_job_names_its_steps_loads_it_and_it_judges() {
    let line = Line::new(Settings::live());
    line.record("always");
    let (mut line, mut watcher, board) = start(line, &[]);
    let mut browser = Browser::start();
    let tab = browser.open(&format!("{board}/engineer"), FULL_HD);
    // Also on the machine itself nobody reads it without a login, and a technician does not.
    browser.until(&tab, "location.pathname === '/login'");
    browser.log_in(&tab, "tom", PASSWORD);
    browser.until(&tab, "location.pathname === '/'");
    browser.go(&tab, &format!("{board}/engineer"));
    browser.until(&tab, "document.body.innerText.includes('Log in with another one')");
    browser.log_in(&tab, "eva", PASSWORD);
    browser.until(&tab, "location.pathname === '/engineer'");
    browser.until(&tab, "document.body.innerText.includes('There is no job yet')");
    for (page, name, says) in [("technician", "technician", "AND-311"), ("", "worker", "No job is loaded")] {
        browser.go(&tab, &format!("{board}/{page}"));
        browser.until(
            &tab,
            &format!("['NO JOB', '{says}'].every(text => document.body.innerText.includes(text))"),
        );
        look(&mut browser, &tab, &format!("no-job-{name}"));
    }
    browser.go(&tab, &format!("{board}/technician"));
    press(&mut browser, &tab, "#line a[href=\"/engineer\"]");
    browser.until(&tab, "document.body.innerText.includes('There is no job yet')");
    // They were looked for since the page was asked for.
    browser.until(&tab, "document.querySelectorAll('[name=film]').length === 6");
    look(&mut browser, &tab, "engineer-empty");

    let choose = "document.getElementById('job').value = 'polish';
        for (const film of document.querySelectorAll('[name=film]')) film.checked = true;
        true";
    browser.value(&tab, choose);
    press(&mut browser, &tab, "button[value=films]");
    ends(&mut browser, &tab, "good");
    browser.until(&tab, "document.querySelector('#jobs tbody tr button[name=load]') !== null");
    look(&mut browser, &tab, "engineer-taught");

    browser.go(&tab, &format!("{board}/engineer/job?at=polish"));
    browser.until(&tab, "document.getElementById('s2') !== null");
    browser.value(
        &tab,
        "document.getElementById('s1').value = 'Polish the brick'; document.getElementById('s2').value = 'Measure <it>'; true",
    );
    press(&mut browser, &tab, "#names button");
    ends(&mut browser, &tab, "good");
    browser.until(&tab, "document.getElementById('s2')?.value === 'Measure <it>'");
    look(&mut browser, &tab, "engineer-job");
    browser.go(&tab, &format!("{board}/engineer/made/report.html?at=polish"));
    browser.until(&tab, "document.body.innerText.includes('What would be noticed')");
    // The policy lets no style of a page through: this one comes from the board.
    assert_eq!(browser.value(&tab, "getComputedStyle(document.body).maxWidth"), json!("980px"));
    let filled = "getComputedStyle(document.querySelector('svg rect')).fill !== 'rgb(0, 0, 0)'";
    assert_eq!(browser.value(&tab, filled), json!(true), "nor has the picture of the steps one");
    look(&mut browser, &tab, "engineer-report");

    browser.go(&tab, &format!("{board}/engineer"));
    press(&mut browser, &tab, "#jobs button[name=load]");
    ends(&mut browser, &tab, "good");
    browser.until(&tab, "document.querySelector('#jobs').innerText.includes('in force')");
    browser.until(
        &tab,
        "[...document.querySelectorAll('#audit tbody tr')]
            .some(row => ['login eva', 'Order', 'load polish', 'done'].every(text => row.innerText.includes(text)))",
    );
    look(&mut browser, &tab, "engineer-audit");
    judges(&mut watcher);
    browser.go(&tab, &format!("{board}/"));
    browser.until(&tab, "document.body.innerText.includes('Polish the brick')");

    // What was recorded until now is judged again.
    line.role("record").signal(Signal::TERM);
    assert!(line.role("record").wait().success(), "{}", line.log("record"));
    browser.go(&tab, &format!("{board}/engineer/job?at=polish"));
    press(&mut browser, &tab, "button[name=whatif]");
    ends(&mut browser, &tab, "good");
    browser.until(&tab, "/pieces right +[1-9]/.test(document.querySelector('#task').innerText)");
    look(&mut browser, &tab, "engineer-whatif");

    let output = line.command("history", &["--audit", "--csv"]);
    let kept = String::from_utf8(output.stdout).unwrap();
    for what in ["teach-films polish", "name polish", "load polish: done"] {
        assert!(kept.lines().any(|row| row.contains("login eva") && row.contains(what)), "{what}: {kept}");
    }
}

#[test]
fn a_job_is_taught_from_films_with_the_keyboard_alone_and_judges_what_the_camera_sees() {
    const FILMS: [&str; 5] =
        ["p1_none_r1.mp4", "p1_none_r2.mp4", "p1_none_r3.mp4", "p2_none_r1.mp4", "p2_none_r2.mp4"];
    let line = Line::with_film("speed = \"file\"", "", &["-i", "p1_J1_r1.mp4"]);
    let (line, mut watcher, board) = start(line, &["capture"]);
    let footage = |film: &str| root().join("tests/footage").join(film);
    for film in &FILMS[1..] {
        fs::copy(footage(film), line.path("made/films").join(film)).unwrap();
    }
    let mut browser = Browser::start();
    let tab = enter(&mut browser, &format!("{board}/engineer"));
    browser.until(&tab, "document.querySelectorAll('[name=film][value$=mp4]').length === 4");
    // One comes from the device of whoever looks at the page.
    browser.choose(&tab, "#recording", &footage(FILMS[0]));
    browser.tab_to(&tab, "document.activeElement.matches('#upload button')");
    browser.press(&tab, "Enter", 13);
    browser.until(&tab, "document.getElementById('sent').innerText.includes('It is there: p1_none_r1.mp4')");
    browser.until(&tab, "document.querySelectorAll('[name=film][value$=mp4]').length === 5");
    look(&mut browser, &tab, "engineer-sent");
    assert_eq!(
        fs::read(line.path("made/films").join(FILMS[0])).unwrap(),
        fs::read(footage(FILMS[0])).unwrap()
    );
    let has_focus = |selector: &str| format!("document.activeElement.matches({})", json!(selector));
    let confirm = |browser: &mut Browser, button: &str| {
        browser.until(&tab, &format!("document.querySelector('{button}') !== null"));
        browser.tab_to(&tab, &has_focus(button));
        browser.value(&tab, "window.isOld = true");
        browser.press(&tab, "Enter", 13);
        browser.until(&tab, "!window.isOld && document.readyState === 'complete'");
        ends(browser, &tab, "good");
    };
    browser.tab_to(&tab, &has_focus("#job"));
    browser.write(&tab, "polish");
    for film in FILMS {
        browser.tab_to(&tab, &has_focus(&format!("[name=film][value='{film}']")));
        browser.press(&tab, " ", 32);
    }
    confirm(&mut browser, "button[value=films]");
    confirm(&mut browser, "#jobs button[name=load]");
    // Half of the strokes.
    watcher.until("a fault", |watcher| {
        watcher.verdicts.iter().any(|verdict| (verdict.level, verdict.outcome) == (3, 2))
    });
}

#[test]
fn a_recording_is_sent_under_a_plain_name_one_at_a_time_and_what_is_stopped_leaves_nothing_behind() {
    let (line, _watcher, board) = start(Line::new(Settings::live()), &[]);
    let folder = tempfile::tempdir().unwrap();
    let [large, small] = ["VID 2026 (1).mp4", "run1.mp4"].map(|name| folder.path().join(name));
    fs::write(&large, vec![7; 30 << 20]).unwrap();
    fs::write(&small, vec![7; 100_000]).unwrap();
    let mut browser = Browser::start();
    let tab = enter(&mut browser, &format!("{board}/engineer"));
    let mut other = Browser::start();
    let second = enter(&mut other, &format!("{board}/engineer?lang=de"));
    let says = |text: &str| format!("document.getElementById('sent').innerText.includes('{text}')");
    let press = |browser: &mut Browser, tab: &Tab, place: usize| {
        let click = format!("document.querySelectorAll('#upload button')[{place}].click(); true");
        browser.value(tab, &click);
    };
    let left = || {
        let entries = fs::read_dir(line.path("made/films")).unwrap().flatten();
        let names = entries.map(|entry| entry.file_name().into_string().unwrap());
        names.filter(|name| !name.ends_with(".tracks.jsonl")).collect::<Vec<_>>()
    };
    browser.choose(&tab, "#recording", &large);
    press(&mut browser, &tab, 0);
    browser.until(&tab, "/^[1-9]+ %$/.test(document.getElementById('sent').innerText)");
    look(&mut browser, &tab, "engineer-sending");
    other.choose(&second, "#recording", &small);
    press(&mut other, &second, 0);
    other.until(&second, &says("Nicht behalten: eva is just sending VID-2026-1-.mp4"));
    let quoted = "document.querySelector('#sent [lang=en]').innerText.startsWith('eva is')";
    assert_eq!(other.value(&second, quoted), json!(true), "what the line says is English on a German page");
    press(&mut browser, &tab, 1);
    browser.until(&tab, &says("It was broken off"));
    assert_eq!(left(), [""; 0]);
    press(&mut other, &second, 0);
    other.until(&second, &says("Angekommen: run1.mp4"));
    assert_eq!(left(), ["run1.mp4"]);
    // A page that goes takes what it was sending with it.
    press(&mut browser, &tab, 0);
    browser.until(&tab, "/^[1-9]+ %$/.test(document.getElementById('sent').innerText)");
    browser.go(&tab, &format!("{board}/"));
    let until = Instant::now() + 2 * PATIENCE;
    while left() != ["run1.mp4"] {
        assert!(Instant::now() < until, "{:?}", left());
        std::thread::sleep(Duration::from_millis(100));
    }
}

#[test]
fn a_damaged_job_says_what_is_wrong_with_it_and_is_put_back_by_a_button_and_a_form_that_is_too_long_leads_back()
 {
    let (line, mut watcher, board) = start(Line::new(Settings::live()), &[]);
    let taught = fs::read(line.path("job.toml")).unwrap();
    let hash = JobFile::parse("job.toml", &taught).unwrap().model_hash();
    fs::write(line.path("jobs/polish.toml"), "no job").unwrap();
    let mut browser = Browser::start();
    let tab = enter(&mut browser, &format!("{board}/engineer"));
    let teach = "in its place";
    browser.until(&tab, &format!("document.querySelector('#jobs').innerText.includes('{teach}')"));
    press(&mut browser, &tab, "#jobs a[href*=\"at=polish\"]");
    browser.until(&tab, &format!("document.querySelector('#versions').innerText.includes('{teach}')"));
    let offers = |what: &str| format!("document.querySelector('{what}') !== null");
    for nothing in ["button[name=back]", "button[name=whatif]", "#names button", "#again"] {
        assert_eq!(browser.value(&tab, &offers(nothing)), json!(false), "{nothing}");
    }
    look(&mut browser, &tab, "engineer-damaged");
    // A version turns up, as from a backup: the page offers it without being asked for again.
    fs::write(line.path(&format!("made/versions/polish.{hash:016x}.toml")), &taught).unwrap();
    browser.until(&tab, &offers("button[name=back]"));
    let says = "document.querySelector('#versions').innerText.includes('put back an earlier version')";
    assert_eq!(browser.value(&tab, says), json!(true));
    look(&mut browser, &tab, "engineer-damaged-version");
    press(&mut browser, &tab, "button[name=back]");
    ends(&mut browser, &tab, "good");
    browser.until(&tab, &offers("#s1"));
    judges(&mut watcher);

    // More than a task holds, and more than the server reads.
    browser.go(&tab, &format!("{board}/engineer/job?at=polish&lang=de"));
    browser.until(&tab, &offers("#s1"));
    let status = "performance.getEntriesByType('navigation')[0].responseStatus";
    for (bytes, says) in [(5_000, "auf einmal"), (80_000, "the form is too long: go back")] {
        browser.value(&tab, &format!("document.getElementById('s1').value = 'x'.repeat({bytes}); true"));
        press(&mut browser, &tab, "#names button");
        let said = format!("document.body.innerText.includes('{says}')");
        assert_eq!(browser.value(&tab, &said), json!(true), "{bytes}");
        assert_eq!(browser.value(&tab, status), json!(413), "{bytes}");
        browser.keep(&tab, &format!("engineer-too-long-{bytes}"));
        if bytes == 5_000 {
            press(&mut browser, &tab, "main a[href*=\"at=polish\"]");
            browser.until(&tab, &offers("#s1"));
        }
    }
    assert_eq!(fs::read(line.path("jobs/polish.toml")).unwrap(), taught);
}

#[test]
fn what_somebody_calls_right_is_taught_a_run_is_left_out_and_a_station_is_written_each_by_one_click() {
    let line = Line::new(Settings { flaw: Flaw::J1, ..Settings::live() });
    line.record("always");
    let (mut line, mut watcher, board) = start(line, &[]);
    let path = line.path("jobs/polish.toml");
    fs::copy(line.path("job.toml"), &path).unwrap();
    let sources = || -> Vec<String> {
        let job = JobFile::parse("polish.toml", &fs::read(&path).unwrap()).unwrap();
        job.provenance.sources.into_iter().map(|source| source.name).collect()
    };
    let mut browser = Browser::start();
    let tab = enter(&mut browser, &format!("{board}/engineer"));
    press(&mut browser, &tab, "#jobs button[name=load]");
    ends(&mut browser, &tab, "good");

    browser.go(&tab, &format!("{board}/engineer/job?at=polish"));
    press(&mut browser, &tab, "button[name=without][value=\"polish/p1_r1.tracks.jsonl\"]");
    ends(&mut browser, &tab, "good");
    browser.until(&tab, "document.querySelectorAll('#versions button[name=back]').length === 1");

    // The work was right, and the job had not been shown enough.
    let is_accused = |verdict: &&Verdict| (verdict.level, verdict.outcome) == (3, 2);
    watcher.until("two faults", |watcher| watcher.verdicts.iter().filter(is_accused).count() > 1);
    let accused = watcher.verdicts.iter().find(is_accused).unwrap().stamp.id();
    line.role("record").signal(Signal::TERM);
    assert!(line.role("record").wait().success(), "{}", line.log("record"));
    browser.go(&tab, &format!("{board}/technician"));
    press(&mut browser, &tab, &format!("#e{accused} button[name=right]"));
    browser.go(&tab, &format!("{board}/engineer/job?at=polish"));
    browser.until(&tab, "document.querySelector('#again [name=force]') !== null");
    browser.value(&tab, "document.querySelector('#again [name=force]').checked = true; true");
    press(&mut browser, &tab, "#again button");
    ends(&mut browser, &tab, "good");
    let sources = sources();
    assert!(sources.iter().any(|name| name.starts_with("confirmed-")), "{sources:?}");
    browser.until(&tab, "document.querySelectorAll('#versions button[name=back]').length === 2");

    browser.go(&tab, &format!("{board}/engineer"));
    browser.value(
        &tab,
        "document.getElementById('station').closest('details').open = true;
         document.getElementById('station').value = 'bench2'; document.getElementById('p1').value = 'brick=0.033'; true",
    );
    press(&mut browser, &tab, "button[value=new]");
    ends(&mut browser, &tab, "good");
    let written = "a[href$=\"station.toml?at=bench2\"]";
    browser.until(&tab, &format!("document.querySelector('#made {written}') !== null"));
    let says = "fetch('/engineer/made/station.toml?at=bench2').then(answer => answer.text())
        .then(text => text.includes('name = \"bench2\"') && text.includes('name = \"brick\"'))";
    assert_eq!(browser.value(&tab, says), json!(true));
}

#[test]
fn pages_with_a_job_that_judges_fit_a_tablet_in_every_language() {
    let (line, mut watcher, board) = start(Line::new(Settings { flaw: Flaw::J1, ..Settings::live() }), &[]);
    fs::copy(line.path("job.toml"), line.path("jobs/polish.toml")).unwrap();
    let mut browser = Browser::start();
    let tab = enter(&mut browser, &format!("{board}/engineer"));
    press(&mut browser, &tab, "#jobs button[name=load]");
    ends(&mut browser, &tab, "good");
    watcher.until("a piece", |watcher| watcher.verdicts.iter().any(|verdict| verdict.level == 3));
    for lang in ["de", "en", "es", "fr", "zh"] {
        for (page, drawn) in [
            ("", "#view h1"),
            ("technician", "#events tbody tr"),
            ("engineer", "#audit tbody tr"),
            ("engineer/job?at=polish", "#s1"),
        ] {
            let sign = if page.contains('?') { '&' } else { '?' };
            browser.go(&tab, &format!("{board}/{page}{sign}lang={lang}"));
            browser.until(&tab, &format!("document.querySelector('{drawn}') !== null"));
            let name = page.split('?').next().unwrap().replace('/', "-");
            if page == "technician" {
                // Also the newest message of a role is seen without moving the table, however long its words are.
                browser.resize(&tab, TABLET);
                let left = "document.querySelector('#roles th:last-child').getBoundingClientRect().left + 60 < innerWidth";
                assert_eq!(browser.value(&tab, left), json!(true), "{lang}");
            }
            look(&mut browser, &tab, &format!("{lang}-{name}"));
        }
    }
}

#[test]
fn a_job_is_shown_at_the_bench_by_buttons_and_an_order_without_the_role_that_does_it_is_said_to_be_none() {
    let (mut line, _watcher, board) = start(Line::new(Settings::live()), &[]);
    let mut browser = Browser::start();
    let tab = enter(&mut browser, &format!("{board}/engineer?lang=de"));
    browser.value(
        &tab,
        "document.getElementById('job').value = 'shown'; document.getElementById('count').value = '2';
         document.querySelector('[name=force]').checked = true; true",
    );
    press(&mut browser, &tab, "button[value=live]");
    browser.until(&tab, "document.querySelector('button[value=\"run/\"]') !== null");
    look(&mut browser, &tab, "engineer-showing");
    complete(&mut browser, &tab);
    look(&mut browser, &tab, "engineer-keeping");
    press(&mut browser, &tab, "button[value=\"keep/d\"]");
    complete(&mut browser, &tab);
    press(&mut browser, &tab, "button[value=\"keep/k\"]");
    browser.until(&tab, "document.querySelector('#task').innerText.includes('run 2 of 2')");
    press(&mut browser, &tab, "button[value=\"run/q\"]");
    ends(&mut browser, &tab, "fault");
    browser.until(
        &tab,
        "document.querySelector('#task').innerText.includes('The runs that were kept are there')",
    );
    assert!(line.path("jobs/shown-run1.tracks.jsonl").is_file());
    assert!(!line.path("jobs/shown-run2.tracks.jsonl").exists());

    line.role("executor").kill();
    browser.until(&tab, "document.querySelector('#task').innerText.includes('executor')");
    press(&mut browser, &tab, "button[value=markers]");
    browser.until(&tab, "document.body.innerText.includes('antwortet nicht')");
    look(&mut browser, &tab, "engineer-unheard");
}

#[test]
fn a_job_that_is_shown_at_the_bench_by_buttons_is_loaded_and_judges() {
    let line = Line::new(Settings::live());
    line.work_in_turn(&[Flaw::None], 10.0);
    let (line, mut watcher, board) = start(line, &[]);
    let mut bench = Bench::new(&line);
    let mut browser = Browser::start();
    let tab = enter(&mut browser, &format!("{board}/engineer"));
    browser.value(
        &tab,
        "document.getElementById('job').value = 'shown'; document.getElementById('count').value = '1';
         document.querySelector('[name=force]').checked = true; true",
    );
    press(&mut browser, &tab, "button[value=live]");
    bench.until_nobody_works();
    press(&mut browser, &tab, "button[value=\"run/d\"]");
    bench.until_somebody_works();
    bench.until_nobody_works();
    press(&mut browser, &tab, "button[value=\"run/\"]");
    press(&mut browser, &tab, "button[value=\"keep/t\"]");
    ends(&mut browser, &tab, "good");
    press(&mut browser, &tab, "#jobs button[name=load]");
    ends(&mut browser, &tab, "good");
    judges(&mut watcher);
}

#[test]
fn markers_are_drawn_and_the_bench_is_looked_at_and_calibrated_by_buttons() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("bench.pgm");
    fs::write(&picture, bench()).unwrap();
    let film = ["-loop", "1", "-framerate", "30", "-t", "5", "-i", picture.to_str().unwrap(), "-vf", NOISE];
    let (line, _watcher, board) = start(Line::with_film("", "", &film), &["capture"]);
    let mut browser = Browser::start();
    let tab = enter(&mut browser, &format!("{board}/engineer"));

    press(&mut browser, &tab, "button[value=markers]");
    ends(&mut browser, &tab, "good");
    browser.until(&tab, "document.querySelector('#made a[href$=\"markers.pdf\"]') !== null");
    let begins =
        "fetch('/engineer/made/markers.pdf').then(answer => answer.text()).then(text => text.slice(0, 5))";
    assert_eq!(browser.value(&tab, begins), json!("%PDF-"));

    press(&mut browser, &tab, "button[value=look]");
    ends(&mut browser, &tab, "good");
    browser.until(&tab, "document.querySelector('#task').innerText.includes('640 x 480 pixels')");
    browser.until(&tab, "document.querySelector('#made a[href$=\"seen.jpg\"]') !== null");
    look(&mut browser, &tab, "engineer-looked");

    let calibrate = |browser: &mut Browser, first: u16, class: &str, says: &str| {
        let given = |(number, (id, [x, y])): (u16, (u16, [f64; 2]))| {
            let id = if number == 1 { first } else { id };
            format!("document.getElementById('m{number}').value = '{id}={x},{y}';")
        };
        let fill: String = (1..).zip(CORNERS).map(given).collect();
        browser.value(&tab, &format!("document.querySelector('details').open = true; {fill} true"));
        press(browser, &tab, "button[value=calibrate]");
        ends(browser, &tab, class);
        browser.until(&tab, &format!("document.querySelector('#task').innerText.includes('{says}')"));
    };
    calibrate(&mut browser, 45, "fault", "not found in the picture");
    assert!(!line.path("made/calibration.toml").exists());
    calibrate(&mut browser, CORNERS[0].0, "good", "each marker lies within");
    let first = fs::read(line.path("made/calibration.toml")).unwrap();
    calibrate(&mut browser, CORNERS[0].0, "good", "it counts once that is started again");
    let says = "document.querySelector('details').textContent.includes('A calibration counts once the station is started again.')";
    assert_eq!(browser.value(&tab, says), json!(true));
    let mut kept = fs::read_dir(line.path("made/versions")).unwrap().flatten();
    assert!(kept.any(|entry| fs::read(entry.path()).unwrap() == first), "the one before it");
    browser.until(&tab, "document.querySelector('#made a[href$=\"calibrated.jpg\"]') !== null");
    look(&mut browser, &tab, "engineer-calibrated");
    for name in ["seen", "calibrated"] {
        browser.go(&tab, &format!("{board}/engineer/made/{name}.jpg"));
        browser.until(&tab, "document.images[0].naturalWidth === 640");
        browser.keep(&tab, &format!("engineer-{name}-picture"));
    }
}
