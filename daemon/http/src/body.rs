//! What a client reads: bytes that are there, or a feed that goes on.

use std::convert::Infallible;
use std::pin::Pin;
use std::task::{Context, Poll};

use hyper::body::{Body, Bytes, Frame, SizeHint};
use tokio::sync::{mpsc, oneshot};

/// Messages that wait for a client. One that does not read for so long is cut off.
const WAITING: usize = 64;

/// The body of a [`super::Response`], before its client is there.
#[derive(Debug)]
pub(super) enum Sent {
    Whole(Vec<u8>),
    Feed { messages: mpsc::Receiver<Bytes>, ending: Ending },
}

impl Sent {
    /// What hyper sends, and what ends it if it has no end of its own.
    pub(super) fn open(self) -> (Content, Option<Ending>) {
        match self {
            Self::Whole(bytes) => (Content::Whole(Some(bytes.into())), None),
            Self::Feed { messages, ending } => (Content::Feed(messages), Some(ending)),
        }
    }
}

/// The sending end of an answer without an end. The client's connection ends when this is dropped.
#[derive(Debug)]
pub struct Feed {
    messages: mpsc::Sender<Bytes>,
    /// Its drop is seen also where the client does not read, and the messages stand still.
    _open: oneshot::Sender<Infallible>,
}

impl Feed {
    pub(super) fn new() -> (Self, Sent) {
        let (send, messages) = mpsc::channel(WAITING);
        let (open, ending) = oneshot::channel();
        (Self { messages: send, _open: open }, Sent::Feed { messages, ending: Ending(ending) })
    }

    /// Sends these bytes, and waits for nothing. False where the client has left, or does not read: the feed is then to be dropped.
    #[must_use]
    pub fn send(&self, message: impl Into<Vec<u8>>) -> bool {
        self.messages.try_send(Bytes::from(message.into())).is_ok()
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
    Feed(mpsc::Receiver<Bytes>),
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
            Self::Feed(messages) => messages.poll_recv(context),
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
