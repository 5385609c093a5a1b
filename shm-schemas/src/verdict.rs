//! Channel `verdict`: what is judged, how it came out, and why.

use crate::code::{UnknownCode, codes};
use crate::layout::wire_of_fields;
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
        LateralDeviation = 7 formerly "Bow",
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

/// The fields of a verdict, in the order of the wire, for a macro: the one place that names them. It gives them to the macro `$to`.
///
/// Of them are made the wire and [`Verdict::NONE`], the struct and header for C, and the table [`COLUMNS`](crate::COLUMNS). By that table the journal and
/// CSV are written. A field has its meaning, its type, and in braces its columns. A column has its place in the table, which never changes, and its
/// kind. The kind says how a number is meant and which one stands for none. The columns of a part of a field have names of their own.
///
/// C has the fields of `in_c` as the wire has them. Of the others it has stamp, station and part alone, each in a form of its own. There a
/// `VerdictLevel` is called `AndonLevel`, as all names that C sees.
#[macro_export]
macro_rules! verdict_fields {
    ($to:ident) => { $to! { "andon.Verdict", 192, filled up by reserved: [u8; 3];
        /// One verdict. The stamp names the newest frame that the decision depends on.
        struct Verdict

        not_in_c {
            /// The stamp.
            stamp: Stamp {
                35 long epoch(.epoch), 36 long seq(.seq),
                39 long frame_seq(.frame_seq), 40 long captured_ns(.captured_ns), 41 long sent_ns(.sent_ns)
            }
        }
        in_c {
            /// Hash of the job file.
            model_hash: u64 { 6 hash }
            /// When the IU, activity or job began, source time in nanoseconds.
            began_ns: u64 { 32 time }
            /// When it ended, or when it was decided if that was earlier, source time in nanoseconds.
            ended_ns: u64 { 33 time }
            /// Time of the newest feature couple that the decision depends on, source time in nanoseconds.
            decided_ns: u64 { 34 time }
            /// When it was decided, nanoseconds since 1970 UTC.
            decided_utc_ns: u64 { 38 long }
            /// The job that is watched.
            job_id: u32 { 5 whole }
            /// DTW distance to the nearest taught motion; NaN if none was computed.
            distance: f32 { 14 number }
            /// The threshold that the distance was compared with; NaN if there is none.
            threshold: f32 { 15 number }
            /// The value of the measure that is out of its bounds, in the unit of `measure`; NaN if none is.
            measured: f32 { 22 number }
            /// The minimum that was shown; NaN if none is out of its bounds.
            shown_min: f32 { 23 number }
            /// The maximum that was shown; NaN if none is out of its bounds.
            shown_max: f32 { 24 number }
        }
        not_in_c {
            /// For how long the hand or object was not seen, in all, or no frame came, at most, in seconds. NaN where that is not the reason.
            missing_s: f32 { 29 number }
        }
        in_c {
            /// Context features x_c of the IU; of its first IU for an activity; 0 for a job.
            x_c: [u16; 4] { 10 whole x_c0([0]), 11 whole x_c1([1]), 12 whole x_c2([2]), 13 whole x_c3([3]) }
            /// Index of the activity in this job, from 0, or [`NO_INDEX`].
            activity: u16 { 7 index }
            /// Index of the IU in its activity, from 0, or [`NO_INDEX`].
            iu: u16 { 8 index }
            /// Index of the taught activity that it was judged against, or [`NO_INDEX`].
            nearest: u16 { 9 index }
            /// Index of the other taught activity of the order that was broken, or [`NO_INDEX`].
            broken_activity: u16 { 19 index }
            /// How many of the runs that were shown keep that order.
            broken_runs: u16 { 20 whole }
        }
        not_in_c {
            /// The object that was not seen, or whose marker was in view twice; 0 where that is not the reason.
            missing_object: u16 { 28 object }
        }
        in_c {
            /// A [`VerdictLevel`].
            level: u8 { 0 VerdictLevel }
            /// A [`VerdictOutcome`]. Treat a number that is not in the list as not judged: it comes from another version.
            outcome: u8 { 1 VerdictOutcome }
            /// A [`VerdictReason`].
            reason: u8 { 2 VerdictReason }
            /// A [`HandCode`].
            hand: u8 { 3 HandCode }
            /// 1 if the verdict came before the IU ended, otherwise 0.
            early: u8 { 16 whole }
        }
        not_in_c {
            /// Name of the station in ASCII, padded with zeros.
            station: [u8; STATION_BYTES] { 4 station }
            /// The part that was worked on: the id that was in force when its job began.
            part: PartId { 37 part }
            /// How many of a hundred frames of the IU were captured; [`NO_PERCENT`] where that says nothing.
            captured_percent: u8 { 25 percent }
            /// In how many of a hundred frames of the IU the hand and each object that it acts on were seen. [`NO_PERCENT`] where that says nothing.
            seen_percent: u8 { 26 percent }
            /// How many of a hundred frames came of what the verdict depends on; [`NO_PERCENT`] where that is not the reason.
            missing_percent: u8 { 30 percent }
            /// How many of a hundred frames the job needs; [`NO_PERCENT`] where that is not the reason, or none are asked for.
            needed_percent: u8 { 31 percent }
            /// A [`HandCode`]: the hand that was not seen; none where that is not the reason.
            missing_hand: u8 { 27 HandCode }
        }
        in_c {
            /// A [`VerdictNote`]: what was not shown before and breaks no rule of the order.
            note: u8 { 17 VerdictNote }
            /// An [`OrderFault`].
            broken: u8 { 18 OrderFault }
            /// A [`VerdictMeasure`]: which measure is out of its bounds.
            measure: u8 { 21 VerdictMeasure }
        }
    } };
}

verdict_fields!(wire_of_fields);
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
