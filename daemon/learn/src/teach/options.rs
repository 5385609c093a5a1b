//! How to teach, and why nothing was taught.

use crate::job_file::{JobFile, Provenance};
use crate::rule::{BoundsRule, ThresholdRule};
use crate::strictness::Strictness;
use andon_core::capacity::IU_FRAMES;
use andon_core::config::Method;
use andon_core::couple::Context;
use andon_core::dtw::Refused;
use andon_core::job::LocalCost;

/// How to teach.
#[derive(Clone, Debug, PartialEq)]
pub struct TeachOptions {
    /// The number by which a PLC selects the job.
    pub id: u32,
    /// The name that people use for the job.
    pub name: String,
    /// The date of teaching; it is copied into the job file as it is.
    pub date: String,
    /// Program and version; they are copied into the job file as they are.
    pub program: String,
    /// The constants that the runs were encoded with.
    pub method: Method,
    /// How motions are compared.
    pub cost: LocalCost,
    /// The job's [`max_slowdown`](andon_core::job::Job::max_slowdown), 1 or more.
    pub max_slowdown: f32,
    /// The job's [`has_free_ends`](andon_core::job::Job::has_free_ends).
    pub has_free_ends: bool,
    /// How thresholds are chosen.
    pub rule: ThresholdRule,
    /// How bounds are chosen.
    pub bounds: BoundsRule,
    /// How much evidence makes a law of an order.
    pub strictness: Strictness,
    /// Whether the activities must come in the order in which they are numbered, or may come in any. `None`: as the runs show.
    pub order_matters: Option<bool>,
    /// Whether it is measured how many frames per second the job needs; otherwise nothing is asked of the rate.
    pub measure_rate: bool,
    /// Whether the runs show where and how near hands and objects meet; otherwise it is as their objects say.
    pub find_contact_regions: bool,
    /// Whether the runs are examined for what speaks against learning from them.
    pub examine_runs: bool,
    /// Whether each run is judged by what the others teach, and what rejects it is no law. It takes as many times as long.
    pub leave_one_out: bool,
    /// The names that people have given to steps, each with the contexts of its IUs; other steps get a proposal.
    pub step_names: Vec<(Vec<Context>, String)>,
}

impl TeachOptions {
    /// The default of [`max_slowdown`](Self::max_slowdown): half speed is no anomaly.
    pub const DEFAULT_MAX_SLOWDOWN: f32 = 2.0;

    /// The default rules, which measured best on simulated people who were held out, with the development seeds.
    pub fn new(name: &str, date: &str, method: Method) -> Self {
        Self {
            id: 1,
            name: name.to_owned(),
            date: date.to_owned(),
            program: concat!("andond ", env!("CARGO_PKG_VERSION")).to_owned(),
            cost: LocalCost::Circular { bins: method.bins },
            method,
            max_slowdown: Self::DEFAULT_MAX_SLOWDOWN,
            has_free_ends: true,
            rule: ThresholdRule::default(),
            bounds: BoundsRule::default(),
            strictness: Strictness::default(),
            order_matters: None,
            measure_rate: true,
            find_contact_regions: true,
            examine_runs: true,
            leave_one_out: true,
            step_names: Vec::new(),
        }
    }

    /// A job without anything that is taught.
    pub(super) fn job(&self) -> JobFile {
        JobFile {
            id: self.id,
            name: self.name.clone(),
            passive_contacts: Vec::new(),
            steps: Vec::new(),
            cost: self.cost,
            max_slowdown: self.max_slowdown,
            has_free_ends: self.has_free_ends,
            min_rate_hz: 0.0,
            method: self.method,
            objects: Vec::new(),
            activities: Vec::new(),
            provenance: Provenance {
                program: self.program.clone(),
                date: self.date.clone(),
                rule: self.rule,
                bounds: self.bounds,
                strictness: Some(self.strictness),
                order: self.order_matters,
                sources: Vec::new(),
            },
            step_names: Vec::new(),
            older: None,
        }
    }

    /// The options that a job was taught with, to teach it again with more or fewer runs on this date.
    pub fn of_job(job: &JobFile, date: &str) -> Self {
        let from = &job.provenance;
        Self {
            id: job.id,
            cost: job.cost,
            max_slowdown: job.max_slowdown,
            has_free_ends: job.has_free_ends,
            rule: from.rule,
            bounds: from.bounds,
            strictness: from.strictness.unwrap_or_default(),
            order_matters: from.order,
            step_names: job.named_contexts(),
            ..Self::new(&job.name, date, job.method)
        }
    }

