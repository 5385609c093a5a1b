//! `record`: from every channel to recordings. It only reads: nothing waits for it, and without it nothing is slower or faster.

use std::collections::VecDeque;
use std::io;
use std::sync::Arc;
use std::time::{Duration, Instant};

use andon_host::config::Config;
use andon_host::exit::Code::Fault;
use andon_host::log::Remedy::OfCode;
use andon_host::log::{code, log};
use andon_host::role::{Cycle, CycleError, Ending, Failure, Role, Turn};
use andon_ipc::{
    Channel, ChannelMessage, FrameReader, FrameSample, MonotonicTime, Node, Port, Reader, UtcTime,
};
use prost::Message as _;
use serde::{Deserialize, Serialize};
use shm_schemas::{
    AccountKept, AccountUpdate, Audit, Command, Couples, Detections, Health, Journalled, JudgePhase, Judging,
    Printed, Stamp, Task, Verdict, VerdictMeasure, VerdictOutcome, bytes_of, flag,
};

use crate::disk::Disk;
use crate::picture::{Decoded, PictureMaker, message_of, picture_in};
use crate::recorder::{MESSAGE_MEMORY, Recorder, ToDisk};
use crate::retention::{budget, say};
use crate::topic::Topic;
use crate::viewer::{Level, Log, Number, timestamp};
use crate::writer::{Attachment, Entry};

/// Detections that wait for a verdict on them: a verdict is decided a tenth of a second after its frame.
const RECENT: usize = 60;

/// How long a disk that could not be written is left alone.
const AGAIN: Duration = Duration::from_secs(5);

/// A disk that is too slow is so all the time.
const LOG_SLOW_EVERY: Duration = Duration::from_secs(60);

/// What the recorder cannot know, because it lies above it.
pub trait Narrator {
    /// A verdict as a sentence.
    fn sentence(&mut self, verdict: &Verdict) -> String;

    /// The job in force, as a file; `None` where it cannot be read.
    fn job(&mut self, judging: &Judging) -> Option<Attachment>;

    /// A picture with what was seen in it and what was said of it, as JPEG.
    fn still(&mut self, picture: Decoded, seen: Option<&Detections>, verdict: &Verdict) -> Option<Vec<u8>>;
}

/// Why the role ends.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// What ends any role.
    #[error(transparent)]
    Cycle(#[from] CycleError),
    /// The thread that writes cannot be started.
    #[error("the thread that writes recordings cannot be started: {0}")]
    Thread(io::Error),
}

impl Failure for RecordError {
    fn ending(&self) -> Option<Ending> {
        match self {
            Self::Cycle(error) => error.ending(),
            Self::Thread(_) => Some((&code::ROLE_FAILED, OfCode, Fault)),
        }
    }

    fn is_lasting(&self) -> bool {
        matches!(self, Self::Cycle(error) if error.is_lasting())
    }
}

/// What the recorder did not get, since the recording began or it was said last.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Losses {
    /// The channel; `recording` where the disk was too slow.
    pub channel: String,
    /// Messages that did not come.
    pub lost: u64,
    /// How often its writer has started again.
    pub restarts: u32,
}

/// A channel whose messages are kept as they are.
struct Tap<T: ChannelMessage> {
    reader: Reader<T>,
    said: (u64, u32),
}

impl<T: ChannelMessage> Tap<T> {
    fn new(node: &Node) -> Result<Self, CycleError> {
        Ok(Self { reader: node.reader()?, said: (0, 0) })
    }

    /// What has not come since this was asked last.
    fn news(&mut self) -> Option<Losses> {
        let now = (self.reader.lost(), self.reader.restarts());
        losses(T::CHANNEL, now, &mut self.said)
    }
}

fn losses(channel: Channel, now: (u64, u32), said: &mut (u64, u32)) -> Option<Losses> {
    let (lost, restarts) = std::mem::replace(said, now);
    let is_news = now != (lost, restarts);
    is_news.then(|| Losses {
        channel: channel.name().into(),
        lost: now.0.saturating_sub(lost),
        restarts: now.1.saturating_sub(restarts),
    })
}

