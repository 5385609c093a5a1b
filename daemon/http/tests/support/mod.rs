//! A server beside its loop, and clients of plain bytes.

#![allow(clippy::unwrap_used, dead_code)]

use std::io::{Read, Write as _};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use andon_http::{Request, Response, Server};

/// Only a failing test waits for so long.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

pub(crate) fn connect(server: &Server) -> TcpStream {
    let stream = TcpStream::connect(server.address()).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream
}

/// Everything that comes until the server closes.
pub(crate) fn remaining(mut stream: impl Read) -> String {
    let mut answer = Vec::new();
    // A client that was cut off reads an error.
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

/// The server may close before it has read everything.
pub(crate) fn ask(server: &Server, request: &str) -> String {
    let mut stream = connect(server);
    let _ = stream.write_all(request.as_bytes());
    remaining(stream)
}

/// Says what has come.
pub(crate) fn answer(request: &Request) -> Response {
    let form = match &request.form {
        Some(form) => format!("form {}", String::from_utf8_lossy(form)),
        None => "no form".to_owned(),
    };
    let (cookies, own, peer) = (&request.cookies, request.is_from_own_page, request.peer.unwrap());
    Response::ok("text/plain", format!("{form}, cookies {cookies}, own {own}, from {peer}"))
}

/// Runs a test beside the loop that answers.
pub(crate) fn served(server: &Server, test: impl FnOnce(&Server)) {
    served_by(server, answer, test);
}

/// The same with other answers.
pub(crate) fn served_by(server: &Server, answer: fn(&Request) -> Response, test: impl FnOnce(&Server)) {
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !is_over.load(Ordering::Relaxed) {
                server.serve(answer);
                std::thread::sleep(Duration::from_millis(1));
            }
        });
        let tested = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| test(server)));
        is_over.store(true, Ordering::Relaxed);
        tested.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    });
}
