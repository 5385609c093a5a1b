//! Sending as fast as the readers read, without a loss (`--speed max`).
//!
//! A paced writer sends at most a *burst* of W messages. Then it waits until each reader that it follows has said `caught up`: its queue was empty
//! just now. A reader says so every time it finds its queue empty after it has taken something. It also says so when it comes up, and when it hears
//! that a writer came up.
//!
//! Events are not messages: an event may be old. Nothing is lost all the same, because:
//!
//! 1. Before the first message of a burst the writer drains and forgets every event that has come so far.
//! 2. So an event that counts for burst k was raised after all of burst k-1 had been sent. When it was raised,
//!    the queue was empty, hence every message up to and including burst k-1 had left the queue.
//! 3. When the writer goes on after burst k, at most the W messages of burst k are in the queue; it then adds W.
//!    At most 2 W are ever in the queue, and 2 W <= buffer, so it never overflows. (`Qos::burst`; a test checks it.)
//!
//! It never hangs. After the last message of a burst is sent, the reader takes it. Then it finds its queue empty, after step 1 of this burst. That
//! event is still to come, or it has come and counts. An event that is raised in the middle of a burst only lets the writer go on earlier, within 3.
//! A reader that dies says nothing: the writer's wait ends at its deadline, and the reader's successor says `caught up` when it comes up.
//!
//! Each stage of the line paces its own channel. So a slow journal holds back the judge, the judge holds back encode, and in the end the recording
//! waits. Live sources are never paced: a stuck reader must not stop the line.

use shm_schemas::RoleId;

/// A set of roles, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Roles(u32);

impl Roles {
    fn of(roles: &[RoleId]) -> Self {
        Self(roles.iter().fold(0, |bits, role| bits | 1 << role.code()))
    }

    fn insert(&mut self, role: RoleId) {
        self.0 |= 1 << role.code();
    }

    fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

/// The state of a writer. One that follows nobody is live and always has room.
#[derive(Debug)]
pub(crate) struct Pace {
    follows: Roles,
    /// Readers whose queue was empty after the last burst; of a live writer, after the last message.
    caught_up: Roles,
    burst: usize,
    sent: usize,
}

impl Pace {
    /// A live writer, which never waits.
    pub(crate) fn live() -> Self {
        Self { follows: Roles::default(), caught_up: Roles::default(), burst: 0, sent: 0 }
    }

    /// From now on follows these readers; an empty list makes it live again. The first burst waits for them as well, because they may
    /// not be there yet. What they said while the writer was live counts: they do not say it twice.
    pub(crate) fn follow(&mut self, readers: &[RoleId], burst: usize) {
        (self.follows, self.burst, self.sent) = (Roles::of(readers), burst, burst);
    }

    fn is_live(&self) -> bool {
        self.follows == Roles::default()
    }

    /// A reader has found its queue empty.
    pub(crate) fn caught_up(&mut self, reader: RoleId) {
        self.caught_up.insert(reader);
    }

    /// The burst has been sent and its readers have caught up. The next may begin once what has come so far is forgotten (step 1).
    pub(crate) fn may_begin(&self) -> bool {
        self.sent >= self.burst && self.caught_up.contains(self.follows)
    }

    /// Begins the next burst.
    pub(crate) fn begin(&mut self) {
        self.sent = 0;
        self.caught_up = Roles::default();
    }

    /// Whether one more message may be sent now.
    pub(crate) fn has_room(&self) -> bool {
        self.is_live() || self.sent < self.burst
    }

    /// A message was sent.
    pub(crate) fn sent(&mut self) {
        if self.is_live() {
            self.caught_up = Roles::default();
        }
        self.sent = self.sent.saturating_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn following(readers: &[RoleId], burst: usize) -> Pace {
        let mut pace = Pace::live();
        pace.follow(readers, burst);
        pace
    }

    #[test]
    fn a_reader_that_came_up_before_the_writer_followed_it_is_not_waited_for_again() {
        let mut pace = Pace::live();
        pace.caught_up(RoleId::Encode);
        pace.follow(&[RoleId::Encode], 2);
        assert!(pace.may_begin());
    }

    #[test]
    fn a_reader_that_has_not_taken_the_last_live_message_is_waited_for() {
        let mut pace = Pace::live();
        pace.caught_up(RoleId::Encode);
        pace.sent();
        pace.follow(&[RoleId::Encode], 2);
        assert!(!pace.may_begin());
        pace.caught_up(RoleId::Encode);
        assert!(pace.may_begin());
    }

    /// Explores the worst that asynchronous events can do, with a writer, a reader with a queue, and events that the writer sees late. It tries every
    /// interleaving of their steps up to a depth. The queue must never exceed the buffer.
    #[test]
    fn no_interleaving_of_writer_and_reader_overflows_two_bursts() {
        const BURST: usize = 2;

        #[derive(Clone, Copy)]
        struct World {
            sent_in_burst: usize,
            queued: usize,
            taken: bool,
            event: bool,
        }

        fn explore(world: World, depth: usize, worst: &mut usize, sent: usize, max_sent: &mut usize) {
            *worst = (*worst).max(world.queued);
            *max_sent = (*max_sent).max(sent);
            if depth == 0 {
                return;
            }
            let mut pace = following(&[RoleId::Encode], BURST);
            pace.sent = world.sent_in_burst;
            // The writer sends if it has room; otherwise it looks for the event and begins the next burst.
            if pace.has_room() {
                pace.sent();
                let next = World { sent_in_burst: pace.sent, queued: world.queued + 1, ..world };
                explore(next, depth - 1, worst, sent + 1, max_sent);
            } else if world.event {
                pace.caught_up(RoleId::Encode);
                assert!(pace.may_begin());
                pace.begin();
                let next = World { sent_in_burst: 0, event: false, ..world };
                explore(next, depth - 1, worst, sent, max_sent);
            }
            // The reader takes a message, or finds the queue empty and says so.
            if world.queued > 0 {
                let next = World { queued: world.queued - 1, taken: true, ..world };
                explore(next, depth - 1, worst, sent, max_sent);
            } else if world.taken {
                let next = World { taken: false, event: true, ..world };
                explore(next, depth - 1, worst, sent, max_sent);
            }
        }

        let start = World { sent_in_burst: BURST, queued: 0, taken: false, event: true };
        let (mut worst, mut max_sent) = (0, 0);
        explore(start, 24, &mut worst, 0, &mut max_sent);
        assert_eq!(worst, 2 * BURST, "two bursts are needed and are enough");
        assert!(max_sent >= 4 * BURST, "the exploration must go through several bursts: {max_sent}");
    }

    #[test]
    fn a_live_writer_never_waits() {
        let mut pace = Pace::live();
        for _ in 0..10_000 {
            assert!(pace.has_room());
            pace.sent();
        }
    }

    #[test]
    fn a_writer_waits_for_every_reader_that_it_follows() {
        let mut pace = following(&[RoleId::Journal, RoleId::Plc], 1);
        pace.caught_up(RoleId::Journal);
        pace.caught_up(RoleId::Judge);
        assert!(!pace.may_begin());
        pace.caught_up(RoleId::Plc);
        assert!(pace.may_begin());
    }
}
