//! The job that is watched, without channels: the role `judge` watches live, and a replay of a recording once more.

use andon_core::anomaly::{Event, Judge, Unusable};
use andon_core::couple::Couples;
use andon_core::dtw::OnlineDtw;
use andon_core::job::Job;
use andon_learn::job_file::JobFile;

/// A judge of one job, with as much memory as the job needs.
pub struct Watch<'j> {
    job: &'j Job<'j>,
    file: &'j JobFile,
    judge: Judge<'j, Vec<OnlineDtw<'j>>>,
    /// The time of the newest couples.
    newest_ns: u64,
}

impl<'j> Watch<'j> {
    /// `is_between_jobs`: it is known that no piece is under work.
    ///
    /// # Errors
    /// A constant or a job that cannot be used.
    pub fn new(job: &'j Job<'j>, file: &'j JobFile, is_between_jobs: bool) -> Result<Self, Unusable> {
        let judge = Judge::with_memory(job, file.method)?;
        let judge = if is_between_jobs { judge.between_jobs() } else { judge };
        Ok(Self { job, file, judge, newest_ns: 0 })
    }

    /// Whether it is known that no piece is under work.
    pub fn is_between_jobs(&self) -> bool {
        self.judge.is_between_jobs()
    }

    /// Whether the time of these couples is before that of the newest. Then the source has started again, and the job must be broken off first.
    pub fn begins_again(&self, couples: &Couples) -> bool {
        couples.captured_ns < self.newest_ns
    }

    /// Judges the next couples.
    pub fn step(&mut self, couples: &Couples, take: &mut impl FnMut(Event)) {
        self.newest_ns = couples.captured_ns;
        self.judge.step(couples, take);
    }

    /// Starts a job on command.
    pub fn start(&mut self, take: &mut impl FnMut(Event)) {
        self.judge.start(take);
    }

    /// Ends the job; what comes next belongs to a new one.
    ///
    /// # Errors
    /// As [`Watch::new`].
    pub fn finish(&mut self, take: &mut impl FnMut(Event)) -> Result<(), Unusable> {
        self.judge.finish(take);
        self.begin_again()
    }

    /// Ends the job where its couples break off, or are not watched any more.
    ///
    /// # Errors
    /// As [`Watch::new`].
    pub fn break_off(&mut self, take: &mut impl FnMut(Event)) -> Result<(), Unusable> {
        self.judge.break_off(take);
        self.begin_again()
    }

    fn begin_again(&mut self) -> Result<(), Unusable> {
        self.judge = Judge::with_memory(self.job, self.file.method)?;
        Ok(())
    }
}
