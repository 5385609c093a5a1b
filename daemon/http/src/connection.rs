//! One client: its request, the way to the loop and back, and the limits that keep it from costing others anything.

use std::convert::Infallible;
use std::sync::Mutex;
use std::time::Duration;

use hyper::body::Incoming;
use hyper::header::{CONTENT_TYPE, HOST, HeaderName, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::TcpStream;
use tokio::sync::{mpsc, oneshot};
use tokio::time::{sleep, timeout};

use super::body::{Content, Ending};
use super::clients::Progress;
use super::{Call, Request, Response};

/// How long a client may take to send its request: a machine in the same hall needs milliseconds.
const REQUEST: Duration = Duration::from_secs(2);

/// The whole of a connection, with the time in which a slow client reads its answer.
const CONNECTION: Duration = Duration::from_secs(10);

/// A loop that has not answered by then stands still: a role turns twenty times a second.
const LOOP_PATIENCE: Duration = Duration::from_secs(2);

/// The request of a browser without a body is shorter.
const REQUEST_BYTES: usize = 16 * 1024;

/// How long a client has after the end of a feed to read what was sent to it.
const REST: Duration = Duration::from_secs(1);

/// Serves a client to the end of its connection.
pub(super) async fn serve(stream: TcpStream, calls: mpsc::Sender<Call>, progress: Progress) {
    let (starts, started) = oneshot::channel();
    let starts = Mutex::new(Some(starts));
    let service = service_fn(|request: hyper::Request<Incoming>| {
        let (calls, starts, progress) = (calls.clone(), &starts, &progress);
        progress.asked();
        async move {
            let response = answer(&request, &calls).await;
            progress.answered(response.is_feed());
            Ok::<_, Infallible>(whole(response, starts))
        }
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(REQUEST)
        .max_buf_size(REQUEST_BYTES)
        .keep_alive(false)
        .serve_connection(TokioIo::new(stream), service);
    tokio::select! {
        ended = connection => if let Err(error) = ended {
            tracing::debug!(%error, "a client was not answered");
        },
        () = limit(started) => tracing::debug!("a client took too long"),
    }
}

/// Waits until the client has had its time: a feed lasts as long as its sender feeds it, everything else a fixed time.
async fn limit(started: oneshot::Receiver<Ending>) {
    if let Ok(Ok(ending)) = timeout(CONNECTION, started).await {
        ending.wait().await;
        sleep(REST).await;
    }
}

/// Lets the loop answer.
async fn answer(request: &hyper::Request<Incoming>, calls: &mpsc::Sender<Call>) -> Response {
    if ![Method::GET, Method::HEAD].contains(request.method()) {
        return Response::text(405, "only GET and HEAD are served\n").with(&[("allow", "GET, HEAD")]);
    }
    let uri = request.uri();
    let request = Request {
        path: uri.path().to_owned(),
        query: uri.query().unwrap_or_default().to_owned(),
        host: host(request),
        is_from_another_site: is_from_another_site(request),
    };
    let (reply, answered) = oneshot::channel();
    // Where there is no room for it, nobody answers it either.
    let _ = calls.try_send(Call { request, reply });
    match timeout(LOOP_PATIENCE, answered).await {
        Ok(Ok(response)) => response,
        _ => Response::text(503, "the program does not answer now\n"),
    }
}

fn host(request: &hyper::Request<Incoming>) -> Option<String> {
    let mut hosts = request.headers().get_all(HOST).iter();
    match (hosts.next(), hosts.next()) {
        (Some(host), None) => host.to_str().ok().map(str::to_owned),
        _ => None,
    }
}

/// Whether a page of another origin asks for this as a part of itself. A link that a person follows is none of that, and a program that is no browser
/// says nothing of a site.
fn is_from_another_site(request: &hyper::Request<Incoming>) -> bool {
    let is = |name, values: &[&[u8]]| {
        let header = request.headers().get(name);
        header.is_some_and(|value| values.contains(&value.as_bytes()))
    };
    let is_elsewhere = is("sec-fetch-site", &[b"cross-site", b"same-site"]);
    is_elsewhere && !(is("sec-fetch-mode", &[b"navigate"]) && is("sec-fetch-dest", &[b"document"]))
}

fn whole(
    mut response: Response,
    starts: &Mutex<Option<oneshot::Sender<Ending>>>,
) -> hyper::Response<Content> {
    let mut starts = starts.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some((ending, starts)) = response.body.ending().zip(starts.take()) {
        // The other end is in `limit`, which lasts as long as this.
        let _ = starts.send(ending);
    }
    let mut whole = hyper::Response::new(response.body);
    *whole.status_mut() = StatusCode::from_u16(response.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
    whole.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static(response.kind));
    for (name, value) in response.headers {
        whole.headers_mut().insert(HeaderName::from_static(name), HeaderValue::from_static(value));
    }
    whole
}