struct Recording<N> {
    frames: FrameReader,
    frames_said: (u64, u32),
    detections: Tap<Detections>,
    couples: Tap<Couples>,
    verdicts: Tap<Verdict>,
    accounts: Tap<AccountUpdate>,
    kept: Tap<AccountKept>,
    rows: Tap<Journalled>,
    health: Tap<Health>,
    commands: Tap<Command>,
    judging: Tap<Judging>,
    audits: Tap<Audit>,
    tasks: Tap<Task>,
    printed: Tap<Printed>,
    pictures: PictureMaker,
    /// The newest frame, until the judge has the couples that it led to: to encode it meanwhile would make verdicts later on a machine that has few
    /// processors.
    waiting: Option<FrameSample>,
    /// When couples were sent last.
    coupled: MonotonicTime,
    recorder: Recorder<ToDisk>,
    narrator: N,
    /// The job that the recordings carry.
    model_hash: u64,
    /// Whether this station has pictures at all.
    has_pictures: bool,
    recent: VecDeque<Detections>,
    /// What was sent before belongs to an earlier recording.
    began: MonotonicTime,
    failed: Option<Instant>,
    slow_logged: Option<Instant>,
    lost_said: u64,
    lost_logged: u64,
}

/// Runs until it is asked to stop. `attachments` belong to every recording.
///
/// # Errors
/// What ends the role.
pub fn run<N: Narrator>(
    node: &Node,
    config: &Config,
    attachments: Vec<Attachment>,
    narrator: N,
) -> Result<(), RecordError> {
    let record = config.record.clone();
    let limit = ((record.memory_mb as usize) << 20) + MESSAGE_MEMORY;
    let disk = Disk::start(config.recordings(), budget(config), limit).map_err(RecordError::Thread)?;
    let mut recorder = Recorder::new(ToDisk { disk, offset_ns }, record.clone());
    attachments.into_iter().for_each(|attachment| recorder.attach(attachment));
    let mut role = Recording {
        frames: node.frame_reader().map_err(CycleError::from)?,
        frames_said: (0, 0),
        detections: Tap::new(node)?,
        couples: Tap::new(node)?,
        verdicts: Tap::new(node)?,
        accounts: Tap::new(node)?,
        kept: Tap::new(node)?,
        rows: Tap::new(node)?,
        health: Tap::new(node)?,
        commands: Tap::new(node)?,
        judging: Tap::new(node)?,
        audits: Tap::new(node)?,
        tasks: Tap::new(node)?,
        printed: Tap::new(node)?,
        pictures: PictureMaker::new(&record),
        waiting: None,
        coupled: MonotonicTime::now(),
        recorder,
        narrator,
        model_hash: 0,
        has_pictures: false,
        recent: VecDeque::with_capacity(RECENT),
        began: MonotonicTime::now(),
        failed: None,
        slow_logged: None,
        lost_said: 0,
        lost_logged: 0,
    };
    let mut cycle = Cycle::new(node)?;
    // On a bench whose camera is away no message may come for hours.
    cycle.stepped(Instant::now());
    cycle.run(&mut role)
}

/// UTC now minus CLOCK_MONOTONIC now, nanoseconds.
fn offset_ns() -> i128 {
    i128::from(UtcTime::now().nanoseconds()) - i128::from(MonotonicTime::now().nanoseconds())
}

/// Takes everything that has come on a channel, and does this with each message besides.
macro_rules! drain {
    ($self:ident, $tap:ident) => {
        drain!($self, $tap, message => ())
    };
    ($self:ident, $tap:ident, $message:ident => $besides:expr) => {
        while let Some($message) = $self.$tap.reader.take().map_err(CycleError::from)? {
            $self.keep(&*$message, false);
            $besides;
        }
        if let Some(losses) = $self.$tap.news() {
            $self.say_losses(&losses);
        }
    };
}

