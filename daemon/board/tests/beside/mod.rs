//! A test beside the loop of a board, and clients of plain bytes.

#![allow(clippy::unwrap_used)]

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Ipv4Addr, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Only a failing test waits for so long.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// Runs a test, and turns beside it until it has ended.
pub(crate) fn beside(turn: impl Fn() + Sync, test: impl FnOnce()) {
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !is_over.load(Ordering::Relaxed) {
                turn();
                std::thread::sleep(Duration::from_millis(2));
            }
        });
        let tested = std::panic::catch_unwind(std::panic::AssertUnwindSafe(test));
        is_over.store(true, Ordering::Relaxed);
        tested.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    });
}

pub(crate) fn connect(port: u16) -> TcpStream {
    let stream = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream
}

/// Everything that comes until the server closes.
pub(crate) fn sent(port: u16, request: &[u8]) -> String {
    let mut stream = connect(port);
    // The server may close before it has read everything.
    let _ = stream.write_all(request);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

/// Reads a feed until a line has this text. The board sends a sign of life again and again, so the time for one line is no limit.
pub(crate) fn until(feed: &mut BufReader<TcpStream>, text: &str) {
    let (mut line, deadline) = (String::new(), Instant::now() + PATIENCE);
    while !line.contains(text) {
        assert!(Instant::now() < deadline, "waited in vain for {text:?}");
        line.clear();
        assert!(feed.read_line(&mut line).unwrap() > 0, "the stream ended before {text:?}");
    }
}
