//! As much of HTTP as a monitoring system needs: one request, one answer, and the connection ends.
//!
//! It is served in the role's own loop, so a client may take its time only for so long.
//!
//! The parser is a library's (`httparse`), the server is not. For one answer a second an async server would be another thread and a dozen
//! crates.

use std::io::{self, ErrorKind, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::time::Duration;

use crate::http::receive;

/// A client of this machine has sent its request by then.
const PATIENCE: Duration = Duration::from_millis(200);
/// A request without a body is shorter.
const REQUEST: usize = 8192;
const HEADERS: usize = 64;

/// The media type of OpenMetrics 1.0.
const OPEN_METRICS: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";
const PLAIN: &str = "text/plain; charset=utf-8";

/// A server that listens.
pub(super) struct Server(TcpListener);

impl Server {
    pub(super) fn bind(address: SocketAddr) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self(listener))
    }

    /// Answers one client, if one waits. One that leaves or is too slow gets no answer.
    pub(super) fn serve(&self, text: impl FnOnce() -> String) {
        let served = self.0.accept().and_then(|(stream, _)| answer(stream, text));
        if let Err(error) = served
            && error.kind() != ErrorKind::WouldBlock
        {
            tracing::debug!(%error, "a request for metrics was not answered");
        }
    }
}

fn answer(mut stream: TcpStream, text: impl FnOnce() -> String) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let (status, kind, body) = match receive(&mut stream, REQUEST, PATIENCE, parse)?.unwrap_or(Request::Bad) {
        Request::Metrics => ("200 OK", OPEN_METRICS, text()),
        Request::OtherPath => ("404 Not Found", PLAIN, "the metrics are at /metrics\n".into()),
        Request::OtherMethod => ("405 Method Not Allowed", PLAIN, "only GET is served\n".into()),
        Request::Bad => ("400 Bad Request", PLAIN, "this is not an HTTP request\n".into()),
    };
    let length = body.len();
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{body}"
    )
}

/// What a client asks for.
enum Request {
    Metrics,
    OtherPath,
    OtherMethod,
    Bad,
}

/// The request, once all of it has come.
fn parse(bytes: &[u8]) -> Option<Request> {
    let mut headers = [httparse::EMPTY_HEADER; HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    match request.parse(bytes) {
        Err(_) => Some(Request::Bad),
        Ok(httparse::Status::Partial) => None,
        Ok(httparse::Status::Complete(_)) => Some(match (request.method, request.path) {
            (Some("GET"), Some("/metrics")) => Request::Metrics,
            (Some("GET"), _) => Request::OtherPath,
            _ => Request::OtherMethod,
        }),
    }
}
