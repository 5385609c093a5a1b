//! Hostile requests, and browsers that watch beside them.

#![allow(clippy::unwrap_used, clippy::panic)]

mod beside;

use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{Ipv4Addr, TcpStream};
use std::sync::{LazyLock, Mutex};
use std::time::{Duration, Instant};

use andon_board::{Board, Code, Film, Job, Line, Picture, Settings, Step, Thing, Visibility, Wanted, What};
use andon_http::{Response, Server};
use beside::{PATIENCE, beside, connect, sent, until};
use shm_schemas::{
    JudgePhase, Judging, PartId, RoleId, Verdict, VerdictLevel, VerdictOutcome, VerdictReason,
};

/// The clock of the boards and of what they are told.
fn now_ns() -> u64 {
    static BEGAN: LazyLock<Instant> = LazyLock::new(Instant::now);
    u64::try_from(BEGAN.elapsed().as_nanos()).unwrap()
}

/// What an engineer may have typed, or somebody who means harm.
const MARKUP: &str = "\"><script>alert(1)</script><img src=x onerror=alert(1)>";

/// A place of each kind.
const PATHS: [&str; 7] = [
    "/",
    "/technician",
    "/technician/event",
    "/technician/explain",
    "/technician/film/frame.svg",
    "/events",
    "/board.js",
];

fn settings(port: u16) -> Settings {
    Settings {
        roles: vec![RoleId::Judge],
        codes: vec![Code {
            number: 307,
            name: "AND-307",
            group: "Judging",
            meaning: "not judged",
            ..Code::default()
        }],
        code_of: |_| Some(307),
        local_time: |_| MARKUP.to_owned(),
        ..Settings::new(MARKUP, Ipv4Addr::LOCALHOST.into(), port)
    }
}

/// A job, a part and a fault whose names are markup.
fn fill(board: &mut Board) {
    let step = |_| Step { name: MARKUP.to_owned(), contexts: vec![[1, 5, 0, 0]], picture: Some(vec![7; 3]) };
    let parts = [(5, MARKUP.to_owned()), (6, MARKUP.to_owned())].into();
    board.job(Job { hash: 7, name: MARKUP.to_owned(), parts, steps: (0..2).map(step).collect() });
    board.line(Line::Ready, None);
    let part = PartId::new(b"\"><script>").unwrap();
    board.judging(&Judging { phase: JudgePhase::Running.code(), is_enabled: 1, part, ..Judging::default() });
    board.verdict(&fault(part));
}

fn fault(part: PartId) -> Verdict {
    Verdict {
        level: VerdictLevel::Iu.code(),
        outcome: VerdictOutcome::Anomaly.code(),
        reason: VerdictReason::WrongObject.code(),
        model_hash: 7,
        nearest: 0,
        iu: 0,
        x_c: [1, 6, 0, 0],
        part,
        ..Verdict::NONE
    }
}

/// Runs a test beside the loop of a board.
fn served(test: impl FnOnce(u16, &Mutex<Board>)) {
    let server = Server::bind((Ipv4Addr::LOCALHOST, 0).into()).unwrap();
    let port = server.address().port();
    let board = Mutex::new(Board::new(settings(port)));
    fill(&mut board.lock().unwrap());
    let turn = || {
        let mut board = board.lock().unwrap();
        board.publish(now_ns());
        server.serve(|request| board.answer(request));
    };
    beside(turn, || test(port, &board));
}

fn get(port: u16, target: &str) -> String {
    sent(port, format!("GET {target} HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n").as_bytes())
}

/// A browser that watches a page.
fn watch(port: u16, query: &str) -> BufReader<TcpStream> {
    let mut stream = connect(port);
    let request = format!("GET /events?{query} HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n");
    stream.write_all(request.as_bytes()).unwrap();
    BufReader::new(stream)
}

