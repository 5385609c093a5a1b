//! When something is recorded: always, or around verdicts. Without a clock, a channel or a disk.

use std::collections::VecDeque;

use andon_host::config::{Record, RecordMode, Trigger};
use shm_schemas::{MessageId, Verdict, VerdictNote, VerdictOutcome};

use crate::disk::Disk;
use crate::ring::Ring;
use crate::topic::Topic;
use crate::writer::{Attachment, Entry, shifted};

const SECOND: u64 = 1_000_000_000;

/// Memory for everything but the pictures since the start of a job: two and a half minutes at 30 frames per second.
pub const MESSAGE_MEMORY: usize = 16 << 20;

/// A clip has this much time before the start of its job, because it shows where the parts lay.
const LEAD_NS: u64 = 2 * SECOND;

/// How many jobs are attached at most: more than come into force while one is done.
const JOBS: usize = 4;

/// A clip lasts until its job has ended, so that the job can be taught; but no longer than this after its verdict. Then only what is near a verdict
/// has pictures.
const LONGEST_TAIL_NS: u64 = 120 * SECOND;

/// Where recordings go.
pub trait Sink {
    /// Begins a recording, in place of the one that is open.
    fn begin(&mut self, now_ns: u64);
    /// Adds a file.
    fn attach(&mut self, attachment: Attachment);
    /// Adds a message. False where it is lost.
    fn write(&mut self, entry: Entry) -> bool;
    /// Puts the picture of a verdict beside the recording. False where it is lost.
    fn still(&mut self, verdict: MessageId, jpeg: Vec<u8>) -> bool;
    /// Completes the recording.
    fn end(&mut self);
}

/// The disk, with the clock of the messages.
pub struct ToDisk {
    /// The thread that writes.
    pub disk: Disk,
    /// UTC now minus CLOCK_MONOTONIC now, nanoseconds.
    pub offset_ns: fn() -> i128,
}

impl Sink for ToDisk {
    fn begin(&mut self, now_ns: u64) {
        let offset_ns = (self.offset_ns)();
        self.disk.begin(shifted(now_ns, offset_ns), offset_ns);
    }

    fn attach(&mut self, attachment: Attachment) {
        self.disk.attach(attachment);
    }

    fn write(&mut self, entry: Entry) -> bool {
        self.disk.write(entry)
    }

    fn still(&mut self, verdict: MessageId, jpeg: Vec<u8>) -> bool {
        self.disk.still(verdict, jpeg)
    }

    fn end(&mut self) {
        self.disk.end();
    }
}

/// A recording that is open.
#[derive(Debug)]
struct Open {
    /// Bytes of its messages.
    bytes: u64,
    /// In fault mode: until when its pictures are written.
    pictures_until_ns: u64,
    /// In fault mode, after that time: the place in the ring from which on nothing is written yet. A kill would cost it. Another fault may still want
    /// its pictures, and each picture comes before what was detected in it.
    waits_from: Option<u64>,
}

/// Decides what is recorded.
pub struct Recorder<S> {
    sink: S,
    record: Record,
    ring: Ring,
    /// What every recording begins with.
    attachments: Vec<Attachment>,
    /// The names of the newest jobs in it, the newest last.
    jobs: VecDeque<String>,
    /// The newest messages that say how things stand: a recording of everything begins with them. A clip begins with what is in memory, where they
    /// come twice a second.
    standing: Vec<Entry>,
    open: Option<Open>,
    job_began_ns: u64,
    /// When the newest job ended that is not running any more.
    job_ended_ns: u64,
    is_job_running: bool,
    /// Entries and stills that were lost because too much waited for the disk.
    lost: u64,
}

impl<S: Sink> Recorder<S> {
    /// One that has received nothing.
    pub fn new(sink: S, record: Record) -> Self {
        // Where everything is written, stills are made of them: the disk and this memory share their bytes.
        let pictures = (record.memory_mb as usize) << 20;
        let others = if record.mode == RecordMode::Fault { MESSAGE_MEMORY } else { 0 };
        Self {
            sink,
            record,
            ring: Ring::new(pictures, others),
            attachments: Vec::new(),
            jobs: VecDeque::new(),
            standing: Vec::new(),
            open: None,
            job_began_ns: 0,
            job_ended_ns: 0,
            is_job_running: false,
            lost: 0,
        }
    }

