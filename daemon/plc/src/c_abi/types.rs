//! What a C program sees.

use std::ffi::c_char;

use shm_schemas::{HandCode, STATION_BYTES, Verdict, VerdictKind, VerdictReason};

/// What is judged, and how it came out.
#[repr(u8)]
pub enum AndonKind {
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

/// The rule that decided.
#[repr(u8)]
pub enum AndonReason {
    /// Nothing is wrong.
    None = 0,
    /// The context belongs to no nominal activity.
    WrongObject = 1,
    /// The context or the activity does not belong here.
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

/// Which hand.
#[repr(u8)]
pub enum AndonHand {
    /// No hand: verdicts on jobs.
    None = 0,
    /// The right hand.
    Right = 1,
    /// The left hand.
    Left = 2,
}

// The numbers are those of the wire.
const _: () = {
    assert!(AndonKind::IuOk as u8 == VerdictKind::IuOk.code());
    assert!(AndonKind::IuAnomaly as u8 == VerdictKind::IuAnomaly.code());
    assert!(AndonKind::ActivityOk as u8 == VerdictKind::ActivityOk.code());
    assert!(AndonKind::ActivityAnomaly as u8 == VerdictKind::ActivityAnomaly.code());
    assert!(AndonKind::JobOk as u8 == VerdictKind::JobOk.code());
    assert!(AndonKind::JobAnomaly as u8 == VerdictKind::JobAnomaly.code());
    assert!(AndonKind::NotJudged as u8 == VerdictKind::NotJudged.code());
    assert!(VerdictKind::ALL.len() == 7);
    assert!(AndonReason::None as u8 == VerdictReason::None.code());
    assert!(AndonReason::WrongObject as u8 == VerdictReason::WrongObject.code());
    assert!(AndonReason::WrongOrder as u8 == VerdictReason::WrongOrder.code());
    assert!(AndonReason::Motion as u8 == VerdictReason::Motion.code());
    assert!(AndonReason::TooShort as u8 == VerdictReason::TooShort.code());
    assert!(AndonReason::TooLong as u8 == VerdictReason::TooLong.code());
    assert!(AndonReason::NotCompleted as u8 == VerdictReason::NotCompleted.code());
    assert!(AndonReason::Unknown as u8 == VerdictReason::Unknown.code());
    assert!(AndonReason::Blind as u8 == VerdictReason::Blind.code());
    assert!(AndonReason::Overload as u8 == VerdictReason::Overload.code());
    assert!(VerdictReason::ALL.len() == 10);
    assert!(AndonHand::None as u8 == HandCode::None.code());
    assert!(AndonHand::Right as u8 == HandCode::Right.code());
    assert!(AndonHand::Left as u8 == HandCode::Left.code());
    assert!(HandCode::ALL.len() == 3);
};

/// How a call ended: not negative is no fault.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AndonResult {
    /// Nothing came in time; or: done.
    Nothing = 0,
    /// A verdict is in `out`.
    Verdict = 1,
    /// The judge is gone, stopped or dead: nothing comes until it is back. Said once. Drop ready.
    WriterGone = 2,
    /// A null pointer, or text that is not UTF-8.
    Argument = -1,
    /// The station's name or root cannot be used.
    Station = -2,
    /// The station has no steward.
    NoSteward = -3,
    /// The station runs another build.
    OtherBuild = -4,
    /// Too many readers.
    TooManyReaders = -5,
    /// Shared memory or the system refused.
    System = -6,
    /// A fault in this library; the reader cannot be used any more, only closed.
    Internal = -7,
}

/// In place of an index that has no meaning for this kind of verdict.
pub const ANDON_NO_INDEX: u16 = 0xFFFF;
const _: () = assert!(ANDON_NO_INDEX == shm_schemas::NO_INDEX);

/// Bytes of a station's name with the zero behind it.
pub const ANDON_STATION_BYTES: usize = 17;
const _: () = assert!(ANDON_STATION_BYTES == STATION_BYTES + 1);

/// One verdict.
#[repr(C)]
pub struct AndonVerdict {
    /// Number among its judge's, from 1. A jump is a loss.
    pub seq: u64,
    /// One per start of the judge.
    pub epoch: u64,
    /// The newest frame it rests on.
    pub frame_seq: u64,
    /// When that frame was captured, CLOCK_MONOTONIC in nanoseconds.
    pub captured_ns: u64,
    /// When the verdict was sent, CLOCK_MONOTONIC in nanoseconds.
    pub sent_ns: u64,
    /// Hash of the job file.
    pub model_hash: u64,
    /// When what is judged began, source time in nanoseconds.
    pub began_ns: u64,
    /// When it ended, source time in nanoseconds.
    pub ended_ns: u64,
    /// The newest couple the decision rests on, source time in nanoseconds.
    pub decided_ns: u64,
    /// When it was decided, nanoseconds since 1970 UTC.
    pub decided_utc_ns: u64,
    /// The job.
    pub job_id: u32,
    /// DTW distance to the nearest nominal; NaN none.
    pub distance: f32,
    /// The threshold it was held against; NaN none.
    pub threshold: f32,
    /// Context features x_c.
    pub x_c: [u16; 4],
    /// Number of the activity in this job, from 0, or ANDON_NO_INDEX.
    pub activity: u16,
    /// Number of the IU in its activity, from 0, or ANDON_NO_INDEX.
    pub iu: u16,
    /// The nominal activity it is judged against, or ANDON_NO_INDEX.
    pub nearest: u16,
    /// An AndonKind. A number that is not in the list comes from another build: treat it as not judged.
    pub kind: u8,
    /// An AndonReason.
    pub reason: u8,
    /// An AndonHand.
    pub hand: u8,
    /// 1: said before the IU ended.
    pub early: u8,
    /// Name of the station, zero-terminated.
    pub station: [c_char; ANDON_STATION_BYTES],
}

impl From<&Verdict> for AndonVerdict {
    fn from(verdict: &Verdict) -> Self {
        let mut station = [0; ANDON_STATION_BYTES];
        for (to, from) in station.iter_mut().zip(verdict.station) {
            *to = from as c_char;
        }
        Self {
            seq: verdict.stamp.seq,
            epoch: verdict.stamp.epoch,
            frame_seq: verdict.stamp.frame_seq,
            captured_ns: verdict.stamp.captured_ns,
            sent_ns: verdict.stamp.sent_ns,
            model_hash: verdict.model_hash,
            began_ns: verdict.began_ns,
            ended_ns: verdict.ended_ns,
            decided_ns: verdict.decided_ns,
            decided_utc_ns: verdict.decided_utc_ns,
            job_id: verdict.job_id,
            distance: verdict.distance,
            threshold: verdict.threshold,
            x_c: verdict.x_c,
            activity: verdict.activity,
            iu: verdict.iu,
            nearest: verdict.nearest,
            kind: verdict.kind,
            reason: verdict.reason,
            hand: verdict.hand,
            early: verdict.early,
            station,
        }
    }
}

/// What the reader has seen since it was opened.
#[repr(C)]
#[derive(Default)]
pub struct AndonStatus {
    /// Verdicts received.
    pub received: u64,
    /// Verdicts sent and not received in time.
    pub lost: u64,
    /// Starts of the judge after the first.
    pub restarts: u32,
    /// 1: the judge went away and nothing has come since.
    pub writer_gone: u8,
    /// Keeps the size a multiple of 8.
    pub reserved: [u8; 3],
}
