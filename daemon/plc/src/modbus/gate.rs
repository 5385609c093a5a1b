//! The gate between a client's bytes and the Modbus decoder.
//!
//! The decoder of `tokio-modbus` 0.17 ends the connection without an answer at the first malformed request. It computes `quantity * 2` in 16 bits,
//! which panics in a build with overflow checks. So no malformed request may reach it. The gate cuts the stream into frames, and passes one
//! well-formed frame on at a time. It answers a malformed one with the exception that the Modbus specification names. A connection ends when its
//! stream cannot be cut into frames any more, or when no complete request came within the idle timeout.

use std::future::Future;
use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::time::{Instant, Sleep, sleep};

use super::counters::Counters;

/// Bytes before the PDU: transaction, protocol, length and unit (Modbus Messaging on TCP/IP 1.0b, 3.1.3).
const HEADER: usize = 7;
/// Maximum bytes of a PDU (Modbus Application Protocol 1.1b3, 4.1).
const PDU: usize = 253;
/// Maximum bytes of a frame on TCP.
const FRAME: usize = HEADER + PDU;
/// Maximum registers of one read (6.3, 6.4) and of one write (6.12).
const MAX_READ: u16 = 125;
const MAX_WRITE: u16 = 123;

const ILLEGAL_FUNCTION: u8 = 1;
const ILLEGAL_DATA_VALUE: u8 = 3;

/// The functions that are served.
pub(super) const READ_HOLDING: u8 = 3;
pub(super) const READ_INPUT: u8 = 4;
pub(super) const WRITE_SINGLE: u8 = 6;
pub(super) const WRITE_MULTIPLE: u8 = 16;

/// A connection behind the gate.
pub(super) struct Gate<S> {
    stream: S,
    counters: Arc<Counters>,
    idle: Duration,
    timer: Pin<Box<Sleep>>,
    /// Bytes that have come and are not cut into frames yet: the first `filled`.
    inbox: Box<[u8; FRAME]>,
    filled: usize,
    /// What is still to be passed on of the frame at the head of the inbox.
    passing: std::ops::Range<usize>,
    /// What is still to be sent of an exception.
    answer: Vec<u8>,
}

impl<S> Gate<S> {
    /// Must be called inside a tokio runtime: it starts the idle timer.
    pub(super) fn new(stream: S, idle: Duration, counters: Arc<Counters>) -> Self {
        Self {
            stream,
            counters,
            idle,
            timer: Box::pin(sleep(idle)),
            inbox: Box::new([0; FRAME]),
            filled: 0,
            passing: 0..0,
            answer: Vec::new(),
        }
    }

    fn timed_out(&mut self, cx: &mut Context<'_>) -> io::Result<()> {
        if self.timer.as_mut().poll(cx).is_pending() {
            return Ok(());
        }
        Counters::add(&self.counters.idle_closed);
        Err(io::Error::new(io::ErrorKind::TimedOut, "no complete request within the idle timeout"))
    }

    /// The length of the first frame in the inbox, once all of it has come.
    fn whole_frame(&self) -> io::Result<Option<usize>> {
        if self.filled < HEADER {
            return Ok(None);
        }
        let protocol = u16::from_be_bytes([self.inbox[2], self.inbox[3]]);
        // The length counts the unit and the PDU, and a PDU has at least its function.
        let length = usize::from(u16::from_be_bytes([self.inbox[4], self.inbox[5]]));
        if protocol != 0 || !(2..=PDU + 1).contains(&length) {
            Counters::add(&self.counters.unframed);
            return Err(io::Error::new(io::ErrorKind::InvalidData, "not a Modbus TCP frame"));
        }
        let frame = HEADER - 1 + length;
        Ok((self.filled >= frame).then_some(frame))
    }

    fn remove(&mut self, bytes: usize) {
        self.inbox.copy_within(bytes..self.filled, 0);
        self.filled -= bytes;
    }

    /// Passes on what there is room for: the decoder's buffer may hold less than a frame.
    fn pass_on(&mut self, out: &mut ReadBuf<'_>) {
        let bytes = self.passing.len().min(out.remaining());
        let end = self.passing.start + bytes;
        out.put_slice(&self.inbox[self.passing.start..end]);
        self.passing.start = end;
        if self.passing.is_empty() {
            self.remove(end);
            self.passing = 0..0;
        }
    }

    /// Lets the frame through, or prepares the exception that answers it.
    fn check(&mut self, frame: usize) {
        self.timer.as_mut().reset(Instant::now() + self.idle);
        match exception(&self.inbox[HEADER..frame]) {
            None => {
                Counters::add(&self.counters.requests);
                self.passing = 0..frame;
            }
            Some(code) => {
                Counters::add(&self.counters.malformed);
                let function = self.inbox[HEADER] | 0x80;
                self.answer.extend_from_slice(&self.inbox[..4]);
                self.answer.extend_from_slice(&[0, 3, self.inbox[6], function, code]);
                self.remove(frame);
            }
        }
    }
}

/// The exception that answers a malformed request.
fn exception(pdu: &[u8]) -> Option<u8> {
    let word = |at: usize| pdu.get(at..at + 2).map(|two| u16::from_be_bytes([two[0], two[1]]));
    let well_formed = match pdu.first().copied() {
        Some(READ_HOLDING | READ_INPUT) => {
            pdu.len() == 5 && word(3).is_some_and(|quantity| (1..=MAX_READ).contains(&quantity))
        }
        Some(WRITE_SINGLE) => pdu.len() == 5,
        Some(WRITE_MULTIPLE) => word(3).is_some_and(|quantity| {
            let bytes = usize::from(quantity) * 2;
            (1..=MAX_WRITE).contains(&quantity)
                && pdu.len() == 6 + bytes
                && pdu.get(5).copied().map(usize::from) == Some(bytes)
        }),
        _ => return Some(ILLEGAL_FUNCTION),
    };
    (!well_formed).then_some(ILLEGAL_DATA_VALUE)
}

impl<S: AsyncRead + AsyncWrite + Unpin> AsyncRead for Gate<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        out: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let gate = &mut *self;
        loop {
            gate.timed_out(cx)?;
            while !gate.answer.is_empty() {
                let sent = ready!(Pin::new(&mut gate.stream).poll_write(cx, &gate.answer))?;
                if sent == 0 {
                    return Poll::Ready(Err(io::ErrorKind::WriteZero.into()));
                }
                gate.answer.drain(..sent);
            }
            if !gate.passing.is_empty() {
                gate.pass_on(out);
                return Poll::Ready(Ok(()));
            }
            if let Some(frame) = gate.whole_frame()? {
                gate.check(frame);
                continue;
            }
            let mut room = ReadBuf::new(&mut gate.inbox[gate.filled..]);
            ready!(Pin::new(&mut gate.stream).poll_read(cx, &mut room))?;
            let received = room.filled().len();
            if received == 0 {
                // The end of the stream. Half a frame is not a request.
                if gate.filled > 0 {
                    Counters::add(&gate.counters.unframed);
                }
                return Poll::Ready(Ok(()));
            }
            gate.filled += received;
        }
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Gate<S> {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        // A client that never reads its answers counts as idle.
        self.timed_out(cx)?;
        Pin::new(&mut self.stream).poll_write(cx, bytes)
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}
