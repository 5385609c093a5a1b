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

    /// Returns what there is no room for any more.
    fn push(&mut self, order: u64, entry: Entry) -> Vec<(u64, Entry)> {
        self.bytes += HEAD + entry.data.len();
        self.entries.push_back((order, entry));
        let mut gone = Vec::new();
        while self.bytes > self.limit
            && let Some(oldest) = self.entries.pop_front()
        {
            self.bytes -= HEAD + oldest.1.data.len();
            gone.push(oldest);
        }
        gone
    }

    fn from(&self, order: u64) -> impl Iterator<Item = &(u64, Entry)> {
        self.entries.range(self.entries.partition_point(|(known, _)| *known < order)..)
    }
}

impl Ring {
    /// A ring with this many bytes of memory for pictures, and this many for everything else.
    #[must_use]
    pub fn new(pictures: usize, others: usize) -> Self {
        Self { pictures: Part::new(pictures), others: Part::new(others), next: 0 }
    }

    /// The place in the order of the next one.
    #[must_use]
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Takes what was received. What is oldest goes, and is returned.
    pub fn push(&mut self, entry: Entry) -> Vec<(u64, Entry)> {
        let part = if entry.topic == Topic::Picture { &mut self.pictures } else { &mut self.others };
        let gone = part.push(self.next, entry);
        self.next += 1;
        gone
    }

    /// What was received from this place in the order on and sent since these times, in the order in which it was received.
    #[must_use]
    pub fn since(&self, order: u64, pictures_ns: u64, others_ns: u64) -> Vec<Entry> {
        let pictures = self.pictures.from(order).filter(|(_, entry)| entry.sent_ns >= pictures_ns);
        let others = self.others.from(order).filter(|(_, entry)| entry.sent_ns >= others_ns);
        let mut found: Vec<&(u64, Entry)> = pictures.chain(others).collect();
        found.sort_by_key(|(order, _)| *order);
        found.into_iter().map(|(_, entry)| entry.clone()).collect()
    }

    /// What is no picture, from this place in the order on, up to the first that was not sent before this time.
    #[must_use]
    pub fn others_before(&self, order: u64, until_ns: u64) -> Vec<(u64, Entry)> {
        self.others.from(order).take_while(|(_, entry)| entry.sent_ns < until_ns).cloned().collect()
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
        let found = ring.since(0, 0, 480);
        let pictures = found.iter().filter(|entry| entry.topic == Topic::Picture).count();
        assert_eq!((pictures, found.len()), (10, 30));
        assert!(found.is_sorted_by_key(|entry| entry.sent_ns));
        assert_eq!(ring.picture_at(495).map(|entry| entry.sent_ns), Some(495));
        assert_eq!(ring.picture_at(400), None);
    }

    #[test]
    fn what_is_larger_than_it_is_not_kept() {
        let mut ring = Ring::new(50, 50);
        assert_eq!(ring.push(entry(Topic::Picture, 1, 1000)).len(), 1);
        assert!(ring.since(0, 0, 0).is_empty());
        assert_eq!(ring.pictures.bytes, 0);
    }
}
