//! Connections that could not be made.
//!
//! iceoryx2 0.10.0 tries once to connect a reader with a writer, and again only when the list of readers or writers changes. Where that one try
//! fails, the two stay deaf to each other, in silence. It does where a process has no file descriptor left for a moment. Each port therefore has an
//! alarm that iceoryx2 raises. Then the list is changed. A reader is recreated, and a writer, which must keep its history and its other readers, lets
//! a reader come and go.

use crate::service::{Header, Payload, PublishSubscribe, Services};
use crate::station::Transport;
use iceoryx2::port::publisher::Publisher;
use iceoryx2::port::update_connections::UpdateConnections;
use iceoryx2::port::{DegradationAction, DegradationCause, DegradationInfo};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Between two tries: what is missing is often missing for a while.
const TRY_AGAIN: Duration = Duration::from_millis(100);

/// Raised when a connection of a port could not be made.
#[derive(Debug, Default)]
pub(crate) struct Alarm {
    raised: Arc<AtomicBool>,
    tried: Option<Instant>,
}

impl Alarm {
    /// What iceoryx2 calls.
    pub(crate) fn handler(
        &self,
    ) -> impl Fn(DegradationCause, &DegradationInfo) -> DegradationAction + Send + 'static {
        let raised = Arc::clone(&self.raised);
        move |_, _| {
            raised.store(true, Ordering::Relaxed);
            DegradationAction::Ignore
        }
    }

    /// Whether the connections must be tried again now. True once per [`TRY_AGAIN`] until that works.
    pub(crate) fn is_due(&mut self) -> bool {
        let is_due = self.raised.load(Ordering::Relaxed)
            && self.tried.is_none_or(|tried| tried.elapsed() >= TRY_AGAIN);
        if is_due {
            self.raised.store(false, Ordering::Relaxed);
            self.tried = Some(Instant::now());
        }
        is_due
    }

    /// That try has failed too.
    pub(crate) fn raise(&self) {
        self.raised.store(true, Ordering::Relaxed);
    }

    /// Lets a writer try again to connect the readers that it could not reach. They get its history. True when it has tried.
    pub(crate) fn reconnect<P: Payload + ?Sized, H: Header>(
        &mut self,
        publisher: &Publisher<Transport, P, H>,
        services: &Services<PublishSubscribe<P, H>>,
    ) -> bool {
        if !self.is_due() {
            return false;
        }
        let passer_by = services.messages.subscriber_builder().buffer_size(1).create();
        let has_tried = passer_by.is_ok();
        drop(passer_by);
        if !has_tried || publisher.update_connections().is_err() {
            self.raise();
        }
        has_tried
    }
}
