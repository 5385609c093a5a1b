//! Teaching: from a few correct runs of a whole job, without labels, to a job file (paper III-C, III-D, IV-B).
//!
//! [`teach`] lists the stages: the runs go through them once, in this order. What asks for less runs a part of the same list:
//! [`with_learned_contacts`], [`teach_again`], and leaving one run out, which teaches with the others.
//!
//! Contexts give the nominal activities ([`Disagreement`] says where a run differs) and DBA the reference of each IU. A
//! [`ThresholdRule`](crate::rule::ThresholdRule) gives its threshold, and a [`BoundsRule`](crate::rule::BoundsRule) the bounds of duration and of the
//! other measures. The same runs give the same job, byte for byte. What speaks against learning from the runs is found in [`trust`] and said in the
//! report.
//!
//! A constant says where it comes from and what it changes by itself, mostly halved and doubled. It was tried on 70 sets of 5 to 9 runs, taught
//! without leaving one out, and on 435 right and 540 faulty runs of others. These are simulated people with one and two hands and by feel, the films
//! of the tests, and motion capture. The constants accept 422 of the right runs and accuse 11, and find 473 faults and call 13 right.
//! `tests/constants.py` says of which sets the job differs.

mod contact_regions;
mod either_first;
mod ius;
mod kind;
mod leave_one_out;
mod measures;
mod noticed;
mod options;
mod order;
mod page;
mod pairs;
mod people;
mod reach;
mod relation;
mod report;
mod sampling;
mod sequence;
mod start;
mod statement;
mod strength;
mod threshold;
mod trust;
mod widened;

pub use options::{TeachError, TeachOptions};
pub use page::page;
pub use report::TeachReport;
pub use sequence::{Disagreement, Occluded};
pub use statement::Statement;
pub use threshold::Memory;
pub use trust::{Doubt, Outlier};

use crate::job_file::JobFile;
use crate::recording::NamedObject;
use crate::run::Run;
use andon_core::capacity::{ACTIVITIES, ACTIVITY_IUS, OBJECTS};
use ius::Teacher;
use leave_one_out::LeftOut;
use people::People;
use sampling::rates;
use sequence::{Agreement, agree};
use strength::Strengths;
use trust::{odd_runs, too_few_frames, without_copies};

/// Teaches a job from correct runs of it.
///
/// # Errors
/// If there is no run or the runs have nothing in common. If the job exceeds a capacity, or an option is out of its range.
pub fn teach(runs: &[Run], options: &TeachOptions) -> Result<(JobFile, TeachReport), TeachError> {
    options.check()?;
    let mut teaching = Teaching::new(runs.to_vec(), options);
    teaching.examine()?;
    teaching.find_contacts().map_err(|nothing| teaching.doubtful(nothing))?;
    teaching.leave_one_out();
    teaching.learn().map_err(|nothing| teaching.doubtful(nothing))?;
    teaching.rate();
    teaching.trust();
    Ok(teaching.report())
}

/// The runs as they are where hands and objects meet as these runs show it.
///
/// # Errors
/// If the objects cannot be used.
pub fn with_learned_contacts(runs: &[Run], options: &TeachOptions) -> Result<Vec<Run>, TeachError> {
    let mut teaching = Teaching::new(runs.to_vec(), options);
    teaching.find_contacts()?;
    Ok(teaching.runs)
}

/// Teaches runs as they are, where hands and parts meet as these say, with what was learned from the same runs before.
///
/// # Errors
/// As for [`teach`].
pub fn teach_again(runs: &[Run], options: &TeachOptions, memory: &mut Memory) -> Result<JobFile, TeachError> {
    options.check()?;
    let mut teaching = Teaching::new(runs.to_vec(), options);
    std::mem::swap(&mut teaching.memory, memory);
    teaching.agree();
    let learnt = teaching.learn();
    std::mem::swap(&mut teaching.memory, memory);
    learnt?;
    teaching.rate();
    Ok(teaching.report.job)
}

/// Runs on their way to a job. The report, which has the job, grows from stage to stage.
struct Teaching<'a> {
    options: &'a TeachOptions,
    /// The different runs as they were given, once `runs` are not.
    given: Vec<Run>,
    /// The different runs, where hands and objects meet as they show it once that is found.
    runs: Vec<Run>,
    agreement: Agreement,
    strengths: Strengths,
    left_out: Option<LeftOut>,
    people: People,
    memory: Memory,
    report: TeachReport,
}

impl<'a> Teaching<'a> {
    fn new(runs: Vec<Run>, options: &'a TeachOptions) -> Self {
        Self {
            options,
            given: Vec::new(),
            runs,
            agreement: Agreement::default(),
            strengths: Strengths::default(),
            left_out: None,
            people: People::IN_GENERAL,
            memory: Memory::default(),
            report: TeachReport::of(options.job()),
        }
    }

    /// Takes out copies, and looks for runs with too few frames.
    fn examine(&mut self) -> Result<(), TeachError> {
        if self.runs.is_empty() {
            return Err(TeachError::NoRun);
        }
        if self.options.examine_runs {
            self.report.doubts.extend(without_copies(&mut self.runs));
            self.report.doubts.extend(too_few_frames(&self.runs, &self.options.method));
        }
        Ok(())
    }

