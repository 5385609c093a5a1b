//! What the roles did while a recording was made, as far as their results depend on it.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

use andon_ipc::Channel;
use andon_record::{End, Item, Losses, RecordingReader, Topic};
use shm_schemas::{
    Command as CommandMessage, Couples, Detections, Judging, MessageId, Refusal, Stamp, Verdict, bytes_of,
    flag,
};

use super::{BlackboxError, Station, message};
use crate::wire::command::{self, Command};

/// An encoder, from its first frame to its last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderRun {
    /// The start of the role.
    pub epoch: u64,
    /// The hash of the job that it was made for; 0 where there was none.
    pub model_hash: u64,
    /// CLOCK_MONOTONIC of its first frame, nanoseconds.
    pub began_ns: u64,
}

/// Couples that were sent: which they are, and what tells them from others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sent {
    /// Which message.
    pub id: MessageId,
    /// Of everything in it that is computed.
    pub digest: u64,
}

/// What a judge did, and when in the stream of couples.
#[derive(Clone, Debug, PartialEq)]
pub enum Deed {
    /// A judge began, with this job in force, watching or not.
    Began {
        /// The hash of the job; 0 where there was none.
        model_hash: u64,
        /// Whether it watched.
        is_enabled: bool,
    },
    /// It obeyed a command.
    Obeyed(Command),
    /// It loaded another job.
    Loaded(u64),
}

/// What the roles did.
pub struct Plan {
    /// The station.
    pub station: Station,
    /// The encoders, in their order.
    pub encoders: Vec<EncoderRun>,
    /// What was sent after each frame, by CLOCK_MONOTONIC of the frame and the start of the role.
    pub sent: BTreeMap<(u64, u64), Vec<Sent>>,
    /// What the judges did before they took these couples, in its order.
    pub before: HashMap<MessageId, Vec<Deed>>,
    /// What they did after they had taken these, in its order.
    pub after: HashMap<MessageId, Vec<Deed>>,
    /// The verdicts that were sent.
    pub verdicts: Vec<Verdict>,
    /// Whether the recording has the very first frame that the encoder took, and the very first couples that the judge took.
    pub is_from_start: bool,
    /// How many messages the recorder did not get of each channel that verdicts depend on; none where it got all.
    pub lost: BTreeMap<&'static str, u64>,
    /// How the recording ended.
    pub end: End,
}

/// What is collected while the recording is read.
#[derive(Default)]
struct Reading {
    attached: HashMap<String, Vec<u8>>,
    first_frame_ns: Option<u64>,
    /// The first detections, and the newest.
    detections: Option<(MessageId, MessageId)>,
    /// Of which frame each of the couples are, and which they are.
    couples: Vec<(u64, MessageId)>,
    encoders: Vec<EncoderRun>,
    sent: BTreeMap<(u64, u64), Vec<Sent>>,
    commands: Vec<CommandMessage>,
    judgings: Vec<Judging>,
    verdicts: Vec<Verdict>,
    lost: BTreeMap<&'static str, u64>,
    end: Option<End>,
}

impl Plan {
    /// Reads a recording.
    ///
    /// # Errors
    /// Why it cannot be used.
    pub fn read(path: &Path) -> Result<Self, BlackboxError> {
        Reading::of(path)?.into_plan(path)
    }
}

/// Recordings of which each goes on where the one before it ends are one: their recorder has only begun another file.
pub struct Chain {
    /// The files, in the order of time.
    pub paths: Vec<PathBuf>,
    /// What the roles did, or why nothing can be judged by it.
    pub plan: Result<Plan, BlackboxError>,
}

/// Reads recordings one after the other, the oldest first, and shows `take` each chain. One that cannot be read is a chain of its own.
pub fn chains(paths: &[PathBuf], take: &mut impl FnMut(Chain)) {
    let mut open: Option<(Vec<PathBuf>, Reading)> = None;
    for path in paths {
        match (Reading::of(path), &mut open) {
            (Err(error), _) => take(Chain { paths: vec![path.clone()], plan: Err(error) }),
            (Ok(next), Some((known, reading))) if reading.is_followed_by(&next) => {
                known.push(path.clone());
                reading.append(next);
            }
            (Ok(next), _) => {
                if let Some((paths, reading)) = open.replace((vec![path.clone()], next)) {
                    take(Chain::new(paths, reading));
                }
            }
        }
    }
    if let Some((paths, reading)) = open {
        take(Chain::new(paths, reading));
    }
}

