//! What a client reads: bytes that are there, or a feed that goes on.

use std::convert::Infallible;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::task::{Context, Poll};
use std::time::{Duration, Instant};

use hyper::body::{Body, Bytes, Frame, SizeHint};
use tokio::sync::{mpsc, oneshot};

use super::Response;

/// Messages that wait for a client. One that does not read for so long is cut off.
const WAITING: usize = 64;

/// Bytes that wait for a client, unless one message alone is larger. A hundred deaf clients must not cost the machine its memory.
const WAITING_BYTES: usize = 1 << 20;

/// How often a sender looks whether its client has read.
const LOOK: Duration = Duration::from_millis(2);

/// The body of a [`super::Response`], before its client is there.
#[derive(Debug)]
pub(super) enum Sent {
    Whole(Vec<u8>),
    Feed {
        messages: Messages,
        ending: Ending,
    },
    /// The whole answer comes later.
    Later(oneshot::Receiver<Response>),
}

/// The receiving end of a feed.
#[derive(Debug)]
pub(super) struct Messages {
    messages: mpsc::Receiver<Bytes>,
    /// Bytes that wait.
    waiting: Arc<AtomicUsize>,
}

impl Messages {
    fn poll(&mut self, context: &mut Context<'_>) -> Poll<Option<Bytes>> {
        let next = self.messages.poll_recv(context);
        if let Poll::Ready(Some(message)) = &next {
            self.waiting.fetch_sub(message.len(), Ordering::Relaxed);
        }
        next
    }
}

impl Sent {
    /// What hyper sends, and what ends it if it has no end of its own.
    pub(super) fn open(self) -> (Content, Option<Ending>) {
        match self {
            Self::Whole(bytes) => (Content::Whole(Some(bytes.into())), None),
            Self::Feed { messages, ending } => (Content::Feed(messages), Some(ending)),
            // What is opened has been waited for.
            Self::Later(_) => (Content::Whole(None), None),
        }
    }
}

/// The sending end of an answer without an end. The client's connection ends when this is dropped.
#[derive(Debug)]
pub struct Feed {
    messages: mpsc::Sender<Bytes>,
    /// Bytes that wait.
    waiting: Arc<AtomicUsize>,
    /// Its drop is seen also where the client does not read, and the messages stand still.
    _open: oneshot::Sender<Infallible>,
}

impl Feed {
    pub(super) fn new() -> (Self, Sent) {
        let (send, messages) = mpsc::channel(WAITING);
        let (open, ending) = oneshot::channel();
        let waiting = Arc::<AtomicUsize>::default();
        let messages = Messages { messages, waiting: Arc::clone(&waiting) };
        (Self { messages: send, waiting, _open: open }, Sent::Feed { messages, ending: Ending(ending) })
    }

    /// Sends these bytes, and waits for nothing. False where the client has left, or does not read: the feed is then to be dropped.
    #[must_use]
    pub fn send(&self, message: impl Into<Bytes>) -> bool {
        let message = message.into();
        let before = self.waiting.fetch_add(message.len(), Ordering::Relaxed);
        let has_room = before == 0 || before + message.len() <= WAITING_BYTES;
        has_room && self.messages.try_send(message).is_ok()
    }

    /// As [`Feed::send`], and waits in this thread for so long for a client that reads slowly. For a file, which waits for its reader.
    #[must_use]
    pub fn send_within(&self, patience: Duration, message: impl Into<Bytes>) -> bool {
        let (message, until) = (message.into(), Instant::now() + patience);
        while !self.messages.is_closed() {
            if self.messages.capacity() > 0
                && self.waiting.load(Ordering::Relaxed) + message.len() <= WAITING_BYTES
            {
                return self.send(message);
            }
            if Instant::now() >= until {
                return false;
            }
            std::thread::sleep(LOOK);
        }
        false
    }

    /// Ends it when all of it was read, or after this time.
    pub fn end_within(self, patience: Duration) {
        let until = Instant::now() + patience;
        while self.waiting.load(Ordering::Relaxed) > 0 && !self.messages.is_closed() && Instant::now() < until
        {
            std::thread::sleep(LOOK);
        }
    }
}

/// The sending end of an answer that comes later, from whatever thread has it. Where it is dropped, the client is told that nobody answers.
#[derive(Debug)]
pub struct Later(oneshot::Sender<Response>);

impl Later {
    pub(super) fn new() -> (Self, Sent) {
        let (send, receive) = oneshot::channel();
        (Self(send), Sent::Later(receive))
    }

    /// Answers; the headers are those of the answer that promised this one.
    pub fn send(self, response: Response) {
        // A client that has left needs none.
        let _ = self.0.send(response);
    }

    /// Whether nobody waits for it any more.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.0.is_closed()
    }
}

/// Tells when a feed is dropped.
#[derive(Debug)]
pub(super) struct Ending(oneshot::Receiver<Infallible>);

impl Ending {
    pub(super) async fn wait(self) {
        // Nothing is ever sent.
        let _ = self.0.await;
    }
}

/// A body as hyper reads it.
#[derive(Debug)]
pub(super) enum Content {
    Whole(Option<Bytes>),
    Feed(Messages),
}

impl Body for Content {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        let next = match self.get_mut() {
            Self::Whole(bytes) => Poll::Ready(bytes.take()),
            Self::Feed(messages) => messages.poll(context),
        };
        next.map(|bytes| bytes.map(|bytes| Ok(Frame::data(bytes))))
    }

    fn is_end_stream(&self) -> bool {
        matches!(self, Self::Whole(None))
    }

    fn size_hint(&self) -> SizeHint {
        match self {
            Self::Whole(bytes) => SizeHint::with_exact(bytes.as_ref().map_or(0, Bytes::len) as u64),
            Self::Feed(_) => SizeHint::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sends until a feed refuses, and returns how many messages it has taken.
    fn taken(feed: &Feed, message: &Bytes) -> usize {
        (0..2 * WAITING).take_while(|_| feed.send(message.clone())).count()
    }

    #[test]
    fn a_feed_keeps_no_more_than_its_bytes_and_takes_any_message_alone() {
        let (feed, _sent) = Feed::new();
        assert_eq!(taken(&feed, &Bytes::from(vec![7; WAITING_BYTES / 4])), 4);
        let (feed, _sent) = Feed::new();
        assert_eq!(taken(&feed, &Bytes::from(vec![7; 2 * WAITING_BYTES])), 1);
        let (feed, _sent) = Feed::new();
        assert_eq!(taken(&feed, &Bytes::from_static(b"beat")), WAITING);
    }

    #[test]
    fn what_was_read_makes_room() {
        let (feed, sent) = Feed::new();
        let Sent::Feed { mut messages, .. } = sent else { unreachable!("a feed was made") };
        let mut context = Context::from_waker(std::task::Waker::noop());
        for _ in 0..10 {
            assert!(feed.send(vec![7; WAITING_BYTES]));
            assert!(messages.poll(&mut context).is_ready());
        }
    }
}