    /// Where recordings go.
    pub fn sink(&mut self) -> &mut S {
        &mut self.sink
    }

    /// Entries and stills that were lost so far because too much waited for the disk.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// A file that belongs to every recording from now on, in place of the one of this name.
    pub fn attach(&mut self, attachment: Attachment) {
        if self.open.is_some() {
            self.sink.attach(attachment.clone());
        }
        self.attachments.retain(|known| known.name != attachment.name);
        self.attachments.push(attachment);
    }

    /// As [`Recorder::attach`], for a job that has come into force. What is in memory may still be of one of the jobs before.
    pub fn attach_job(&mut self, job: Attachment) {
        self.jobs.retain(|known| *known != job.name);
        self.jobs.push_back(job.name.clone());
        if self.jobs.len() > JOBS
            && let Some(oldest) = self.jobs.pop_front()
        {
            self.attachments.retain(|known| known.name != oldest);
        }
        self.attach(job);
    }

    /// A job has begun, or has ended.
    pub fn job(&mut self, is_running: bool, now_ns: u64) {
        match (self.is_job_running, is_running) {
            (false, true) => self.job_began_ns = now_ns,
            (true, false) => self.job_ended_ns = now_ns,
            _ => {}
        }
        self.is_job_running = is_running;
    }

    /// Takes what was received. `is_standing` says that only the newest message of its topic counts, and that it holds until the next.
    pub fn take(&mut self, entry: Entry, is_standing: bool) {
        if is_standing {
            self.standing.retain(|known| known.topic != entry.topic);
            self.standing.push(entry.clone());
        }
        if self.record.mode == RecordMode::Fault {
            self.take_for_clip(entry);
            return;
        }
        if entry.topic == Topic::Picture {
            self.ring.push(entry.clone());
        }
        if self.open.is_none() {
            self.begin(entry.sent_ns, u64::MAX);
            if is_standing {
                // It was written as the recording began.
                return;
            }
        }
        self.write(entry);
    }

    /// Near a fault everything is written at once. Else it waits until no fault can want its pictures any more. Then it is written without them.
    fn take_for_clip(&mut self, entry: Entry) {
        let sent_ns = entry.sent_ns;
        if let Some(open) = &mut self.open
            && sent_ns > open.pictures_until_ns
        {
            open.waits_from.get_or_insert(self.ring.next());
        }
        if self.waits_from().is_none() {
            self.write(entry.clone());
        }
        // What there is no room for in memory cannot wait any longer either.
        let gone = self.ring.push(entry);
        self.write_without_pictures(gone);
        self.write_waiting(sent_ns.saturating_sub(self.before_ns()));
    }

    fn waits_from(&self) -> Option<u64> {
        self.open.as_ref()?.waits_from
    }

    /// Writes what waits and was sent before this time, without its pictures.
    fn write_waiting(&mut self, until_ns: u64) {
        if let Some(from) = self.waits_from() {
            let waiting = self.ring.others_before(from, until_ns);
            self.write_without_pictures(waiting);
        }
    }

    fn write_without_pictures(&mut self, entries: Vec<(u64, Entry)>) {
        for (order, entry) in entries {
            let Some(open) = &mut self.open else { return };
            if entry.topic != Topic::Picture && open.waits_from.is_some_and(|from| from <= order) {
                open.waits_from = Some(order + 1);
                self.write(entry);
            }
        }
    }

    fn before_ns(&self) -> u64 {
        u64::from(self.record.before_s) * SECOND
    }

    /// Says in the recording what is missing in it. False where nothing is open or too much waits: it is to be said again.
    pub fn note(&mut self, entry: Entry) -> bool {
        self.open.is_some() && self.sink.write(entry)
    }

    fn file_bytes(&self) -> u64 {
        u64::from(self.record.file_mb) << 20
    }

    /// Takes a verdict, which was taken as a message before. True where a clip is made of it.
    pub fn verdict(&mut self, verdict: &Verdict, now_ns: u64) -> bool {
        let is_fault = is_trigger(verdict, &self.record.on);
        if self.record.mode == RecordMode::Fault && is_fault {
            self.clip(now_ns);
        }
        is_fault && self.open.is_some()
    }

