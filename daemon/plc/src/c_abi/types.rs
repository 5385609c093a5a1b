//! What a C program sees. The enums of a verdict are not here: the header has them from the wire, see `tests/header.rs`.

use std::ffi::c_char;

use shm_schemas::{PART_BYTES, STATION_BYTES, Stamp, Verdict};

/// How a call ended. Negative numbers are faults.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AndonResult {
    /// No verdict came in time; for the other functions: it is done.
    Nothing = 0,
    /// A verdict is in `out`.
    Verdict = 1,
    /// The judge has been stopped or has died, and no verdict comes until it is back. Returned once: clear your own ready bit.
    WriterGone = 2,
    /// A pointer is null, or a text is not UTF-8.
    Argument = -1,
    /// The station's name or root is not allowed.
    Station = -2,
    /// The station is not running (no steward), or was not ready in time.
    NoSteward = -3,
    /// The station runs another version of Andon.
    OtherBuild = -4,
    /// The verdict channel has as many readers as it allows.
    TooManyReaders = -5,
    /// Shared memory or the operating system refused.
    System = -6,
    /// A fault in this library. The reader can only be closed.
    Internal = -7,
}

/// In place of an index that has no meaning on this level.
pub const ANDON_NO_INDEX: u16 = 0xFFFF;
const _: () = assert!(ANDON_NO_INDEX == shm_schemas::NO_INDEX);

/// Bytes of a station's name, with the zero at its end.
pub const ANDON_STATION_BYTES: usize = 17;
const _: () = assert!(ANDON_STATION_BYTES == STATION_BYTES + 1);

/// Bytes of a part id, with the zero at its end.
pub const ANDON_PART_BYTES: usize = 33;
const _: () = assert!(ANDON_PART_BYTES == PART_BYTES + 1);

/// One verdict.
#[repr(C)]
pub struct AndonVerdict {
    /// Number of the verdict since this start of the judge, from 1. A gap is a loss.
    pub seq: u64,
    /// Number of this start of the judge.
    pub epoch: u64,
    /// Number of the newest frame that the verdict depends on.
    pub frame_seq: u64,
    /// When that frame was captured, CLOCK_MONOTONIC in nanoseconds.
    pub captured_ns: u64,
    /// When the verdict was sent, CLOCK_MONOTONIC in nanoseconds.
    pub sent_ns: u64,
    /// Hash of the job file.
    pub model_hash: u64,
    /// When the IU, activity or job began, source time in nanoseconds.
    pub began_ns: u64,
    /// When it ended, or when it was decided if that was earlier, source time in nanoseconds.
    pub ended_ns: u64,
    /// Time of the newest feature couple that the decision depends on, source time in nanoseconds.
    pub decided_ns: u64,
    /// When it was decided, nanoseconds since 1970 UTC.
    pub decided_utc_ns: u64,
    /// The job that is watched.
    pub job_id: u32,
    /// DTW distance to the nearest nominal; NaN if none was computed.
    pub distance: f32,
    /// The threshold that the distance was compared with; NaN if there is none.
    pub threshold: f32,
    /// What the measure is that is out of its bounds, in the unit of `measure`; NaN if none is.
    pub measured: f32,
    /// The minimum that was shown; NaN if none is out of its bounds.
    pub shown_min: f32,
    /// The maximum that was shown; NaN if none is out of its bounds.
    pub shown_max: f32,
    /// Context features x_c of the IU; of its first IU for an activity; 0 for a job.
    pub x_c: [u16; 4],
    /// Index of the activity in this job, from 0, or ANDON_NO_INDEX.
    pub activity: u16,
    /// Index of the IU in its activity, from 0, or ANDON_NO_INDEX.
    pub iu: u16,
    /// Index of the nominal activity that it was judged against, or ANDON_NO_INDEX.
    pub nearest: u16,
    /// Index of the other nominal activity of the order that was broken, or ANDON_NO_INDEX.
    pub broken_activity: u16,
    /// How many of the runs that were shown keep that order.
    pub broken_runs: u16,
    /// An AndonLevel.
    pub level: u8,
    /// An AndonOutcome. Treat a number that is not in the list as not judged: it comes from another version.
    pub outcome: u8,
    /// An AndonReason.
    pub reason: u8,
    /// An AndonHand.
    pub hand: u8,
    /// 1 if the verdict came before the IU ended, otherwise 0.
    pub early: u8,
    /// An AndonNote: what was not shown before and breaks no rule of the order.
    pub note: u8,
    /// An AndonOrderFault.
    pub broken: u8,
    /// An AndonMeasure: which measure is out of its bounds.
    pub measure: u8,
    /// Name of the station, zero-terminated.
    pub station: [c_char; ANDON_STATION_BYTES],
    /// The part id that was in force when the job began, printable ASCII, zero-terminated; empty if none was given.
    pub part: [c_char; ANDON_PART_BYTES],
}