impl Chain {
    fn new(paths: Vec<PathBuf>, reading: Reading) -> Self {
        let plan = reading.into_plan(paths.first().map_or(Path::new(""), PathBuf::as_path));
        Self { paths, plan }
    }
}

impl Reading {
    fn of(path: &Path) -> Result<Self, BlackboxError> {
        let mut reader = RecordingReader::open(path)?;
        let mut reading = Self::default();
        while let Some(item) = reader.next_item()? {
            match item {
                Item::Attachment(file) => drop(reading.attached.insert(file.name, file.data.to_vec())),
                Item::Entry(entry) => reading.take(entry.topic, &entry.data),
            }
        }
        reading.end = Some(reader.end());
        Ok(reading)
    }

    /// Whether another recording goes on with the very next detections, of the same configuration.
    fn is_followed_by(&self, next: &Self) -> bool {
        let configuration = |reading: &Self| reading.attached.get(crate::role::CONFIGURATION).cloned();
        let ids = self.detections.zip(next.detections);
        let is_next = ids.is_some_and(|((_, last), (first, _))| {
            first.epoch == last.epoch && Some(first.seq) == last.seq.checked_add(1)
        });
        is_next && configuration(self) == configuration(next)
    }

    /// Adds what comes after it.
    fn append(&mut self, next: Self) {
        self.attached.extend(next.attached);
        self.detections = self.detections.zip(next.detections).map(|((first, _), (_, last))| (first, last));
        self.couples.extend(next.couples);
        let known = self.encoders.last().copied();
        self.encoders.extend(next.encoders.into_iter().skip_while(|run| Some(*run) == known));
        for (frame, sent) in next.sent {
            self.sent.entry(frame).or_default().extend(sent);
        }
        self.commands.extend(next.commands);
        self.judgings.extend(next.judgings);
        self.verdicts.extend(next.verdicts);
        for (channel, lost) in next.lost {
            *self.lost.entry(channel).or_default() += lost;
        }
        self.end = next.end;
    }

    fn take(&mut self, topic: Topic, data: &[u8]) {
        let raw = Topic::Raw;
        if let Some(detections) = message::<Detections>(topic, raw(Channel::Detections), data) {
            let id = detections.stamp.id();
            self.first_frame_ns.get_or_insert(detections.stamp.captured_ns);
            self.detections = Some((self.detections.map_or(id, |(first, _)| first), id));
        } else if let Some(couples) = message::<Couples>(topic, raw(Channel::Couple), data) {
            self.take_couples(&couples);
        } else if let Some(command) = message::<CommandMessage>(topic, raw(Channel::Command), data) {
            self.commands.push(command);
        } else if let Some(judging) = message::<Judging>(topic, raw(Channel::Judging), data) {
            self.judgings.push(judging);
        } else if let Some(verdict) = message::<Verdict>(topic, raw(Channel::Verdict), data) {
            self.verdicts.push(verdict);
        } else if topic == Topic::Losses
            && let Ok(losses) = serde_json::from_slice::<Losses>(data)
        {
            // Where the judge did what it did is known by what it says of itself.
            let matters = ["detections", "couple", "command", "judging", "recording"];
            let channel = matters.into_iter().find(|channel| losses.lost > 0 && losses.channel == *channel);
            if let Some(channel) = channel {
                *self.lost.entry(channel).or_default() += losses.lost;
            }
        }
    }

    fn take_couples(&mut self, couples: &Couples) {
        let Stamp { epoch, captured_ns, .. } = couples.stamp;
        self.couples.push((captured_ns, couples.stamp.id()));
        let sent = Sent { id: couples.stamp.id(), digest: digest(couples) };
        self.sent.entry((captured_ns, epoch)).or_default().push(sent);
        let Couples { model_hash, began_ns, .. } = *couples;
        let run = EncoderRun { epoch, model_hash, began_ns };
        if couples.flags & flag::END_OF_STREAM == 0 && self.encoders.last() != Some(&run) {
            self.encoders.push(run);
        }
    }

