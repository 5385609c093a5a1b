//! Clients that are slow, silent or hostile, beside one that is served.

#![allow(clippy::unwrap_used)]

mod support;

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use andon_http::{Request, Response, Server};
use support::{connect, remaining, served_by};

fn ask(server: &Server, request: &str) -> String {
    let mut stream = connect(server);
    stream.write_all(request.as_bytes()).unwrap();
    remaining(stream)
}

fn answer(request: &Request) -> Response {
    match request.path.as_str() {
        "/host" => Response::ok("text/plain", request.host.clone().unwrap_or_default()),
        "/large" => Response::ok("image/jpeg", vec![7; 40_000_000]),
        "/long" => Response::ok("image/jpeg", vec![0; 8_000_000]),
        "/safe" => Response::ok("text/html", "<p>").with(&[("x-content-type-options", "nosniff")]),
        _ => Response::text(404, "nothing is there\n"),
    }
}

/// Runs a test beside the loop that answers.
fn served(test: impl FnOnce(&Server)) {
    served_by(&Server::bind(([127, 0, 0, 1], 0).into()).unwrap(), answer, test);
}

#[test]
fn a_client_that_sends_one_byte_and_stalls_holds_up_nobody() {
    served(|server| {
        // One after the other they would hold up a scrape for two minutes.
        let mut stalled: Vec<TcpStream> = (0..60).map(|_| connect(server)).collect();
        for client in &mut stalled {
            client.write_all(b"G").unwrap();
        }
        for _ in 0..100 {
            assert!(ask(server, "GET /host HTTP/1.1\r\nHost: here\r\n\r\n").ends_with("here"));
        }
        // They are cut off.
        for client in stalled {
            assert!(!remaining(client).contains(" 200 "));
        }
    });
}

#[test]
fn a_client_that_does_not_read_its_answer_holds_up_nobody() {
    served(|server| {
        let mut deaf = connect(server);
        deaf.write_all(b"GET /large HTTP/1.1\r\n\r\n").unwrap();
        for _ in 0..10 {
            assert!(ask(server, "GET /host HTTP/1.1\r\nHost: here\r\n\r\n").ends_with("here"));
        }
    });
}

#[test]
fn clients_that_read_slowly_make_way_for_one_that_reads() {
    served(|server| {
        let mut slow: Vec<TcpStream> = (0..64).map(|_| connect(server)).collect();
        for client in &mut slow {
            client.write_all(b"GET /long HTTP/1.1\r\n\r\n").unwrap();
        }
        for client in &mut slow {
            client.read_exact(&mut [0]).unwrap();
        }
        // Each of them holds a place for the ten seconds of a connection, if nobody else wants it.
        let began = Instant::now();
        assert!(ask(server, "GET /host HTTP/1.1\r\nHost: here\r\n\r\n").ends_with("here"));
        assert!(began.elapsed() < Duration::from_secs(8), "{:?}", began.elapsed());
        drop(slow);
    });
}

#[test]
fn a_client_that_waits_for_its_answer_is_not_slow() {
    let server = Server::bind(([127, 0, 0, 1], 0).into()).unwrap();
    let ask = |client: &mut TcpStream| client.write_all(b"GET /host HTTP/1.1\r\nHost: here\r\n\r\n").unwrap();
    let mut clients: Vec<TcpStream> = (0..64).map(|_| connect(&server)).collect();
    clients.iter_mut().for_each(ask);
    // The loop stands still for longer than a slow client has, and another client comes.
    std::thread::sleep(Duration::from_millis(1300));
    clients.push(connect(&server));
    clients.last_mut().into_iter().for_each(ask);
    std::thread::sleep(Duration::from_millis(200));
    served_by(&server, answer, |_| {
        let answers: Vec<String> = clients.into_iter().map(remaining).collect();
        // On a machine that is busy they may hear that the loop stands still. None is cut off.
        assert!(answers.iter().all(|answer| answer.starts_with("HTTP/1.1 ")), "{answers:?}");
    });
}

#[test]
fn more_clients_than_are_served_at_once_wait_and_are_served() {
    served(|server| {
        let stalled: Vec<TcpStream> = (0..100).map(|_| connect(server)).collect();
        assert!(ask(server, "GET /host HTTP/1.1\r\nHost: here\r\n\r\n").ends_with("here"));
        drop(stalled);
    });
}

#[test]
fn what_is_no_request_or_no_get_is_refused_and_headers_go_out() {
    served(|server| {
        assert!(ask(server, "\u{1}\u{2} nonsense\r\n\r\n").starts_with("HTTP/1.1 400 "));
        assert!(ask(server, "POST /host HTTP/1.1\r\nContent-Length: 0\r\n\r\n").starts_with("HTTP/1.1 405 "));
        assert!(ask(server, "GET /other HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 404 "));
        let two = "GET /host HTTP/1.1\r\nHost: one\r\nHost: two\r\n\r\n";
        let answer = ask(server, two);
        assert!(answer.contains("connection: close\r\n") && answer.ends_with("\r\n\r\n"), "{answer}");
        let safe = ask(server, "GET /safe?of=1 HTTP/1.1\r\n\r\n");
        assert!(safe.contains("x-content-type-options: nosniff\r\n") && safe.ends_with("<p>"), "{safe}");
        let long = format!("GET /{} HTTP/1.1\r\n\r\n", "x".repeat(100_000));
        assert!(!ask_unchecked(server, &long).contains(" 200 "));
    });
}

