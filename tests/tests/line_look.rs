//! `andond look --page` in a real browser.
#![allow(clippy::unwrap_used, clippy::panic)]

use andon_tests::browser::Browser;
use andon_tests::line::{Killed, Line, PATIENCE, andond, free_port, root};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

#[test]
fn what_the_camera_sees_before_there_is_a_line_is_a_page_of_the_board_too() {
    let line = Line::with_film("speed = \"file\"", "", &["-i", "p1_none_r1.mp4"]);
    let film = root().join("tests/footage/p1_none_r1.mp4");
    let port = free_port();
    let mut look = Command::new(andond());
    look.arg("look").arg(film).arg("-c").arg(line.config()).arg("--page").arg(port.to_string());
    let look = Killed(look.stdout(Stdio::null()).spawn().unwrap());
    let until = Instant::now() + PATIENCE;
    while std::net::TcpStream::connect(("127.0.0.1", port)).is_err() {
        assert!(Instant::now() < until, "nothing listens");
        std::thread::sleep(Duration::from_millis(50));
    }
    let mut browser = Browser::start();
    let tab = browser.open(&format!("http://localhost:{port}/?lang=de"), [1920, 1080]);
    browser.until(&tab, "document.getElementById('picture').naturalWidth > 0");
    browser.until(&tab, "document.querySelectorAll('#findings .ok').length > 3");
    browser.until(&tab, "document.getElementById('findings').innerText.includes('polisher')");
    assert_eq!(browser.faults(&tab, ""), Vec::<String>::new());
    drop(look);
    browser.until(&tab, "!document.getElementById('lost').hidden");
}
