//! Channel `verdict`: what is judged, how it came out, and why.

use crate::code::{UnknownCode, codes};
use crate::layout::wire;
use crate::part::PartId;
use crate::stamp::{Stamp, message};

/// Longest name of a station, in bytes: it must fit a verdict, a unit name and a path under 60 characters.
pub const STATION_BYTES: usize = 16;

/// In place of an index that has no meaning on this level.
pub const NO_INDEX: u16 = 0xFFFF;

/// In place of a percentage where there is none.
pub const NO_PERCENT: u8 = 0xFF;

codes! {
    /// What is judged.
    enum VerdictLevel: u8 {
        /// One IU (interaction unit): one contact within a step.
        Iu = 1 as "iu",
        /// One activity: a step of the job.
        Activity = 2 as "activity",
        /// The whole job.
        Job = 3 as "job",
    }
}

codes! {
    /// How it came out.
    enum VerdictOutcome: u8 {
        /// It was done right.
        Ok = 1 as "ok",
        /// It can no longer be right.
        Anomaly = 2 as "anomaly",
        /// Too little was seen to decide.
        NotJudged = 3 as "not_judged",
    }
}

/// The word under the key `kind` of JSON and CSV: level and outcome in one, where `NotJudged` names no level.
/// Programs outside read it; this is the only place that makes it.
pub const fn verdict_kind(level: VerdictLevel, outcome: VerdictOutcome) -> &'static str {
    match (level, outcome) {
        (VerdictLevel::Iu, VerdictOutcome::Ok) => "IuOk",
        (VerdictLevel::Iu, VerdictOutcome::Anomaly) => "IuAnomaly",
        (VerdictLevel::Activity, VerdictOutcome::Ok) => "ActivityOk",
        (VerdictLevel::Activity, VerdictOutcome::Anomaly) => "ActivityAnomaly",
        (VerdictLevel::Job, VerdictOutcome::Ok) => "JobOk",
        (VerdictLevel::Job, VerdictOutcome::Anomaly) => "JobAnomaly",
        (_, VerdictOutcome::NotJudged) => "NotJudged",
    }
}

codes! {
    /// The rule that decided.
    enum VerdictReason: u8 {
        /// Nothing is wrong.
        None = 0,
        /// A wrong object, or the wrong hand: no taught activity that is still possible has this contact.
        WrongObject = 1,
        /// Wrong order: the IU belongs to the activity, or the activity to the job, but not at this point.
        WrongOrder = 2,
        /// Wrong motion: its DTW distance exceeds the threshold of every taught activity that is still possible.
        Motion = 3,
        /// Fewer frames, or fewer reversals of the movement, than the demonstrations allow.
        TooShort = 4,
        /// More frames, or more reversals of the movement, than the demonstrations allow.
        TooLong = 5,
        /// The activity or the job ended before its last IU or activity.
        NotCompleted = 6,
        /// It could not be judged, for none of the other reasons.
        Unknown = 7,
        /// Too little of it was seen, for none of the other reasons.
        Blind = 8,
        /// It lasted longer than can be compared.
        Overload = 9,
        /// The hand was out of view for too long.
        HandNotSeen = 10,
        /// An object was out of view for too long.
        ObjectNotSeen = 11,
        /// Its beginning was not seen: it came before the station was enabled, or was hidden.
        BeginningNotSeen = 12,
        /// Aborted before its end: the station was disabled, got another job, or its source began again.
        BrokenOff = 13,
        /// No frame came for too long.
        FramesMissing = 14,
        /// Too few frames came.
        TooFewFrames = 15,
        /// It could not be told whether its two objects touched or one only passed the other.
        Passing = 16,
        /// The marker of an object was in view twice, so that it was not known which of the two lay on it.
        MarkerTwice = 17,
    }
}

codes! {
    /// What was not shown before and breaks no law: was it right?
    enum VerdictNote: u8 {
        /// Nothing.
        None = 0,
        /// The activity came before another one that had come first in all runs that were shown.
        Order = 1,
        /// The activity was done already.
        Again = 2,
        /// The other hand did it.
        OtherHand = 3,
        /// An unknown step, with no other parts than those of the job.
        Step = 4,
    }
}

codes! {
    /// How an activity breaks the order of its job.
    enum OrderFault: u8 {
        /// The order was kept.
        None = 0,
        /// It began before another one had begun.
        NotBegun = 1,
        /// It began before another one had ended.
        NotEnded = 2,
        /// It began after another one.
        TooLate = 3,
        /// It was done already: the other one is itself.
        Again = 4,
    }
}

