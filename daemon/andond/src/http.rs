//! Reads a request of HTTP from a client that may be slow or hostile, for the small servers of a station: its metrics and the page of `andond look`.

use std::io::{self, ErrorKind, Read};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// What `parse` makes of the bytes that a client has sent, as soon as it makes something of them; `None` if it makes nothing of `size` bytes.
///
/// # Errors
/// A client that leaves, or is not done within `patience`.
pub(crate) fn receive<T>(
    stream: &mut TcpStream,
    size: usize,
    patience: Duration,
    parse: impl Fn(&[u8]) -> Option<T>,
) -> io::Result<Option<T>> {
    let until = Instant::now() + patience;
    let (mut inbox, mut filled) = (vec![0; size], 0);
    while filled < size {
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        stream.set_read_timeout(Some(left))?;
        let received = stream.read(&mut inbox[filled..])?;
        if received == 0 {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        filled += received;
        if let Some(request) = parse(&inbox[..filled]) {
            return Ok(Some(request));
        }
    }
    Ok(None)
}
