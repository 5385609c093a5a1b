//! Does to the detections of a recording what the roles did to them.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use andon_core::anomaly::{Event, Unusable};
use andon_core::couple::Couples;
use andon_core::verdict::Verdict;
use andon_host::video::pipe::PictureFormat;
use andon_learn::job_file::JobFile;
use shm_schemas::{Couples as Message, Detections, MessageId, flag};

use super::plan::{Deed, EncoderRun, Plan, Sent, digest};
use super::{BlackboxError, Frames, Looked, Sight};
use crate::encoding::Encoding;
use crate::watch::Watch;
use crate::wire;
use crate::wire::command::Command;

/// What a frame has led to.
pub struct Step<'a> {
    /// The file that it is in.
    pub recording: &'a Path,
    /// The detections in it.
    pub frame: MessageId,
    /// The job in force, and its hash.
    pub job: (&'a JobFile, u64),
    /// The newest couples.
    pub couples: Option<&'a Couples>,
    /// The verdicts that came with it.
    pub verdicts: &'a [Verdict],
    /// The picture with what was seen in it, where there is one.
    pub view: Option<(PictureFormat, &'a [u8], &'a Detections)>,
}

/// What has come of it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Couples that differ from those that were sent.
    pub couples_differ: u64,
    /// Couples that were sent and have come out again.
    pub couples: u64,
    /// What has come of looking at the pictures again, where that was wanted.
    pub looked: Option<Looked>,
}

/// Recordings that follow each other, and what the roles did.
#[derive(Clone, Copy)]
pub struct Recorded<'p> {
    /// The files.
    pub paths: &'p [PathBuf],
    /// What the roles did.
    pub plan: &'p Plan,
    /// The job that is to be judged by, whichever was in force; those that were in force where there is none.
    pub instead: Option<&'p JobFile>,
    /// Whether `show` wants to see pictures: to decode them takes longer than everything else.
    pub wants_pictures: bool,
    /// By what the pictures are looked at again; what was detected then is judged where there is none.
    pub sight: Option<&'p Sight>,
}

/// Judges recordings again. `show` is told of every frame.
///
/// # Errors
/// What is missing or damaged, and what `show` says.
pub fn judge<E: From<BlackboxError>>(
    recorded: Recorded<'_>,
    show: &mut impl FnMut(Step<'_>) -> Result<(), E>,
) -> Result<Outcome, E> {
    let mut line = Line::new(recorded)?;
    // Before any judge has begun nothing is judged.
    let mut next = line.until_judged(false)?;
    while let Some(session) = next {
        next = match line.job(session.model_hash)? {
            None => line.until_judged(session.is_enabled)?,
            Some(file) => file.with_job(|job| {
                let watch = Watch::new(job, file, session.is_between_jobs);
                let watch = watch.map_err(|error| line.method(&error))?;
                line.with_job(file, watch, session, show)
            })?,
        };
    }
    Ok(Outcome { looked: line.frames.looked(), ..line.outcome })
}

/// A judge with a job, or with none.
#[derive(Clone, Copy)]
struct Session {
    /// The hash of the job that was in force.
    model_hash: u64,
    is_enabled: bool,
    is_between_jobs: bool,
}

/// What comes to the judge.
enum Input {
    /// What it does before it takes the next couples, or after it has taken the last.
    Deed(Deed),
    /// Couples, and the hash of the job that they are made for.
    Couples(Box<Couples>, u64),
    /// The source has ended.
    End,
    /// A frame has been worked on.
    Frame,
}

struct Line<'p> {
    recorded: Recorded<'p>,
    frames: Frames,
    encoding: Option<(EncoderRun, Encoding)>,
    /// Encoders that have not begun.
    encoders: VecDeque<EncoderRun>,
    /// CLOCK_MONOTONIC of the newest frame.
    newest_ns: u64,
    inputs: VecDeque<Input>,
    newest: Option<Couples>,
    outcome: Outcome,
}

impl<'p> Line<'p> {
    fn new(recorded: Recorded<'p>) -> Result<Self, BlackboxError> {
        let frames = Frames::open_chain(recorded.paths)?;
        Ok(Self {
            recorded,
            frames: match recorded.sight {
                Some(sight) => frames.looked_at_again(sight.config()),
                None if recorded.wants_pictures => frames.with_pictures(),
                None => frames,
            },
            encoding: None,
            encoders: recorded.plan.encoders.iter().copied().collect(),
            newest_ns: 0,
            inputs: VecDeque::new(),
            newest: None,
            outcome: Outcome::default(),
        })
    }

