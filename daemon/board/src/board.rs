//! What the board knows, and what it answers.

use std::collections::VecDeque;
use std::net::IpAddr;

use shm_schemas::{Health, JudgePhase, Judging, MessageId, RoleId, Verdict, VerdictLevel};

use crate::access::Access;
use crate::address::{Address, Page};
use crate::clips::Clips;
use crate::code::Code;
use crate::confirm::{Asked, Confirmations, Was};
use crate::desk::Desk;
use crate::film::Asks;
use crate::guard::Guard;
use crate::job::Job;
use crate::line::{Ill, Line};
use crate::look::{Finding, Look};
use crate::page;
use crate::picture::Picture;
use crate::piece::Piece;
use crate::pieces::Pieces;
use crate::shift::Shift;
use crate::told::fault_key;
use crate::viewers::Viewers;
use crate::watchers::{Version, Watchers};
use crate::words::{Table, Tables};

/// Events that are kept to be looked at: a busy shift has fewer faults. `andond history` has all.
const EVENTS: usize = 1000;

/// A browser without scripts asks twice a minute.
const LOOKED_NS: u64 = 60_000_000_000;

/// What the board has to know before anything comes.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The name of the station.
    pub station: String,
    /// The address that the server listens on.
    pub bind: IpAddr,
    /// Its port.
    pub port: u16,
    /// Further names by which browsers may call it.
    pub hosts: Vec<String>,
    /// Whether browsers reach it by TLS alone.
    pub is_secure: bool,
    /// All languages.
    pub tables: Tables,
    /// The code of the language of a page whose address names none.
    pub language: String,
    /// Whether the camera's picture is shown to the technician.
    pub picture: bool,
    /// Whether there is no line, but only a picture, with what to improve.
    pub is_look: bool,
    /// Whether an engineer may order anything.
    pub takes_orders: bool,
    /// The folder of the recordings that an engineer teaches from, for people.
    pub films: String,
    /// The roles of the station, in the order of the data path.
    pub roles: Vec<RoleId>,
    /// The codes of the log, in the order of their numbers.
    pub codes: Vec<Code>,
    /// The number of the code that belongs to a verdict, if there is one.
    pub code_of: fn(&Verdict) -> Option<u32>,
    /// A time as people there read it, from nanoseconds since 1970 UTC.
    pub local_time: fn(u64) -> String,
}

impl Settings {
    /// A board in English that shows pictures and has no roles, codes or clock. The rest is for its caller to say.
    #[must_use]
    pub fn new(station: &str, bind: IpAddr, port: u16) -> Self {
        Self {
            station: station.to_owned(),
            bind,
            port,
            hosts: Vec::new(),
            is_secure: false,
            tables: Tables::shipped(),
            language: "en".to_owned(),
            picture: true,
            is_look: false,
            takes_orders: false,
            films: String::new(),
            roles: Vec::new(),
            codes: Vec::new(),
            code_of: |_| None,
            local_time: |utc_ns| utc_ns.to_string(),
        }
    }
}

/// What happened before the board began.
#[derive(Clone, Debug, Default)]
pub struct Past {
    /// The verdicts that it [keeps](Board::keeps), in their order.
    pub verdicts: Vec<Verdict>,
    /// Begin and end of each time in which nobody watched, nanoseconds since 1970 UTC.
    pub unwatched: Vec<[u64; 2]>,
    /// What was said of which verdict, and by whom, in their order.
    pub confirmed: Vec<(MessageId, Was, String)>,
}

/// The board.
#[derive(Debug)]
pub struct Board {
    pub(crate) settings: Settings,
    pub(crate) guard: Guard,
    pub(crate) access: Access,
    /// What people ask the line to keep.
    pub(crate) asked: Vec<Asked>,
    pub(crate) confirmations: Confirmations,
    pub(crate) desk: Desk,
    pub(crate) line: Line,
    /// Why the line does not watch: the role that keeps it from that, and what is the matter with it.
    pub(crate) cause: Option<(RoleId, Ill)>,
    pub(crate) job: Job,
    pub(crate) judging: Option<Judging>,
    pub(crate) piece: Piece,
    pub(crate) pieces: Pieces,
    pub(crate) shift: Shift,
    /// What is to be looked at, and what became of each piece; newest first.
    pub(crate) events: VecDeque<Verdict>,
    /// The newest health of each role.
    pub(crate) healths: Vec<Health>,
    pub(crate) clips: Clips,
    pub(crate) asks: Asks,
    pub(crate) look: Look,
    pub(crate) watchers: Watchers,
    pub(crate) viewers: Viewers,
    /// Changes with whatever a page may show.
    pub(crate) version: u64,
    /// Changes with what somebody waits for: verdicts, what is said of them, and the state of the line.
    pub(crate) news: u64,
    /// When somebody asked for the list of events.
    pub(crate) asked_ns: Option<u64>,
    /// CLOCK_MONOTONIC.
    pub(crate) now_ns: u64,
}