    /// The same with another strictness: of the order, and of the bounds.
    #[must_use]
    pub fn with_strictness(self, strictness: Strictness) -> Self {
        let bounds = BoundsRule { false_alarms: strictness.false_alarms(), ..self.bounds };
        Self { strictness, bounds, ..self }
    }

    /// Checks that every number is in its range.
    ///
    /// # Errors
    /// [`TeachError::Option`] for the first one that is not.
    pub(super) fn check(&self) -> Result<(), TeachError> {
        match self.rule {
            ThresholdRule::Paper { sigmas } => at_least(0.0, "sigmas", sigmas)?,
            ThresholdRule::LeaveOneOut { sigmas, border_s } => {
                at_least(0.0, "sigmas", sigmas)?;
                at_least(0.0, "border_s", border_s)?;
            }
            ThresholdRule::Conformal { false_alarms: value } => {
                let is_share = value > 0.0 && value < 1.0;
                option(is_share, "false_alarms", value, "greater than 0 and less than 1")?;
            }
        }
        at_least(1.0, "max_slowdown", f64::from(self.max_slowdown))?;
        let bounds = self.bounds;
        option((0.0..=1.0).contains(&bounds.false_alarms), "false_alarms", bounds.false_alarms, "0 to 1")?;
        at_least(1.0, "max_duration", bounds.max_duration)?;
        at_least(0.0, "pause_s", bounds.pause_s)
    }
}

fn at_least(min: f64, name: &'static str, value: f64) -> Result<(), TeachError> {
    option(value >= min && value.is_finite(), name, value, if min == 0.0 { "0 or more" } else { "1 or more" })
}

fn option(is_kept: bool, name: &'static str, value: f64, range: &'static str) -> Result<(), TeachError> {
    if is_kept { Ok(()) } else { Err(TeachError::Option(name, value, range)) }
}

/// Why nothing was taught.
#[derive(Debug, thiserror::Error)]
pub enum TeachError {
    /// No run was given.
    #[error("there is no run to learn from: give at least one recording of the whole job")]
    NoRun,
    /// No run has an activity, or no step is common to most of them.
    #[error(
        "{}: check that the hand touches the objects (interaction points, contact distances){}",
        if *.0 == 1 { "the one run shows no step".to_owned() } else { format!("the {} runs have no step in common", .0) },
        if *.0 == 1 { "" } else { " and that all runs show the same job" }
    )]
    NothingInCommon(usize),
    /// There are steps that most runs have, and no run that has all of them and nothing else.
    #[error(
        "most of the {runs} runs share steps, and no run has exactly these: {}. Look at these places, and show runs that agree",
        differences.join("; ")
    )]
    NoneAgrees {
        /// Number of runs.
        runs: usize,
        /// Where each run differs, in words.
        differences: Vec<String>,
    },
    /// No run shows an IU well enough. It has the index of its activity in the job and its own in that, from 1, and its context in words.
    #[error(
        "step {0}, IU {1} ({2}) was not seen well enough in any run: see that hand and parts stay in view, with at least half \
         of the frames"
    )]
    NeverSeen(usize, usize, String),
    /// Something speaks against the runs, each with what to do, and why nothing could be learned from them.
    #[error("{doubts}; {1}", doubts = .0.join("; "))]
    Doubtful(Vec<String>, Box<TeachError>),
    /// The job exceeds a capacity of the method.
    #[error("the job needs {needed} {what}; at most {max} can be judged: split the job")]
    Full {
        /// What there is too much of.
        what: &'static str,
        /// How many the job needs.
        needed: usize,
        /// How many there may be.
        max: usize,
    },
    /// An IU of a run cannot be compared: the index of its activity in the run, its own in that, from 1, and why.
    #[error("run {0}, step {1}, IU {2}: {3}; at most {IU_FRAMES} frames can be compared")]
    Iu(String, usize, usize, Refused),
    /// The option with this name has this value, and must be in this range.
    #[error("{0} is {1}; it must be {2}")]
    Option(&'static str, f64, &'static str),
}

impl TeachError {
    /// Whether it is the runs that nothing can be learned from, rather than a fault of the caller.
    pub fn is_of_runs(&self) -> bool {
        matches!(
            self,
            Self::NothingInCommon(_) | Self::NoneAgrees { .. } | Self::NeverSeen(..) | Self::Doubtful(..)
        )
    }
}
