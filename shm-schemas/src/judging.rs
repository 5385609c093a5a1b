//! Channel `judging`: what the judge is doing, and what became of the last command.

use crate::code::codes;
use crate::layout::wire;
use crate::part::PartId;
use crate::stamp::{Stamp, message};

codes! {
    /// Where the judge is in its job.
    enum JudgePhase: u8 {
        /// No job is loaded.
        NoJob = 1 as "no job",
        /// A job is loaded, and none has begun.
        Waiting = 2 as "waiting",
        /// A job has begun and has not ended.
        Running = 3 as "running",
    }
}

codes! {
    /// Why a command was refused. The numbers are on the registers: one that is not used any more is never used again.
    enum Refusal: u8 {
        /// It was not refused.
        None = 0 as "none",
        /// There is no file of this job.
        NoSuchJob = 1 as "no such job",
        /// There is a file of this job, but with another hash.
        OtherVersion = 2 as "other version",
        /// Two files have this job: one of them must go, or the hash must say which is meant.
        Ambiguous = 3 as "ambiguous",
        /// The job does not fit this station, or its file is damaged: see AND-302 in the log.
        Unfit = 4 as "unfit",
        /// No job is loaded.
        NoJob = 5 as "no job",
        /// `enable` is not set.
        NotEnabled = 6 as "not enabled",
        /// The station is not ready.
        NotReady = 7 as "not ready",
        /// A job is running.
        Busy = 8 as "busy",
        /// The judge has not answered in time.
        NoAnswer = 9 as "no answer",
        /// No result is offered.
        NothingOffered = 10 as "nothing offered",
        /// Another command is under way, or too many wait.
        TooMany = 11 as "too many",
        /// The part id is not printable ASCII. The next job has none.
        BadPart = 12 as "bad part",
        /// Another result is offered than the one that is acknowledged.
        OtherResult = 13 as "other result",
        /// The PLC gives the part ids of this station.
        PartOfPlc = 14 as "part of plc",
        /// The PLC chooses the jobs of this station.
        JobOfPlc = 15 as "job of plc",
    }
}

wire! { "andon.Judging", 152;
    /// The state of the judge. It is sent when it changes and with every beat; only the newest counts.
    struct Judging {
        /// The stamp.
        stamp: Stamp,
        /// The hash of the job in force; 0 where there is none.
        model_hash: u64,
        /// The epoch of the judge's verdicts.
        verdict_epoch: u64,
        /// The `seq` of the newest of them; 0 before the first.
        verdict_seq: u64,
        /// [`crate::Command::number`] of the last command; 0 before the first.
        command: u64,
        /// The epoch of the couples after which that command was obeyed, so that a recording can obey it at the same place.
        obeyed_epoch: u64,
        /// The `seq` of these couples; 0 where none had come.
        obeyed_seq: u64,
        /// The epoch of the first couples that this judge has taken since its start.
        first_epoch: u64,
        /// The `seq` of these couples; 0 where none has come.
        first_seq: u64,
        /// The job in force; 0 where there is none.
        job_id: u32,
        /// A [`Refusal`]: why the last command was refused, or that it was done.
        refusal: u8,
        /// A [`JudgePhase`]. Zero is none: an empty message is no state.
        phase: u8,
        /// 1 while it watches, else 0.
        is_enabled: u8,
        /// The [`crate::CommandSource`] of `part`; 0 where nobody has given one.
        part_source: u8,
        /// The part id of the jobs that begin from now on.
        part: PartId,
        /// How many frames per second that job needs, Hz; 0 where there is none, or it does not say.
        min_rate_hz: f32,
        /// Zero.
        reserved: u32,
    }
}
message!(Judging);