impl Board {
    /// A board that knows nothing yet.
    #[must_use]
    pub fn new(settings: Settings) -> Self {
        Self {
            guard: Guard::new(settings.bind, settings.port, &settings.hosts),
            // Who is at the machine itself may read. From a network that takes a login.
            access: Access::new(settings.port, settings.is_secure, settings.bind.is_loopback()),
            asked: Vec::new(),
            confirmations: Confirmations::default(),
            desk: Desk::default(),
            settings,
            line: Line::default(),
            cause: None,
            job: Job::default(),
            judging: None,
            piece: Piece::default(),
            pieces: Pieces::default(),
            shift: Shift::default(),
            events: VecDeque::with_capacity(EVENTS),
            healths: Vec::new(),
            clips: Clips::default(),
            asks: Asks::default(),
            look: Look::default(),
            watchers: Watchers::default(),
            viewers: Viewers::default(),
            version: 0,
            news: 0,
            asked_ns: None,
            now_ns: 0,
        }
    }

    /// The names of the job in force.
    pub fn job(&mut self, job: Job) {
        self.job = job;
        self.version += 1;
    }

    /// What the judge says of itself.
    pub fn judging(&mut self, judging: &Judging) {
        let was_running = self.is_running();
        if self.judging.is_some_and(|known| known.model_hash != judging.model_hash) {
            self.piece.leave();
        }
        self.judging = Some(*judging);
        if self.is_running() && !was_running {
            self.piece.begin();
        }
        self.version += 1;
    }

    /// Whether the judge has said that it has no job.
    #[must_use]
    pub fn has_no_job(&self) -> bool {
        self.judging.is_some_and(|judging| judging.phase == JudgePhase::NoJob.code())
    }

    /// Whether a job has begun and has not ended.
    pub(crate) fn is_running(&self) -> bool {
        self.judging.is_some_and(|judging| judging.phase == JudgePhase::Running.code())
    }

    /// Whether it keeps this verdict to be looked for: right contacts and steps are none of that.
    #[must_use]
    pub fn keeps(verdict: &Verdict) -> bool {
        fault_key(verdict).is_some() || verdict.level() == Ok(VerdictLevel::Job)
    }

    /// What the journal has. What has come from the channel meanwhile follows.
    pub fn past(&mut self, past: &Past) {
        let came = std::mem::take(&mut self.events);
        self.pieces = self.pieces.uncounted();
        self.shift.forget_alarms();
        past.unwatched.iter().for_each(|span| self.shift.add_unwatched(*span));
        for (verdict, was, who) in &past.confirmed {
            if self.confirmations.of(*verdict).is_none() {
                self.confirmed(*verdict, *was, who);
            }
        }
        past.verdicts.iter().chain(came.iter().rev()).for_each(|verdict| self.keep(verdict));
        self.version += 1;
    }

    /// A verdict from the channel, which may have come from the journal already.
    pub fn verdict(&mut self, verdict: &Verdict) {
        self.piece.take(verdict, self.is_running());
        self.keep(verdict);
        self.version += 1;
    }

    fn keep(&mut self, verdict: &Verdict) {
        let id = verdict.stamp.id();
        if Self::keeps(verdict) && !self.events.iter().any(|event| event.stamp.id() == id) {
            self.news += 1;
            self.pieces.count(verdict);
            self.shift.take(verdict);
            self.events.truncate(EVENTS - 1);
            self.events.push_front(*verdict);
        }
    }

