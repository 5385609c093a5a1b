//! What the judge has said, in the order in which it was said.
//!
//! Verdicts and what the judge says of itself come in two channels, and a board that lags finds much in both. Whoever took one channel before the other
//! would give a fault to the wrong piece, or clear it.

use shm_schemas::{Judging, Verdict};

/// A message of the judge.
#[derive(Clone, Debug)]
pub enum Said {
    /// What it has decided.
    Verdict(Box<Verdict>),
    /// What it says of itself.
    Judging(Box<Judging>),
}

impl Said {
    /// When it was sent, CLOCK_MONOTONIC.
    fn sent_ns(&self) -> u64 {
        match self {
            Self::Verdict(verdict) => verdict.stamp.sent_ns,
            Self::Judging(judging) => judging.stamp.sent_ns,
        }
    }
}

/// Messages that have come and were not taken yet.
#[derive(Debug, Default)]
pub struct Inbox(Vec<Said>);

impl Inbox {
    /// A message has come.
    pub fn put(&mut self, said: Said) {
        self.0.push(said);
    }

    /// Takes what was sent before this time, the oldest first. Give the time before both channels were read: what was sent while they were may have
    /// come from one of them only, and waits for the next time.
    pub fn take_until(&mut self, until_ns: u64) -> Vec<Said> {
        // Of two that were sent at once the verdict is the first: it was put in first.
        self.0.sort_by_key(Said::sent_ns);
        let count = self.0.partition_point(|said| said.sent_ns() <= until_ns);
        self.0.drain(..count).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(sent_ns: u64) -> Said {
        let mut verdict = Verdict::NONE;
        verdict.stamp.sent_ns = sent_ns;
        Said::Verdict(Box::new(verdict))
    }

    fn judging(sent_ns: u64) -> Said {
        let mut judging = Judging::default();
        judging.stamp.sent_ns = sent_ns;
        Said::Judging(Box::new(judging))
    }

    /// The messages as letters and times.
    fn told(said: &[Said]) -> Vec<(char, u64)> {
        let kind = |said: &Said| if matches!(said, Said::Verdict(_)) { 'v' } else { 'j' };
        said.iter().map(|said| (kind(said), said.sent_ns())).collect()
    }

    #[test]
    fn messages_of_both_channels_come_in_the_order_of_their_sending() {
        let mut inbox = Inbox::default();
        for said in [verdict(1), verdict(3), verdict(4), judging(2), judging(4), judging(5)] {
            inbox.put(said);
        }
        let expected = [('v', 1), ('j', 2), ('v', 3), ('v', 4), ('j', 4), ('j', 5)];
        assert_eq!(told(&inbox.take_until(9)), expected);
        assert_eq!(told(&inbox.take_until(9)), []);
    }

    #[test]
    fn what_was_sent_while_the_channels_were_read_waits() {
        let mut inbox = Inbox::default();
        inbox.put(verdict(8));
        inbox.put(judging(6));
        assert_eq!(told(&inbox.take_until(7)), [('j', 6)]);
        inbox.put(judging(7));
        assert_eq!(told(&inbox.take_until(9)), [('j', 7), ('v', 8)]);
    }
}
