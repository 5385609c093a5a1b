//! One client: its request, the way to the loop and back, and the limits that keep it from costing others anything.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use http_body_util::Full;
use hyper::body::{Bytes, Incoming};
use hyper::header::{CONTENT_TYPE, HOST, HeaderName, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Semaphore, mpsc, oneshot};
use tokio::time::{sleep, timeout};

use super::{Call, Request, Response};

/// How long a client may take to send its request: a machine in the same hall needs milliseconds.
const REQUEST: Duration = Duration::from_secs(2);

/// Clients that are served at once; one more waits until one of them is done. Each may hold a request and an answer in memory.
const CLIENTS: usize = 64;

/// The whole of a connection, with the time in which a slow client reads its answer.
const CONNECTION: Duration = Duration::from_secs(10);

/// A loop that has not answered by then stands still: a role turns twenty times a second.
const LOOP_PATIENCE: Duration = Duration::from_secs(2);

/// The request of a browser without a body is shorter.
const REQUEST_BYTES: usize = 16 * 1024;

/// After a failure to accept, as when there are no file descriptors left.
const PAUSE: Duration = Duration::from_millis(100);

/// Serves every client, each beside the others, until it is dropped.
pub(super) async fn accept_all(listener: &TcpListener, calls: &mpsc::Sender<Call>) {
    let room = Arc::new(Semaphore::new(CLIENTS));
    // Nobody closes the semaphore.
    while let Ok(place) = Arc::clone(&room).acquire_owned().await {
        match listener.accept().await {
            Ok((stream, _)) => {
                let calls = calls.clone();
                // The runtime has one thread, and ends with it whatever still waits.
                tokio::spawn(async move {
                    serve(stream, calls).await;
                    drop(place);
                });
            }
            Err(error) => {
                tracing::debug!(%error, "a client was not accepted");
                sleep(PAUSE).await;
            }
        }
    }
}

async fn serve(stream: TcpStream, calls: mpsc::Sender<Call>) {
    let service = service_fn(|request: hyper::Request<Incoming>| {
        let calls = calls.clone();
        async move { Ok::<_, Infallible>(whole(answer(&request, &calls).await)) }
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(REQUEST)
        .max_buf_size(REQUEST_BYTES)
        .keep_alive(false)
        .serve_connection(TokioIo::new(stream), service);
    match timeout(CONNECTION, connection).await {
        Ok(Ok(())) => (),
        Ok(Err(error)) => tracing::debug!(%error, "a client was not answered"),
        Err(_) => tracing::debug!("a client took too long"),
    }
}

/// Lets the loop answer.
async fn answer(request: &hyper::Request<Incoming>, calls: &mpsc::Sender<Call>) -> Response {
    if request.method() != Method::GET {
        return Response::text(405, "only GET is served\n");
    }
    let request = Request { path: request.uri().path().to_owned(), host: host(request) };
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

fn whole(response: Response) -> hyper::Response<Full<Bytes>> {
    let mut whole = hyper::Response::new(Full::new(response.body.into()));
    *whole.status_mut() = StatusCode::from_u16(response.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
    whole.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static(response.kind));
    for (name, value) in response.headers {
        whole.headers_mut().insert(HeaderName::from_static(name), HeaderValue::from_static(value));
    }
    whole
}