    /// What a role says of itself.
    pub fn health(&mut self, health: &Health) {
        self.healths.retain(|known| known.role != health.role);
        self.healths.push(*health);
        self.version += 1;
    }

    /// How the line is, and for the technician which role is the cause.
    pub fn line(&mut self, line: Line, cause: Option<(RoleId, Ill)>) {
        if (self.line, self.cause) != (line, cause) {
            self.shift.watch(!matches!(line, Line::Stopped(_)));
            (self.line, self.cause) = (line, cause);
            self.version += 1;
            self.news += 1;
        }
    }

    /// What the clock on the wall says, and when its day began: nanoseconds since 1970 UTC.
    pub fn clock(&mut self, now_utc_ns: u64, day_utc_ns: u64) {
        self.pieces.day(day_utc_ns);
        self.version += u64::from(self.shift.clock(now_utc_ns));
    }

    /// Which verdicts have clips.
    pub fn clips(&mut self, clips: Clips) {
        self.version += u64::from(self.clips != clips);
        self.clips = clips;
    }

    /// Whether somebody looks at the list of events, or did so a moment ago.
    #[must_use]
    pub fn is_looked_through(&self) -> bool {
        let asked = self.asked_ns.is_some_and(|asked_ns| self.now_ns.saturating_sub(asked_ns) < LOOKED_NS);
        asked || self.watchers.look_at(Page::Technician)
    }

    /// Whether a browser waits for the camera's picture.
    #[must_use]
    pub fn wants_picture(&self) -> bool {
        !self.viewers.is_empty()
    }

    /// The camera's picture as it is now. All who wait for one get it.
    pub fn picture(&mut self, picture: &Picture) {
        let viewers = std::mem::take(&mut self.viewers);
        viewers.show(|address| page::drawn(self, address, picture));
    }

    /// The event of this name.
    pub(crate) fn event(&self, name: &str) -> Option<&Verdict> {
        self.events.iter().find(|event| event.stamp.id().to_string() == name)
    }

    /// What the picture comes from, and what was found in it.
    pub fn look(&mut self, source: &str, findings: Vec<Finding>) {
        let look = Look { source: source.to_owned(), findings };
        self.version += u64::from(self.look != look);
        self.look = look;
    }

    /// Sends the browsers what has changed. The time is that of CLOCK_MONOTONIC.
    pub fn publish(&mut self, now_ns: u64) {
        let before = page::state(self);
        self.now_ns = now_ns;
        let is_another = u64::from(page::state(self) != before);
        self.version += is_another;
        self.news += is_another;
        let mut watchers = std::mem::take(&mut self.watchers);
        watchers.cut(|pass| !self.access.lasts(pass, now_ns));
        watchers.tell(Version { all: self.version, news: self.news }, now_ns, |address| {
            page::view(self, address)
        });
        self.watchers = watchers;
        self.viewers.give_up(now_ns);
    }

    /// The words of a page, and their language.
    pub(crate) fn words<'b>(&'b self, address: &'b Address) -> (&'b str, &'b Table) {
        let Settings { tables, language, .. } = &self.settings;
        let asked = tables.get(&address.lang).map(|table| (address.lang.as_str(), table));
        // The role has looked whether its own language is there.
        asked
            .or_else(|| tables.get(language).map(|table| (language.as_str(), table)))
            .unwrap_or(("en", tables.english()))
    }

    pub(crate) fn health_of(&self, role: RoleId) -> Option<&Health> {
        self.healths.iter().find(|health| health.role == role.code())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{right, settings};

    fn piece(seq: u64) -> Verdict {
        let mut verdict = right(VerdictLevel::Job, 0);
        verdict.stamp.seq = seq;
        verdict
    }

    #[test]
    fn what_the_journal_has_stands_before_what_came_meanwhile_and_counts_once() {
        let mut board = Board::new(settings());
        board.verdict(&piece(3));
        board.verdict(&piece(4));
        board.past(&Past { verdicts: [1, 2, 3].map(piece).to_vec(), ..Past::default() });
        board.verdict(&piece(4));
        let order: Vec<u64> = board.events.iter().map(|event| event.stamp.seq).collect();
        assert_eq!((order.as_slice(), board.pieces.good), ([4, 3, 2, 1].as_slice(), 4));
    }
}
