//! The body of a POST: a form of a browser, which comes at once.

use std::future::poll_fn;
use std::pin::Pin;

use hyper::body::{Body as _, Incoming};
use hyper::header::{CONTENT_TYPE, HOST, HeaderName, ORIGIN};
use tokio::time::timeout;

use super::Response;
use super::connection::REQUEST;

/// The longest form: a piece of a recording has 64 KiB, with what it is a piece of. One that names twenty steps in letters of three bytes each has 11.
pub(super) const FORM_BYTES: usize = 68 << 10;

const FORM: &str = "application/x-www-form-urlencoded";

/// Reads a form, or answers why it is not read.
pub(super) async fn read(request: &mut hyper::Request<Incoming>) -> Result<Vec<u8>, Response> {
    let kind = request.headers().get(CONTENT_TYPE).and_then(|kind| kind.to_str().ok()).unwrap_or_default();
    let kind = kind.split(';').next().unwrap_or_default().trim();
    if !kind.eq_ignore_ascii_case(FORM) {
        return Err(Response::text(415, "only forms are taken\n"));
    }
    match timeout(REQUEST, whole(request.body_mut())).await {
        Ok(read) => read,
        Err(_) => Err(Response::text(408, "the form came too slowly\n")),
    }
}

async fn whole(body: &mut Incoming) -> Result<Vec<u8>, Response> {
    let mut read = Vec::new();
    let mut is_too_long = body.size_hint().lower() > FORM_BYTES as u64;
    while !is_too_long && let Some(frame) = poll_fn(|context| Pin::new(&mut *body).poll_frame(context)).await
    {
        let frame = frame.map_err(|_| Response::text(400, "the form did not come whole\n"))?;
        if let Ok(bytes) = frame.into_data() {
            read.extend_from_slice(&bytes);
        }
        is_too_long = read.len() > FORM_BYTES;
    }
    if is_too_long {
        Err(Response::text(413, "the form is too long: go back, and write or choose less at once\n"))
    } else {
        Ok(read)
    }
}

/// Whether the browser says that a page of this very server sends the form. Every browser of today says so with a form, and a program that says
/// nothing is none of them.
pub(super) fn is_from_own_page(request: &hyper::Request<Incoming>, is_tls: bool) -> bool {
    let only = |name: HeaderName| {
        let mut values = request.headers().get_all(name).iter();
        values.next().filter(|_| values.next().is_none()).map(|value| value.as_bytes())
    };
    let scheme: &[u8] = if is_tls { b"https://" } else { b"http://" };
    let is_own = match (only(ORIGIN), only(HOST)) {
        (Some(origin), Some(host)) => {
            origin.strip_prefix(scheme).is_some_and(|name| name.eq_ignore_ascii_case(host))
        }
        _ => false,
    };
    let site = HeaderName::from_static("sec-fetch-site");
    is_own && (!request.headers().contains_key(&site) || only(site) == Some(b"same-origin"))
}
