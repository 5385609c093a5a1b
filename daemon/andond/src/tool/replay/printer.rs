//! Prints the verdicts of a recording as they come, and remembers what they come to.

use std::io::Write;

use andon_core::verdict::{Level, Outcome, Verdict};
use andon_learn::distribution::{Distribution, LEGEND};
use andon_learn::job_file::JobFile;
use shm_schemas::PartId;

use crate::report::{Names, Teller, VerdictLine, on_recording};
use crate::tool::code_of_verdicts;

pub(super) struct Printer {
    json: bool,
    seq: u64,
    teller: Teller,
    /// Whether the signs of a distribution have been explained.
    has_legend: bool,
    anomaly: bool,
    not_judged: bool,
    judged: bool,
}

impl Printer {
    pub(super) fn new(json: bool) -> Self {
        Self {
            json,
            seq: 0,
            teller: Teller::default(),
            has_legend: false,
            anomaly: false,
            not_judged: false,
            judged: false,
        }
    }

    /// Whether nothing was judged.
    pub(super) fn is_silent(&self) -> bool {
        self.seq == 0
    }

    pub(super) fn print(&mut self, verdict: &Verdict, file: &JobFile, names: &Names) -> std::io::Result<()> {
        self.seq += 1;
        self.anomaly |= verdict.outcome == Outcome::Anomaly;
        self.not_judged |= verdict.outcome == Outcome::NotJudged;
        self.judged |= verdict.level == Level::Job && verdict.outcome == Outcome::Ok;
        let mut out = anstream::stdout().lock();
        if self.json {
            let line = VerdictLine::new(self.seq, verdict, &PartId::NONE, names, Some(file));
            serde_json::to_writer(&mut out, &line)?;
            writeln!(out)
        } else {
            let mut line = self.teller.tell(&on_recording(verdict.decided_ns), verdict, names);
            line.text += &self.shown(verdict, file);
            line.write(&mut out)
        }
    }

    /// Where what is not right lies among the runs that were shown, beneath its verdict; the first time with what the signs mean.
    fn shown(&mut self, verdict: &Verdict, file: &JobFile) -> String {
        let Some(shown) = Distribution::of_verdict(file, verdict) else { return String::new() };
        let mut rows = vec![shown.to_string()];
        if !std::mem::replace(&mut self.has_legend, true) {
            rows.push(format!("({LEGEND})"));
        }
        let beneath = on_recording(0).len() + 2;
        rows.into_iter().map(|row| format!("\n{:beneath$}{row}", "")).collect()
    }

    pub(super) fn exit_code(&self) -> u8 {
        code_of_verdicts(self.anomaly, self.not_judged || !self.judged)
    }
}
