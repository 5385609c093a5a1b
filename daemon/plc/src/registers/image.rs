//! What the registers show at one moment, as values.

use shm_schemas::Verdict;

/// Bits of the status word.
pub mod status {
    /// The role runs and its loop turns.
    pub const ONLINE: u16 = 1;
    /// Everything from the camera to the journal works, it is enabled, no error is latched.
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
    /// Results were lost: the queue was full, or the channel ran over.
    pub const OVERRUN: u16 = 1 << 8;
    /// Every bit in order, with its name and its meaning.
    pub const BITS: [(u16, &str, &str); 9] = [
        (ONLINE, "online", "the role runs and its loop turns"),
        (
            READY,
            "ready",
            "camera, every process, the verdict channel and the journal work, `enable` is set, no error is latched",
        ),
        (BUSY, "busy", "a job is running"),
        (DONE, "done", "a result is offered and not acknowledged"),
        (OK, "ok", "the offered result is right; only with `done`"),
        (NOK, "nok", "the offered result is an anomaly; only with `done`"),
        (NOT_JUDGED, "not-judged", "the offered result could not be judged; only with `done`"),
        (ERROR, "error", "an error is latched: see the register `error`"),
        (OVERRUN, "overrun", "results were lost: the queue was full, or the verdict channel ran over"),
    ];
}

/// Bits of the control word.
pub mod control {
    /// Watch (level).
    pub const ENABLE: u16 = 1;
    /// Load the job of the registers `load_job_id` and `load_model_hash`.
    pub const LOAD_JOB: u16 = 1 << 1;
    /// The job begins now.
    pub const START: u16 = 1 << 2;
    /// The job ends now.
    pub const ABORT: u16 = 1 << 3;
    /// The offered result has been taken over.
    pub const ACKNOWLEDGE: u16 = 1 << 4;
    /// Clears the latched error and the overrun bit.
    pub const RESET_ERROR: u16 = 1 << 5;
    /// All bits that have a meaning.
    pub const ALL: u16 = (1 << 6) - 1;
    /// Every bit in order, with its name and its meaning.
    pub const BITS: [(u16, &str, &str); 6] = [
        (ENABLE, "enable", "a level: watch while it is set"),
        (LOAD_JOB, "load_job", "load the job of `load_job_id` and `load_model_hash`; refused while busy"),
        (START, "start", "the job begins now; refused unless ready and not busy"),
        (ABORT, "abort", "the job ends now"),
        (ACKNOWLEDGE, "acknowledge", "the offered result has been taken over; refused where none is offered"),
        (RESET_ERROR, "reset_error", "clears the latched error and the overrun bit"),
    ];
}

/// The registers that a client writes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Control {
    /// The control word, bits of [`control`].
    pub word: u16,
    /// The job that `load_job` loads.
    pub load_job_id: u32,
    /// Its version; 0 accepts any.
    pub load_model_hash: u64,
}

/// The result block: one verdict and its number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResultBlock {
    /// Number of this result since the role started, from 1; a jump is a loss.
    pub sequence: u32,
    /// [`status::OK`], [`status::NOK`] or [`status::NOT_JUDGED`].
    pub outcome: u16,
    /// What was judged.
    pub verdict: Verdict,
}

/// All values at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Image {
    /// Bits of [`status`].
    pub status: u16,
    /// Commands carried out whose control bit is still set.
    pub carried_out: u16,
    /// Commands refused whose control bit is still set.
    pub refused: u16,
    /// Moves four times a second.
    pub heartbeat: u16,
    /// [`crate::handshake::Fault`] as a number; 0 is none.
    pub error: u16,
    /// The number in the code `AND-n` of the log line that belongs to the error; 0 where there is none.
    pub error_detail: u32,
    /// Results that wait behind the offered one.
    pub queued: u16,
    /// Results lost since the role started.
    pub lost: u32,
    /// The result; `None` before the first one.
    pub result: Option<ResultBlock>,
    /// What the client has written.
    pub control: Control,
}