#[test]
fn a_browser_that_calls_the_board_by_another_name_reads_nothing() {
    served(|port, _| {
        for host in
            ["evil.example", &format!("evil.example:{port}"), "127.0.0.1", "", &format!("0.0.0.0:{port}")]
        {
            for path in PATHS {
                let answer = sent(port, format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n").as_bytes());
                assert!(
                    answer.starts_with("HTTP/1.1 421 ") && !answer.contains("<html"),
                    "{host} {path}: {answer}"
                );
            }
        }
        assert!(sent(port, b"GET / HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 421 "));
        let twice = format!("GET / HTTP/1.1\r\nHost: localhost:{port}\r\nHost: evil.example\r\n\r\n");
        assert!(sent(port, twice.as_bytes()).starts_with("HTTP/1.1 421 "));
        let absolute =
            format!("GET http://evil.example/ HTTP/1.1\r\nHost: evil.example\r\nX: localhost:{port}\r\n\r\n");
        assert!(sent(port, absolute.as_bytes()).starts_with("HTTP/1.1 421 "));
    });
}

#[test]
fn a_page_of_another_site_loads_nothing_and_a_link_of_it_leads_here() {
    served(|port, _| {
        let asked = |path: &str, fetch: &str| {
            sent(port, format!("GET {path} HTTP/1.1\r\nHost: localhost:{port}\r\n{fetch}\r\n").as_bytes())
        };
        for path in PATHS {
            for fetch in [
                "Sec-Fetch-Site: cross-site\r\n",
                "Sec-Fetch-Site: same-site\r\nSec-Fetch-Mode: no-cors\r\nSec-Fetch-Dest: script\r\n",
                "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: iframe\r\n",
            ] {
                let answer = asked(path, fetch);
                assert!(answer.starts_with("HTTP/1.1 403 ") && !answer.contains("<html"), "{path}: {answer}");
            }
        }
        for fetch in [
            "",
            "Sec-Fetch-Site: none\r\n",
            "Sec-Fetch-Site: same-origin\r\nSec-Fetch-Mode: cors\r\n",
            "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: document\r\n",
        ] {
            assert!(asked("/technician", fetch).starts_with("HTTP/1.1 200 "), "{fetch}");
        }
    });
}

#[test]
fn no_path_leads_to_a_file() {
    served(|port, _| {
        for path in [
            "/../../etc/passwd",
            "/..%2f..%2fetc/passwd",
            "/%2e%2e/%2e%2e/etc/passwd",
            "/....//etc/passwd",
            "/board.css/../../../etc/passwd",
            "/board.css%00.txt",
            "//etc/passwd",
            "/etc/passwd",
            "/\\..\\etc\\passwd",
            "/technician/",
            "/favicon.ico",
            "/.git/config",
            "/step/0000000000000007-3.jpg",
            "/step/../../etc/passwd",
            "/technician/film/",
            "/technician/film/../../etc/passwd?at=0-0",
            "/technician/film/%2e%2e%2fetc%2fpasswd?at=0-0",
            "/technician/film/frame.svg?at=0-0&frame=-1",
            "/technician/film/frame.svg?at=0-0&frame=99999999999999999999999",
            "/technician/film/frame.svg?at=7-7",
            "/technician/film/one.mcap",
        ] {
            let answer = get(port, path);
            assert!(
                answer.starts_with("HTTP/1.1 404 ") || answer.starts_with("HTTP/1.1 400 "),
                "{path}: {answer}"
            );
            assert!(!answer.contains("root:"), "{path}");
        }
    });
}

#[test]
fn nothing_but_get_and_head_is_served() {
    served(|port, _| {
        for method in ["POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT", "PROPFIND"] {
            let request =
                format!("{method} / HTTP/1.1\r\nHost: localhost:{port}\r\nContent-Length: 0\r\n\r\n");
            assert!(sent(port, request.as_bytes()).starts_with("HTTP/1.1 405 "), "{method}");
        }
        let head = sent(port, format!("HEAD / HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n").as_bytes());
        assert!(head.starts_with("HTTP/1.1 200 ") && head.ends_with("\r\n\r\n"), "{head}");
    });
}

#[test]
fn large_headers_and_bodies_are_refused_unread() {
    served(|port, _| {
        let header =
            format!("GET / HTTP/1.1\r\nHost: localhost:{port}\r\nX: {}\r\n\r\n", "x".repeat(1 << 20));
        assert!(!sent(port, header.as_bytes()).contains(" 200 "));
        let many = "X: y\r\n".repeat(1000);
        assert!(
            !sent(port, format!("GET / HTTP/1.1\r\nHost: localhost:{port}\r\n{many}\r\n").as_bytes())
                .contains(" 200 ")
        );
        assert!(!get(port, &format!("/?lang={}", "x".repeat(1 << 20))).contains(" 200 "));
        let mut stream = connect(port);
        let request =
            format!("POST / HTTP/1.1\r\nHost: localhost:{port}\r\nContent-Length: 100000000000\r\n\r\n");
        stream.write_all(request.as_bytes()).unwrap();
        let chunk = vec![7; 1 << 16];
        let taken = (0..16_384).take_while(|_| stream.write_all(&chunk).is_ok()).count();
        assert!(taken < 16_384, "a gigabyte was taken");
        assert!(get(port, "/").starts_with("HTTP/1.1 200 "));
    });
}

#[test]
fn names_that_are_markup_and_queries_that_are_markup_are_text_on_every_page() {
    served(|port, _| {
        let queries = [
            "",
            "?lang=de",
            "?fault=fault.WrongObject",
            "?fault=%22%3E%3Cscript%3E",
            "?at=\"><script>",
            "?lang=<script>",
            "?code=307",
            "?code=\"><script>",
            "?at=9-9",
        ];
        for path in ["/", "/technician", "/technician/event", "/technician/explain"] {
            for query in queries {
                let answer = get(port, &format!("{path}{query}"));
                let (head, page) = answer.split_once("\r\n\r\n").unwrap();
                // Hyper refuses some of these by itself.
                assert!(head.starts_with("HTTP/1.1 200 ") || head.starts_with("HTTP/1.1 400 "), "{answer}");
                let scripts = page.matches("<script").count();
                // An event has a film as well.
                let most = if path == "/technician/event" { 2 } else { 1 };
                assert!(scripts <= most && !page.contains("<img src=x"), "{path}{query}: {page}");
            }
        }
        let page = get(port, "/technician");
        assert!(page.contains("&quot;&gt;&lt;script&gt;"), "{page}");
        let mut browser = watch(port, "view=worker");
        let mut line = String::new();
        while !line.starts_with("data: <main") {
            line.clear();
            browser.read_line(&mut line).unwrap();
        }
        assert!(!line.contains("<script") && line.contains("&lt;script&gt;"), "{line}");
    });
}

#[test]
fn names_that_are_markup_are_text_in_the_picture_and_whoever_waits_in_vain_is_let_go() {
    served(|port, board| {
        std::thread::scope(|scope| {
            let asked = scope.spawn(|| get(port, "/picture.svg?lang=%3Cscript%3E"));
            let deadline = Instant::now() + PATIENCE;
            while !board.lock().unwrap().wants_picture() {
                assert!(Instant::now() < deadline, "nobody asks");
                std::thread::sleep(Duration::from_millis(5));
            }
            let lines = vec![[[1.0, 2.0], [3.0, f32::NAN]]];
            let thing = Thing { what: What::Part(5), visibility: Visibility::Seen, lines };
            let unseen = Thing { what: What::Part(6), visibility: Visibility::Unseen, lines: Vec::new() };
            let picture = Picture { jpeg: vec![7], size: [64, 48], things: vec![thing, unseen] };
            board.lock().unwrap().picture(&picture);
            let answer = asked.join().unwrap();
            assert!(answer.contains("content-type: image/svg+xml") && answer.contains("</svg>"), "{answer}");
            assert!(!answer.contains("<script") && !answer.contains("<img"), "{answer}");
            assert_eq!(answer.matches("&quot;&gt;&lt;script&gt;").count(), 2, "{answer}");
        });
        let answer = get(port, "/picture.svg");
        assert!(answer.starts_with("HTTP/1.1 200 ") && !answer.contains("<svg"), "{answer}");
    });
}

#[test]
fn an_event_is_a_page_whatever_its_names_are_and_a_recording_is_asked_for_by_a_name_that_is_text() {
    served(|port, board| {
        let asks = |paths: &[&str], answer: &dyn Fn(&Board, andon_board::Ask)| -> Vec<String> {
            std::thread::scope(|scope| {
                let asked: Vec<_> = paths.iter().map(|path| scope.spawn(move || get(port, path))).collect();
                let (mut count, deadline) = (0, Instant::now() + PATIENCE);
                while count < paths.len() {
                    assert!(Instant::now() < deadline, "{count} have asked");
                    let mut board = board.lock().unwrap();
                    for ask in board.asks() {
                        count += 1;
                        answer(&board, ask);
                    }
                    drop(board);
                    std::thread::sleep(Duration::from_millis(5));
                }
                asked.into_iter().map(|asked| asked.join().unwrap()).collect()
            })
        };
        let film = Film { clip: MARKUP.to_owned(), times_ms: vec![-5, 0, 5] };
        let pages = asks(
            &["/technician/event?at=0-0", "/technician/event?at=0-0&frame=%22&lang=%3C"],
            &|board, ask| {
                assert_eq!(ask.wanted, Wanted::Film);
                board.film(ask, &Ok(film.clone()));
            },
        );
        for page in pages {
            assert!(page.starts_with("HTTP/1.1 200 ") && page.contains("default-src 'none'"), "{page}");
            assert_eq!(page.matches("<script").count(), 2, "{page}");
            assert!(page.contains("film/&quot;&gt;&lt;script&gt;") && !page.contains("<img src=x"), "{page}");
        }
        let [recording] = &asks(&["/technician/film/..passwd?at=0-0"], &|_, ask| {
            assert_eq!(ask.wanted, Wanted::Recording("..passwd".to_owned()));
            ask.answer(Response::text(404, "there is none\n"));
        })[..] else {
            panic!("one was asked for")
        };
        assert!(recording.starts_with("HTTP/1.1 404 ") && recording.contains("nosniff"), "{recording}");
        // Nobody answers, and the browser is told so.
        let [left] = &asks(&["/technician/film/frame.svg?at=0-0&frame=1"], &|_, ask| drop(ask))[..] else {
            panic!("one was asked for")
        };
        assert!(left.starts_with("HTTP/1.1 503 "), "{left}");
    });
}

#[test]
fn more_who_wait_for_clips_than_can_be_served_are_told_so() {
    served(|port, _| {
        let mut waiting: Vec<TcpStream> = (0..40).map(|_| connect(port)).collect();
        for client in &mut waiting {
            let request = format!(
                "GET /technician/film/frame.svg?at=0-0&frame=1 HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n"
            );
            client.write_all(request.as_bytes()).unwrap();
        }
        let refused = waiting.into_iter().filter(|client| {
            let mut first = String::new();
            BufReader::new(client).read_line(&mut first).unwrap();
            assert!(first.starts_with("HTTP/1.1 503 "), "{first}");
            first.contains("503")
        });
        assert_eq!(refused.count(), 40, "nobody answers, or there are too many");
        assert!(get(port, "/").starts_with("HTTP/1.1 200 "));
    });
}

#[test]
fn every_answer_forbids_whatever_the_pages_do_not_need() {
    served(|port, _| {
        for path in [
            "/",
            "/technician?lang=fr",
            "/technician/explain",
            "/board.css",
            "/board.js",
            "/player.js",
            "/upload.js",
            "/sound.js",
            "/nothing",
        ] {
            let answer = get(port, path);
            for header in [
                "content-security-policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; ",
                "frame-ancestors 'none'",
                "x-content-type-options: nosniff\r\n",
                "referrer-policy: same-origin\r\n",
                "cross-origin-resource-policy: same-origin\r\n",
                "cache-control: no-store\r\n",
            ] {
                assert!(answer.contains(header), "{path}: {header} is not in {answer}");
            }
            assert!(!answer.contains("unsafe") && !answer.contains("access-control-allow"), "{answer}");
            // No exception is needed: nothing is inline, and nothing comes from elsewhere.
            let page = answer.split_once("\r\n\r\n").unwrap().1;
            let is_page = page.contains("<html");
            assert!(
                !is_page
                    || ![" style=", "<style", " onclick", "http://", "https://"]
                        .iter()
                        .any(|of| page.contains(of)),
                "{page}"
            );
        }
    });
}

#[test]
fn a_page_that_is_watched_shows_a_verdict_beside_a_thousand_connections_and_slow_clients() {
    served(|port, board| {
        let mut browser = watch(port, "view=worker&lang=de");
        until(&mut browser, "FEHLER");
        let mut slow: Vec<TcpStream> = (0..50).map(|_| connect(port)).collect();
        for client in &mut slow {
            let _ = client.write_all(b"GET / HT");
        }
        // They watch, and read nothing.
        let deaf: Vec<_> =
            (0..10).map(|name| watch(port, &format!("view=technician&browser={name}"))).collect();
        let silent: Vec<TcpStream> = (0..1000).map(|_| connect(port)).collect();
        let mut right = Verdict {
            outcome: VerdictOutcome::Ok.code(),
            reason: VerdictReason::None.code(),
            level: VerdictLevel::Job.code(),
            ..fault(PartId::NONE)
        };
        // A right piece is shown for ten seconds from its verdict on.
        right.stamp.sent_ns = now_ns();
        board.lock().unwrap().verdict(&right);
        until(&mut browser, "GUT");
        assert!(get(port, "/").starts_with("HTTP/1.1 200 "));
        drop((slow, deaf, silent));
    });
}

#[test]
fn more_browsers_than_can_be_served_are_told_so_and_the_first_go_on() {
    served(|port, _| {
        let mut browsers: Vec<_> =
            (0..32).map(|name| watch(port, &format!("view=worker&browser={name}"))).collect();
        for browser in &mut browsers {
            until(browser, "event: show");
        }
        let mut late = String::new();
        watch(port, "view=worker").read_line(&mut late).unwrap();
        assert!(late.starts_with("HTTP/1.1 503 "), "{late}");
        until(&mut browsers[0], "event: alive");
        browsers.truncate(31);
        let until_there_is_room = Instant::now() + PATIENCE;
        loop {
            let mut answer = String::new();
            watch(port, "view=worker").read_line(&mut answer).unwrap();
            if answer.starts_with("HTTP/1.1 200 ") {
                break;
            }
            assert!(Instant::now() < until_there_is_room, "a browser that has left keeps its place");
            std::thread::sleep(Duration::from_millis(50));
        }
    });
}

#[test]
fn a_page_whose_place_another_one_of_its_browser_takes_is_told_so() {
    served(|port, _| {
        let mut pages: Vec<_> = (0..6).map(|_| watch(port, "view=worker&browser=one")).collect();
        until(&mut pages[0], "event: elsewhere");
        for page in &mut pages[1..] {
            until(page, "event: show");
        }
    });
}
