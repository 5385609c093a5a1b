//! The register map: one table, from which registers are read and written and `REGISTERS.md` is generated.

use shm_schemas::{PART_BYTES, Verdict, VerdictMeasure};

use super::image::{Control, Image, ResultBlock};

/// Changes when an address, a type or a meaning changes.
pub const MAP_VERSION: u16 = 6;
/// The first register that can be written. Registers below it that have no meaning yet are read as 0, so that a client can read
/// everything in one request.
pub const CONTROL_BASE: u16 = 100;

/// The type of a value, and how it is read from the image.
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
    /// Sixteen registers of two bytes each.
    Text(fn(&Image) -> [u8; PART_BYTES]),
}

/// How a written value is put into the control block.
#[derive(Clone, Copy)]
pub enum Access {
    /// It is read-only.
    Read,
    /// It can be read back and written.
    ReadWrite(fn(&mut Control, u64)),
    /// It can be read back and written as bytes.
    WriteText(fn(&mut Control, [u8; PART_BYTES])),
    /// Bits of the control word: what becomes of the word when they are written. They are read as 0.
    Bits(fn(u16, u16) -> u16),
}

/// One value of the map.
#[derive(Clone, Copy)]
pub struct Register {
    /// Protocol address of its first register, from 0.
    pub address: u16,
    /// Name, in lower case with underscores.
    pub name: &'static str,
    /// Type, and how it is read.
    pub get: Get,
    /// Whether it can be written, and how.
    pub access: Access,
    /// What it means, with unit.
    pub meaning: &'static str,
}

impl Register {
    /// The number of 16-bit registers that it takes.
    pub const fn words(&self) -> u16 {
        match self.get {
            Get::U16(_) => 1,
            Get::U32(_) | Get::F32(_) => 2,
            Get::U64(_) => 4,
            Get::Text(_) => PART_BYTES as u16 / 2,
        }
    }

    /// The name of its type in the document.
    pub const fn type_name(&self) -> &'static str {
        match self.get {
            Get::U16(_) => "u16",
            Get::U32(_) => "u32",
            Get::U64(_) => "u64",
            Get::F32(_) => "f32",
            Get::Text(_) => "text",
        }
    }
}

fn of(image: &Image) -> Verdict {
    image.result.map_or(Verdict::NONE, |result| result.verdict)
}

fn sequence(image: &Image) -> u32 {
    image.result.map_or(0, |result: ResultBlock| result.sequence)
}

/// A number of the measure as a whole one, in the unit that [`measure_scale`] says; 0 where there is none.
fn scaled(image: &Image, value: fn(&Verdict) -> f32) -> u16 {
    let verdict = of(image);
    let scale = VerdictMeasure::try_from(verdict.measure).map_or(0.0, |measure| measure_scale(measure).0);
    // The cast makes 0 of what is not a number, and keeps within the range.
    (value(&verdict) * scale).round() as u16
}

/// By how much a number of this measure is multiplied in its register, and the unit that it has there.
pub(crate) const fn measure_scale(measure: VerdictMeasure) -> (f32, &'static str) {
    match measure {
        VerdictMeasure::None => (0.0, "none"),
        VerdictMeasure::Duration => (100.0, "hundredths of a second"),
        VerdictMeasure::Strokes => (10.0, "tenths of a stroke"),
        VerdictMeasure::StrokeLength
        | VerdictMeasure::Path
        | VerdictMeasure::LateralDeviation
        | VerdictMeasure::Place => (1000.0, "millimetres"),
        VerdictMeasure::Direction => (10.0, "tenths of a degree"),
    }
}

const NS_PER_S: u64 = 1_000_000_000;
const NS_PER_MS: u64 = 1_000_000;

const fn read(address: u16, name: &'static str, get: Get, meaning: &'static str) -> Register {
    Register { address, name, get, access: Access::Read, meaning }
}

const fn write(
    address: u16,
    name: &'static str,
    get: Get,
    access: Access,
    meaning: &'static str,
) -> Register {
    Register { address, name, get, access, meaning }
}

