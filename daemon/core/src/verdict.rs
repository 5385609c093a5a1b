//! What the method says, and why.

use crate::couple::Context;
use crate::input::Side;

/// What is judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Level {
    /// One IU.
    Iu,
    /// One activity.
    Activity,
    /// The whole job.
    #[default]
    Job,
}

/// How it came out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outcome {
    /// It is right.
    Ok,
    /// It cannot be right any more.
    Anomaly,
    /// There was too little to decide by.
    #[default]
    NotJudged,
}

/// The rule that decided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reason {
    /// Nothing is wrong.
    None,
    /// No nominal activity has this context at this index, and none of the possible ones has it anywhere.
    WrongObject,
    /// The context belongs to the activity, or the activity to the job, but not now.
    WrongOrder,
    /// The DTW distance is above the threshold of every candidate.
    Motion,
    /// Fewer frames or fewer reversals than the taught bounds.
    TooShort,
    /// More frames or more reversals than the taught bounds.
    TooLong,
    /// The activity or the job ended before it was complete.
    NotCompleted,
    /// There was nothing to compare it with.
    #[default]
    Unknown,
    /// Too little was seen, and it is not known of what.
    Blind,
    /// It lasted longer than can be compared.
    Overload,
    /// A hand was not seen for too long.
    HandNotSeen,
    /// An object was not seen for too long.
    ObjectNotSeen,
    /// It may have begun before what was seen of it.
    BeginningNotSeen,
    /// It was not watched to its end: the couples broke off.
    BrokenOff,
    /// No frame came for too long.
    FramesMissing,
    /// Too few frames came.
    TooFewFrames,
    /// Whether its two objects touched, or one only passed the other, cannot be told.
    Passing,
    /// The marker of an object was in view twice.
    MarkerTwice,
}

/// What was missing for a verdict that could not be given. All is `None` of other verdicts, and where it does not say why.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Missing {
    /// The hand that was not seen.
    pub hand: Option<Side>,
    /// The id of the object that was not seen.
    pub object: Option<u16>,
    /// For how long the hand or object was not seen, in all, or no frame came, at most; in seconds.
    pub seconds: Option<f32>,
    /// How many of a hundred frames of what the verdict depends on were captured.
    pub captured_percent: Option<u8>,
    /// How many of a hundred frames the job needs.
    pub needed_percent: Option<u8>,
}

/// How an activity breaks the order of its job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrderFault {
    /// It began before the other one had begun.
    NotBegun,
    /// It began before the other one had ended.
    NotEnded,
    /// It began after the other one.
    TooLate,
    /// It was done already: the other one is itself.
    Again,
}

/// The relation between two activities that was broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BrokenOrder {
    /// How.
    pub fault: OrderFault,
    /// The other activity ([`crate::job::NominalActivity::activity`]).
    pub activity: u16,
    /// How many of the runs that were shown keep the relation: all that have both.
    pub runs: u16,
}

/// What was not shown before and breaks no law: was it right?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Note {
    /// The activity came before another one that had come first in all runs.
    Order,
    /// The activity was done already.
    Again,
    /// The other hand did it.
    OtherHand,
    /// No nominal activity is done so, and all its parts belong to the job.
    Step,
}

/// What of an IU is out of its bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Measure {
    /// How long it lasted, in seconds; too long is only the time in which the hand did not wait for the other one.
    Duration,
    /// How many strokes it had, to and fro.
    Strokes,
    /// The mean length of a stroke, in metres.
    StrokeLength,
    /// The length of its path, in metres.
    Path,
    /// The lateral deviation: how far off the straight line the way of the hand leads, in metres.
    LateralDeviation,
    /// How far its direction lies from the one that was shown, in degrees.
    Direction,
    /// How far its place lies from the one that was shown, in metres.
    Place,
}

/// What was measured of an IU that is out of a bound, beside what the runs measured that were shown. The bound itself is wider.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Which measure it is, and its unit.
    pub measure: Measure,
    /// What it measured; of an early verdict, so far.
    pub value: f32,
    /// The minimum that was shown.
    pub shown_min: f32,
    /// The maximum that was shown.
    pub shown_max: f32,
}

/// One verdict. The default says nothing: a job that was not judged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Verdict {
    /// What is judged.
    pub level: Level,
    /// How it came out.
    pub outcome: Outcome,
    /// The rule that decided.
    pub reason: Reason,
    /// Whose hand; `None` for a job.
    pub side: Option<Side>,
    /// The activity it is judged against ([`crate::job::NominalActivity::activity`]), if any is near.
    pub nearest: Option<u16>,
    /// The number of the activity in this job, from 0 in the order in which they came; for a job, how many came.
    pub activity: u16,
    /// The number of the IU in its activity, from 0 in the order in which they came; `None` for activities and jobs.
    pub iu: Option<u16>,
    /// The context of the IU; of its first IU for an activity.
    pub context: Context,
    /// DTW distance to the nearest nominal IU, if one was computed.
    pub distance: Option<f32>,
    /// The threshold with which the distance was compared.
    pub threshold: Option<f32>,
    /// How many of a hundred frames of the IU were captured; `None` where that says nothing: at its beginning, for activities and jobs.
    pub captured_percent: Option<u8>,
    /// In how many of a hundred frames of the IU the hand and each object that it acts on were seen. `None` where `captured_percent` is.
    pub seen_percent: Option<u8>,
    /// Why it was not judged, with figures.
    pub missing: Missing,
    /// The measure that is out of its bounds. Why an IU is wrong, or would be if what was not seen of it had no other explanation. An activity and a
    /// job have that of the IU for which they are wrong.
    pub measured: Option<Measured>,
    /// The relation that was broken, where that is why an activity or a job is wrong.
    pub broken: Option<BrokenOrder>,
    /// What was not shown before, of an activity; of a job, the first such thing in it.
    pub note: Option<Note>,
    /// Whether it was given before the end of what is judged.
    pub early: bool,
    /// When what is judged began, in nanoseconds.
    pub began_ns: u64,
    /// When it ended; for an early verdict, the time of the newest couples, in nanoseconds.
    pub ended_ns: u64,
    /// The time of the newest frame that the verdict depends on, in nanoseconds: `persist_frames` after the newest couples.
    /// A verdict that needs more frames to be believed says so.
    pub decided_ns: u64,
}