/// As [`ask`], where the server may close before it has read everything.
fn ask_unchecked(server: &Server, request: &str) -> String {
    let mut stream = connect(server);
    let _ = stream.write_all(request.as_bytes());
    remaining(stream)
}

#[test]
fn a_loop_that_stands_still_is_said_to() {
    let server = Server::bind(([127, 0, 0, 1], 0).into()).unwrap();
    assert!(ask(&server, "GET /host HTTP/1.1\r\n\r\n").starts_with("HTTP/1.1 503 "));
    let address = server.address();
    drop(server);
    assert!(Server::bind(address).is_ok(), "the port is free again");
}

#[test]
fn a_call_of_the_loop_answers_a_few_requests_and_the_next_calls_the_rest() {
    let server = Server::bind(([127, 0, 0, 1], 0).into()).unwrap();
    let clients: Vec<TcpStream> = (0..30).map(|_| connect(&server)).collect();
    for mut client in &clients {
        client.write_all(b"GET /host HTTP/1.1\r\nHost: here\r\n\r\n").unwrap();
    }
    let (mut all, mut most) = (0, 0);
    while all < 30 {
        let mut answered = 0;
        server.serve(|request| {
            answered += 1;
            // Others come meanwhile, and do not prolong this call.
            std::thread::sleep(Duration::from_millis(5));
            answer(request)
        });
        (all, most) = (all + answered, most.max(answered));
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!((2..=8).contains(&most), "{most}");
    assert!(clients.into_iter().all(|client| remaining(client).ends_with("here")));
}

#[test]
fn a_feed_goes_on_until_it_is_dropped_and_a_client_that_does_not_read_it_is_cut_off() {
    let server = Server::bind(([127, 0, 0, 1], 0).into()).unwrap();
    let mut clients: Vec<TcpStream> = (0..2).map(|_| connect(&server)).collect();
    for client in &mut clients {
        client.write_all(b"GET /feed HTTP/1.1\r\n\r\n").unwrap();
    }
    let mut feeds = Vec::new();
    while feeds.len() < 2 {
        server.serve(|_| {
            let (response, feed) = Response::feed("text/event-stream");
            feeds.push(feed);
            response
        });
        std::thread::sleep(Duration::from_millis(1));
    }
    // Both are sent more than the system keeps for a client, and only one of them reads.
    let (reader, deaf) = (clients.remove(0), clients.remove(0));
    let reader = std::thread::spawn(move || remaining(reader));
    let message = "x".repeat(100_000);
    let mut is_fed = [true; 2];
    while is_fed.iter().all(|fed| *fed) {
        for (fed, feed) in is_fed.iter_mut().zip(&feeds) {
            *fed = feed.send(message.clone());
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    // Which of the two was answered first is not known.
    let left = feeds.remove(usize::from(is_fed[0]));
    drop(left);
    assert!(feeds[0].send("the end"));
    drop(feeds);
    let read = reader.join().unwrap();
    assert!(read.starts_with("HTTP/1.1 200 OK\r\n") && read.contains("the end"));
    assert!(!remaining(deaf).contains("the end"));
}

#[test]
fn head_is_answered_without_a_body_and_every_other_method_is_refused() {
    served(|server| {
        let head = ask(server, "HEAD /host HTTP/1.1\r\nHost: here\r\n\r\n");
        assert!(head.starts_with("HTTP/1.1 200 OK\r\n") && head.contains("content-length: 4\r\n"), "{head}");
        assert!(head.ends_with("\r\n\r\n"), "{head}");
        for method in ["POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT", "PROPFIND", "get"] {
            let answer = ask(server, &format!("{method} /host HTTP/1.1\r\nHost: here\r\n\r\n"));
            assert!(answer.starts_with("HTTP/1.1 405 "), "{method}: {answer}");
            assert!(answer.contains("allow: GET, HEAD\r\n"), "{answer}");
        }
    });
}

#[test]
fn a_body_is_never_read() {
    served(|server| {
        let mut client = connect(server);
        client.write_all(b"POST / HTTP/1.1\r\nHost: here\r\nContent-Length: 100000000000\r\n\r\n").unwrap();
        let chunk = vec![7; 1 << 16];
        // The server closes long before a gigabyte.
        let sent = (0..16_384).take_while(|_| client.write_all(&chunk).is_ok()).count();
        assert!(sent < 16_384, "{sent}");
    });
}

#[test]
fn a_thousand_connections_that_ask_nothing_keep_nobody_out() {
    served(|server| {
        let silent: Vec<TcpStream> = (0..1000).map(|_| connect(server)).collect();
        for _ in 0..20 {
            assert!(ask(server, "GET /host HTTP/1.1\r\nHost: here\r\n\r\n").ends_with("here"));
        }
        drop(silent);
    });
}