codes! {
    /// What of an IU is out of its bounds, and the unit of the numbers that belong to it.
    enum VerdictMeasure: u8 {
        /// None.
        None = 0,
        /// How long it lasted, in seconds.
        Duration = 1,
        /// How many strokes it had, to and fro.
        Strokes = 2,
        /// The mean length of a stroke, in metres.
        StrokeLength = 3,
        /// The length of its path, in metres.
        Path = 4,
        /// The angle between its direction and the one that was shown, in degrees.
        Direction = 5,
        /// The distance between its place and the one that was shown, in metres.
        Place = 6,
        /// The lateral deviation: the maximum distance of the hand's path from the straight line, in metres.
        LateralDeviation = 7 as "Bow",
    }
}

codes! {
    /// Which hand; the number is `ID_h` of the context features.
    enum HandCode: u8 {
        /// No hand: verdicts on jobs.
        None = 0 as "",
        /// The right hand.
        Right = 1 as "right",
        /// The left hand.
        Left = 2 as "left",
    }
}

wire! { "andon.Verdict", 192;
    /// One verdict. The stamp names the newest frame that the decision depends on.
    struct Verdict {
        /// The stamp.
        stamp: Stamp,
        /// Hash of the job file.
        model_hash: u64,
        /// When what is judged began, in nanoseconds of source time.
        began_ns: u64,
        /// When it ended, or of an early verdict when it was decided. In nanoseconds of source time.
        ended_ns: u64,
        /// Time of the newest couple that the decision depends on, in nanoseconds of source time.
        decided_ns: u64,
        /// When it was decided, nanoseconds since 1970 UTC.
        decided_utc_ns: u64,
        /// The job.
        job_id: u32,
        /// DTW distance to the nearest taught motion; NaN when none was computed.
        distance: f32,
        /// The threshold for that distance; NaN when there is none.
        threshold: f32,
        /// The value of the measure that is out of its bounds, in the unit of `measure`; NaN when none is.
        measured: f32,
        /// The minimum that was shown; NaN when none is.
        shown_min: f32,
        /// The maximum that was shown; NaN when none is.
        shown_max: f32,
        /// For how long the hand or object was not seen, in all, or no frame came, at most, in seconds. NaN where that is not the reason.
        missing_s: f32,
        /// Context of the IU, `x_c`; of its first IU for an activity; zero for a job.
        x_c: [u16; 4],
        /// Index of the activity in this job, in the order of time; [`NO_INDEX`] for a job.
        activity: u16,
        /// Index of the IU in its activity, in the order of time; [`NO_INDEX`] for activities and jobs.
        iu: u16,
        /// The nominal activity that it is compared with; [`NO_INDEX`] when none is near.
        nearest: u16,
        /// The other activity of the order that was broken; [`NO_INDEX`] where that is not why.
        broken_activity: u16,
        /// How many of the runs that were shown keep that order.
        broken_runs: u16,
        /// The object that was not seen, or whose marker was in view twice; 0 where that is not the reason.
        missing_object: u16,
        /// A [`VerdictLevel`]. Zero is none: an empty message is not a verdict.
        level: u8,
        /// A [`VerdictOutcome`]. Zero is none.
        outcome: u8,
        /// A [`VerdictReason`].
        reason: u8,
        /// A [`HandCode`].
        hand: u8,
        /// 1 when it was decided before the IU ended, else 0.
        early: u8,
        /// Name of the station in ASCII, padded with zeros.
        station: [u8; STATION_BYTES],
        /// The part that was worked on: the id that was in force when its job began.
        part: PartId,
        /// How many of a hundred frames of the IU were captured; [`NO_PERCENT`] where that says nothing.
        captured_percent: u8,
        /// In how many of a hundred frames of the IU the hand and each object that it acts on were seen. [`NO_PERCENT`] where that says nothing.
        seen_percent: u8,
        /// How many of a hundred frames came of what the verdict depends on; [`NO_PERCENT`] where that is not the reason.
        missing_percent: u8,
        /// How many of a hundred frames the job needs; [`NO_PERCENT`] where that is not the reason, or none are asked for.
        needed_percent: u8,
        /// A [`HandCode`]: the hand that was not seen; none where that is not the reason.
        missing_hand: u8,
        /// A [`VerdictNote`].
        note: u8,
        /// An [`OrderFault`].
        broken: u8,
        /// A [`VerdictMeasure`].
        measure: u8,
        /// Keeps the size a multiple of 8.
        reserved: [u8; 3],
    }
}
message!(Verdict);

impl Verdict {
    /// What is judged.
    ///
    /// # Errors
    /// A number that stands for no level.
    pub fn level(&self) -> Result<VerdictLevel, UnknownCode> {
        self.level.try_into()
    }

    /// How it came out.
    ///
    /// # Errors
    /// A number that stands for no outcome.
    pub fn outcome(&self) -> Result<VerdictOutcome, UnknownCode> {
        self.outcome.try_into()
    }
}
