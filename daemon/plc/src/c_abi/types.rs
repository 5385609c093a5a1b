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

/// Keeps the source of a struct beside it. The generator of the header reads that, because it expands no macro.
macro_rules! with_source {
    ($source:ident: $item:item) => {
        $item
        #[doc(hidden)]
        pub const $source: &str = stringify!($item);
    };
}

/// Makes of a verdict's fields the struct that C sees, and takes it from the wire.
macro_rules! c_struct_of_fields {
    ($type_name:literal, $bytes:literal, filled up by $filling:ident: $filling_ty:ty; $(#[$doc:meta])+ struct $wire:ident $(
        not_in_c { $($left_out:tt)+ }
        in_c { $( $(#[$field_doc:meta])+ $field:ident: $ty:ty { $($columns:tt)+ } )+ }
    )+) => {
        with_source! { VERDICT_SOURCE:
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
                $( $( $(#[$field_doc])+ pub $field: $ty, )+ )+
                /// Name of the station, zero-terminated.
                pub station: [c_char; ANDON_STATION_BYTES],
                /// The part id that was in force when the job began, printable ASCII, zero-terminated; empty if none was given.
                pub part: [c_char; ANDON_PART_BYTES],
            }
        }

        impl From<&$wire> for AndonVerdict {
            fn from(verdict: &$wire) -> Self {
                let Stamp { seq, epoch, frame_seq, captured_ns, sent_ns } = verdict.stamp;
                let (station, part) = (text(&verdict.station), text(verdict.part.bytes()));
                Self { seq, epoch, frame_seq, captured_ns, sent_ns, station, part, $( $( $field: verdict.$field, )+ )+ }
            }
        }
    };
}

shm_schemas::verdict_fields!(c_struct_of_fields);

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
