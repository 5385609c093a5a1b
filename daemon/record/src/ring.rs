//! What was received last, in memory of a fixed size: pictures of some seconds, and everything else for as long as a job lasts.

use std::collections::VecDeque;

use crate::topic::Topic;
use crate::writer::Entry;

/// What an entry takes beside its bytes: its place in the queue and the head of its allocation.
const HEAD: usize = 96;

/// The newest entries.
#[derive(Debug)]
pub struct Ring {
    pictures: Part,
    others: Part,
    /// The order in which the next one was received.
    next: u64,
}

#[derive(Debug)]
struct Part {
    entries: VecDeque<(u64, Entry)>,
    bytes: usize,
    limit: usize,
}

impl Part {
    fn new(limit: usize) -> Self {
        Self { entries: VecDeque::new(), bytes: 0, limit }
    }

    fn push(&mut self, order: u64, entry: Entry) {
        self.bytes += HEAD + entry.data.len();
        self.entries.push_back((order, entry));
        while self.bytes > self.limit
            && let Some((_, oldest)) = self.entries.pop_front()
        {
            self.bytes -= HEAD + oldest.data.len();
        }
    }

    fn since(&self, begin_ns: u64) -> impl Iterator<Item = &(u64, Entry)> {
        self.entries.iter().filter(move |(_, entry)| entry.sent_ns >= begin_ns)
    }
}

impl Ring {
    /// A ring that takes so many bytes of memory for pictures, and so many for everything else.
    #[must_use]
    pub fn new(pictures: usize, others: usize) -> Self {
        Self { pictures: Part::new(pictures), others: Part::new(others), next: 0 }
    }

    /// Takes what was received; what is oldest goes.
    pub fn push(&mut self, entry: Entry) {
        let part = if entry.topic == Topic::Picture { &mut self.pictures } else { &mut self.others };
        part.push(self.next, entry);
        self.next += 1;
    }

    /// What was sent since these times, in the order in which it was received.
    #[must_use]
    pub fn since(&self, pictures_ns: u64, others_ns: u64) -> Vec<Entry> {
        let mut found: Vec<&(u64, Entry)> =
            self.pictures.since(pictures_ns).chain(self.others.since(others_ns)).collect();
        found.sort_by_key(|(order, _)| *order);
        found.into_iter().map(|(_, entry)| entry.clone()).collect()
    }

    /// The newest picture of a time that is not after this one.
    #[must_use]
    pub fn picture_at(&self, time_ns: u64) -> Option<&Entry> {
        let mut newest_first = self.pictures.entries.iter().rev().map(|(_, entry)| entry);
        newest_first.find(|entry| entry.time_ns <= time_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_ipc::Channel;

    fn entry(topic: Topic, sent_ns: u64, bytes: usize) -> Entry {
        Entry { topic, time_ns: sent_ns, sent_ns, data: vec![0; bytes].into() }
    }

    #[test]
    fn it_never_takes_more_than_it_may_and_keeps_the_newest_in_their_order() {
        let mut ring = Ring::new(10 * (HEAD + 100), 1000 * (HEAD + 10));
        for ns in 0..500 {
            ring.push(entry(Topic::Raw(Channel::Detections), ns, 10));
            ring.push(entry(Topic::Picture, ns, 100));
            assert!(ring.pictures.bytes <= ring.pictures.limit && ring.others.bytes <= ring.others.limit);
        }
        let found = ring.since(0, 480);
        let pictures = found.iter().filter(|entry| entry.topic == Topic::Picture).count();
        assert_eq!((pictures, found.len()), (10, 30));
        assert!(found.is_sorted_by_key(|entry| entry.sent_ns));
        assert_eq!(ring.picture_at(495).map(|entry| entry.sent_ns), Some(495));
        assert_eq!(ring.picture_at(400), None);
    }

    #[test]
    fn what_is_larger_than_it_is_not_kept() {
        let mut ring = Ring::new(50, 50);
        ring.push(entry(Topic::Picture, 1, 1000));
        assert!(ring.since(0, 0).is_empty());
        assert_eq!(ring.pictures.bytes, 0);
    }
}
