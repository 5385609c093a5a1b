//! Observations deleted from a recording: what a camera, a detector or a busy machine may miss.

use crate::simulator::Random;
use andon_core::anomaly::Judge;
use andon_core::couple::Couples;
use andon_core::input::{Frame, Side};
use andon_core::object::ObjectShape;
use andon_core::verdict::{Level, Outcome, Verdict};
use andon_learn::job_file::JobFile;
use andon_learn::recording::Recording;
use andon_learn::run::Run;
use std::ops::Range;

/// What is deleted in a stretch of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hidden {
    /// Both hands.
    Hands,
    /// One hand.
    Hand(Side),
    /// The object with this index in the header.
    Object(usize),
    /// All objects.
    Objects,
    /// One hand and the object with this index in the header.
    HandAndObject(Side, usize),
    /// The frames themselves.
    Everything,
}

impl Hidden {
    fn hide(self, frame: &mut Frame, objects: &[ObjectShape]) {
        match self {
            Self::Hands => frame.hands.clear(),
            Self::Hand(side) => frame.hands.retain(|hand| hand.side != side),
            Self::Objects => frame.objects.clear(),
            Self::Object(index) => frame.objects.retain(|object| object.id != objects[index].id),
            Self::HandAndObject(side, index) => {
                Self::Hand(side).hide(frame, objects);
                Self::Object(index).hide(frame, objects);
            }
            Self::Everything => {}
        }
    }
}

/// A deletion of observations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Deletion {
    /// Something is not seen from a time on, for so long, both in seconds.
    Stretch(Hidden, f64, f64),
    /// Only every n-th frame comes.
    Every(usize),
    /// Frames are lost at random, each with this probability.
    Lost(f64),
    /// The recording begins this many seconds later.
    Late(f64),
}

impl Deletion {
    /// Any deletion that a recording of this length in seconds and with this number of objects can have.
    pub fn any(random: &mut Random, length_s: f64, objects: usize) -> Self {
        let hidden = match random.index(6) {
            0 => Hidden::Hands,
            1 => Hidden::Object(random.index(objects)),
            2 => Hidden::Objects,
            3 => Hidden::Hand(Side::ALL[random.index(2)]),
            4 => Hidden::HandAndObject(Side::ALL[random.index(2)], random.index(objects)),
            _ => Hidden::Everything,
        };
        match random.index(8) {
            0 => Self::Every(2 + random.index(7)),
            1 => Self::Lost(random.between(0.05, 0.95)),
            2 => Self::Late(random.between(0.0, length_s)),
            _ => Self::Stretch(hidden, random.between(0.0, length_s), random.between(0.03, 10.0)),
        }
    }

    /// What is left of a recording. Its last second stays, or its last frame where frames are lost. The end of a recording is the end of the work,
    /// and what is missing then is missing.
    #[must_use]
    pub fn of(self, recording: &Recording, random: &mut Random) -> Recording {
        let mut left = recording.clone();
        let objects = recording.header.shapes();
        let began_ns = left.frames.first().map_or(0, |frame| frame.captured_ns);
        let at_s = |captured_ns: u64| (captured_ns - began_ns) as f64 * 1e-9;
        let end_s = length_s(recording) - 1.0;
        match self {
            Self::Every(count) => {
                let mut index = 0;
                left.frames.retain(|_| {
                    index += 1;
                    (index - 1) % count == 0
                });
            }
            Self::Lost(share) => {
                let newest_ns = left.frames.last().map(|frame| frame.captured_ns);
                left.frames.retain(|frame| random.uniform() >= share || Some(frame.captured_ns) == newest_ns);
            }
            Self::Late(seconds) => {
                left.frames.retain(|frame| at_s(frame.captured_ns) >= seconds.min(end_s));
            }
            Self::Stretch(hidden, from_s, seconds) => {
                let to_s = end_s.min(from_s + seconds);
                let is_within = |captured_ns| (from_s..to_s).contains(&at_s(captured_ns));
                if hidden == Hidden::Everything {
                    left.frames.retain(|frame| !is_within(frame.captured_ns));
                }
                for frame in left.frames.iter_mut().filter(|frame| is_within(frame.captured_ns)) {
                    hidden.hide(frame, &objects);
                }
            }
        }
        left
    }
}

/// Recordings one after the other, with a pause of this many seconds without frames between them. The parts of the next piece then lie
/// where that recording has them.
pub fn one_after_the_other(recordings: &[&Recording], pause_s: f64) -> Recording {
    let mut all = recordings[0].clone();
    for recording in &recordings[1..] {
        let newest_ns = all.frames.last().map_or(0, |frame| frame.captured_ns);
        let first_ns = recording.frames.first().map_or(0, |frame| frame.captured_ns);
        let shift_ns = newest_ns + (pause_s * 1e9) as u64;
        for frame in &recording.frames {
            let mut frame = frame.clone();
            frame.captured_ns = frame.captured_ns - first_ns + shift_ns;
            all.frames.push(frame);
        }
    }
    all
}

/// When an encoder ended and how long it took to start again, both in seconds.
pub type Restart = (f64, f64);

/// The verdicts of a judge that does not know whether the recording begins with a job.
///
/// # Panics
/// If the recording cannot be judged against the job.
pub fn judged(job: &JobFile, recording: &Recording) -> Vec<Verdict> {
    judged_from(job, &couples(job, recording))
}