    /// The job to judge by where that of this hash was in force.
    fn job(&self, model_hash: u64) -> Result<Option<&'p JobFile>, BlackboxError> {
        if self.recorded.instead.is_some() || model_hash == 0 {
            return Ok(self.recorded.instead);
        }
        let job = self.recorded.plan.station.jobs.get(&model_hash);
        job.map(Some).ok_or_else(|| BlackboxError::NoJob { path: self.frames.path().into(), model_hash })
    }

    fn method(&self, why: &impl std::fmt::Debug) -> BlackboxError {
        BlackboxError::Method { path: self.frames.path().into(), why: format!("{why:?}") }
    }

    /// Until a judge begins or loads a job; `None` at the end.
    fn until_judged(&mut self, mut is_enabled: bool) -> Result<Option<Session>, BlackboxError> {
        let is_between_jobs = false;
        while let Some(input) = self.next_input()? {
            match input {
                Input::Deed(Deed::Began { model_hash, is_enabled }) => {
                    return Ok(Some(Session { model_hash, is_enabled, is_between_jobs }));
                }
                Input::Deed(Deed::Loaded(model_hash)) => {
                    return Ok(Some(Session { model_hash, is_enabled, is_between_jobs }));
                }
                Input::Deed(Deed::Obeyed(Command::Enable)) => is_enabled = true,
                Input::Deed(Deed::Obeyed(Command::Disable)) => is_enabled = false,
                _ => (),
            }
        }
        Ok(None)
    }

    /// Until another job is in force or a judge starts again; `None` at the end.
    fn with_job<E: From<BlackboxError>>(
        &mut self,
        file: &JobFile,
        mut watch: Watch<'_>,
        mut session: Session,
        show: &mut impl FnMut(Step<'_>) -> Result<(), E>,
    ) -> Result<Option<Session>, E> {
        let mut verdicts = Vec::new();
        let job = (file, file.model_hash());
        let mut next = None;
        while next.is_none()
            && let Some(input) = self.next_input()?
        {
            let take = &mut |event: Event| verdicts.extend(event.verdict());
            let done = match input {
                Input::Couples(couples, model_hash) => {
                    let is_watched = session.is_enabled && model_hash == session.model_hash;
                    let done = if is_watched { step(&mut watch, &couples, take) } else { Ok(()) };
                    self.newest = Some(*couples);
                    done
                }
                Input::End => watch.finish(take),
                Input::Frame => {
                    self.show(job, &mut verdicts, show)?;
                    Ok(())
                }
                Input::Deed(deed) => obey(deed, &mut session, &mut watch, take).map(|other| next = other),
            };
            done.map_err(|error| self.method(&error))?;
        }
        self.show(job, &mut verdicts, show)?;
        Ok(next)
    }

    fn show<E>(
        &self,
        job: (&JobFile, u64),
        verdicts: &mut Vec<Verdict>,
        show: &mut impl FnMut(Step<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        let (couples, view) = (self.newest.as_ref(), self.frames.shown());
        let (recording, frame) = (self.frames.path(), self.frames.newest());
        show(Step { recording, frame, job, couples, verdicts, view })?;
        verdicts.clear();
        Ok(())
    }

    fn next_input(&mut self) -> Result<Option<Input>, BlackboxError> {
        while self.inputs.is_empty() {
            let Some(detections) = self.frames.next_detections()?.copied() else { return Ok(None) };
            self.encode(&detections)?;
            self.inputs.push_back(Input::Frame);
        }
        Ok(self.inputs.pop_front())
    }

    /// Works on a frame as the encoder that was running did.
    fn encode(&mut self, detections: &Detections) -> Result<(), BlackboxError> {
        let captured_ns = detections.stamp.captured_ns;
        let is_end = detections.flags & flag::END_OF_STREAM != 0;
        let begins = !is_end
            && self.encoders.front().is_some_and(|run| {
                run.began_ns == captured_ns || self.encoding.is_none() && run.began_ns < captured_ns
            });
        if begins && let Some(run) = self.encoders.pop_front() {
            // An encoder that was killed gives nothing back.
            if let Some((known, _)) = self.encoding.as_ref().filter(|(known, _)| known.epoch == run.epoch) {
                // One that followed the judge to another job did so before it took this frame; one whose source has started again, after it.
                if known.model_hash == run.model_hash {
                    self.newest_ns = captured_ns;
                }
                self.flush();
            }
            let job = self.job(run.model_hash)?;
            let encoding = Encoding::new(&self.recorded.plan.station.config, job);
            self.encoding = Some((run, encoding.map_err(|error| self.method(&error))?));
        }
        if is_end {
            self.newest_ns = captured_ns;
            self.flush();
            self.end(captured_ns);
            return Ok(());
        }
        let Some((run, mut encoding)) = self.encoding.take() else { return Ok(()) };
        self.newest_ns = captured_ns;
        let frame = wire::detections::to_core(detections);
        let mut ready = Vec::new();
        // One out of order has led to nothing then either.
        let _ = encoding.step(&frame, captured_ns, &mut |couples| ready.push(couples));
        self.encoding = Some((run, encoding));
        self.send(run, ready);
        Ok(())
    }

    fn flush(&mut self) {
        let Some((run, mut encoding)) = self.encoding.take() else { return };
        let mut ready = Vec::new();
        encoding.flush(&mut |couples| ready.push(couples));
        self.send(run, ready);
    }

    /// The source has ended: the judge hears of it, if the message was sent.
    fn end(&mut self, captured_ns: u64) {
        let sent = self.recorded.plan.sent.range((captured_ns, 0)..=(captured_ns, u64::MAX));
        let ids = sent.flat_map(|(_, sent)| sent.iter().map(|sent| sent.id));
        // The message of the end is the last one that was sent after this frame.
        let Some(id) = ids.max_by_key(|id| (id.epoch, id.seq)) else { return };
        self.deeds(&self.recorded.plan.before, id);
        self.inputs.push_back(Input::End);
        self.deeds(&self.recorded.plan.after, id);
    }

    /// Gives couples to the judge, those that were sent then.
    fn send(&mut self, run: EncoderRun, ready: Vec<Couples>) {
        let sent: &[Sent] =
            self.recorded.plan.sent.get(&(self.newest_ns, run.epoch)).map_or(&[], |sent| sent.as_slice());
        let of_run: Vec<(u64, Couples)> = ready
            .into_iter()
            .map(|couples| {
                let mut message =
                    Message { model_hash: run.model_hash, began_ns: run.began_ns, ..Message::default() };
                wire::couples::write(&couples, &mut message);
                (digest(&message), couples)
            })
            .collect();
        let knows_all = self.recorded.plan.is_from_start && self.recorded.plan.lost.is_empty();
        let mut unvisited: VecDeque<MessageId> = sent.iter().map(|sent| sent.id).collect();
        for (index, (computed, couples)) in of_run.into_iter().enumerate() {
            let same = sent.iter().find(|sent| sent.digest == computed);
            // Where the start of the encoder is not known, the couples differ, and stand for those that were sent.
            let id = same.or_else(|| sent.get(index)).map(|sent| sent.id);
            self.outcome.couples += u64::from(same.is_some());
            self.outcome.couples_differ += u64::from(same.is_none() && id.is_some());
            if id.is_none() && knows_all {
                // What was computed and not sent, because the encoder was killed, the judge has never had.
                continue;
            }
            let id = id.unwrap_or_default();
            if let Some(place) = unvisited.iter().position(|other| *other == id) {
                self.pass_over(unvisited.drain(..=place).take(place));
            }
            self.deeds(&self.recorded.plan.before, id);
            self.inputs.push_back(Input::Couples(Box::new(couples), run.model_hash));
            self.deeds(&self.recorded.plan.after, id);
        }
        self.pass_over(unvisited.into_iter());
    }

    /// Couples that do not come out again, because the encoder had begun before the recording: what the judge did at them it did all the same.
    fn pass_over(&mut self, ids: impl Iterator<Item = MessageId>) {
        for id in ids {
            self.deeds(&self.recorded.plan.before, id);
            self.deeds(&self.recorded.plan.after, id);
        }
    }

    fn deeds(&mut self, of: &std::collections::HashMap<MessageId, Vec<Deed>>, id: MessageId) {
        let deeds = of.get(&id).into_iter().flatten().cloned().map(Input::Deed);
        self.inputs.extend(deeds);
    }
}

/// Gives couples to a judge that watches.
fn step(watch: &mut Watch<'_>, couples: &Couples, take: &mut impl FnMut(Event)) -> Result<(), Unusable> {
    if watch.begins_again(couples) {
        watch.break_off(take)?;
    }
    watch.step(couples, take);
    Ok(())
}

/// Does what the judge did; the session that takes the place of this one, where one does.
fn obey(
    deed: Deed,
    session: &mut Session,
    watch: &mut Watch<'_>,
    take: &mut impl FnMut(Event),
) -> Result<Option<Session>, Unusable> {
    match deed {
        Deed::Began { model_hash, is_enabled } => {
            return Ok(Some(Session { model_hash, is_enabled, is_between_jobs: false }));
        }
        Deed::Loaded(model_hash) => {
            let is_between_jobs = watch.is_between_jobs();
            watch.break_off(take)?;
            return Ok(Some(Session { model_hash, is_between_jobs, ..*session }));
        }
        Deed::Obeyed(Command::Enable) => session.is_enabled = true,
        Deed::Obeyed(Command::Disable) => {
            session.is_enabled = false;
            watch.break_off(take)?;
        }
        // While nobody watches it is refused. Of several commands at one place only the last one's refusal is recorded.
        Deed::Obeyed(Command::Start) if session.is_enabled => watch.start(take),
        Deed::Obeyed(Command::Abort) => watch.finish(take)?,
        Deed::Obeyed(Command::Start | Command::LoadJob { .. } | Command::SetPart { .. }) => (),
    }
    Ok(None)
}
