//! A person who has never seen a shell: from a station without a job to one that judges, on the board alone, in a real browser.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::browser::{Browser, Tab};
use andon_tests::line::{Line, Settings, Watcher, free_port, save_runs};
use serde_json::json;
use std::fs;
use std::time::Duration;

const FULL_HD: [u32; 2] = [1920, 1080];
const WHOLE: [u32; 2] = [1920, 2400];
const TABLET: [u32; 2] = [800, 1280];
const PASSWORD: &str = "correct horse";

/// A station without a job that plays a worker, with a board on this machine, recordings, and a login for each rank.
fn station() -> (Line, Watcher, String) {
    let mut line = Line::new(Settings::live());
    let port = free_port();
    line.reconfigure("job = \"job.toml\"\n", "jobs = \"jobs\"\n");
    let tables = format!(
        "[board]\nenable = true\nport = {port}\nlogins = \"logins.toml\"\n\n[executor]\nenable = true\npath = \"made\"\n\n[plc]\n"
    );
    line.reconfigure("[plc]\n", &tables);
    fs::create_dir_all(line.path("made/films")).unwrap();
    save_runs(&line.path("made/films"));
    for (name, role) in [("eva", "engineer"), ("tom", "technician")] {
        let output = line.command_told("board", &["login", name, "--role", role], PASSWORD);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let watcher = line.launch();
    line.start("executor");
    line.start("board");
    line.wait_for_log("board", "AND-620", "");
    (line, watcher, format!("http://localhost:{port}"))
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
    for (size, of) in [(TABLET, "-tablet"), (WHOLE, "")] {
        browser.resize(tab, size);
        let wide = "document.documentElement.scrollWidth <= innerWidth";
        assert_eq!(browser.value(tab, wide), json!(true), "{name}{of}");
        assert_eq!(browser.faults(tab, ""), [""; 0], "{name}{of}");
        browser.keep(tab, &format!("{name}{of}"));
    }
    browser.resize(tab, FULL_HD);
}

#[test]
fn an_engineer_without_a_shell_teaches_a_job_names_its_steps_loads_it_and_it_judges() {
    let (line, mut watcher, board) = station();
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
    browser.resize(&tab, WHOLE);
    browser.keep(&tab, "engineer-report");

    browser.go(&tab, &format!("{board}/engineer"));
    press(&mut browser, &tab, "#jobs button[name=load]");
    ends(&mut browser, &tab, "good");
    browser.until(&tab, "document.querySelector('#jobs').innerText.includes('in force')");
    watcher.until("a right piece", |watcher| {
        watcher.verdicts.iter().any(|verdict| (verdict.level, verdict.outcome) == (3, 1))
    });
    browser.go(&tab, &format!("{board}/"));
    browser.until(&tab, "document.body.innerText.includes('Polish the brick')");

    let output = line.command("history", &["--audit", "--csv"]);
    let kept = String::from_utf8(output.stdout).unwrap();
    for what in ["teach-films polish", "name polish", "load polish: done"] {
        assert!(kept.lines().any(|row| row.contains("login eva") && row.contains(what)), "{what}: {kept}");
    }
}

#[test]
fn a_job_is_shown_at_the_bench_by_buttons_and_an_order_without_the_role_that_does_it_is_said_to_be_none() {
    let (mut line, _watcher, board) = station();
    let mut browser = Browser::start();
    let tab = browser.open(&format!("{board}/engineer?lang=de"), FULL_HD);
    browser.log_in(&tab, "eva", PASSWORD);
    browser.until(&tab, "document.getElementById('count') !== null");
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
    browser.keep(&tab, "engineer-unheard");
}
