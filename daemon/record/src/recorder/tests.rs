//! When something is recorded, on scripted messages.
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
    let mut times = recording.iter().filter(|entry| entry.topic == topic).map(|entry| entry.sent_ns / TENTH);
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
    assert!(all.len() == 1200 && all.is_sorted(), "two messages, ten times in each of 60 s: {}", all.len());
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
    let budget = Budget { bytes: u64::MAX, age: Duration::MAX, journal: None };
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
