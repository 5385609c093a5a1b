//! The HTTP server of a station's programs: metrics, the page of `andond look`, and what comes.
//!
//! A library (hyper) reads and writes in a thread of its own, and the program answers in its own loop, whenever it calls [`Server::serve`].
//! So a client that is slow or hostile costs neither the loop nor another client anything. A loop that stands still answers nothing, and
//! its clients are told so.
//!
//! An answer may go on: [`Response::feed`] gives its sending end, as for server-sent events. It may come later, from another thread, as what a disk
//! has: [`Response::later`].
//!
//! Who binds with an [`Offer`] is reached by TLS, or takes forms as well. Without one a server answers GET and HEAD alone.
//!
//! ```
//! use andon_http::{Response, Server};
//!
//! let server = Server::bind(([127, 0, 0, 1], 0).into())?;
//! // In every turn of the loop:
//! server.serve(|request| match request.path.as_str() {
//!     "/count" => Response::ok("text/plain", "3"),
//!     _ => Response::text(404, "the count is at /count\n"),
//! });
//! # Ok::<(), std::io::Error>(())
//! ```
#![forbid(unsafe_code)]

mod body;
mod clients;
mod connection;
mod form;
mod tls;

use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::{Mutex, PoisonError};
use std::thread::JoinHandle;

use tokio::net::TcpListener;
use tokio::runtime::Builder;
use tokio::sync::{mpsc, oneshot};

use body::Sent;
use clients::accept_all;
use connection::Service;

pub use body::{Feed, Later};
pub use hyper::body::Bytes;
pub use tls::{Tls, TlsError, self_signed};

/// Requests that wait for the loop. A monitoring system sends one in some seconds, a browser a few at once.
const WAITING: usize = 64;

/// Requests that are answered in one call of [`Server::serve`]: a loop has other work, and the rest waits for its next turn.
const AT_ONCE: usize = 8;

/// What a server offers beside answers to GET and HEAD over plain HTTP.
#[derive(Clone, Debug, Default)]
pub struct Offer {
    /// The certificate and the key of TLS; without them it speaks plain HTTP.
    pub tls: Option<Tls>,
    /// Whether it takes forms, by POST.
    pub takes_forms: bool,
}

/// What a client asks for. Only `GET`, `HEAD` and a `POST` with a form come this far. The server leaves out the body of what answers a `HEAD`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Request {
    /// The path, without a query.
    pub path: String,
    /// What follows the question mark, as it came; empty where nothing does.
    pub query: String,
    /// The header `Host`, if there is exactly one.
    pub host: Option<String>,
    /// Whether the browser says that a page of another site asks for this, other than by leading its reader here.
    pub is_from_another_site: bool,
    /// Whether the browser says that a page of this server sends this: by `Origin`, and by `Sec-Fetch-Site` where it sends that.
    pub is_from_own_page: bool,
    /// What came as cookies; empty where nothing did.
    pub cookies: String,
    /// The address of the client.
    pub peer: Option<IpAddr>,
    /// The form of a POST as it came, `application/x-www-form-urlencoded` and 4 KiB at most; `None` for everything else.
    pub form: Option<Vec<u8>>,
}

/// What a client is answered.
#[derive(Debug)]
pub struct Response {
    status: u16,
    kind: &'static str,
    headers: &'static [(&'static str, &'static str)],
    own_headers: Vec<(&'static str, String)>,
    body: Sent,
}

impl Response {
    fn new(status: u16, kind: &'static str, body: Sent) -> Self {
        Self { status, kind, headers: &[], own_headers: Vec::new(), body }
    }

    /// An answer with its media type.
    pub fn ok(kind: &'static str, body: impl Into<Vec<u8>>) -> Self {
        Self::new(200, kind, Sent::Whole(body.into()))
    }

    /// A sentence with a status, for what is not served.
    pub fn text(status: u16, sentence: &str) -> Self {
        Self::new(status, "text/plain; charset=utf-8", Sent::Whole(sentence.into()))
    }

    /// Leads the browser to another address of this server, which it then asks for by GET.
    pub fn see(address: &str) -> Self {
        Self::text(303, "").with_own("location", address.to_owned())
    }

    /// An answer that goes on until its feed is dropped.
    pub fn feed(kind: &'static str) -> (Self, Feed) {
        let (feed, body) = Feed::new();
        (Self::new(200, kind, body), feed)
    }

    /// An answer that somebody gives later. The client waits some seconds for it.
    pub fn later() -> (Self, Later) {
        let (later, body) = Later::new();
        (Self::new(200, "", body), later)
    }

    /// The answer itself, once it has come; `None` where nobody gives it.
    async fn settled(self) -> Option<Self> {
        match self.body {
            Sent::Later(later) => later.await.ok().map(|response| {
                let mut response = response.with(self.headers);
                response.own_headers.extend(self.own_headers);
                response
            }),
            _ => Some(self),
        }
    }

    fn is_feed(&self) -> bool {
        matches!(self.body, Sent::Feed { .. })
    }

    /// The same with further headers, whose names are in small letters.
    #[must_use]
    pub fn with(self, headers: &'static [(&'static str, &'static str)]) -> Self {
        Self { headers, ..self }
    }

    /// The same with another status.
    #[must_use]
    pub fn with_status(self, status: u16) -> Self {
        Self { status, ..self }
    }

    /// The same with one more header, whose name is in small letters. A value that cannot be one is left out.
    #[must_use]
    pub fn with_own(mut self, name: &'static str, value: String) -> Self {
        self.own_headers.push((name, value));
        self
    }
}

/// A request and where its answer goes.
struct Call {
    request: Request,
    reply: oneshot::Sender<Response>,
}

/// A server that listens. It ends when this is dropped.
pub struct Server {
    address: SocketAddr,
    calls: Mutex<mpsc::Receiver<Call>>,
    /// Dropped to end the thread.
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Listens, in a thread that ends with this server. Port 0 takes any that is free.
    ///
    /// # Errors
    /// What the system says: the address is taken, or does not belong to this machine.
    pub fn bind(address: SocketAddr) -> io::Result<Self> {
        Self::bind_with(address, Offer::default())
    }

    /// As [`Server::bind`], with TLS or for forms.
    ///
    /// # Errors
    /// As [`Server::bind`].
    pub fn bind_with(address: SocketAddr, offer: Offer) -> io::Result<Self> {
        let listener = std::net::TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let runtime = Builder::new_current_thread().enable_io().enable_time().build()?;
        let listener = {
            let _entered = runtime.enter();
            TcpListener::from_std(listener)?
        };
        let (send, calls) = mpsc::channel(WAITING);
        let service = Service { calls: send, offer };
        let (stop, stopped) = oneshot::channel::<()>();
        let thread = std::thread::Builder::new().name("http".into()).spawn(move || {
            runtime.block_on(async {
                tokio::select! {
                    () = accept_all(&listener, &service) => (),
                    _ = stopped => (),
                }
            });
        })?;
        Ok(Self { address, calls: Mutex::new(calls), stop: Some(stop), thread: Some(thread) })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Answers requests that have come, and leaves what is more than a few to the next call. It waits for none.
    pub fn serve(&self, mut answer: impl FnMut(&Request) -> Response) {
        let mut calls = self.calls.lock().unwrap_or_else(PoisonError::into_inner);
        for _ in 0..AT_ONCE {
            let Ok(call) = calls.try_recv() else { return };
            // A client that has left, or has been told that nobody answers, needs no answer.
            if !call.reply.is_closed() {
                let _ = call.reply.send(answer(&call.request));
            }
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.stop.take());
        // It has no other work than to end.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}
