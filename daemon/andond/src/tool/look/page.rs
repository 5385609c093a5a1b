//! A page on this machine: the newest picture and its sentences, fetched one after the other by a few lines of JavaScript.
//!
//! It listens on the loopback address only. A page of another site that a browser on this machine has open must not read it either. A name that leads
//! here by a trick of the other site's DNS is refused by the header Host. No answer allows other origins.

use std::io;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};

use andon_http::{Request, Response, Server};
use serde::Serialize;

use super::findings::Finding;

const HTML: &str = include_str!("page.html");
const SCRIPT: &str = include_str!("page.js");
const STYLE: &str = include_str!("page.css");

/// Nothing comes from anywhere else, and nothing of it goes to another site.
const SAFETY: &[(&str, &str)] = &[
    (
        "content-security-policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-resource-policy", "same-origin"),
    ("cache-control", "no-store"),
];

/// The newest picture and what is said of it.
#[derive(Clone, Default)]
struct Newest {
    jpeg: Vec<u8>,
    words: String,
}

/// What the page reads as JSON.
#[derive(Serialize)]
struct Words<'a> {
    source: &'a str,
    lines: Vec<Finding>,
}

/// A page that is being served.
pub(super) struct Page {
    address: SocketAddr,
    newest: Arc<Mutex<Newest>>,
}

impl Page {
    /// Serves a page in a thread of its own, as long as this process lives.
    pub(super) fn serve(address: SocketAddr) -> io::Result<Self> {
        let server = Server::bind(address)?;
        let address = server.address();
        let newest = Arc::<Mutex<Newest>>::default();
        let shown = Arc::clone(&newest);
        std::thread::Builder::new().name("page".into()).spawn(move || {
            while server.serve_next(|request| answer(request, address.port(), &shown).with(SAFETY)) {}
        })?;
        Ok(Self { address, newest })
    }

    pub(super) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Shows the next picture.
    pub(super) fn show(&self, jpeg: Vec<u8>, source: &str, lines: Vec<Finding>) {
        // Texts and truth values always become JSON.
        let words = serde_json::to_string(&Words { source, lines }).unwrap_or_default();
        *self.newest.lock().unwrap_or_else(PoisonError::into_inner) = Newest { jpeg, words };
    }
}

fn answer(request: &Request, port: u16, newest: &Mutex<Newest>) -> Response {
    let own = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    if !request.host.as_ref().is_some_and(|host| own.contains(host)) {
        return Response::text(421, "this page is only for this machine\n");
    }
    let newest = || newest.lock().unwrap_or_else(PoisonError::into_inner).clone();
    match request.path.as_str() {
        "/" => Response::ok("text/html; charset=utf-8", HTML),
        "/page.js" => Response::ok("text/javascript; charset=utf-8", SCRIPT),
        "/page.css" => Response::ok("text/css; charset=utf-8", STYLE),
        "/newest.jpg" => Response::ok("image/jpeg", newest().jpeg),
        "/newest.json" => Response::ok("application/json", newest().words),
        _ => Response::text(404, "the page is at /\n"),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::io::{Read as _, Write as _};

    use super::*;
    use std::net::{Ipv4Addr, TcpStream};

    fn asked(page: &Page, request: &str) -> String {
        let mut stream = TcpStream::connect(page.address()).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        String::from_utf8_lossy(&answer).into_owned()
    }

    #[test]
    fn the_page_shows_the_newest_picture_and_its_sentences_to_this_machine_only() {
        let page = Page::serve(SocketAddr::from((Ipv4Addr::LOCALHOST, 0))).unwrap();
        let finding = Finding { is_good: false, about: "brick".into(), sentence: "not seen".into() };
        page.show(b"a picture".to_vec(), "a film", vec![finding]);
        let port = page.address().port();
        let get =
            |path: &str, host: &str| asked(&page, &format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n\r\n"));
        let own = format!("127.0.0.1:{port}");
        let html = get("/", &own);
        assert!(
            html.contains("200 OK") && html.contains("page.js") && html.contains("default-src 'none'"),
            "{html}"
        );
        assert!(get("/newest.jpg", &format!("localhost:{port}")).ends_with("a picture"));
        let words = get("/newest.json", &own);
        assert!(
            words.ends_with(
                r#"{"source":"a film","lines":[{"is_good":false,"about":"brick","sentence":"not seen"}]}"#
            ),
            "{words}"
        );
        for host in ["evil.example", "127.0.0.1", &format!("evil.example:{port}")] {
            assert!(get("/", host).contains("421"), "{host}");
        }
        assert!(get("/other", &own).contains("404"));
        assert!(asked(&page, "nonsense\r\n\r\n").contains("400"));
        assert!(asked(&page, &format!("POST / HTTP/1.1\r\nHost: {own}\r\n\r\n")).contains("405"));
        assert!(asked(&page, "GET / HTTP/1.1\r\n\r\n").contains("421"));
    }
}
