//! Counts losses by the numbers of the messages alone.

use shm_schemas::{MessageId, Stamp};

/// Writers whose numbers are followed at the same time: the maximum number of writers of any channel.
const EPOCHS: usize = 16;

/// What the number of a message says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arrival {
    /// It has not come before.
    New,
    /// It has come before: the history overlaps with what has been received.
    Again,
}

/// Follows `seq` per epoch.
#[derive(Debug, Default)]
pub(crate) struct LossCounter {
    /// The newest message of each epoch. A new epoch replaces the oldest one.
    newest: [MessageId; EPOCHS],
    next: usize,
    /// Messages that were sent and not received.
    pub(crate) lost: u64,
    /// Messages received.
    pub(crate) received: u64,
    /// Epochs that began while listening, after the first.
    pub(crate) restarts: u32,
}

impl LossCounter {
    /// Whether a message of this epoch has come before.
    pub(crate) fn knows(&self, epoch: u64) -> bool {
        self.newest_of(epoch) != 0
    }

    /// The newest `seq` of this epoch; 0 where nothing of it has come.
    pub(crate) fn newest_of(&self, epoch: u64) -> u64 {
        let known = self.newest.iter().find(|known| known.epoch == epoch && known.seq != 0);
        known.map_or(0, |known| known.seq)
    }

    /// Notes a message. `from_start`: if its epoch is new, this reader was there for every message of it.
    pub(crate) fn note(&mut self, stamp: &Stamp, from_start: bool) -> Arrival {
        let known = self.newest.iter_mut().find(|known| known.epoch == stamp.epoch && known.seq != 0);
        match known {
            Some(newest) if stamp.seq <= newest.seq => return Arrival::Again,
            Some(newest) => {
                self.lost += stamp.seq - newest.seq - 1;
                newest.seq = stamp.seq;
            }
            None => {
                if from_start {
                    self.lost += stamp.seq.saturating_sub(1);
                }
                self.newest[self.next] = stamp.id();
                self.next = (self.next + 1) % EPOCHS;
                self.restarts += u32::from(self.received > 0);
            }
        }
        self.received += 1;
        Arrival::New
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn feed(numbers: &[(u64, u64)]) -> LossCounter {
        let mut counter = LossCounter::default();
        for &(epoch, seq) in numbers {
            counter.note(&Stamp { epoch, seq, ..Stamp::default() }, false);
        }
        counter
    }

    #[test]
    fn what_is_missing_at_the_start_of_an_epoch_that_began_while_listening_is_a_loss() {
        let mut counter = feed(&[(7, 100)]);
        counter.note(&Stamp { epoch: 8, seq: 4, ..Stamp::default() }, true);
        assert_eq!((counter.lost, counter.restarts), (3, 1));
    }

    #[test]
    fn a_gap_in_the_numbers_is_a_loss() {
        assert_eq!(feed(&[(7, 1), (7, 2), (7, 5), (7, 6)]).lost, 2);
    }

    #[test]
    fn what_was_sent_before_the_reader_came_is_no_loss() {
        assert_eq!(feed(&[(7, 100), (7, 101)]).lost, 0);
    }

    #[test]
    fn each_writer_is_counted_for_itself() {
        let counter = feed(&[(7, 1), (9, 1), (7, 2), (9, 3)]);
        assert_eq!((counter.lost, counter.received, counter.restarts), (1, 4, 1));
    }

    #[test]
    fn a_message_that_comes_twice_counts_once() {
        let counter = feed(&[(7, 1), (7, 2), (7, 1), (7, 2), (7, 3)]);
        assert_eq!((counter.lost, counter.received), (0, 3));
    }
}
