//! What teaching found, and whether the job can be trusted.

use super::sequence::{Agreement, Disagreement};
use super::statistics::{deviation, mean, median};
use super::threshold::{Learned, least_promise};
use super::{TeachOptions, ThresholdRule};
use crate::job_file::{JobFile, TaughtIu, context_words, object_name};
use crate::recording::NamedObject;
use crate::run::Run;
use andon_core::couple::Context;
use andon_core::job::Bounds;
use std::fmt;

/// A threshold that rests on fewer demonstrations is reported: 5 should be enough (issue "Teaching").
const FEW: usize = 5;

/// A demonstration is an outlier when it is this many times the median distance: twice as far is common among correct
/// runs of different people, three times was not seen.
const OUTLIER: f64 = 2.5;

/// Fewer demonstrations cannot tell which of them is the odd one.
const OUTLIER_RUNS: usize = 4;

/// A demonstration much further from the others than they are from each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Outlier {
    /// The run's name.
    pub run: String,
    /// Its distance.
    pub distance: f64,
    /// The median of all.
    pub median: f64,
}

/// What one IU of a nominal activity rests on.
#[derive(Clone, Debug, PartialEq)]
pub struct IuReport {
    /// The number of the activity in the job.
    pub activity: u16,
    /// The place of the IU in it, from 0.
    pub iu: usize,
    /// Its context.
    pub context: Context,
    /// Demonstrations.
    pub demonstrations: usize,
    /// Frames of the barycentre.
    pub reference_frames: usize,
    /// Mean and standard deviation of the distances that the threshold comes from.
    pub distances: (f64, f64),
    /// The threshold.
    pub threshold: f32,
    /// Bounds of duration.
    pub frames: Bounds,
    /// Bounds of reversals.
    pub reversals: Bounds,
    /// Demonstrations that are far from the others.
    pub outliers: Vec<Outlier>,
}

impl IuReport {
    pub(super) fn new(
        activity: u16,
        iu: usize,
        runs: Vec<String>,
        learned: &Learned,
        taught: &TaughtIu,
    ) -> Self {
        let distances = if learned.left_out.is_empty() { &learned.own } else { &learned.left_out };
        let median = median(distances);
        let far = |distance: f64| distances.len() >= OUTLIER_RUNS && distance > OUTLIER * median;
        let outliers = runs
            .into_iter()
            .zip(distances)
            .filter(|(_, distance)| far(**distance))
            .map(|(run, &distance)| Outlier { run, distance, median })
            .collect();
        Self {
            activity,
            iu,
            context: taught.context,
            demonstrations: learned.own.len(),
            reference_frames: learned.reference.len(),
            distances: (mean(distances), deviation(distances, 1)),
            threshold: taught.threshold,
            frames: taught.frames,
            reversals: taught.reversals,
            outliers,
        }
    }
}

/// What teaching found. `Display` prints it for a person.
#[derive(Clone, Debug, PartialEq)]
pub struct TeachReport {
    /// Runs given.
    pub runs: usize,
    /// Runs left out, and why.
    pub disagreements: Vec<Disagreement>,
    /// Whether the order of activities matters, and whether the caller said so.
    pub order_matters: (bool, bool),
    /// The rule that chose the thresholds.
    pub rule: ThresholdRule,
    /// Each IU of each nominal sequence.
    pub ius: Vec<IuReport>,
    objects: Vec<NamedObject>,
}

impl TeachReport {
    pub(super) fn new(
        runs: &[Run],
        options: &TeachOptions,
        job: &JobFile,
        agreement: Agreement,
        ius: Vec<IuReport>,
    ) -> Self {
        Self {
            runs: runs.len(),
            disagreements: agreement.disagreements,
            order_matters: (job.order_matters, options.order_matters.is_some()),
            rule: options.rule,
            ius,
            objects: job.objects.clone(),
        }
    }

    /// What a person should know before trusting the job, one sentence each; empty when there is nothing.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.runs == 1 {
            warnings.push("taught from one run: thresholds are a guess from other people's spread; show the job again, 5 runs should be enough".to_owned());
        }
        for found in &self.disagreements {
            let words = |context: Option<Context>| {
                context.map_or("the end of it".to_owned(), |context| self.words(context))
            };
            warnings.push(format!(
                "{} was left out: in activity {}, IU {} it has {}, the others have {}",
                found.name,
                found.activity + 1,
                found.iu + 1,
                words(found.had),
                words(found.others)
            ));
        }
        for iu in &self.ius {
            let place =
                format!("activity {}, IU {} ({})", iu.activity + 1, iu.iu + 1, self.words(iu.context));
            if iu.demonstrations < FEW && self.runs > 1 {
                warnings.push(format!(
                    "{place} rests on {} demonstrations only; {FEW} should be enough",
                    iu.demonstrations
                ));
            }
            for outlier in &iu.outliers {
                warnings.push(format!(
                    "{place}: {} is {:.1} from the others, whose median is {:.1}; look at that run, and leave it out if it is not correct",
                    outlier.run, outlier.distance, outlier.median
                ));
            }
            if let ThresholdRule::Conformal { false_alarms } = self.rule
                && false_alarms < least_promise(iu.demonstrations)
            {
                warnings.push(format!(
                    "{place}: {} demonstrations can promise at best {:.1} % false alarms, not {:.1} %",
                    iu.demonstrations,
                    100.0 * least_promise(iu.demonstrations),
                    100.0 * false_alarms
                ));
            }
        }
        warnings
    }

    fn words(&self, context: Context) -> String {
        context_words(context, |id| object_name(&self.objects, id))
    }
}

impl fmt::Display for TeachReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} runs, {} used", self.runs, self.runs - self.disagreements.len())?;
        let (matters, said) = self.order_matters;
        let why = match (matters, said) {
            (_, true) => "as you said",
            (true, false) => "all runs agree on it",
            (false, false) => "the runs differ, or there is only one",
        };
        writeln!(
            f,
            "the order of activities {} ({why})",
            if matters { "matters" } else { "does not matter" }
        )?;
        writeln!(f, "activity  IU  shown  frames          reversals   distance         threshold  context")?;
        for iu in &self.ius {
            writeln!(
                f,
                "{:>8}  {:>2}  {:>5}  {:<14}  {:<10}  {:>6.2} +- {:<5.2}  {:>9.2}  {}",
                iu.activity + 1,
                iu.iu + 1,
                iu.demonstrations,
                range(iu.frames),
                range(iu.reversals),
                iu.distances.0,
                iu.distances.1,
                iu.threshold,
                self.words(iu.context)
            )?;
        }
        for warning in self.warnings() {
            writeln!(f, "warning: {warning}")?;
        }
        Ok(())
    }
}

fn range(bounds: Bounds) -> String {
    if bounds.most == u32::MAX {
        format!("{}..", bounds.least)
    } else {
        format!("{}..{}", bounds.least, bounds.most)
    }
}
