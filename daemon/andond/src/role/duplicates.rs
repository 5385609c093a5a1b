//! Logs that the marker of a part is in view twice. Which of the two is the part is not guessed, and the part counts as not seen.

use andon_host::config::{Config, Object};
use andon_host::log::{code, log};

/// What is in view twice for so many frames is no lucky pattern.
const FRAMES: u32 = 5;

/// When it was not in view twice for so long, in nanoseconds, somebody has taken the other print away. It is news when it comes again.
const GONE_NS: u64 = 2_000_000_000;

/// The markers that are or were in view twice.
pub(super) struct DuplicateMarkers<'a> {
    config: &'a Config,
    known: Vec<DuplicateMarker>,
}

struct DuplicateMarker {
    id: u16,
    frames: u32,
    newest_ns: u64,
}

impl<'a> DuplicateMarkers<'a> {
    pub(super) fn new(config: &'a Config) -> Self {
        Self { config, known: Vec::new() }
    }

    /// Takes the ids that a frame shows twice.
    pub(super) fn look(&mut self, twice: &[u16], now_ns: u64) {
        for id in self.news(twice, now_ns) {
            let object = self.config.objects.iter().find(|object| object.id == id);
            let name = object.map_or("", |object| object.name.as_str());
            let marker = object.and_then(Object::marker_id).unwrap_or(id);
            log!(code::MARKER_TWICE, { object = id }, "marker {marker} ({name}) is in view twice");
        }
    }

    /// Those of them that are news.
    fn news(&mut self, twice: &[u16], now_ns: u64) -> Vec<u16> {
        // The times of another source may begin anew.
        self.known
            .retain(|duplicate| now_ns >= duplicate.newest_ns && now_ns - duplicate.newest_ns < GONE_NS);
        let mut news = Vec::new();
        for &id in twice {
            let index = self.known.iter().position(|duplicate| duplicate.id == id).unwrap_or_else(|| {
                self.known.push(DuplicateMarker { id, frames: 0, newest_ns: now_ns });
                self.known.len() - 1
            });
            let duplicate = &mut self.known[index];
            duplicate.newest_ns = now_ns;
            duplicate.frames = duplicate.frames.saturating_add(1);
            if duplicate.frames == FRAMES {
                news.push(id);
            }
        }
        news
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duplicate_is_told_once_while_it_is_there_and_again_when_it_comes_back() {
        let config = Config::default();
        let mut duplicates = DuplicateMarkers::new(&config);
        let mut told = Vec::new();
        for frame in 0..600_u64 {
            // From the fifth to the seventh second there is one, except in every seventh frame; and one picture that looks like it.
            let is_there =
                (150..210).contains(&frame) && frame % 7 != 0 || (400..420).contains(&frame) || frame == 20;
            let twice: &[u16] = if is_there { &[5] } else { &[] };
            if !duplicates.news(twice, frame * 33_333_333).is_empty() {
                told.push(frame);
            }
        }
        assert_eq!(told, [155, 404]);
    }
}