impl<N: Narrator> Role for Recording<N> {
    type Error = RecordError;
    // A silent writer is reported by the roles that need it.
    const INPUT_IS_STEADY: bool = false;

    fn ports(&mut self) -> Vec<&mut dyn Port> {
        vec![
            &mut self.commands.reader,
            &mut self.judging.reader,
            &mut self.frames,
            &mut self.detections.reader,
            &mut self.couples.reader,
            &mut self.verdicts.reader,
            &mut self.rows.reader,
            &mut self.accounts.reader,
            &mut self.kept.reader,
            &mut self.audits.reader,
            &mut self.tasks.reader,
            &mut self.printed.reader,
            &mut self.health.reader,
        ]
    }

    fn turn(&mut self, cycle: &mut Cycle<'_>) -> Result<Turn, RecordError> {
        drain!(self, commands);
        self.take_judging()?;
        self.take_frames()?;
        let mut turn = Turn::Idle;
        while let Some(detections) = cycle.take(&mut self.detections.reader)? {
            self.keep(&*detections, false);
            if self.recent.len() == RECENT {
                self.recent.pop_front();
            }
            self.recent.push_back(*detections);
            turn = Turn::Stepped;
        }
        if let Some(losses) = self.detections.news() {
            self.say_losses(&losses);
        }
        drain!(self, couples, message => self.coupled = MonotonicTime::sent(&message.stamp));
        if self.is_waiting_over() {
            self.take_waiting();
        }
        self.take_verdicts()?;
        drain!(self, rows);
        drain!(self, accounts);
        drain!(self, kept);
        drain!(self, audits);
        drain!(self, tasks);
        drain!(self, printed);
        drain!(self, health);
        // First, because what ends now must say what is missing in it.
        self.say_slowness();
        self.recorder.look(MonotonicTime::now().nanoseconds());
        let is_failing = self.is_failing(cycle);
        let is_judging = self.waiting.is_some();
        self.recorder.sink().disk.release(is_judging);
        Ok(if is_failing { Turn::Idle } else { turn })
    }

    fn stop(&mut self, _cycle: &mut Cycle<'_>) -> Result<(), RecordError> {
        self.take_waiting();
        self.say_slowness();
        self.recorder.end();
        self.recorder.sink().disk.finish();
        self.listen_to_disk();
        Ok(())
    }
}

impl<N: Narrator> Recording<N> {
    /// Keeps a message as it is.
    fn keep<T: ChannelMessage>(&mut self, message: &T, is_standing: bool) {
        let entry = raw(T::CHANNEL, message.stamp(), bytes_of(message));
        self.recorder.take(entry, is_standing);
    }

    fn take_judging(&mut self) -> Result<(), RecordError> {
        while let Some(judging) = self.judging.reader.take().map_err(CycleError::from)? {
            if judging.model_hash != self.model_hash {
                self.model_hash = judging.model_hash;
                if let Some(job) = self.narrator.job(&judging) {
                    self.recorder.attach_job(job);
                }
            }
            self.keep(&*judging, true);
            let is_running = judging.phase == JudgePhase::Running.code();
            self.recorder.job(is_running, judging.stamp.sent_ns);
        }
        if let Some(losses) = self.judging.news() {
            self.say_losses(&losses);
        }
        Ok(())
    }

    /// The frames that wait. One that cannot be a picture is kept as its header alone. No more than can wait at once. Where the machine is too slow
    /// to encode them, more would come for ever, and everything else would be lost.
    fn take_frames(&mut self) -> Result<(), RecordError> {
        for _ in 0..Channel::Frame.qos().buffer {
            let Some(frame) = self.frames.take().map_err(CycleError::from)? else { break };
            let header = frame.header();
            self.recorder.take(raw(Channel::Frame, &header.stamp, bytes_of(header)), false);
            if header.width > 0 && header.flags & flag::END_OF_STREAM == 0 {
                self.take_waiting();
                self.waiting = Some(frame);
            }
        }
        let now = (self.frames.lost(), self.frames.restarts());
        if let Some(losses) = losses(Channel::Frame, now, &mut self.frames_said) {
            self.say_losses(&losses);
        }
        Ok(())
    }

