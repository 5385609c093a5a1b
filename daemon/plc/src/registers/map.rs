//! The register map: the one table that the encoder, the decoder and `REGISTERS.md` are made from.

use shm_schemas::{NO_INDEX, Verdict};

use super::image::{Control, Image, ResultBlock};

/// Changes when an address, a type or a meaning changes.
pub const MAP_VERSION: u16 = 1;
/// The first register that can be written. 100 leaves the read block room to grow.
pub const CONTROL_BASE: u16 = 100;

/// How a value is read from the image; also its type.
#[derive(Clone, Copy)]
pub enum Get {
    /// One register.
    U16(fn(&Image) -> u16),
    /// Two registers.
    U32(fn(&Image) -> u32),
    /// Four registers.
    U64(fn(&Image) -> u64),
    /// Two registers, IEEE 754 single precision.
    F32(fn(&Image) -> f32),
}

/// How a written value is put into the control block.
#[derive(Clone, Copy)]
pub enum Access {
    /// It is read only.
    Read,
    /// It can be read back and written.
    ReadWrite(fn(&mut Control, u64)),
}

/// One value of the map.
#[derive(Clone, Copy)]
pub struct Register {
    /// Protocol address of its first register, from 0.
    pub address: u16,
    /// Name in lower case.
    pub name: &'static str,
    /// Type, and how it is read.
    pub get: Get,
    /// Whether it can be written, and how.
    pub access: Access,
    /// What it means, with unit.
    pub meaning: &'static str,
}

impl Register {
    /// How many 16-bit registers it takes.
    pub const fn words(&self) -> u16 {
        match self.get {
            Get::U16(_) => 1,
            Get::U32(_) | Get::F32(_) => 2,
            Get::U64(_) => 4,
        }
    }

    /// Its type, as the document writes it.
    pub const fn type_name(&self) -> &'static str {
        match self.get {
            Get::U16(_) => "u16",
            Get::U32(_) => "u32",
            Get::U64(_) => "u64",
            Get::F32(_) => "f32",
        }
    }
}

fn of(image: &Image) -> Verdict {
    image.result.map_or(NO_VERDICT, |result| result.verdict)
}

fn sequence(image: &Image) -> u32 {
    image.result.map_or(0, |result: ResultBlock| result.sequence)
}

/// What the result block shows before the first result.
const NO_VERDICT: Verdict = Verdict {
    stamp: shm_schemas::Stamp { seq: 0, epoch: 0, frame_seq: 0, captured_ns: 0, sent_ns: 0 },
    model_hash: 0,
    began_ns: 0,
    ended_ns: 0,
    decided_ns: 0,
    decided_utc_ns: 0,
    job_id: 0,
    distance: f32::NAN,
    threshold: f32::NAN,
    x_c: [0; 4],
    activity: NO_INDEX,
    iu: NO_INDEX,
    nearest: NO_INDEX,
    kind: 0,
    reason: 0,
    hand: 0,
    early: 0,
    station: [0; shm_schemas::STATION_BYTES],
    reserved: [0; 2],
};

const NS_PER_S: u64 = 1_000_000_000;
const NS_PER_MS: u64 = 1_000_000;

const fn read(address: u16, name: &'static str, get: Get, meaning: &'static str) -> Register {
    Register { address, name, get, access: Access::Read, meaning }
}

const fn write(
    address: u16,
    name: &'static str,
    get: Get,
    put: fn(&mut Control, u64),
    meaning: &'static str,
) -> Register {
    Register { address, name, get, access: Access::ReadWrite(put), meaning }
}