    /// `path` is what messages call it.
    fn into_plan(self, path: &Path) -> Result<Plan, BlackboxError> {
        let station = Station::of(path, &self.attached)?;
        let (mut before, mut after) = (HashMap::<_, Vec<_>>::new(), HashMap::<_, Vec<_>>::new());
        // Couples of a frame that came before the first one here never come out again: nothing can be placed at them.
        let first_ns = self.first_frame_ns.unwrap_or(u64::MAX);
        let of_frames = self.couples.iter().filter(|(captured_ns, _)| *captured_ns >= first_ns);
        // A day has millions of them, and thousands of commands.
        let couples: HashSet<MessageId> = of_frames.clone().map(|(_, id)| *id).collect();
        let first_couples = of_frames.map(|(_, id)| *id).next();
        let firsts = self.firsts();
        let mut is_from_start = match (self.encoders.first(), self.first_frame_ns) {
            (Some(run), Some(first_ns)) => run.began_ns >= first_ns,
            _ => true,
        };
        // As the judge does it.
        let plc = &station.config.plc;
        let is_enabled_at_start = !(plc.enable && plc.writes);
        let mut known = State::default();
        let mut obeyed = HashSet::new();
        for judging in &self.judgings {
            let first = firsts.get(&judging.stamp.epoch).copied();
            if judging.stamp.epoch != known.epoch {
                // Where the recording begins in the middle of a judge, its state is known and what it had seen is not.
                let is_middle = known.epoch == 0 && first.is_some_and(|first| !couples.contains(&first));
                is_from_start &= !is_middle;
                let place = if is_middle { first_couples } else { first };
                let is_enabled = if is_middle { judging.is_enabled != 0 } else { is_enabled_at_start };
                if let Some(place) = place {
                    let began = Deed::Began { model_hash: judging.model_hash, is_enabled };
                    before.entry(place).or_default().push(began);
                }
                // A command that its sender still holds is obeyed by the next judge once more.
                obeyed.clear();
                known = State::of(judging);
                known.command = if is_middle { judging.command } else { 0 };
            }
            if judging.command != known.command || judging.model_hash != known.model_hash {
                let place = MessageId { epoch: judging.obeyed_epoch, seq: judging.obeyed_seq };
                let deeds = self.deeds(judging, known, &mut obeyed);
                let is_at_begin = place.seq == 0 || !couples.contains(&place);
                match (is_at_begin, first.or(first_couples)) {
                    (false, _) => after.entry(place).or_default().extend(deeds),
                    (true, Some(first)) => before.entry(first).or_default().extend(deeds),
                    (true, None) => (),
                }
            }
            known = State::of(judging);
        }
        Ok(Plan {
            station,
            encoders: self.encoders,
            sent: self.sent,
            before,
            after,
            verdicts: self.verdicts,
            is_from_start,
            lost: self.lost,
            end: self.end.unwrap_or(End::Complete),
        })
    }

    /// The first couples that each judge took, by its start, as far as any of its messages says it.
    fn firsts(&self) -> HashMap<u64, MessageId> {
        let mut firsts = HashMap::new();
        for judging in self.judgings.iter().filter(|judging| judging.first_seq != 0) {
            let first = MessageId { epoch: judging.first_epoch, seq: judging.first_seq };
            firsts.entry(judging.stamp.epoch).or_insert(first);
        }
        firsts
    }

    /// What the judge did between two of its messages. Of several commands that it obeyed at once only the last is named: those before it came at the
    /// same place.
    fn deeds(&self, judging: &Judging, known: State, obeyed: &mut HashSet<u64>) -> Vec<Deed> {
        let until = self.commands.iter().position(|command| command.number == judging.command);
        let from = self.commands.iter().position(|command| command.number == known.command);
        let mut deeds = Vec::new();
        if let Some(until) = until {
            let begin = from.map_or(until, |from| from + 1).min(until);
            for message in &self.commands[begin..=until] {
                let is_last = message.number == judging.command;
                let is_refused = is_last && judging.refusal != Refusal::None.code();
                if let Ok(command) = command::read(message)
                    && obeyed.insert(message.number)
                    && !is_refused
                    && !matches!(command, Command::LoadJob { .. })
                {
                    deeds.push(Deed::Obeyed(command));
                }
            }
        }
        if judging.model_hash != known.model_hash {
            deeds.push(Deed::Loaded(judging.model_hash));
        }
        deeds
    }
}

/// What is known of the judge.
#[derive(Clone, Copy, Default)]
struct State {
    epoch: u64,
    command: u64,
    model_hash: u64,
}

impl State {
    fn of(judging: &Judging) -> Self {
        let Judging { stamp, command, model_hash, .. } = *judging;
        Self { epoch: stamp.epoch, command, model_hash }
    }
}

/// Of everything in couples that is computed: not of when and by whom they were sent.
pub(super) fn digest(couples: &Couples) -> u64 {
    let computed = Couples { stamp: Stamp::default(), flags: 0, ..*couples };
    let mut hasher = DefaultHasher::new();
    bytes_of(&computed).hash(&mut hasher);
    hasher.finish()
}
