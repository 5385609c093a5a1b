//! `andond look --page`: the board's page for the picture, on this machine, without a line.
//!
//! It listens on the loopback address only, and answers to no other name: see `andon_board`.

use std::io;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use andon_board::{Board, Finding, Picture, Settings};
use andon_host::config::Config;
use andon_http::Server;
use andon_ipc::MonotonicTime;

/// How often browsers are answered.
const TURN: Duration = Duration::from_millis(20);

/// A page that is being served.
pub(super) struct Page {
    address: SocketAddr,
    board: Arc<Mutex<Board>>,
}

impl Page {
    /// Serves a page in a thread of its own, as long as this process lives.
    pub(super) fn serve(address: SocketAddr, config: &Config) -> io::Result<Self> {
        let server = Server::bind(address)?;
        let address = server.address();
        let board = Arc::new(Mutex::new(Board::new(settings(address, config))));
        let page = Self { address, board: Arc::clone(&board) };
        std::thread::Builder::new().name("page".into()).spawn(move || {
            loop {
                let mut served = locked(&board);
                served.publish(MonotonicTime::now().nanoseconds());
                server.serve(|request| served.answer(request));
                drop(served);
                std::thread::sleep(TURN);
            }
        })?;
        Ok(page)
    }

    pub(super) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Whether a browser waits for a picture.
    pub(super) fn wants_picture(&self) -> bool {
        locked(&self.board).wants_picture()
    }

    /// Shows the next picture, with whatever is drawn into it.
    pub(super) fn show(&self, jpeg: Vec<u8>, size: [u32; 2]) {
        locked(&self.board).picture(&Picture { jpeg, size, things: Vec::new() });
    }

    /// Says what the pictures come from and what was found in them.
    pub(super) fn say(&self, source: &str, findings: Vec<Finding>) {
        locked(&self.board).look(source, findings);
    }
}

fn locked(board: &Mutex<Board>) -> MutexGuard<'_, Board> {
    board.lock().unwrap_or_else(PoisonError::into_inner)
}

fn settings(address: SocketAddr, config: &Config) -> Settings {
    Settings {
        language: config.board.language.clone(),
        is_look: true,
        ..Settings::new(&config.station.name, address.ip(), address.port())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::io::{Read as _, Write as _};

    use super::*;
    use std::net::{Ipv4Addr, TcpStream};

    #[test]
    fn the_page_shows_the_newest_picture_and_its_sentences_to_this_machine_only() {
        let page = Page::serve(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)), &Config::default()).unwrap();
        let finding = Finding { is_good: false, about: "brick".into(), sentence: "not seen".into() };
        page.say("a film", vec![finding]);
        let port = page.address().port();
        let get = |path: &str, host: &str| {
            let mut stream = TcpStream::connect(page.address()).unwrap();
            write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n").unwrap();
            let mut answer = String::new();
            stream.read_to_string(&mut answer).unwrap();
            answer
        };
        let own = format!("127.0.0.1:{port}");
        let html = get("/", &own);
        for text in ["200 OK", "default-src 'none'", "a film", "improve", ">brick<", ">not seen<"] {
            assert!(html.contains(text), "{text} is not in {html}");
        }
        std::thread::scope(|scope| {
            let asked = scope.spawn(|| get("/picture.svg", &format!("localhost:{port}")));
            while !page.wants_picture() {
                std::thread::sleep(TURN);
            }
            page.show(vec![0; 3], [4, 3]);
            let picture = asked.join().unwrap();
            assert!(picture.contains("base64,AAAA\"") && !picture.contains("<text"), "{picture}");
        });
        for host in ["evil.example", "127.0.0.1", &format!("evil.example:{port}")] {
            assert!(get("/", host).contains("421"), "{host}");
        }
        for path in ["/technician", "/technician/event", "/login", "/other"] {
            assert!(get(path, &own).contains("404"), "{path}");
        }
    }
}
