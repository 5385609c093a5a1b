//! A page on this machine: the newest picture and its sentences, fetched one after the other by a few lines of JavaScript.
//!
//! It listens on the loopback address only. A page of another site that a browser on this machine has open must not read it either: a name
//! that leads here by a trick of the other site's DNS is refused by the header Host, and no answer allows other origins.

use std::io::{self, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use serde::Serialize;

use super::findings::Line;
use crate::http::receive;

/// A browser of this machine has sent its request by then.
const PATIENCE: Duration = Duration::from_millis(500);
/// A request of a browser without a body is shorter.
const REQUEST: usize = 16_384;
const HEADERS: usize = 64;

const HTML: &str = include_str!("page.html");
const SCRIPT: &str = include_str!("page.js");
const STYLE: &str = include_str!("page.css");
/// Nothing comes from anywhere else.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

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
    lines: Vec<Line>,
}

/// A page that is being served.
pub(super) struct Page {
    address: SocketAddr,
    newest: Arc<Mutex<Newest>>,
}

impl Page {
    /// Serves a page in a thread of its own, as long as this process lives.
    pub(super) fn serve(address: SocketAddr) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        let address = listener.local_addr()?;
        let newest = Arc::<Mutex<Newest>>::default();
        let shown = Arc::clone(&newest);
        std::thread::Builder::new().name("page".into()).spawn(move || {
            for stream in listener.incoming().flatten() {
                // A client that leaves or is too slow gets no answer.
                let _ = answer(stream, address.port(), &shown);
            }
        })?;
        Ok(Self { address, newest })
    }

    pub(super) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Shows the next picture.
    pub(super) fn show(&self, jpeg: Vec<u8>, source: &str, lines: Vec<Line>) {
        // Texts and truth values always become JSON.
        let words = serde_json::to_string(&Words { source, lines }).unwrap_or_default();
        *self.newest.lock().unwrap_or_else(PoisonError::into_inner) = Newest { jpeg, words };
    }
}

fn answer(mut stream: TcpStream, port: u16, newest: &Mutex<Newest>) -> io::Result<()> {
    stream.set_write_timeout(Some(PATIENCE))?;
    let newest = || newest.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let received = receive(&mut stream, REQUEST, PATIENCE, |bytes| parse(bytes, port))?;
    let (status, kind, body) = match received.unwrap_or(Request::Bad) {
        Request::Bad => ("400 Bad Request", "text/plain", b"this is not an HTTP request\n".to_vec()),
        Request::OtherHost => {
            ("421 Misdirected Request", "text/plain", b"this page is only for this machine\n".to_vec())
        }
        Request::OtherMethod => ("405 Method Not Allowed", "text/plain", b"only GET is served\n".to_vec()),
        Request::Get(path) => match path.as_str() {
            "/" => ("200 OK", "text/html; charset=utf-8", HTML.into()),
            "/page.js" => ("200 OK", "text/javascript; charset=utf-8", SCRIPT.into()),
            "/page.css" => ("200 OK", "text/css; charset=utf-8", STYLE.into()),
            "/newest.jpg" => ("200 OK", "image/jpeg", newest().jpeg),
            "/newest.json" => ("200 OK", "application/json", newest().words.into_bytes()),
            _ => ("404 Not Found", "text/plain", b"the page is at /\n".to_vec()),
        },
    };
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nContent-Security-Policy: {POLICY}\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Cache-Control: no-store\r\nConnection: close\r\n\r\n",
        body.len()
    )?;
    stream.write_all(&body)
}

/// What a client asks for.
#[derive(Debug, PartialEq)]
enum Request {
    Get(String),
    OtherHost,
    OtherMethod,
    Bad,
}

/// The request, once all of it has come.
fn parse(bytes: &[u8], port: u16) -> Option<Request> {
    let mut headers = [httparse::EMPTY_HEADER; HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    match request.parse(bytes) {
        Err(_) => Some(Request::Bad),
        Ok(httparse::Status::Partial) => None,
        Ok(httparse::Status::Complete(_)) => {
            let hosts: Vec<&[u8]> = request
                .headers
                .iter()
                .filter(|header| header.name.eq_ignore_ascii_case("host"))
                .map(|header| header.value)
                .collect();
            let own = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
            let is_own = matches!(hosts[..], [host] if own.iter().any(|own| own.as_bytes() == host));
            Some(match (request.method, request.path) {
                _ if !is_own => Request::OtherHost,
                (Some("GET"), Some(path)) => Request::Get(path.to_owned()),
                _ => Request::OtherMethod,
            })
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use std::io::Read as _;

    use super::*;
    use std::net::Ipv4Addr;

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
        let line = Line { is_good: false, about: "brick".into(), sentence: "not seen".into() };
        page.show(b"a picture".to_vec(), "a film", vec![line]);
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
