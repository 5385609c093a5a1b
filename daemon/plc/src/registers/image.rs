//! The values that the registers show at one moment.

use shm_schemas::{PART_BYTES, PartId, Verdict};

/// Bits of the status word.
pub mod status {
    /// The role runs and its loop turns.
    pub const ONLINE: u16 = 1;
    /// Everything from the camera to the journal works, the judge watches the wanted job, and no error is latched.
    pub const READY: u16 = 1 << 1;
    /// A job is running.
    pub const BUSY: u16 = 1 << 2;
    /// A result is offered and not acknowledged.
    pub const DONE: u16 = 1 << 3;
    /// The offered result is right. Only with `DONE`.
    pub const OK: u16 = 1 << 4;
    /// The offered result is an anomaly. Only with `DONE`.
    pub const NOK: u16 = 1 << 5;
    /// The offered result could not be judged. Only with `DONE`.
    pub const NOT_JUDGED: u16 = 1 << 6;
    /// An error is latched: see the register `error`.
    pub const ERROR: u16 = 1 << 7;
    /// Results were lost: the journal does not have them, or nobody may acknowledge and the queue was full.
    pub const OVERRUN: u16 = 1 << 8;
    /// The offered result has something that was not shown before, and breaks no law. Only with `DONE`.
    pub const NOTE: u16 = 1 << 9;
    /// Every bit in order, with its name and meaning.
    pub const BITS: [(u16, &str, &str); 10] = [
        (ONLINE, "online", "the Modbus server runs and its cycle is alive"),
        (
            READY,
            "ready",
            "camera, every process of the station and the journal work, and no error is latched. The judge watches (`enable`, or `plc.writes` is false) and has the job that was loaded",
        ),
        (BUSY, "busy", "a job is running"),
        (DONE, "done", "a result is offered and not acknowledged"),
        (OK, "ok", "the offered result is right; set only with `done`"),
        (NOK, "nok", "the offered result is an anomaly; set only with `done`"),
        (NOT_JUDGED, "not-judged", "the offered result could not be judged; set only with `done`"),
        (ERROR, "error", "a fault is latched: see the register `error`"),
        (
            OVERRUN,
            "overrun",
            "results were lost: the journal does not have them or, without `plc.writes`, more came than can wait",
        ),
        (
            NOTE,
            "note",
            "the offered result has something that was not shown before: was it right? See the register `note`; set only with `done`",
        ),
    ];
}

/// Bits of the control word.
pub mod control {
    /// The station watches for as long as it is set.
    pub const ENABLE: u16 = 1;
    /// Load the job of the registers `load_job_id` and `load_model_hash`.
    pub const LOAD_JOB: u16 = 1 << 1;
    /// A job begins now.
    pub const START: u16 = 1 << 2;
    /// The running job ends now.
    pub const ABORT: u16 = 1 << 3;
    /// The client has read the offered result.
    pub const ACKNOWLEDGE: u16 = 1 << 4;
    /// Clears the latched error and the overrun bit.
    pub const RESET_ERROR: u16 = 1 << 5;
    /// The id in the register `part` is that of the next job.
    pub const SET_PART: u16 = 1 << 6;
    /// Every bit that has a meaning.
    pub const ALL: u16 = (1 << 7) - 1;
    /// Every bit in order, with its name and meaning.
    pub const BITS: [(u16, &str, &str); 7] = [
        (
            ENABLE,
            "enable",
            "the station watches as long as this bit is set; carried out once the judge says so",
        ),
        (
            LOAD_JOB,
            "load_job",
            "load the job of `load_job_id` and `load_model_hash`; refused while busy and without `enable`",
        ),
        (START, "start", "a job begins now; refused unless ready and not busy"),
        (ABORT, "abort", "the running job ends now; refused without `enable`"),
        (
            ACKNOWLEDGE,
            "acknowledge",
            "the client has read the result of `acknowledge_sequence`; refused when that is not offered",
        ),
        (
            RESET_ERROR,
            "reset_error",
            "clear `error` and `overrun`; a fault that is still there is latched again at once",
        ),
        (SET_PART, "set_part", "the id in `part` goes with the jobs that begin from now on"),
    ];
}

/// The registers that a client writes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Control {
    /// The control word, bits of [`control`].
    pub word: u16,
    /// The job that `load_job` loads.
    pub load_job_id: u32,
    /// Hash of the job file that `load_job` accepts; 0 accepts any.
    pub load_model_hash: u64,
    /// The part id that `set_part` gives to the next job, as it was written.
    pub part: [u8; PART_BYTES],
    /// The number of the result that `acknowledge` means; 0 is the offered one, whichever it is.
    pub acknowledge_sequence: u32,
}

/// The result block: one verdict and its number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResultBlock {
    /// Number of this result, from 1; a gap is a loss.
    pub sequence: u32,
    /// [`status::OK`], [`status::NOK`] or [`status::NOT_JUDGED`].
    pub outcome: u16,
    /// The verdict.
    pub verdict: Verdict,
}

/// The values of all registers at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Image {
    /// Counts the starts of the role; 0 until the journal has said what it keeps.
    pub boot: u32,
    /// Bits of [`status`].
    pub status: u16,
    /// Control bits of the commands that were carried out, until the bit is cleared.
    pub carried_out: u16,
    /// Control bits of the commands that were refused, until the bit is cleared.
    pub refused: u16,
    /// Control bits of the commands that are under way.
    pub executing: u16,
    /// Why the newest refused command was refused: a [`shm_schemas::Refusal`].
    pub refusal: u16,
    /// The job that the judge has; 0 none.
    pub job_in_force: u32,
    /// The hash of its file.
    pub hash_in_force: u64,
    /// A [`shm_schemas::JudgePhase`]; 0 before the judge was heard.
    pub phase: u16,
    /// The part id that the judge gives to the next job.
    pub next_part: PartId,
    /// Counts up four times per second.
    pub heartbeat: u16,
    /// The latched [`crate::handshake::Fault`] as a number; 0 is none.
    pub error: u16,
    /// The number in the code `AND-n` of the log line that belongs to the error; 0 where there is none.
    pub error_detail: u32,
    /// Results that wait behind the offered one.
    pub queued: u16,
    /// Results that were lost to the PLC.
    pub lost: u32,
    /// The newest result that was offered; `None` before the first one.
    pub result: Option<ResultBlock>,
    /// What the client has written.
    pub control: Control,
}