    /// Whether `perceive` and then `encode` have done with the frame that waits. Couples may be of an earlier frame, so the order of sending tells.
    fn is_waiting_over(&self) -> bool {
        let newest = self.waiting.as_ref().zip(self.recent.back());
        newest.is_some_and(|(frame, seen)| {
            frame.header().stamp.captured_ns <= seen.stamp.captured_ns
                && MonotonicTime::sent(&seen.stamp) < self.coupled
        })
    }

    /// Keeps the picture of the frame that waits.
    fn take_waiting(&mut self) {
        let Some(frame) = self.waiting.take() else { return };
        self.has_pictures = true;
        let header = frame.header();
        let Ok(colour) = frame.colour() else { return };
        let jpeg = match self.pictures.jpeg(header, colour, frame.jpeg()) {
            Ok(jpeg) => jpeg,
            Err(error) => {
                tracing::debug!(%error, "frame {} has no picture", header.stamp.seq);
                return;
            }
        };
        let (time_ns, sent_ns) = times(&header.stamp);
        self.take(Topic::Picture, time_ns, sent_ns, message_of(jpeg, utc(time_ns)));
    }

    fn take(&mut self, topic: Topic, time_ns: u64, sent_ns: u64, data: Vec<u8>) {
        self.recorder.take(Entry { topic, time_ns, sent_ns, data: data.into() }, false);
    }

    fn take_verdicts(&mut self) -> Result<(), RecordError> {
        while let Some(verdict) = self.verdicts.reader.take().map_err(CycleError::from)? {
            if MonotonicTime::sent(&verdict.stamp) < self.began {
                continue;
            }
            self.keep(&*verdict, false);
            self.tell_viewers(&verdict);
            let now_ns = MonotonicTime::now().nanoseconds();
            let is_clip = self.recorder.verdict(&verdict, now_ns);
            if is_clip && verdict.outcome() == Ok(VerdictOutcome::Anomaly) {
                self.keep_still(&verdict);
            }
        }
        if let Some(losses) = self.verdicts.news() {
            self.say_losses(&losses);
        }
        Ok(())
    }

    /// The verdict as a sentence, and its numbers.
    fn tell_viewers(&mut self, verdict: &Verdict) {
        let (time_ns, sent_ns) = times(&verdict.stamp);
        let at = timestamp(utc(time_ns));
        let level = match verdict.outcome() {
            Ok(VerdictOutcome::Anomaly) => Level::Error,
            Ok(VerdictOutcome::NotJudged) => Level::Warning,
            Ok(VerdictOutcome::Ok) if verdict.note != 0 => Level::Warning,
            _ => Level::Info,
        };
        let message = self.narrator.sentence(verdict);
        let log = Log { timestamp: at, level: level as i32, message, name: "judge".into() };
        self.take(Topic::Log, time_ns, sent_ns, log.encode_to_vec());
        let ratio = f64::from(verdict.distance) / f64::from(verdict.threshold);
        if ratio.is_finite() {
            let number = Number { timestamp: at, value: ratio, name: "distance over threshold".into() };
            self.take(Topic::Ratio, time_ns, sent_ns, number.encode_to_vec());
        }
        if let Ok(measure) = VerdictMeasure::try_from(verdict.measure)
            && verdict.measured.is_finite()
        {
            let (value, name) = (f64::from(verdict.measured), measure.name().into());
            let number = Number { timestamp: at, value, name };
            self.take(Topic::Measure, time_ns, sent_ns, number.encode_to_vec());
        }
    }