    /// Puts the picture of a verdict beside the recording.
    pub fn still(&mut self, verdict: MessageId, jpeg: Vec<u8>) {
        if !self.sink.still(verdict, jpeg) {
            self.lost += 1;
        }
    }

    /// The newest picture of a time that is not after this one, while it is in memory.
    #[must_use]
    pub fn picture_at(&self, time_ns: u64) -> Option<&Entry> {
        self.ring.picture_at(time_ns)
    }

    /// Ends what has lasted long enough, or is large enough.
    pub fn look(&mut self, now_ns: u64) {
        let Some(open) = &self.open else { return };
        let pictures_until_ns = open.pictures_until_ns;
        let is_full = open.bytes >= self.file_bytes();
        let is_over = match self.record.mode {
            RecordMode::Fault => {
                let is_shown = now_ns > pictures_until_ns;
                let is_job_over = !self.is_job_running || now_ns > pictures_until_ns + LONGEST_TAIL_NS;
                is_shown && is_job_over
            }
            RecordMode::Always | RecordMode::Off => is_full,
        };
        if is_over {
            self.end();
        } else if is_full && open.waits_from.is_none() {
            self.go_on(now_ns, pictures_until_ns);
        }
    }

    /// Goes on with a clip in another file: where one fault follows the other it has no end, and the budget counts in files. Not while something
    /// waits: its pictures may still be wanted, and what has none grows slowly.
    fn go_on(&mut self, now_ns: u64, pictures_until_ns: u64) {
        self.end();
        self.begin(now_ns, pictures_until_ns);
    }

    /// What was open cannot be written any more: what comes begins another.
    pub fn give_up(&mut self) {
        self.open = None;
    }

    /// Ends the recording; what comes begins another.
    pub fn end(&mut self) {
        self.write_waiting(u64::MAX);
        if self.open.take().is_some() {
            self.sink.end();
        }
    }

    /// Opens a clip with what is in memory, or goes on with the one that is open.
    fn clip(&mut self, now_ns: u64) {
        let pictures_until_ns = now_ns + u64::from(self.record.after_s) * SECOND;
        let begin_ns = now_ns.saturating_sub(self.before_ns());
        if let Some(open) = &mut self.open {
            open.pictures_until_ns = pictures_until_ns;
            let waiting = open.waits_from.take().map(|from| self.ring.since(from, begin_ns, 0));
            waiting.into_iter().flatten().for_each(|entry| self.write(entry));
            return;
        }
        // A job that ended before explains nothing. The verdict on a job comes with its end.
        let is_of_job = self.is_job_running || self.job_ended_ns >= begin_ns;
        let job_ns = if is_of_job { self.job_began_ns.saturating_sub(LEAD_NS) } else { begin_ns };
        let kept = self.ring.since(0, begin_ns, begin_ns.min(job_ns));
        self.begin(now_ns, pictures_until_ns);
        kept.into_iter().for_each(|entry| self.write(entry));
    }

    fn begin(&mut self, now_ns: u64, pictures_until_ns: u64) {
        self.open = Some(Open { bytes: 0, pictures_until_ns, waits_from: None });
        self.sink.begin(now_ns);
        for attachment in self.attachments.clone() {
            self.sink.attach(attachment);
        }
        if self.record.mode == RecordMode::Always {
            for entry in self.standing.clone() {
                self.write(entry);
            }
        }
    }

    fn write(&mut self, entry: Entry) {
        let Some(open) = &mut self.open else { return };
        open.bytes += entry.data.len() as u64;
        if !self.sink.write(entry) {
            self.lost += 1;
        }
    }
}

/// Whether a clip is made of a verdict.
fn is_trigger(verdict: &Verdict, on: &[Trigger]) -> bool {
    let outcome = verdict.outcome();
    let has_note = verdict.note != VerdictNote::None.code();
    on.iter().any(|trigger| match trigger {
        Trigger::Anomaly => outcome == Ok(VerdictOutcome::Anomaly),
        Trigger::NotJudged => outcome == Ok(VerdictOutcome::NotJudged),
        Trigger::Note => has_note,
    })
}

#[cfg(test)]
mod tests;
