//! Channel `verdict`: what is judged, how it came out, and why (DESIGN 5).

use crate::code::codes;
use crate::layout::{message, wire};
use crate::stamp::Stamp;

/// Longest name of a station, in bytes: it must fit a verdict, a unit name and a path under 60 characters.
pub const STATION_BYTES: usize = 16;

/// In place of an index that has no meaning for this kind of verdict.
pub const NO_INDEX: u16 = 0xFFFF;

codes! {
    /// What is judged, and how it came out.
    enum VerdictKind: u8 {
        /// The IU is right.
        IuOk = 1,
        /// The IU cannot be right any more.
        IuAnomaly = 2,
        /// The activity is right.
        ActivityOk = 3,
        /// The activity cannot be right any more.
        ActivityAnomaly = 4,
        /// The job is right.
        JobOk = 5,
        /// The job cannot be right any more.
        JobAnomaly = 6,
        /// There was too little to go by.
        NotJudged = 7,
    }
}

codes! {
    /// The rule that decided.
    enum VerdictReason: u8 {
        /// Nothing is wrong.
        None = 0,
        /// No nominal activity has this context at this place, and none has it anywhere in the activity.
        WrongObject = 1,
        /// The context belongs to the activity, or the activity to the job, but not here.
        WrongOrder = 2,
        /// The DTW distance is over the threshold of every candidate.
        Motion = 3,
        /// Less than in any correct demonstration's bounds.
        TooShort = 4,
        /// More than in any correct demonstration's bounds.
        TooLong = 5,
        /// The activity or the job ended before its last part.
        NotCompleted = 6,
        /// It could not be told.
        Unknown = 7,
        /// The hand or an object was out of sight for too long.
        Blind = 8,
        /// A capacity was full.
        Overload = 9,
    }
}

codes! {
    /// Which hand; the number is `ID_h` of the context features.
    enum HandCode: u8 {
        /// No hand: verdicts on jobs.
        None = 0,
        /// The right hand.
        Right = 1,
        /// The left hand.
        Left = 2,
    }
}

wire! { "andon.Verdict", 128;
    /// One verdict. The stamp's frame is the newest one that the decision rests on.
    struct Verdict {
        /// The stamp.
        stamp: Stamp,
        /// Hash of the job file that it was judged by.
        model_hash: u64,
        /// When what is judged began, source time in nanoseconds.
        began_ns: u64,
        /// When it ended; for an early verdict the time it was decided at. Source time in nanoseconds.
        ended_ns: u64,
        /// The newest couple that the decision rests on, source time in nanoseconds.
        decided_ns: u64,
        /// When it was decided, nanoseconds since 1970 UTC.
        decided_utc_ns: u64,
        /// The job that is watched.
        job_id: u32,
        /// DTW distance to the nearest nominal; NaN where none was computed.
        distance: f32,
        /// The threshold it was held against; NaN where there is none.
        threshold: f32,
        /// Context of the IU, `x_c`; of its first IU for an activity; zero for a job.
        x_c: [u16; 4],
        /// Number of the activity in this job, from 0 as they came; [`NO_INDEX`] for a job.
        activity: u16,
        /// Number of the IU in its activity, from 0 as they came; [`NO_INDEX`] for activities and jobs.
        iu: u16,
        /// The nominal activity it is judged against; [`NO_INDEX`] when none is near.
        nearest: u16,
        /// A [`VerdictKind`]. Zero is none: an empty message is no verdict.
        kind: u8,
        /// A [`VerdictReason`].
        reason: u8,
        /// A [`HandCode`].
        hand: u8,
        /// 1 when it was said before the IU ended, else 0.
        early: u8,
        /// Name of the station, ASCII, filled up with zeros.
        station: [u8; STATION_BYTES],
        /// Keeps the size a multiple of 8.
        reserved: [u8; 2],
    }
}
message!(Verdict);
