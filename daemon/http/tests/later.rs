//! Answers that a thread gives later, whole or piece by piece.

#![allow(clippy::unwrap_used)]

mod support;

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::sync::mpsc::channel;
use std::thread::{self, ScopedJoinHandle};
use std::time::Duration;

use andon_http::{Later, Response, Server};
use support::{PATIENCE, ask, connect, remaining, served};

fn bound() -> Server {
    Server::bind(([127, 0, 0, 1], 0).into()).unwrap()
}

/// A client that waits for its answer, and the sending end of that.
fn asked(server: &Server) -> (TcpStream, Later) {
    let mut client = connect(server);
    client.write_all(b"GET / HTTP/1.1\r\nHost: here\r\n\r\n").unwrap();
    let (send, later) = channel();
    loop {
        server.serve(|_| {
            let (response, later) = Response::later();
            send.send(later).unwrap();
            response.with(&[("x-promised", "yes")]).with_own("x-own", "yes".to_owned())
        });
        if let Ok(later) = later.recv_timeout(Duration::from_millis(1)) {
            return (client, later);
        }
    }
}

#[test]
fn an_answer_comes_later_with_the_headers_that_were_promised_and_holds_up_nobody() {
    let server = bound();
    let (client, later) = asked(&server);
    served(&server, |server| {
        assert!(ask(server, "GET / HTTP/1.1\r\nHost: here\r\n\r\n").contains("no form"));
    });
    later.send(Response::see("/there").with_own("set-cookie", "a=1".to_owned()));
    let answer = remaining(client);
    assert!(answer.starts_with("HTTP/1.1 303 "), "{answer}");
    for header in ["location: /there\r\n", "set-cookie: a=1\r\n", "x-promised: yes\r\n", "x-own: yes\r\n"] {
        assert!(answer.contains(header), "{answer}");
    }
    let (client, later) = asked(&server);
    later.send(Response::text(404, "it was removed\n"));
    let answer = remaining(client);
    assert!(answer.starts_with("HTTP/1.1 404 ") && answer.ends_with("it was removed\n"), "{answer}");
}

#[test]
fn who_is_promised_an_answer_that_nobody_gives_is_told_so_and_who_has_left_is_known() {
    let server = bound();
    let (client, later) = asked(&server);
    drop(later);
    assert!(remaining(client).starts_with("HTTP/1.1 503 "), "nobody answers");
    let (client, later) = asked(&server);
    drop(client);
    while !later.is_over() {
        thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_file_waits_for_a_client_that_reads_slowly_and_comes_whole() {
    const PIECES: usize = 2000;
    let server = bound();
    let (mut client, later) = asked(&server);
    let (response, feed) = Response::feed("application/octet-stream");
    later.send(response);
    thread::scope(|scope| {
        let sent: ScopedJoinHandle<'_, bool> = scope.spawn(move || {
            let is_sent = (0..PIECES).all(|piece| feed.send_within(PATIENCE, vec![piece as u8; 16_384]));
            feed.end_within(PATIENCE);
            is_sent
        });
        let (mut taken, mut piece) = (Vec::new(), [0; 65_536]);
        while let Ok(count @ 1..) = client.read(&mut piece) {
            taken.extend_from_slice(&piece[..count]);
            if taken.len() < 4_000_000 {
                thread::sleep(Duration::from_millis(2));
            }
        }
        assert!(sent.join().unwrap());
        assert!(taken.len() > PIECES * 16_384 && taken.ends_with(b"0\r\n\r\n"), "{} bytes", taken.len());
    });
}

#[test]
fn a_client_that_reads_nothing_of_a_file_holds_up_its_sender_no_longer_than_its_patience() {
    let server = bound();
    let (_client, later) = asked(&server);
    let (response, feed) = Response::feed("application/octet-stream");
    later.send(response);
    // The system takes some megabytes for it.
    let count =
        (0..4000).take_while(|_| feed.send_within(Duration::from_millis(100), vec![7; 16_384])).count();
    assert!(count < 4000, "64 MB wait for a client that reads nothing");
}