/// The same where `encode` is killed and starts again: the couples that were held back never come, and a new encoder begins.
///
/// # Panics
/// If the recording cannot be judged against the job.
pub fn judged_with_restart(job: &JobFile, recording: &Recording, (ended_s, gap_s): Restart) -> Vec<Verdict> {
    let began_ns = recording.frames.first().map_or(0, |frame| frame.captured_ns);
    let part = |is_in: &dyn Fn(f64) -> bool| {
        let mut part = recording.clone();
        part.frames.retain(|frame| is_in((frame.captured_ns - began_ns) as f64 * 1e-9));
        couples(job, &part)
    };
    let mut all = part(&|at_s| at_s < ended_s);
    all.truncate(all.len().saturating_sub(job.method.persist_frames.into()));
    all.extend(part(&|at_s| at_s >= ended_s + gap_s));
    judged_from(job, &all)
}

fn couples(job: &JobFile, recording: &Recording) -> Vec<Couples> {
    let run = Run::new("run", "", recording, &job.method).expect("the recording can be encoded");
    run.couples_for(job).expect("the objects of the job can be encoded").to_vec()
}

fn judged_from(job: &JobFile, couples: &[Couples]) -> Vec<Verdict> {
    job.with_job(|lent| {
        let mut judge = Judge::<Vec<_>>::with_memory(lent, job.method).expect("the job was taught");
        let mut verdicts = Vec::new();
        couples.iter().for_each(|couples| judge.step(couples, &mut |event| verdicts.extend(event.verdict())));
        judge.finish(&mut |event| verdicts.extend(event.verdict()));
        verdicts
    })
}

/// Whether something was called an anomaly.
pub fn is_accused(verdicts: &[Verdict]) -> bool {
    verdicts.iter().any(|verdict| verdict.outcome == Outcome::Anomaly)
}

/// The outcomes of the jobs.
pub fn jobs(verdicts: &[Verdict]) -> Vec<Outcome> {
    verdicts.iter().filter(|verdict| verdict.level == Level::Job).map(|verdict| verdict.outcome).collect()
}

/// How long a recording is, in seconds.
pub fn length_s(recording: &Recording) -> f64 {
    let times = || recording.frames.iter().map(|frame| frame.captured_ns);
    times().max().unwrap_or(0).saturating_sub(times().min().unwrap_or(0)) as f64 * 1e-9
}

/// What became of the recordings from which something was deleted.
#[derive(Debug, Default)]
pub struct Tried {
    /// The cases in which something was called an anomaly, with what was deleted, and when the encoder started again.
    pub accused: Vec<(u64, Vec<Deletion>, Option<Restart>)>,
    /// How many cases were right all the same.
    pub right: u64,
}

/// Deletes one or two things from any of these correct recordings, as often as `cases` says. The first frame that is left shows its objects:
/// one that was never seen is expected nowhere.
pub fn try_deletions(job: &JobFile, correct: &[&Recording], seed: u64, cases: u64) -> Tried {
    let mut tried = Tried::default();
    for case in 0..cases {
        let mut random = Random::new(seed, &[99, case]);
        let whole = correct[random.index(correct.len())];
        let mut left = whole.clone();
        let deletions: Vec<Deletion> = (0..1 + random.index(2))
            .map(|_| Deletion::any(&mut random, length_s(whole), whole.header.objects.len()))
            .collect();
        for deletion in &deletions {
            left = deletion.of(&left, &mut random);
        }
        if let Some(first) = left.frames.first_mut()
            && let Some(shown) = whole.frames.iter().find(|frame| frame.captured_ns == first.captured_ns)
        {
            first.objects.clone_from(&shown.objects);
        }
        let verdicts = judged(job, &left);
        tried.right += u64::from(jobs(&verdicts) == [Outcome::Ok]);
        if is_accused(&verdicts) {
            tried.accused.push((case, deletions, None));
        }
    }
    tried
}

/// Deletes something from any two of these correct recordings, one after the other, as often as `cases` says. In half of the cases the encoder
/// starts again at any time.
pub fn try_two_pieces(job: &JobFile, correct: &[&Recording], seed: u64, cases: Range<u64>) -> Tried {
    let mut tried = Tried::default();
    for case in cases {
        let mut random = Random::new(seed, &[98, case]);
        let pieces = [(); 2].map(|()| correct[random.index(correct.len())]);
        let both = one_after_the_other(&pieces, random.between(0.2, 3.0));
        if is_accused(&judged(job, &both)) {
            continue;
        }
        let deletion = Deletion::any(&mut random, length_s(&both), both.header.objects.len());
        let left = deletion.of(&both, &mut random);
        let longest_s = [0.1, 0.6, 3.0][random.index(3)];
        // The last second stays, as with every deletion.
        let newest_s = length_s(&left) - longest_s - 1.0;
        let restart = (newest_s * random.uniform(), random.between(0.02, longest_s));
        let restart = (random.index(2) == 0 && newest_s > 1.0).then_some(restart);
        let verdicts =
            restart.map_or_else(|| judged(job, &left), |restart| judged_with_restart(job, &left, restart));
        tried.right += u64::from(jobs(&verdicts) == [Outcome::Ok; 2]);
        if is_accused(&verdicts) {
            tried.accused.push((case, vec![deletion], restart));
        }
    }
    tried
}