/// The map, by address.
pub const MAP: &[Register] = &[
    read(0, "status", Get::U16(|i| i.status), "status word, see below"),
    read(
        1,
        "carried_out",
        Get::U16(|i| i.carried_out),
        "control bits of the commands that were completed; each clears with its control bit",
    ),
    read(
        2,
        "refused",
        Get::U16(|i| i.refused),
        "control bits of the commands that were refused; each clears with its control bit",
    ),
    read(3, "heartbeat", Get::U16(|i| i.heartbeat), "counts up four times per second and wraps around"),
    read(4, "error", Get::U16(|i| i.error), "the latched fault, see below; 0 none"),
    read(
        5,
        "error_detail",
        Get::U32(|i| i.error_detail),
        "the number n of the code `AND-n` in the log that belongs to `error`; 0 none",
    ),
    read(7, "map_version", Get::U16(|_| MAP_VERSION), "version of this map"),
    read(
        8,
        "queued",
        Get::U16(|i| i.queued),
        "number of results that wait behind the offered one; 8 also where more wait in the journal",
    ),
    read(
        9,
        "lost",
        Get::U32(|i| i.lost),
        "number of results that were lost to the PLC since the journal was begun",
    ),
    read(
        11,
        "sequence",
        Get::U32(sequence),
        "number of the result, from 1; a gap is a loss; 0 before the first result; after 4,294,967,295 comes 1",
    ),
    read(
        13,
        "outcome",
        Get::U16(|i| i.result.map_or(0, |r| r.outcome)),
        "the bit `ok`, `nok` or `not-judged` at its place in the status word; stays after `acknowledge`",
    ),
    read(14, "job_id", Get::U32(|i| of(i).job_id), "the job of the result"),
    read(16, "model_hash", Get::U64(|i| of(i).model_hash), "hash of the job file that it was judged by"),
    read(
        20,
        "level",
        Get::U16(|i| of(i).level.into()),
        "what was judged, see below; 0 before the first result",
    ),
    read(21, "reason", Get::U16(|i| of(i).reason.into()), "the rule that decided, see below"),
    read(22, "hand", Get::U16(|i| of(i).hand.into()), "0 none, 1 right, 2 left"),
    read(
        23,
        "activity",
        Get::U16(|i| of(i).activity),
        "index of the activity in the job, from 0; 65535 none",
    ),
    read(24, "iu", Get::U16(|i| of(i).iu), "index of the IU in its activity, from 0; 65535 none"),
    read(
        25,
        "nearest",
        Get::U16(|i| of(i).nearest),
        "index of the taught activity that it was judged against, from 0; 65535 none",
    ),
    read(
        26,
        "x_c_0",
        Get::U16(|i| of(i).x_c[0]),
        "context x_c: the hand that touches something; 0 none, 1 right, 2 left",
    ),
    read(
        27,
        "x_c_1",
        Get::U16(|i| of(i).x_c[1]),
        "context x_c: `id` of the object that the hand touches; 0 none",
    ),
    read(
        28,
        "x_c_2",
        Get::U16(|i| of(i).x_c[2]),
        "context x_c: `id` of the object that touches another one; 0 none",
    ),
    read(29, "x_c_3", Get::U16(|i| of(i).x_c[3]), "context x_c: `id` of that other object; 0 none"),
    read(
        30,
        "early",
        Get::U16(|i| of(i).early.into()),
        "1 if the verdict came before the IU ended, otherwise 0",
    ),
    read(31, "distance", Get::F32(|i| of(i).distance), "DTW distance to the nearest taught motion; NaN none"),
    read(
        33,
        "threshold",
        Get::F32(|i| of(i).threshold),
        "the threshold that `distance` was compared with; NaN none",
    ),
    read(
        35,
        "utc_s",
        Get::U32(|i| u32::try_from(of(i).decided_utc_ns / NS_PER_S).unwrap_or(u32::MAX)),
        "when it was decided: seconds since 1970-01-01 00:00 UTC",
    ),
    read(
        37,
        "utc_ms",
        Get::U16(|i| u16::try_from(of(i).decided_utc_ns % NS_PER_S / NS_PER_MS).unwrap_or(0)),
        "and milliseconds, 0 to 999",
    ),
    read(38, "epoch", Get::U64(|i| of(i).stamp.epoch), "with `seq` the key of the verdict in the journal"),
    read(42, "seq", Get::U64(|i| of(i).stamp.seq), "with `epoch` the key of the verdict in the journal"),
    read(46, "sequence_copy", Get::U32(sequence), "the same as `sequence`"),
    read(
        48,
        "boot",
        Get::U32(|i| i.boot),
        "counts the starts of the Modbus server; 0 until the journal keeps the number, and until then nothing is offered",
    ),
    read(
        50,
        "executing",
        Get::U16(|i| i.executing),
        "control bits of the commands whose answer is still to come",
    ),
    read(51, "refusal", Get::U16(|i| i.refusal), "why the newest refused command was refused, see below"),
    read(52, "job_in_force", Get::U32(|i| i.job_in_force), "the job that the judge has; 0 none"),
    read(54, "hash_in_force", Get::U64(|i| i.hash_in_force), "hash of its job file"),
    read(58, "phase", Get::U16(|i| i.phase), "what the judge is doing, see below; 0 until it has reported"),
    read(59, "note", Get::U16(|i| of(i).note.into()), "what was not shown before, see below; 0 nothing"),
    read(60, "result_part", Get::Text(|i| *of(i).part.bytes()), "the part id of the result; all 0 none"),
    read(76, "sequence_end", Get::U32(sequence), "the same as `sequence`"),
    read(
        78,
        "next_part",
        Get::Text(|i| *i.next_part.bytes()),
        "the part id that the judge gives to the job that begins next; all 0 none",
    ),
    read(
        94,
        "measure",
        Get::U16(|i| of(i).measure.into()),
        "which measure of the result is out of its bounds, see below; 0 none",
    ),
    read(
        95,
        "measured",
        Get::U16(|i| scaled(i, |v| v.measured)),
        "its value, in the unit of `measure`, see below",
    ),
    read(
        96,
        "shown_min",
        Get::U16(|i| scaled(i, |v| v.shown_min)),
        "the minimum that was shown, in the same unit",
    ),
    read(
        97,
        "shown_max",
        Get::U16(|i| scaled(i, |v| v.shown_max)),
        "the maximum that was shown, in the same unit",
    ),
    read(98, "sequence_measure", Get::U32(sequence), "the same as `sequence`"),
    write(
        CONTROL_BASE,
        "control",
        Get::U16(|i| i.control.word),
        Access::ReadWrite(|c, v| c.word = v as u16),
        "control word, see below",
    ),
    write(
        101,
        "load_job_id",
        Get::U32(|i| i.control.load_job_id),
        Access::ReadWrite(|c, v| c.load_job_id = v as u32),
        "the job that `load_job` loads",
    ),
    write(
        103,
        "load_model_hash",
        Get::U64(|i| i.control.load_model_hash),
        Access::ReadWrite(|c, v| c.load_model_hash = v),
        "the hash that the job file must have; 0 accepts any",
    ),
    write(
        107,
        "part",
        Get::Text(|i| i.control.part),
        Access::WriteText(|c, bytes| c.part = bytes),
        "the part id that `set_part` gives to the next job; all 0 none",
    ),
    write(
        123,
        "acknowledge_sequence",
        Get::U32(|i| i.control.acknowledge_sequence),
        Access::ReadWrite(|c, v| c.acknowledge_sequence = v as u32),
        "the `sequence` of the result that `acknowledge` refers to; 0 whichever is offered",
    ),
    write(
        125,
        "control_set",
        Get::U16(|_| 0),
        Access::Bits(|word, bits| word | bits),
        "sets these bits of `control` and leaves the others; reads as 0",
    ),
    write(
        126,
        "control_clear",
        Get::U16(|_| 0),
        Access::Bits(|word, bits| word & !bits),
        "clears these bits of `control` and leaves the others; reads as 0",
    ),
];