    /// Finds where and how near hands and objects meet and which pairs of objects count, and what the runs then have in common.
    fn find_contacts(&mut self) -> Result<(), TeachError> {
        if !self.options.find_contact_regions {
            self.agree();
            return Ok(());
        }
        let (objects, unsure) = contact_regions::learn(&self.runs, &self.options.method);
        let encoded = pairs::choose(encoded_with(&objects, &self.runs)?)?;
        let objects = encoded.first().map_or(&[][..], |run| &run.objects);
        self.report.unsure = unsure.into_iter().chain(contact_regions::incidental(objects)).collect();
        self.given = std::mem::replace(&mut self.runs, encoded);
        self.agree();
        if let Some(runs) = reach::widened(&self.runs, &self.agreement, self.options)? {
            self.runs = runs;
            self.agree();
        }
        Ok(())
    }

    /// Finds what the runs have in common where rules are as strong as they are.
    fn agree(&mut self) {
        self.agreement = agree(&self.runs, &self.strengths);
        self.report.job.provenance.sources = self.agreement.sources(&self.runs);
    }

    /// Finds which rules give way to a run that was left out while the others taught.
    fn leave_one_out(&mut self) {
        if self.options.leave_one_out {
            let given = if self.given.is_empty() { &self.runs } else { &self.given };
            self.left_out = leave_one_out::tried(&self.agreement.used_runs(given), self.options);
        }
        if let Some(left_out) = &self.left_out {
            self.strengths = left_out.strengths.clone();
            self.agree();
        }
    }

    /// Learns a job from what the runs have in common.
    fn learn(&mut self) -> Result<(), TeachError> {
        self.check_agreement()?;
        let Self { options, runs, agreement, strengths, .. } = self;
        self.people = People::of(runs, agreement, options.method.rate_hz);
        self.report.people = self.people;
        let job = &mut self.report.job;
        job.passive_contacts.clone_from(&agreement.passive_contacts);
        job.steps = relation::steps(runs, agreement, options, strengths);
        job.objects = start::found(runs, agreement, options.method.space, &mut job.steps);
        self.ius()?;
        self.report.job.name_steps(&self.options.step_names);
        Ok(())
    }

    /// Checks that there is something that can be learnt.
    fn check_agreement(&self) -> Result<(), TeachError> {
        let sequences = &self.agreement.sequences;
        if sequences.is_empty() {
            return Err(self.agreement.nothing_agrees(&self.runs));
        }
        let longest = sequences.iter().map(|sequence| sequence.contexts.len()).max().unwrap_or_default();
        let all = [
            ("nominal activities", sequences.len(), ACTIVITIES),
            ("IUs in one activity", longest, ACTIVITY_IUS),
        ];
        match all.into_iter().find(|(_, needed, max)| needed > max) {
            Some((what, needed, max)) => Err(TeachError::Full { what, needed, max }),
            None => Ok(()),
        }
    }

    /// Learns reference, threshold and bounds of each IU.
    fn ius(&mut self) -> Result<(), TeachError> {
        let mut memory = std::mem::take(&mut self.memory);
        let learnt = Teacher::new(self, &mut memory).teach();
        self.memory = memory;
        (self.report.job.activities, self.report.ius) = learnt?;
        either_first::add(&mut self.report.job.activities, &self.agreement, &self.runs, self.options);
        self.report.occluded = self.agreement.ius().flat_map(|iu| iu.occluded.iter().cloned()).collect();
        Ok(())
    }

    /// Measures how many frames per second the job needs, and from how many on its runs are recognised.
    fn rate(&mut self) {
        if self.options.measure_rate {
            let rates = rates(&self.agreement.used_runs(&self.runs), &self.report.job);
            (self.report.job.min_rate_hz, self.report.recognised_hz) = (rates.min_hz, rates.recognised_hz);
        }
    }

    /// Looks for what speaks against learning from the runs.
    fn trust(&mut self) {
        if self.options.examine_runs {
            let odd = odd_runs(&self.runs, &self.agreement, self.options);
            self.report.doubts.extend(odd.doubts);
            (self.report.questions, self.report.pauses) = (odd.questions, odd.pauses);
        }
    }

    /// The job and what is said of it.
    fn report(self) -> (JobFile, TeachReport) {
        let Self { options, runs, agreement, left_out, mut report, .. } = self;
        if options.leave_one_out {
            let words = |context| report.words(context);
            report.left_out =
                widened::sentences(agreement.used.len(), left_out.as_ref(), &agreement.keys, &words);
        }
        report.rejected = left_out.map(|left_out| left_out.rejected);
        report.runs = runs.len();
        report.disagreements = agreement.disagreements;
        (report.job.clone(), report)
    }

    /// Why nothing was taught, with what speaks against the runs.
    fn doubtful(&self, nothing: TeachError) -> TeachError {
        if self.report.doubts.is_empty() || !nothing.is_of_runs() {
            return nothing;
        }
        let sentence = |doubt: &Doubt| format!("{}: {}", doubt.sentence, doubt.remedy);
        TeachError::Doubtful(self.report.doubts.iter().map(sentence).collect(), Box::new(nothing))
    }
}

/// The runs as they are where hands and objects meet so.
fn encoded_with(objects: &[NamedObject], runs: &[Run]) -> Result<Vec<Run>, TeachError> {
    // The points and distances that are learnt are finite, so it is only their number that may be refused.
    let too_many = |_| TeachError::Full { what: "objects", needed: objects.len(), max: OBJECTS };
    let met = runs.iter().map(|run| run.encoded_with_objects(objects)).collect::<Result<_, _>>();
    met.map_err(too_many)
}
