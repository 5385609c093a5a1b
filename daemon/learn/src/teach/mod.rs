//! Teaching: from a few correct runs of a whole job, without labels, to a job file (paper III-C, III-D, IV-B).
//!
//! Contexts give the nominal activities ([`sequence`]), DBA the reference of each IU, a [`ThresholdRule`] its
//! threshold, a [`BoundsRule`] the bounds of duration and of reversals. The same runs give the same job, byte for byte.

mod bounds;
mod report;
mod rule;
pub mod sequence;
pub(crate) mod statistics;
mod threshold;

pub use report::{IuReport, Outlier, TeachReport};
pub use rule::{BoundsRule, ThresholdRule};
pub use threshold::{Learned, learn, least_promise};

use crate::barycentre::Barycentres;
use crate::job_file::{JobFile, Provenance, Source, TaughtActivity, TaughtIu};
use crate::run::{Iu, Run};
use crate::warp::Warp;
use andon_core::capacity::{ACTIVITIES, ACTIVITY_IUS, IU_FRAMES};
use andon_core::config::Method;
use andon_core::couple::Motion;
use andon_core::dtw::Refused;
use andon_core::job::LocalCost;
use sequence::{Agreement, Sequence, agree};

/// How to teach.
#[derive(Clone, Debug, PartialEq)]
pub struct TeachOptions {
    /// The number that a PLC selects the job by.
    pub id: u32,
    /// What a person calls the job.
    pub name: String,
    /// When it is taught; goes into the job file as it is.
    pub date: String,
    /// Program and version; goes into the job file as it is.
    pub program: String,
    /// The constants that the runs were encoded with.
    pub method: Method,
    /// How motions are compared.
    pub cost: LocalCost,
    /// Up to how many times slower than shown is no anomaly of the motion: [`Job::slowness`](andon_core::job::Job::slowness).
    pub slowness: f32,
    /// How thresholds are chosen.
    pub rule: ThresholdRule,
    /// How bounds are chosen.
    pub bounds: BoundsRule,
    /// Whether the order of activities matters; `None`: it does if at least two runs agree on one.
    pub order_matters: Option<bool>,
}

impl TeachOptions {
    /// Half speed is no anomaly.
    pub const SLOWNESS: f32 = 2.0;

    /// The default rules, which measured best on held-out simulated people of the development seeds.
    pub fn new(name: &str, date: &str, method: Method) -> Self {
        Self {
            id: 1,
            name: name.to_owned(),
            date: date.to_owned(),
            program: concat!("andond ", env!("CARGO_PKG_VERSION")).to_owned(),
            cost: LocalCost::Circular { bins: method.bins },
            method,
            slowness: Self::SLOWNESS,
            rule: ThresholdRule::default(),
            bounds: BoundsRule::default(),
            order_matters: None,
        }
    }
}

/// Why nothing was taught.
#[derive(Debug, thiserror::Error)]
pub enum TeachError {
    /// No run was given.
    #[error("there is no run to learn from: give at least one recording of the whole job")]
    NoRun,
    /// No run has an activity, or no step is common to most of them.
    #[error(
        "the {0} runs have no activity in common: check that the hand touches the objects (interaction points, contact distances) \
         and that all runs show the same job"
    )]
    NothingInCommon(usize),
    /// A capacity of the method is full.
    #[error("the job needs {needed} {what}; {most} can be judged: split the job")]
    Full {
        /// Of what.
        what: &'static str,
        /// How many.
        needed: usize,
        /// How many there may be.
        most: usize,
    },
    /// An IU that cannot be compared.
    #[error("run {run}, activity {activity}, IU {iu}: {refused}; at most {IU_FRAMES} frames can be compared")]
    Iu {
        /// The run's name.
        run: String,
        /// The activity in the run, from 1.
        activity: usize,
        /// The IU in it, from 1.
        iu: usize,
        /// Why.
        refused: Refused,
    },
    /// A share or a factor makes no sense.
    #[error("{name} is {value}; it must be {range}")]
    Option {
        /// Which option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
}

/// Teaches a job from correct runs of it.
///
/// # Errors
/// No run, nothing in common, a capacity that is full, an option out of range.
pub fn teach(runs: &[Run], options: &TeachOptions) -> Result<(JobFile, TeachReport), TeachError> {
    check(options)?;
    if runs.is_empty() {
        return Err(TeachError::NoRun);
    }
    let agreement = agree(runs);
    if agreement.sequences.is_empty() {
        return Err(TeachError::NothingInCommon(runs.len()));
    }
    capacities(&agreement)?;
    let mut teacher = Teacher {
        runs,
        options,
        warp: Warp::new(options.cost),
        tables: Barycentres::new(options.cost, options.method.bins),
        ius: Vec::new(),
    };
    let activities = agreement
        .sequences
        .iter()
        .map(|sequence| teacher.activity(sequence))
        .collect::<Result<Vec<_>, _>>()?;
    let ius = teacher.ius;
    let kept = runs.len() - agreement.disagreements.len();
    let order_matters = options.order_matters.unwrap_or(agreement.one_order && kept > 1);
    let job = JobFile {
        id: options.id,
        name: options.name.clone(),
        order_matters,
        cost: options.cost,
        slowness: options.slowness,
        method: options.method,
        objects: runs[0].objects.clone(),
        activities,
        provenance: Provenance {
            program: options.program.clone(),
            date: options.date.clone(),
            rule: options.rule,
            bounds: options.bounds,
            sources: sources(runs, &agreement),
        },
    };
    let report = TeachReport::new(runs, options, &job, agreement, ius);
    Ok((job, report))
}

