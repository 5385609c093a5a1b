//! Couples in, verdicts out: Algorithm 1 of the paper (III-D) with the additions of DESIGN 4, "Anomaly".

use crate::config::{Method, MethodFault};
use crate::couple::Couples;
use crate::job::Job;
use crate::verdict::Verdict;

/// Why a job cannot be judged against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unusable {
    /// A constant is out of its range.
    Method(MethodFault),
    /// No nominal activity, or more than [`crate::capacity::ACTIVITIES`].
    Activities {
        /// Activities given.
        given: usize,
    },
    /// A nominal activity has no IU, or more than [`crate::capacity::ACTIVITY_IUS`].
    Ius {
        /// Place of the nominal activity in the job, from 0.
        nominal: usize,
        /// IUs given.
        given: usize,
    },
    /// An IU has an idle context, no reference or one longer than [`crate::capacity::IU_FRAMES`], a threshold that is
    /// not a number from 0, or bounds whose least is over the most.
    Iu {
        /// Place of the nominal activity in the job, from 0.
        nominal: usize,
        /// Place of the IU in the activity, from 0.
        iu: usize,
    },
}

/// Judges a job as it happens.
#[derive(Clone, Debug)]
pub struct Judge<'a> {
    job: &'a Job<'a>,
}

impl<'a> Judge<'a> {
    /// Starts before the first touch.
    ///
    /// # Errors
    /// If a constant or a part of the job cannot be used.
    pub fn new(job: &'a Job<'a>, method: Method) -> Result<Self, Unusable> {
        method.check().map_err(Unusable::Method)?;
        Ok(Self { job })
    }

    /// Takes the next couples.
    pub fn step(&mut self, couples: &Couples, emit: &mut impl FnMut(Verdict)) {
        let _ = (couples, emit, self.job);
    }

    /// Starts a job by command: what is open of the one before ends with its verdicts first.
    pub fn start(&mut self, emit: &mut impl FnMut(Verdict)) {
        let _ = emit;
    }

    /// Ends the job by command, or at the end of a recording: what is open ends with its verdicts.
    pub fn finish(&mut self, emit: &mut impl FnMut(Verdict)) {
        let _ = emit;
    }
}