/// The map, by address.
pub const MAP: &[Register] = &[
    read(0, "status", Get::U16(|i| i.status), "status word, see below"),
    read(
        1,
        "carried_out",
        Get::U16(|i| i.carried_out),
        "commands carried out whose control bit is still set",
    ),
    read(2, "refused", Get::U16(|i| i.refused), "commands refused whose control bit is still set"),
    read(3, "heartbeat", Get::U16(|i| i.heartbeat), "moves four times a second, wraps"),
    read(4, "error", Get::U16(|i| i.error), "error number, see below; 0 is none"),
    read(
        5,
        "error_detail",
        Get::U32(|i| i.error_detail),
        "n of the code `AND-n` in the log that belongs to the error; 0 where there is none",
    ),
    read(7, "map_version", Get::U16(|_| MAP_VERSION), "version of this map"),
    read(8, "queued", Get::U16(|i| i.queued), "results that wait behind the offered one"),
    read(9, "lost", Get::U32(|i| i.lost), "results lost since the role started"),
    read(
        11,
        "sequence",
        Get::U32(sequence),
        "number of the result, from 1; a jump is a loss; 0 before the first result",
    ),
    read(
        13,
        "outcome",
        Get::U16(|i| i.result.map_or(0, |r| r.outcome)),
        "the bits `ok`, `nok`, `not-judged` of the status word, kept with the result",
    ),
    read(14, "job_id", Get::U32(|i| of(i).job_id), "the job that was watched"),
    read(16, "model_hash", Get::U64(|i| of(i).model_hash), "hash of the job file it was judged by"),
    read(
        20,
        "kind",
        Get::U16(|i| of(i).kind.into()),
        "what was judged, see below; 0 before the first result",
    ),
    read(21, "reason", Get::U16(|i| of(i).reason.into()), "the rule that decided, see below"),
    read(22, "hand", Get::U16(|i| of(i).hand.into()), "0 none, 1 right, 2 left"),
    read(
        23,
        "activity",
        Get::U16(|i| of(i).activity),
        "number of the activity in the job, from 0; 65535 none",
    ),
    read(24, "iu", Get::U16(|i| of(i).iu), "number of the IU in its activity, from 0; 65535 none"),
    read(25, "nearest", Get::U16(|i| of(i).nearest), "nominal activity it was judged against; 65535 none"),
    read(26, "x_c_0", Get::U16(|i| of(i).x_c[0]), "context features x_c: the hand"),
    read(27, "x_c_1", Get::U16(|i| of(i).x_c[1]), "context features x_c: the object in the hand"),
    read(28, "x_c_2", Get::U16(|i| of(i).x_c[2]), "context features x_c: the object in the hand, in contact"),
    read(29, "x_c_3", Get::U16(|i| of(i).x_c[3]), "context features x_c: the object that it touches"),
    read(30, "early", Get::U16(|i| of(i).early.into()), "1: said before the IU ended"),
    read(31, "distance", Get::F32(|i| of(i).distance), "DTW distance to the nearest nominal; NaN none"),
    read(33, "threshold", Get::F32(|i| of(i).threshold), "the threshold it was held against; NaN none"),
    read(
        35,
        "utc_s",
        Get::U32(|i| u32::try_from(of(i).decided_utc_ns / NS_PER_S).unwrap_or(u32::MAX)),
        "when it was decided, seconds since 1970 UTC",
    ),
    read(
        37,
        "utc_ms",
        Get::U16(|i| u16::try_from(of(i).decided_utc_ns % NS_PER_S / NS_PER_MS).unwrap_or(0)),
        "and milliseconds",
    ),
    read(38, "epoch", Get::U64(|i| of(i).stamp.epoch), "with `seq` the key of the verdict in the journal"),
    read(42, "seq", Get::U64(|i| of(i).stamp.seq), "with `epoch` the key of the verdict in the journal"),
    read(46, "sequence_copy", Get::U32(sequence), "`sequence` again, written after everything else"),
    write(
        CONTROL_BASE,
        "control",
        Get::U16(|i| i.control.word),
        |c, v| c.word = v as u16,
        "control word, see below",
    ),
    write(
        101,
        "load_job_id",
        Get::U32(|i| i.control.load_job_id),
        |c, v| c.load_job_id = v as u32,
        "the job that `load_job` loads",
    ),
    write(
        103,
        "load_model_hash",
        Get::U64(|i| i.control.load_model_hash),
        |c, v| c.load_model_hash = v,
        "its version; 0 accepts any",
    ),
];