    /// Puts the picture that an anomaly was decided on beside the recording. Where the camera has sent no picture yet, nobody expects one.
    fn keep_still(&mut self, verdict: &Verdict) {
        let id = verdict.stamp.id();
        match self.still(verdict) {
            Some(jpeg) => self.recorder.still(id, jpeg),
            None if self.has_pictures => log!(code::STILL_MISSING, "there is no {id}.jpg"),
            None => (),
        }
    }

    fn still(&mut self, verdict: &Verdict) -> Option<Vec<u8>> {
        let entry = self.recorder.picture_at(verdict.stamp.captured_ns)?;
        let (time_ns, picture) = (entry.time_ns, picture_in(entry).ok()?);
        let seen = self.recent.iter().find(|seen| seen.stamp.captured_ns == time_ns);
        self.narrator.still(picture, seen, verdict)
    }

    fn say_losses(&mut self, losses: &Losses) {
        self.recorder.take(losses_entry(losses), false);
        if losses.lost > 0 {
            let now_ns = MonotonicTime::now().nanoseconds();
            let message =
                format!("{} messages of the channel {} are missing here", losses.lost, losses.channel);
            let level = Level::Warning as i32;
            let log = Log { timestamp: timestamp(utc(now_ns)), level, message, name: "record".into() };
            self.take(Topic::Log, now_ns, now_ns, log.encode_to_vec());
        }
    }

    /// Says in the recording at once what a slow disk has cost, and in the log from time to time.
    fn say_slowness(&mut self) {
        let lost = self.recorder.lost();
        let unsaid = Losses { channel: "recording".into(), lost: lost - self.lost_said, restarts: 0 };
        if unsaid.lost > 0 && self.recorder.note(losses_entry(&unsaid)) {
            self.lost_said = lost;
        }
        if lost > self.lost_logged && self.slow_logged.is_none_or(|at| at.elapsed() >= LOG_SLOW_EVERY) {
            self.slow_logged = Some(Instant::now());
            log!(code::RECORDING_SLOW, "{} messages and pictures are missing", lost - self.lost_logged);
            self.lost_logged = lost;
        }
    }

    /// Whether nothing can be written. It is tried again from time to time.
    fn is_failing(&mut self, cycle: &mut Cycle<'_>) -> bool {
        self.listen_to_disk();
        let is_failing = self.recorder.sink().disk.is_failing();
        if !is_failing {
            self.failed = None;
            return false;
        }
        let is_probing = self.recorder.sink().disk.is_probing();
        if !is_probing && self.failed.is_none_or(|at| at.elapsed() >= AGAIN) {
            self.failed = Some(Instant::now());
            self.recorder.give_up();
            self.recorder.sink().disk.probe();
        }
        cycle.liveness().failing();
        true
    }

    fn listen_to_disk(&mut self) {
        self.recorder.sink().disk.told().for_each(say);
    }
}

fn losses_entry(losses: &Losses) -> Entry {
    let now_ns = MonotonicTime::now().nanoseconds();
    // It consists of a text and two numbers: nothing of it cannot be written.
    let text = serde_json::to_vec(losses).unwrap_or_default();
    Entry { topic: Topic::Losses, time_ns: now_ns, sent_ns: now_ns, data: text.into() }
}

/// A message as its bytes.
fn raw(channel: Channel, stamp: &Stamp, bytes: &[u8]) -> Entry {
    let (time_ns, sent_ns) = times(stamp);
    Entry { topic: Topic::Raw(channel), time_ns, sent_ns, data: Arc::from(bytes) }
}

/// The time of the picture that a message comes from, and that of its sending; CLOCK_MONOTONIC, nanoseconds.
fn times(stamp: &Stamp) -> (u64, u64) {
    let time_ns = if stamp.captured_ns == 0 { stamp.sent_ns } else { stamp.captured_ns };
    (time_ns, stamp.sent_ns)
}

fn utc(monotonic_ns: u64) -> u64 {
    UtcTime::at(MonotonicTime::from_nanoseconds(monotonic_ns)).nanoseconds()
}
