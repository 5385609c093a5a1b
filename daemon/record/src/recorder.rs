//! When something is recorded: always, or around verdicts. Without a clock, a channel or a disk.

use std::collections::VecDeque;

use andon_host::config::{Record, RecordMode, Trigger};
use shm_schemas::{MessageId, Verdict, VerdictNote, VerdictOutcome};

use crate::disk::Disk;
use crate::ring::Ring;
use crate::topic::Topic;
use crate::writer::{Attachment, Entry};

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
        let utc_ns = i128::from(now_ns) + offset_ns;
        self.disk.begin(u64::try_from(utc_ns).unwrap_or_default(), offset_ns);
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
            self.begin(entry.sent_ns);
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
        self.begin(now_ns);
        if let Some(open) = &mut self.open {
            open.pictures_until_ns = pictures_until_ns;
        }
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
        self.begin(now_ns);
        kept.into_iter().for_each(|entry| self.write(entry));
        if let Some(open) = &mut self.open {
            open.pictures_until_ns = pictures_until_ns;
        }
    }

    fn begin(&mut self, now_ns: u64) {
        self.open = Some(Open { bytes: 0, pictures_until_ns: u64::MAX, waits_from: None });
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
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::reader::{Item, RecordingReader};
    use crate::store::{Budget, files};
    use andon_ipc::Channel;
    use shm_schemas::VerdictLevel;
    use std::path::PathBuf;
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::time::Duration;

    /// What a recorder has written: one list for each recording.
    #[derive(Default)]
    struct Written {
        recordings: Vec<Vec<Entry>>,
        attached: Vec<String>,
        is_open: bool,
    }

    impl Sink for Written {
        fn begin(&mut self, _now_ns: u64) {
            self.recordings.push(Vec::new());
            self.is_open = true;
        }

        fn attach(&mut self, attachment: Attachment) {
            self.attached.push(attachment.name);
        }

        fn write(&mut self, entry: Entry) -> bool {
            self.recordings.last_mut().map(|recording| recording.push(entry)).is_some()
        }

        fn still(&mut self, _verdict: MessageId, _jpeg: Vec<u8>) -> bool {
            true
        }

        fn end(&mut self) {
            self.is_open = false;
        }
    }

    const TENTH: u64 = SECOND / 10;

    /// Ten pictures and ten detections per second until this time, seconds.
    fn run(recorder: &mut Recorder<Written>, from_s: u64, to_s: u64, bytes: usize) {
        for ns in (from_s * SECOND..to_s * SECOND).step_by(TENTH as usize) {
            for topic in [Topic::Raw(Channel::Detections), Topic::Picture] {
                let entry = Entry { topic, time_ns: ns, sent_ns: ns, data: vec![0; bytes].into() };
                recorder.take(entry, false);
            }
            recorder.look(ns);
        }
    }

    fn verdict(outcome: VerdictOutcome) -> Verdict {
        Verdict { level: VerdictLevel::Iu.code(), outcome: outcome.code(), note: 0, ..Verdict::NONE }
    }

    fn recorder(mode: RecordMode) -> Recorder<Written> {
        Recorder::new(Written::default(), Record { mode, ..Record::default() })
    }

    /// When the first and the last message of a topic in a recording were sent, in tenths of a second.
    fn span(recording: &[Entry], topic: Topic) -> Option<(u64, u64)> {
        let mut times =
            recording.iter().filter(|entry| entry.topic == topic).map(|entry| entry.sent_ns / TENTH);
        let first = times.next()?;
        Some((first, times.next_back().unwrap_or(first)))
    }

    #[test]
    fn a_clip_has_pictures_from_10_s_before_to_3_s_after_its_verdict() {
        let mut recorder = recorder(RecordMode::Fault);
        run(&mut recorder, 0, 60, 10);
        assert!(recorder.verdict(&verdict(VerdictOutcome::Anomaly), 60 * SECOND));
        run(&mut recorder, 60, 80, 10);
        let written = recorder.sink();
        assert_eq!((written.recordings.len(), written.is_open), (1, false));
        assert_eq!(span(&written.recordings[0], Topic::Picture), Some((500, 630)));
    }

    #[test]
    fn the_clip_of_a_job_that_goes_on_has_pictures_around_its_verdict_and_detections_of_the_whole_of_it() {
        let mut recorder = recorder(RecordMode::Fault);
        run(&mut recorder, 0, 20, 10);
        recorder.job(true, 20 * SECOND);
        run(&mut recorder, 20, 60, 10);
        assert!(!recorder.verdict(&verdict(VerdictOutcome::Ok), 60 * SECOND));
        assert!(recorder.verdict(&verdict(VerdictOutcome::Anomaly), 60 * SECOND));
        run(&mut recorder, 60, 80, 10);
        recorder.job(false, 80 * SECOND);
        run(&mut recorder, 80, 100, 10);
        let written = recorder.sink();
        assert_eq!((written.recordings.len(), written.is_open), (1, false));
        let recording = &written.recordings[0];
        assert_eq!(span(recording, Topic::Picture), Some((500, 630)));
        assert_eq!(span(recording, Topic::Raw(Channel::Detections)), Some((180, 800)));
        assert!(recording.is_sorted_by_key(|entry| entry.sent_ns));
    }

    #[test]
    fn the_clip_of_the_verdict_on_a_job_begins_with_the_job_which_has_just_ended() {
        let mut recorder = recorder(RecordMode::Fault);
        run(&mut recorder, 0, 20, 10);
        recorder.job(true, 20 * SECOND);
        run(&mut recorder, 20, 60, 10);
        recorder.job(false, 60 * SECOND);
        let verdict = Verdict { level: VerdictLevel::Job.code(), ..verdict(VerdictOutcome::Anomaly) };
        assert!(recorder.verdict(&verdict, 60 * SECOND));
        let recording = &recorder.sink().recordings[0];
        assert_eq!(span(recording, Topic::Raw(Channel::Detections)).map(|(first, _)| first), Some(180));
    }

    #[test]
    fn two_faults_of_a_job_are_one_clip_with_the_pictures_before_each_and_none_twice() {
        let mut recorder = recorder(RecordMode::Fault);
        recorder.job(true, SECOND);
        run(&mut recorder, 0, 30, 10);
        assert!(recorder.verdict(&verdict(VerdictOutcome::NotJudged), 30 * SECOND));
        run(&mut recorder, 30, 50, 10);
        assert!(recorder.verdict(&verdict(VerdictOutcome::Anomaly), 50 * SECOND));
        run(&mut recorder, 50, 60, 10);
        recorder.end();
        let recording = &recorder.sink().recordings[0];
        let times = |topic: Topic| -> Vec<u64> {
            let of_topic = recording.iter().filter(|entry| entry.topic == topic);
            of_topic.map(|entry| entry.sent_ns / TENTH).collect()
        };
        assert_eq!(times(Topic::Picture), (200..=330).chain(400..=530).collect::<Vec<_>>());
        assert_eq!(times(Topic::Raw(Channel::Detections)), (0..600).collect::<Vec<_>>());
        // A picture comes no later than what was detected in it, as a reader of the clip needs it.
        assert!(recording.is_sorted_by_key(|entry| entry.sent_ns));
        assert_eq!(recorder.sink().recordings.len(), 1);
    }

    #[test]
    fn a_clip_loses_nothing_that_was_detected_where_memory_holds_less_than_the_time_before_a_fault() {
        let mut recorder = recorder(RecordMode::Fault);
        recorder.job(true, SECOND);
        // A second of these takes more than half of the memory.
        run(&mut recorder, 0, 1, MESSAGE_MEMORY / 19);
        assert!(recorder.verdict(&verdict(VerdictOutcome::Anomaly), SECOND));
        run(&mut recorder, 1, 20, MESSAGE_MEMORY / 19);
        recorder.end();
        let recording = &recorder.sink().recordings[0];
        let detected = recording.iter().filter(|entry| entry.topic == Topic::Raw(Channel::Detections));
        let tenths: Vec<u64> = detected.map(|entry| entry.sent_ns / TENTH).collect();
        assert_eq!(tenths, (0..200).collect::<Vec<_>>());
        assert_eq!(span(recording, Topic::Picture), Some((0, 40)));
    }

    #[test]
    fn a_recording_has_the_newest_jobs_and_not_every_one_that_ever_was() {
        let mut recorder = recorder(RecordMode::Always);
        recorder.attach(Attachment { name: "configuration.toml".into(), data: [].into() });
        (0..9).for_each(|job| {
            recorder.attach_job(Attachment { name: format!("job-{job}"), data: [].into() });
        });
        run(&mut recorder, 0, 1, 10);
        assert_eq!(recorder.sink().attached, ["configuration.toml", "job-5", "job-6", "job-7", "job-8"]);
    }

    #[test]
    fn a_job_that_never_ends_does_not_make_a_clip_that_never_ends() {
        let mut recorder = recorder(RecordMode::Fault);
        recorder.job(true, 0);
        run(&mut recorder, 0, 10, 10);
        assert!(recorder.verdict(&verdict(VerdictOutcome::Anomaly), 10 * SECOND));
        run(&mut recorder, 10, 200, 10);
        assert!(!recorder.sink().is_open);
    }

    #[test]
    fn a_clip_that_faults_keep_open_goes_on_in_another_file_and_loses_nothing() {
        let record = Record { mode: RecordMode::Fault, file_mb: 1, ..Record::default() };
        let mut recorder = Recorder::new(Written::default(), record);
        recorder.attach(Attachment { name: "configuration.toml".into(), data: [].into() });
        recorder.job(true, 0);
        for second in 0..60 {
            run(&mut recorder, second, second + 1, 10_000);
            assert!(recorder.verdict(&verdict(VerdictOutcome::Anomaly), (second + 1) * SECOND));
        }
        recorder.end();
        let written = recorder.sink();
        let bytes = |recording: &Vec<Entry>| recording.iter().map(|entry| entry.data.len()).sum::<usize>();
        assert!(written.recordings.iter().all(|recording| bytes(recording) <= (1 << 20) + 20_000));
        assert_eq!(written.attached.len(), written.recordings.len());
        let all: Vec<u64> = written.recordings.iter().flatten().map(|entry| entry.sent_ns).collect();
        assert!(
            all.len() == 1200 && all.is_sorted(),
            "two messages, ten times in each of 60 s: {}",
            all.len()
        );
    }

    #[test]
    fn always_everything_is_written_and_a_file_that_is_large_enough_is_followed_by_another_with_its_files() {
        let record = Record { mode: RecordMode::Always, file_mb: 1, ..Record::default() };
        let mut recorder = Recorder::new(Written::default(), record);
        recorder.attach(Attachment { name: "configuration.toml".into(), data: [].into() });
        run(&mut recorder, 0, 20, 10_000);
        let written = recorder.sink();
        let all: usize = written.recordings.iter().map(Vec::len).sum();
        assert_eq!(all, 400, "two messages, ten times in each of 20 s");
        assert!(written.recordings.len() >= 4);
        assert_eq!(written.attached.len(), written.recordings.len());
    }

    /// What UTC is ahead of the clock of the messages, s.
    static AHEAD_S: AtomicU64 = AtomicU64::new(0);

    #[test]
    fn a_clock_that_is_set_back_costs_no_recording_and_the_times_in_each_go_on_as_they_began() {
        let home = tempfile::tempdir().unwrap();
        let budget = Budget { bytes: u64::MAX, age: Duration::from_secs(86_400), journal: None };
        let disk = Disk::start(home.path().into(), budget, 1 << 20).unwrap();
        let offset_ns = || i128::from(AHEAD_S.load(Ordering::Relaxed) * SECOND);
        let record = Record { mode: RecordMode::Always, ..Record::default() };
        let mut recorder = Recorder::new(ToDisk { disk, offset_ns }, record);
        // The third begins at the same instant of UTC as the first.
        for (begin_s, ahead_s, then_s) in [(1, 5000, 1400), (10, 1400, 1400), (20, 4981, 4981)] {
            for (at_s, ahead_s) in [(begin_s, ahead_s), (begin_s + 1, then_s)] {
                AHEAD_S.store(ahead_s, Ordering::Relaxed);
                let (ns, topic) = (at_s * SECOND, Topic::Log);
                recorder.take(Entry { topic, time_ns: ns, sent_ns: ns, data: [0][..].into() }, false);
            }
            recorder.end();
        }
        recorder.sink().disk.finish();
        let sent_s = |path: PathBuf| -> Vec<u64> {
            let mut reader = RecordingReader::open(&path).unwrap();
            let items = std::iter::from_fn(|| reader.next_item().unwrap());
            items
                .filter_map(|item| match item {
                    Item::Entry(entry) => Some(entry.sent_ns / SECOND),
                    Item::Attachment(_) => None,
                })
                .collect()
        };
        let found: Vec<Vec<u64>> = files(home.path()).unwrap().into_iter().map(sent_s).collect();
        assert_eq!(found, [[5001, 5002], [1410, 1411], [5001, 5002]]);
    }

    #[test]
    fn a_clip_is_made_of_what_the_configuration_names() {
        let note = Verdict { note: VerdictNote::Again.code(), ..verdict(VerdictOutcome::Ok) };
        for (on, expected) in [
            (Trigger::Anomaly, [true, false, false]),
            (Trigger::NotJudged, [false, true, false]),
            (Trigger::Note, [false, false, true]),
        ] {
            let verdicts = [verdict(VerdictOutcome::Anomaly), verdict(VerdictOutcome::NotJudged), note];
            assert_eq!(verdicts.map(|verdict| is_trigger(&verdict, &[on])), expected, "{on:?}");
        }
    }
}
