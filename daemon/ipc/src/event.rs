//! What ports tell each other besides the messages.
//!
//! A channel has two event services, so that nobody is woken by an event for somebody else. *Forward* leads from the writer to its readers, *back*
//! from the readers to the writer.

use crate::channel::Channel;
use crate::error::Error;
use crate::station::Transport;
use iceoryx2::port::listener::Listener;
use iceoryx2::port::notifier::Notifier;
use iceoryx2::prelude::*;
use shm_schemas::RoleId;
use std::os::fd::BorrowedFd;

/// Forward: a message was sent. Not used back.
pub(crate) const SAMPLE: usize = 0;
/// The other side came up. iceoryx2 sends it.
pub(crate) const UP: usize = 1;
/// The other side left in good order. iceoryx2 sends it.
pub(crate) const GONE: usize = 2;
/// The other side was found dead. iceoryx2 sends it, in the steward.
pub(crate) const DEAD: usize = 3;
/// Back: the reader of role `id - CAUGHT_UP` found its queue empty.
const CAUGHT_UP: usize = 16;
/// The largest event number: roles have numbers under 16.
pub(crate) const MAX_ID: usize = 31;

pub(crate) fn caught_up(role: RoleId) -> usize {
    CAUGHT_UP + usize::from(role.code())
}

/// The role that says `caught up` with this event.
pub(crate) fn caught_up_by(id: usize) -> Option<RoleId> {
    let code = id.checked_sub(CAUGHT_UP)?;
    RoleId::try_from(u8::try_from(code).ok()?).ok()
}

/// Hands every event that has come to `on_event`, and looks again until a look finds none.
///
/// The last look matters: iceoryx2 0.10.0 sends one datagram for any number of events and remembers that it did. When an event comes in the middle of
/// a look, the look may take its datagram while the memory of it stays. `poll` would then sleep through every further event. A look that finds
/// nothing has also reset that memory. With several notifiers one interleaving is left in which it has not; because of it, waits look again after
/// `wait::LOOK_AGAIN`.
pub(crate) fn drain(
    listener: &Listener<Transport>,
    channel: Channel,
    mut on_event: impl FnMut(usize),
) -> Result<(), Error> {
    loop {
        let found = listener
            .try_wait(|event| on_event(event.id.as_value()))
            .map_err(|e| Error::transport(channel, "looking for events", e))?;
        if found == 0 {
            return Ok(());
        }
    }
}

/// Wakes the other side. It is no error when a peer no longer listens or its socket is full.
pub(crate) fn notify(notifier: &Notifier<Transport>, channel: Channel, id: usize) -> Result<(), Error> {
    notifier
        .notify_with_custom_event_id(EventId::new(id))
        .map(|_| ())
        .map_err(|e| Error::transport(channel, "waking the other side", e))
}

/// The descriptor that becomes readable when an event comes.
pub(crate) fn fd(listener: &Listener<Transport>) -> BorrowedFd<'_> {
    // SAFETY: the listener owns the descriptor and keeps it open while it lives, and the borrow ends before the listener does.
    #[allow(unsafe_code)]
    unsafe {
        BorrowedFd::borrow_raw(listener.file_descriptor().native_handle())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_role_has_an_event_of_its_own() {
        for &role in RoleId::ALL {
            assert_eq!(caught_up_by(caught_up(role)), Some(role));
            assert!(caught_up(role) <= MAX_ID);
        }
        assert_eq!(caught_up_by(UP), None);
    }
}
