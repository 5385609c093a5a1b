//! What a row of the journal says.

use shm_schemas::{
    HandCode, NO_INDEX, NO_PERCENT, OrderFault, PartId, RoleId, Sight, Verdict, VerdictLevel, VerdictMeasure,
    VerdictNote, VerdictOutcome, VerdictReason, verdict_kind,
};

use super::row::code;

/// A row of the journal, in the order of writing.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// A verdict.
    Verdict(Box<Record>),
    /// Missing verdicts. Every query returns them, since any verdict may have been among them.
    Gap(Gap),
    /// A time in which the line did not see its bench. Every query returns them, since anything may have happened in it.
    NotWatching(NotWatching),
}

/// A verdict as it was written. Times are source times in nanoseconds, except `decided_utc_ns`.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // The fields of `shm_schemas::Verdict`, under their names.
pub struct Record {
    pub epoch: u64,
    pub seq: u64,
    pub level: String,
    pub outcome: String,
    pub reason: String,
    pub hand: String,
    pub station: String,
    pub job_id: u32,
    /// In 16 hexadecimal digits.
    pub model_hash: String,
    pub activity: Option<u16>,
    pub iu: Option<u16>,
    pub nearest: Option<u16>,
    pub x_c: [u16; 4],
    pub distance: Option<f32>,
    pub threshold: Option<f32>,
    pub early: bool,
    /// What was not shown before; `None` as a word.
    pub note: String,
    /// How the order of the job was broken; `None` as a word.
    pub broken: String,
    /// In relation to which activity.
    pub broken_activity: Option<u16>,
    /// And how many runs kept it.
    pub broken_runs: u16,
    /// Which measure was out of its bounds; `None` as a word.
    pub measure: String,
    /// What it was, in seconds, strokes, metres or degrees.
    pub measured: Option<f32>,
    /// The minimum and the maximum that were shown.
    pub shown: [Option<f32>; 2],
    /// How many of a hundred frames of the IU came.
    pub captured_percent: Option<u8>,
    /// In how many of a hundred frames of the IU the hand and each object that it acts on were seen.
    pub seen_percent: Option<u8>,
    /// The hand that was not seen; empty where that is not why it was not judged.
    pub missing_hand: String,
    /// The object that was not seen.
    pub missing_object: Option<u16>,
    /// For how long, in seconds; or for how long no frame came.
    pub missing_s: Option<f32>,
    /// How many of a hundred frames came, where those were too few.
    pub missing_percent: Option<u8>,
    /// How many the job needs.
    pub needed_percent: Option<u8>,
    pub began_ns: u64,
    pub ended_ns: u64,
    pub decided_ns: u64,
    /// Nanoseconds since 1970 UTC.
    pub decided_utc_ns: u64,
    /// Empty where none was given.
    pub part: String,
}

impl Record {
    /// The verdict as it was sent, but for the numbers of its frame and its station, which are left out.
    pub fn message(&self) -> Verdict {
        let index = |index: Option<u16>| index.unwrap_or(NO_INDEX);
        let number = |value: Option<f32>| value.unwrap_or(f32::NAN);
        let percent = |value: Option<u8>| value.unwrap_or(NO_PERCENT);
        Verdict {
            model_hash: u64::from_str_radix(&self.model_hash, 16).unwrap_or_default(),
            began_ns: self.began_ns,
            ended_ns: self.ended_ns,
            decided_ns: self.decided_ns,
            decided_utc_ns: self.decided_utc_ns,
            job_id: self.job_id,
            distance: number(self.distance),
            threshold: number(self.threshold),
            measured: number(self.measured),
            shown_min: number(self.shown[0]),
            shown_max: number(self.shown[1]),
            x_c: self.x_c,
            activity: index(self.activity),
            iu: index(self.iu),
            nearest: index(self.nearest),
            broken_activity: index(self.broken_activity),
            broken_runs: self.broken_runs,
            level: code(VerdictLevel::ALL, VerdictLevel::name, VerdictLevel::code, &self.level),
            outcome: code(VerdictOutcome::ALL, VerdictOutcome::name, VerdictOutcome::code, &self.outcome),
            reason: code(VerdictReason::ALL, VerdictReason::name, VerdictReason::code, &self.reason),
            hand: code(HandCode::ALL, HandCode::name, HandCode::code, &self.hand),
            early: self.early.into(),
            part: PartId::new(self.part.as_bytes()).unwrap_or(PartId::NONE),
            captured_percent: percent(self.captured_percent),
            seen_percent: percent(self.seen_percent),
            missing_percent: percent(self.missing_percent),
            needed_percent: percent(self.needed_percent),
            missing_hand: code(HandCode::ALL, HandCode::name, HandCode::code, &self.missing_hand),
            missing_object: self.missing_object.unwrap_or_default(),
            missing_s: number(self.missing_s),
            note: code(VerdictNote::ALL, VerdictNote::name, VerdictNote::code, &self.note),
            broken: code(OrderFault::ALL, OrderFault::name, OrderFault::code, &self.broken),
            measure: code(VerdictMeasure::ALL, VerdictMeasure::name, VerdictMeasure::code, &self.measure),
            ..Verdict::default()
        }
    }

    /// Level and outcome in one word. A row that holds the number of a code that this build does not know was not judged.
    pub(super) fn kind(&self) -> &'static str {
        let level = VerdictLevel::ALL.iter().find(|level| level.name() == self.level);
        let outcome = VerdictOutcome::ALL.iter().find(|outcome| outcome.name() == self.outcome);
        match (level, outcome) {
            (Some(level), Some(outcome)) => verdict_kind(*level, *outcome),
            _ => verdict_kind(VerdictLevel::Iu, VerdictOutcome::NotJudged),
        }
    }
}

/// Verdicts that are not in the journal.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// When the first verdict after it was decided, nanoseconds since 1970 UTC.
    pub utc_ns: u64,
    /// `lost`: they never arrived, or the queue was full. `restart`: the judge has restarted, and verdicts from before may be
    /// missing. `retention`: they were removed because of their age or number. `removed`: the database was removed under its
    /// writer. `damaged`: it was damaged and put aside.
    pub why: String,
    /// Their epoch; for `retention` that of the newest.
    pub epoch: u64,
    /// Number of the first.
    pub first_seq: u64,
    /// Number of the last; `None` where it is unknown whether any is missing, or which.
    pub last_seq: Option<u64>,
}

/// A time in which the line did not watch, in nanoseconds since 1970 UTC.
#[derive(Clone, Debug, PartialEq)]
pub struct NotWatching {
    /// Its begin.
    pub began_utc_ns: u64,
    /// Its end; `None` while it lasts, and where nobody saw its end.
    pub ended_utc_ns: Option<u64>,
    /// A word of [`Sight`], or what was down.
    pub why: String,
}

impl NotWatching {
    /// Whether the line watched all the same: only a process beside the data path was down.
    pub fn is_beside(&self) -> bool {
        [RoleId::Steward, RoleId::Journal, RoleId::Plc]
            .iter()
            .any(|role| self.why.strip_suffix(" was down") == Some(role.name()))
    }

    /// What was wrong, in a sentence; the word itself where this build does not know it.
    pub fn meaning(&self) -> &str {
        let sight = Sight::ALL.iter().find(|sight| sight.name() == self.why);
        sight.map_or(&self.why, |sight| sight.meaning())
    }
}
