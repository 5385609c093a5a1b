//! One client: its request, the way to the loop and back, and the limits that keep it from costing others anything.

use std::convert::Infallible;
use std::net::IpAddr;
use std::sync::Mutex;
use std::time::Duration;

use hyper::body::Incoming;
use hyper::header::{CONTENT_TYPE, COOKIE, HOST, HeaderName, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpStream;
use tokio::sync::{mpsc, oneshot};
use tokio::time::{sleep, timeout};

use super::body::{Content, Ending};
use super::clients::Progress;
use super::{Call, Offer, Request, Response, form};

/// How long a client may take to shake hands, to send the head of its request, and to send a form. A machine in the same hall needs milliseconds.
pub(super) const REQUEST: Duration = Duration::from_secs(2);

/// The whole of a connection, with the time in which a slow client reads its answer.
const CONNECTION: Duration = Duration::from_secs(10);

/// A loop that has not answered by then stands still: a role turns twenty times a second.
const LOOP_PATIENCE: Duration = Duration::from_secs(2);

/// What is answered later, as by a disk, is waited for so long beyond that: within the time of the connection.
const LATER: Duration = Duration::from_secs(7);

/// The head of a browser's request is shorter.
const REQUEST_BYTES: usize = 16 * 1024;

/// How long a client has after the end of a feed to read what was sent to it.
const REST: Duration = Duration::from_secs(1);

/// What is served to whom.
#[derive(Clone)]
pub(super) struct Service {
    pub(super) calls: mpsc::Sender<Call>,
    pub(super) offer: Offer,
}

/// Serves a client to the end of its connection.
pub(super) async fn serve(stream: TcpStream, peer: IpAddr, service: Service, progress: Progress) {
    let Some(tls) = service.offer.tls.clone() else { return talk(stream, peer, service, progress).await };
    match timeout(REQUEST, tls.accept(stream)).await {
        Ok(Ok(stream)) => talk(stream, peer, service, progress).await,
        Ok(Err(error)) => tracing::debug!(%error, "a client did not shake hands"),
        Err(_) => tracing::debug!("a client took too long to shake hands"),
    }
}

async fn talk(
    stream: impl AsyncRead + AsyncWrite + Unpin,
    peer: IpAddr,
    service: Service,
    progress: Progress,
) {
    let (starts, started) = oneshot::channel();
    let starts = Mutex::new(Some(starts));
    let answered = service_fn(|request: hyper::Request<Incoming>| {
        let (service, starts, progress) = (service.clone(), &starts, &progress);
        async move {
            let response = answer(request, peer, &service, progress).await;
            progress.answered(response.is_feed());
            Ok::<_, Infallible>(whole(response, starts))
        }
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(REQUEST)
        .max_buf_size(REQUEST_BYTES)
        .keep_alive(false)
        .serve_connection(TokioIo::new(stream), answered);
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
async fn answer(
    mut request: hyper::Request<Incoming>,
    peer: IpAddr,
    service: &Service,
    progress: &Progress,
) -> Response {
    let is_post = *request.method() == Method::POST;
    let is_served = [Method::GET, Method::HEAD].contains(request.method());
    if !(is_served || is_post && service.offer.takes_forms) {
        return match service.offer.takes_forms {
            true => Response::text(405, "only GET, HEAD and POST are served\n")
                .with(&[("allow", "GET, HEAD, POST")]),
            false => Response::text(405, "only GET and HEAD are served\n").with(&[("allow", "GET, HEAD")]),
        };
    }
    let form = match is_post {
        true => match form::read(&mut request).await {
            Ok(form) => Some(form),
            Err(refused) => return refused,
        },
        false => None,
    };
    // Until then it may make way for another.
    progress.asked();
    let uri = request.uri();
    let request = Request {
        path: uri.path().to_owned(),
        query: uri.query().unwrap_or_default().to_owned(),
        host: host(&request),
        is_from_another_site: is_from_another_site(&request),
        is_from_own_page: form::is_from_own_page(&request, service.offer.tls.is_some()),
        cookies: cookies(&request),
        peer: Some(peer),
        form,
    };
    let (reply, answered) = oneshot::channel();
    // Where there is no room for it, nobody answers it either.
    let _ = service.calls.try_send(Call { request, reply });
    let answered = match timeout(LOOP_PATIENCE, answered).await {
        Ok(Ok(response)) => timeout(LATER, response.settled()).await.ok().flatten(),
        _ => None,
    };
    answered.unwrap_or_else(|| Response::text(503, "the program does not answer now\n"))
}

/// All that the client sends as cookies; those that are no text are none.
fn cookies(request: &hyper::Request<Incoming>) -> String {
    let sent = request.headers().get_all(COOKIE).iter();
    sent.filter_map(|cookies| cookies.to_str().ok()).collect::<Vec<_>>().join("; ")
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

fn whole(response: Response, starts: &Mutex<Option<oneshot::Sender<Ending>>>) -> hyper::Response<Content> {
    let (content, ending) = response.body.open();
    let mut starts = starts.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some((ending, starts)) = ending.zip(starts.take()) {
        // The other end is in `limit`, which lasts as long as this.
        let _ = starts.send(ending);
    }
    let mut whole = hyper::Response::new(content);
    *whole.status_mut() = StatusCode::from_u16(response.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
    whole.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static(response.kind));
    for (name, value) in response.headers {
        whole.headers_mut().insert(HeaderName::from_static(name), HeaderValue::from_static(value));
    }
    for (name, value) in response.own_headers {
        // The program makes them of what it has read itself: what is no header is none of its own.
        if let Ok(value) = HeaderValue::try_from(value) {
            whole.headers_mut().insert(HeaderName::from_static(name), value);
        }
    }
    whole
}
