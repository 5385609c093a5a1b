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
#[derive(Debug)]
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
    /// DTW distance to the nearest taught motion; NaN if none was computed.
    pub distance: f32,
    /// The threshold that the distance was compared with; NaN if there is none.
    pub threshold: f32,
    /// The value of the measure that is out of its bounds, in the unit of `measure`; NaN if none is.
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
    /// Index of the taught activity that it was judged against, or ANDON_NO_INDEX.
    pub nearest: u16,
    /// Index of the other taught activity of the order that was broken, or ANDON_NO_INDEX.
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

/// Takes a verdict from the wire: the fields that C has as the wire has them, and those that C has not. Each field of the wire is named once: a new
/// one does not compile before it is in one of the two lists.
macro_rules! from_wire {
    (same: $($same:ident)+, left out: $($left_out:ident)+) => {
        impl From<&Verdict> for AndonVerdict {
            fn from(verdict: &Verdict) -> Self {
                let Verdict { stamp, station, part, $($same,)+ $($left_out: _,)+ } = *verdict;
                let Stamp { seq, epoch, frame_seq, captured_ns, sent_ns } = stamp;
                let (station, part) = (text(&station), text(part.bytes()));
                Self { seq, epoch, frame_seq, captured_ns, sent_ns, station, part, $($same),+ }
            }
        }
    };
}

from_wire!(
    same: model_hash began_ns ended_ns decided_ns decided_utc_ns job_id distance threshold measured shown_min shown_max
        x_c activity iu nearest broken_activity broken_runs level outcome reason hand early note broken measure,
    left out: missing_s missing_object missing_hand missing_percent needed_percent captured_percent seen_percent reserved
);

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
    /// 1 while every process of the station says that it runs, perceive sees the bench and the judge watches a job, otherwise 0. Silence is 0.
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
    fn texts_as_long_as_they_may_be_end_with_a_zero() {
        let part = PartId::new(&[b'p'; PART_BYTES]).unwrap();
        let c = AndonVerdict::from(&Verdict { station: [b's'; STATION_BYTES], part, ..Verdict::NONE });
        let ends = |text: &[c_char], of: u8| {
            text.split_last() == Some((&0, vec![of as c_char; text.len() - 1].as_slice()))
        };
        assert!(ends(&c.station, b's') && ends(&c.part, b'p'));
    }
}