impl From<&Verdict> for AndonVerdict {
    fn from(verdict: &Verdict) -> Self {
        // Every field is named: one that is new on the wire does not compile before C has it, or leaves it out as the last ones.
        let Verdict {
            stamp: Stamp { seq, epoch, frame_seq, captured_ns, sent_ns },
            model_hash,
            began_ns,
            ended_ns,
            decided_ns,
            decided_utc_ns,
            job_id,
            distance,
            threshold,
            measured,
            shown_min,
            shown_max,
            x_c,
            activity,
            iu,
            nearest,
            broken_activity,
            broken_runs,
            level,
            outcome,
            reason,
            hand,
            early,
            note,
            broken,
            measure,
            station,
            part,
            missing_s: _,
            missing_object: _,
            missing_hand: _,
            missing_percent: _,
            needed_percent: _,
            captured_percent: _,
            seen_percent: _,
            reserved: _,
        } = *verdict;
        Self {
            seq,
            epoch,
            frame_seq,
            captured_ns,
            sent_ns,
            model_hash,
            began_ns,
            ended_ns,
            decided_ns,
            decided_utc_ns,
            job_id,
            distance,
            threshold,
            measured,
            shown_min,
            shown_max,
            x_c,
            activity,
            iu,
            nearest,
            broken_activity,
            broken_runs,
            level,
            outcome,
            reason,
            hand,
            early,
            note,
            broken,
            measure,
            station: text(&station),
            part: text(part.bytes()),
        }
    }
}

/// Bytes as a text of C, with a zero at its end.
fn text<const BYTES: usize>(bytes: &[u8]) -> [c_char; BYTES] {
    let mut text = [0; BYTES];
    // The last one stays.
    for (to, from) in text.iter_mut().take(BYTES - 1).zip(bytes) {
        *to = *from as c_char;
    }
    text
}

/// What the reader has received since it was opened.
#[repr(C)]
#[derive(Default)]
pub struct AndonStatus {
    /// Number of verdicts received.
    pub received: u64,
    /// Number of verdicts that were sent and not read in time.
    pub lost: u64,
    /// Number of restarts of the judge.
    pub restarts: u32,
    /// 1 if the judge has gone away and no verdict has come since, otherwise 0.
    pub writer_gone: u8,
    /// 1 while every process of the station says that it runs, perceive that it sees the bench, and the judge that it watches a job,
    /// otherwise 0. Silence is 0.
    pub ready: u8,
    /// Keeps the size a multiple of 8.
    pub reserved: [u8; 2],
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use shm_schemas::PartId;

    #[test]
    fn every_field_of_a_verdict_arrives_in_c() {
        let mut verdict = Verdict {
            model_hash: 6,
            began_ns: 7,
            ended_ns: 8,
            decided_ns: 9,
            decided_utc_ns: 10,
            job_id: 11,
            distance: 12.0,
            threshold: 13.0,
            x_c: [14, 15, 16, 17],
            activity: 18,
            iu: 19,
            nearest: 20,
            level: 21,
            outcome: 22,
            reason: 23,
            hand: 24,
            early: 25,
            note: 26,
            broken: 27,
            broken_activity: 28,
            broken_runs: 29,
            measured: 30.0,
            shown_min: 31.0,
            shown_max: 32.0,
            measure: 33,
            station: [b's'; STATION_BYTES],
            part: PartId::new(&[b'p'; PART_BYTES]).unwrap(),
            ..Verdict::default()
        };
        let stamp = &mut verdict.stamp;
        (stamp.seq, stamp.epoch, stamp.frame_seq, stamp.captured_ns, stamp.sent_ns) = (1, 2, 3, 4, 5);
        let c = AndonVerdict::from(&verdict);
        assert_eq!([c.seq, c.epoch, c.frame_seq, c.captured_ns, c.sent_ns], [1, 2, 3, 4, 5]);
        assert_eq!([c.model_hash, c.began_ns, c.ended_ns, c.decided_ns, c.decided_utc_ns], [6, 7, 8, 9, 10]);
        assert_eq!((c.job_id, c.distance, c.threshold, c.x_c), (11, 12.0, 13.0, [14, 15, 16, 17]));
        assert_eq!([c.activity, c.iu, c.nearest], [18, 19, 20]);
        assert_eq!([c.level, c.outcome, c.reason, c.hand, c.early], [21, 22, 23, 24, 25]);
        assert_eq!([c.note, c.broken], [26, 27]);
        assert_eq!([c.broken_activity, c.broken_runs], [28, 29]);
        assert_eq!((c.measured, c.shown_min, c.shown_max, c.measure), (30.0, 31.0, 32.0, 33));
        assert!(c.station[..STATION_BYTES].iter().all(|&byte| byte == b's' as c_char));
        assert_eq!(c.station[STATION_BYTES], 0);
        assert!(c.part[..PART_BYTES].iter().all(|&byte| byte == b'p' as c_char));
        assert_eq!(c.part[PART_BYTES], 0);
    }
}
