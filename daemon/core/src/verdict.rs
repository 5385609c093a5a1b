//! What the method says, and why (DESIGN 5).

use crate::couple::Context;
use crate::input::Side;

/// What is judged, and how it came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The IU is right.
    IuOk,
    /// The IU cannot be right any more.
    IuAnomaly,
    /// The activity is right.
    ActivityOk,
    /// The activity cannot be right any more.
    ActivityAnomaly,
    /// The job is right.
    JobOk,
    /// The job cannot be right any more.
    JobAnomaly,
    /// There was too little to go by.
    NotJudged,
}

/// The rule that decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// Nothing is wrong.
    None,
    /// No nominal activity has this context at this place, and none has it anywhere in the activity.
    WrongObject,
    /// The context belongs to the activity, or the activity to the job, but not here.
    WrongOrder,
    /// The DTW distance is over the threshold of every candidate.
    Motion,
    /// Fewer frames or fewer reversals than in any correct demonstration's bounds.
    TooShort,
    /// More frames or more reversals than in any correct demonstration's bounds.
    TooLong,
    /// The activity or the job ended before its last part.
    NotCompleted,
    /// It could not be told.
    Unknown,
    /// The hand or an object was out of sight for too long.
    Blind,
    /// A capacity was full.
    Overload,
}

/// One verdict.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// What is judged, and how it came out.
    pub kind: Kind,
    /// The rule that decided.
    pub reason: Reason,
    /// Whose hand; `None` for a job.
    pub side: Option<Side>,
    /// The nominal activity it is judged against ([`crate::job::NominalActivity::activity`]), if any is near.
    pub nearest: Option<u16>,
    /// The number of the activity in this job, from 0 as they came; for a job, how many came.
    pub activity: u16,
    /// The number of the IU in its activity, from 0 as they came; `None` for activity and job verdicts.
    pub iu: Option<u16>,
    /// The context of the IU; of its first IU for an activity.
    pub context: Context,
    /// DTW distance to the nearest nominal, where one was computed.
    pub distance: Option<f32>,
    /// The threshold it was held against.
    pub threshold: Option<f32>,
    /// Said before the IU ended.
    pub early: bool,
    /// When what is judged began, in nanoseconds.
    pub began_ns: u64,
    /// When it ended; for an early verdict the time it was decided at.
    pub ended_ns: u64,
    /// The time of the newest frame that the decision rests on: `persist_frames` after the newest couple.
    pub decided_ns: u64,
}
