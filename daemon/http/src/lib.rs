//! The HTTP server of a station's programs: metrics, the page of `andond look`, and what comes.
//!
//! A library (hyper) reads and writes in a thread of its own, and the program answers in its own loop, whenever it calls [`Server::serve`].
//! So a client that is slow or hostile costs neither the loop nor another client anything. A loop that stands still answers nothing, and
//! its clients are told so.
//!
//! An answer may go on: [`Response::feed`] gives its sending end, as for server-sent events.
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

use std::io;
use std::net::SocketAddr;
use std::sync::{Mutex, PoisonError};
use std::thread::JoinHandle;

use tokio::net::TcpListener;
use tokio::runtime::Builder;
use tokio::sync::{mpsc, oneshot};

use body::Content;
use clients::accept_all;

pub use body::Feed;
pub use hyper::body::Bytes;

/// Requests that wait for the loop. A monitoring system sends one in some seconds, a browser a few at once.
const WAITING: usize = 64;

/// Requests that are answered in one call of [`Server::serve`]: a loop has other work, and the rest waits for its next turn.
const AT_ONCE: usize = 8;

/// What a client asks for. Only `GET` and `HEAD` come this far, and the server leaves out the body of what answers the latter.
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
}

/// What a client is answered.
#[derive(Debug)]
pub struct Response {
    status: u16,
    kind: &'static str,
    headers: &'static [(&'static str, &'static str)],
    body: Content,
}

impl Response {
    /// An answer with its media type.
    pub fn ok(kind: &'static str, body: impl Into<Vec<u8>>) -> Self {
        let body: Vec<u8> = body.into();
        Self { status: 200, kind, headers: &[], body: Content::Whole(Some(body.into())) }
    }

    /// A sentence with a status, for what is not served.
    pub fn text(status: u16, sentence: &str) -> Self {
        Self { status, ..Self::ok("text/plain; charset=utf-8", sentence) }
    }

    /// An answer that goes on until its feed is dropped.
    pub fn feed(kind: &'static str) -> (Self, Feed) {
        let (feed, messages) = Feed::new();
        (Self { status: 200, kind, headers: &[], body: Content::Feed(messages) }, feed)
    }

    fn is_feed(&self) -> bool {
        matches!(self.body, Content::Feed(_))
    }

    /// The same with further headers, whose names are in small letters.
    #[must_use]
    pub fn with(self, headers: &'static [(&'static str, &'static str)]) -> Self {
        Self { headers, ..self }
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
        let listener = std::net::TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let runtime = Builder::new_current_thread().enable_io().enable_time().build()?;
        let listener = {
            let _entered = runtime.enter();
            TcpListener::from_std(listener)?
        };
        let (send, calls) = mpsc::channel(WAITING);
        let (stop, stopped) = oneshot::channel::<()>();
        let thread = std::thread::Builder::new().name("http".into()).spawn(move || {
            runtime.block_on(async {
                tokio::select! {
                    () = accept_all(&listener, &send) => (),
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

    /// Answers the next request, for a thread that does nothing else. False when none will come any more.
    pub fn serve_next(&self, answer: impl FnOnce(&Request) -> Response) -> bool {
        let call = self.calls.lock().unwrap_or_else(PoisonError::into_inner).blocking_recv();
        call.map(|call| call.reply.send(answer(&call.request))).is_some()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.stop.take());
        // It has no other work than to end.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}
