//! What became of the pieces: how many were right, wrong and not judged, and by which fault.

use std::collections::HashMap;
use std::fmt::Write as _;

use andon_core::verdict::{Level, Outcome};
use andon_journal::Entry;

use crate::clock::Clock;
use crate::tool::known_jobs::KnownJobs;
use crate::wire;

/// One job that was done.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) utc_ns: u64,
    pub(super) outcome: Outcome,
}

/// Everything that a summary says.
pub(super) struct Summary<'a> {
    known: &'a KnownJobs,
    /// In the order of time.
    pub(super) pieces: Vec<Piece>,
    /// How many pieces have each fault, of those that were wrong and of those that were not judged.
    pub(super) faults: HashMap<(bool, String), u32>,
    /// For how long nobody watched, and how often.
    unwatched_ns: u64,
    unwatched: u32,
    gaps: u32,
}

impl<'a> Summary<'a> {
    pub(super) fn new(known: &'a KnownJobs) -> Self {
        let faults = HashMap::new();
        Self { known, pieces: Vec::new(), faults, unwatched_ns: 0, unwatched: 0, gaps: 0 }
    }

    pub(super) fn add(&mut self, entry: &Entry) {
        match entry {
            Entry::Gap(_) => self.gaps += 1,
            Entry::NotWatching(blind) if blind.is_beside() => (),
            Entry::NotWatching(blind) => {
                self.unwatched += 1;
                let ended_ns = blind.ended_utc_ns.unwrap_or(blind.began_utc_ns);
                self.unwatched_ns += ended_ns.saturating_sub(blind.began_utc_ns);
            }
            Entry::Verdict(message) => {
                let Some(verdict) = wire::verdict::read(message).filter(|of| of.level == Level::Job) else {
                    return;
                };
                self.pieces.push(Piece { utc_ns: message.decided_utc_ns, outcome: verdict.outcome });
                if let Some(fault) = self.known.names(message.model_hash).fault(&verdict) {
                    *self.faults.entry((verdict.outcome == Outcome::Anomaly, fault)).or_default() += 1;
                }
            }
        }
    }

    pub(super) fn count(&self, outcome: Outcome) -> usize {
        self.pieces.iter().filter(|piece| piece.outcome == outcome).count()
    }

    /// The faults of the wrong pieces, or why pieces were not judged, the most frequent first.
    pub(super) fn faults(&self, of_wrong: bool) -> Vec<(&str, u32)> {
        let of_kind = self.faults.iter().filter(|((is_wrong, _), _)| *is_wrong == of_wrong);
        let mut faults: Vec<(&str, u32)> =
            of_kind.map(|((_, fault), count)| (fault.as_str(), *count)).collect();
        faults.sort_by_key(|(fault, count)| (std::cmp::Reverse(*count), *fault));
        faults
    }

    /// How many pieces there were, and when.
    pub(super) fn span(&self, clock: &Clock) -> String {
        let (Some(first), Some(last)) = (self.pieces.first(), self.pieces.last()) else {
            return "no piece was finished".to_owned();
        };
        let all = self.pieces.len();
        let [first, last] = [first, last].map(|piece| clock.date_time(piece.utc_ns));
        match all {
            1 => format!("1 piece at {last} ({})", clock.zone()),
            _ => format!("{all} pieces from {first} to {last} ({})", clock.zone()),
        }
    }

    pub(super) fn text(&self, clock: &Clock) -> String {
        let mut text = String::new();
        // Writing to a `String` cannot fail.
        macro_rules! line { ($($words:tt)*) => {{ let _ = writeln!(text, $($words)*); }}; }
        let all = self.pieces.len();
        line!("{}", self.span(clock));
        for (word, outcome) in
            [("right", Outcome::Ok), ("wrong", Outcome::Anomaly), ("not judged", Outcome::NotJudged)]
        {
            let count = self.count(outcome);
            line!("  {word:10} {count:6}  {:5.1} %", 100.0 * count as f64 / all.max(1) as f64);
        }
        for (title, of_wrong) in [("wrong, by fault", true), ("not judged, by reason", false)] {
            let faults = self.faults(of_wrong);
            if !faults.is_empty() {
                line!("{title}");
            }
            for (fault, count) in faults {
                line!("  {count:6}  {fault}");
            }
        }
        if self.unwatched > 0 {
            let seconds = self.unwatched_ns / 1_000_000_000;
            let times =
                if self.unwatched == 1 { "once".to_owned() } else { format!("{} times", self.unwatched) };
            line!("nobody watched {times}, {} min {} s in all", seconds / 60, seconds % 60);
        }
        if self.gaps > 0 {
            let gaps = if self.gaps == 1 { "1 gap".to_owned() } else { format!("{} gaps", self.gaps) };
            line!("{gaps}: verdicts may be missing, `andond history` shows where");
        }
        text
    }
}