fn check(options: &TeachOptions) -> Result<(), TeachError> {
    let option = |name, value: f64, range, kept| {
        if kept { Ok(()) } else { Err(TeachError::Option { name, value, range }) }
    };
    match options.rule {
        ThresholdRule::Paper { sigmas } => {
            option("sigmas", sigmas, "0 or more", sigmas >= 0.0 && sigmas.is_finite())?;
        }
        ThresholdRule::LeaveOneOut { sigmas, border_s } => {
            for (name, value) in [("sigmas", sigmas), ("border_s", border_s)] {
                option(name, value, "0 or more", value >= 0.0 && value.is_finite())?;
            }
        }
        ThresholdRule::Conformal { false_alarms } => {
            option(
                "false_alarms",
                false_alarms,
                "over 0 and under 1",
                false_alarms > 0.0 && false_alarms < 1.0,
            )?;
        }
    }
    let slowness = f64::from(options.slowness);
    option("slowness", slowness, "1 or more", slowness >= 1.0 && slowness.is_finite())?;
    let bounds = options.bounds;
    for (name, share) in [("shortest", bounds.shortest), ("fewest", bounds.fewest)] {
        option(name, share, "0 to 1", (0.0..=1.0).contains(&share))?;
    }
    for (name, factor) in [("longest", bounds.longest), ("most", bounds.most)] {
        option(name, factor, "1 or more", factor >= 1.0 && factor.is_finite())?;
    }
    option("pause_s", bounds.pause_s, "0 or more", bounds.pause_s >= 0.0 && bounds.pause_s.is_finite())
}

fn capacities(agreement: &Agreement) -> Result<(), TeachError> {
    let longest =
        agreement.sequences.iter().map(|sequence| sequence.contexts.len()).max().unwrap_or_default();
    for (what, needed, most) in [
        ("nominal activities", agreement.sequences.len(), ACTIVITIES),
        ("IUs in one activity", longest, ACTIVITY_IUS),
    ] {
        if needed > most {
            return Err(TeachError::Full { what, needed, most });
        }
    }
    Ok(())
}

fn sources(runs: &[Run], agreement: &Agreement) -> Vec<Source> {
    let left_out = |place| agreement.disagreements.iter().any(|found| found.run == place);
    let source = |(place, run): (usize, &Run)| Source {
        name: run.name.clone(),
        sha256: run.sha256.clone(),
        left_out: left_out(place),
    };
    runs.iter().enumerate().map(source).collect()
}

struct Teacher<'a> {
    runs: &'a [Run],
    options: &'a TeachOptions,
    warp: Warp,
    tables: Barycentres,
    ius: Vec<IuReport>,
}

impl Teacher<'_> {
    fn activity(&mut self, sequence: &Sequence) -> Result<TaughtActivity, TeachError> {
        let ius =
            (0..sequence.contexts.len()).map(|place| self.iu(sequence, place)).collect::<Result<_, _>>()?;
        Ok(TaughtActivity { activity: sequence.activity, ius })
    }

    fn iu(&mut self, sequence: &Sequence, place: usize) -> Result<TaughtIu, TeachError> {
        let shown: Vec<&Iu> = sequence
            .shown
            .iter()
            .map(|&(run, activity)| &self.runs[run].activities[activity].ius[place])
            .collect();
        let motions: Vec<&[Motion]> = shown.iter().map(|iu| iu.motion.as_slice()).collect();
        for (motion, &(run, activity)) in motions.iter().zip(&sequence.shown) {
            self.warp.distance(motion, &motion[..1.min(motion.len())]).map_err(|refused| TeachError::Iu {
                run: self.runs[run].name.clone(),
                activity: activity + 1,
                iu: place + 1,
                refused,
            })?;
        }
        let leave_out = !matches!(self.options.rule, ThresholdRule::Paper { .. });
        let slowness = self.options.slowness;
        let learned =
            learn(&mut self.warp, &self.tables, &motions, leave_out, slowness).map_err(|refused| {
                TeachError::Iu {
                    run: "all".to_owned(),
                    activity: usize::from(sequence.activity) + 1,
                    iu: place + 1,
                    refused,
                }
            })?;
        let context = sequence.contexts[place];
        let frames: Vec<u32> = motions.iter().map(|motion| motion.len() as u32).collect();
        let reversals: Vec<u32> = shown.iter().map(|iu| iu.reversals).collect();
        let taught = TaughtIu {
            context,
            threshold: learned.threshold(self.options.rule, f64::from(self.options.method.rate_hz)) as f32,
            frames: self.options.bounds.frames(context, self.options.method.rate_hz, &frames),
            reversals: self.options.bounds.reversals(context, &reversals),
            reference: learned.reference.clone(),
            demonstrations: shown.len() as u32,
        };
        let names = sequence.shown.iter().map(|&(run, _)| self.runs[run].name.clone()).collect();
        self.ius.push(IuReport::new(sequence.activity, place, names, &learned, &taught));
        Ok(taught)
    }
}
