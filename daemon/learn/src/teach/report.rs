//! What teaching found, and whether the job can be trusted.

use super::options::TeachOptions;
use super::order::OrderReport;
use super::sequence::Disagreement;
use super::threshold::{Learned, min_false_alarms};
use crate::job_file::{JobFile, TaughtIu, context_words};
use crate::recording::{NamedObject, object_name};
use crate::rule::ThresholdRule;
use crate::statistics::{deviation, mean, median};
use andon_core::couple::Context;
use andon_core::job::Bounds;
use std::fmt;

/// A threshold that rests on fewer demonstrations than this is reported: people are asked to show a job five times.
const ENOUGH_DEMONSTRATIONS: usize = 5;

/// How many more runs are asked for where the runs reject each other.
const MORE_RUNS: usize = 3;

/// A demonstration is an outlier if its distance is more than this many times the median distance. Twice the median is common among correct
/// runs of different people; three times the median was not seen.
const OUTLIER_FACTOR: f64 = 2.5;

/// Fewer demonstrations than this cannot tell which of them is the outlier.
const MIN_DEMONSTRATIONS_FOR_OUTLIERS: usize = 4;

/// A demonstration that is much further from the others than they are from each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Outlier {
    /// The run's name.
    pub run: String,
    /// The demonstration's DTW distance to the barycentre.
    pub distance: f64,
    /// The median distance of all demonstrations.
    pub median: f64,
}

/// What teaching found for one IU of a nominal activity.
#[derive(Clone, Debug, PartialEq)]
pub struct IuReport {
    /// Index of the activity in the job, from 0.
    pub activity: u16,
    /// Index of the IU in the activity, from 0.
    pub iu: usize,
    /// The context of the IU.
    pub context: Context,
    /// Number of demonstrations.
    pub demonstrations: usize,
    /// Mean and standard deviation of the DTW distances that the threshold is derived from.
    pub distances: (f64, f64),
    /// Maximum DTW distance of a correct execution.
    pub threshold: f32,
    /// Bounds of duration, in frames of the grid.
    pub frames: Bounds,
    /// Bounds of the number of reversals.
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
        let is_far = |distance: f64| {
            distances.len() >= MIN_DEMONSTRATIONS_FOR_OUTLIERS && distance > OUTLIER_FACTOR * median
        };
        let outliers = runs
            .into_iter()
            .zip(distances)
            .filter(|(_, distance)| is_far(**distance))
            .map(|(run, &distance)| Outlier { run, distance, median })
            .collect();
        Self {
            activity,
            iu,
            context: taught.context,
            demonstrations: learned.own.len(),
            distances: (mean(distances), deviation(distances, 1)),
            threshold: taught.threshold,
            frames: taught.frames,
            reversals: taught.reversals,
            outliers,
        }
    }
}

/// What teaching found. `Display` prints it for people.
#[derive(Clone, Debug, PartialEq)]
pub struct TeachReport {
    /// Number of runs that were given.
    pub runs: usize,
    /// The runs that were left out, and why.
    pub disagreements: Vec<Disagreement>,
    /// The steps of the job and their order.
    pub order: OrderReport,
    /// The names of the runs that a job taught with the others would have rejected; `None` if it was not tried.
    pub rejected: Option<Vec<String>>,
    /// How many frames per second the job needs, and how many the runs were encoded with.
    pub rate_hz: [f32; 2],
    /// The rule by which the thresholds were chosen.
    pub rule: ThresholdRule,
    /// Each IU of each nominal sequence.
    pub ius: Vec<IuReport>,
    objects: Vec<NamedObject>,
}

impl TeachReport {
    pub(super) fn new(
        runs: usize,
        options: &TeachOptions,
        job: &JobFile,
        disagreements: Vec<Disagreement>,
        rejected: Option<Vec<String>>,
        ius: Vec<IuReport>,
    ) -> Self {
        let order = OrderReport::new(job, runs - disagreements.len());
        Self {
            runs,
            disagreements,
            order,
            rejected,
            rate_hz: [job.min_rate_hz, job.method.rate_hz],
            rule: options.rule,
            ius,
            objects: job.objects.clone(),
        }
    }

    /// What people should know before they trust the job, one sentence each; empty if there is nothing.
    pub fn warnings(&self) -> Vec<String> {
        let single = (self.runs == 1).then(|| {
            format!(
                "the job was taught from one run, so its thresholds are a guess from the spread of other people; record more runs, \
                 {ENOUGH_DEMONSTRATIONS} should be enough"
            )
        });
        let left_out = self.disagreements.iter().map(|found| self.disagreement_warning(found));
        let of_ius = self.ius.iter().flat_map(|iu| self.iu_warnings(iu));
        single.into_iter().chain(left_out).chain(of_ius).collect()
    }

    fn disagreement_warning(&self, found: &Disagreement) -> String {
        let words = |context: Option<Context>| {
            context.map_or("the end of the activity".to_owned(), |context| self.words(context))
        };
        format!(
            "{} was left out: in activity {}, IU {} it has {}, the others have {}",
            found.name,
            found.activity + 1,
            found.iu + 1,
            words(found.had),
            words(found.others)
        )
    }

    fn iu_warnings(&self, iu: &IuReport) -> Vec<String> {
        let name = format!("activity {}, IU {} ({})", iu.activity + 1, iu.iu + 1, self.words(iu.context));
        let mut warnings = Vec::new();
        if iu.demonstrations < ENOUGH_DEMONSTRATIONS && self.runs > 1 {
            warnings.push(format!(
                "{name} rests on only {} demonstrations; {ENOUGH_DEMONSTRATIONS} should be enough",
                iu.demonstrations
            ));
        }
        for Outlier { run, distance, median } in &iu.outliers {
            warnings.push(format!(
                "{name}: {run} has distance {distance:.1} where the median is {median:.1}; check that run, and leave it out if it is not \
                 correct"
            ));
        }
        let min_false_alarms = min_false_alarms(iu.demonstrations);
        if let ThresholdRule::Conformal { false_alarms } = self.rule
            && false_alarms < min_false_alarms
        {
            warnings.push(format!(
                "{name}: {} demonstrations can promise {:.1} % false alarms at best, not {:.1} %",
                iu.demonstrations,
                100.0 * min_false_alarms,
                100.0 * false_alarms
            ));
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
        write!(f, "{}", self.order)?;
        if let Some(rejected) = &self.rejected {
            let used = self.order.runs;
            match rejected.len() {
                0 => writeln!(f, "of your {used} runs the others would have rejected none")?,
                count => writeln!(
                    f,
                    "of your {used} runs the others would have rejected {count} ({}); show {MORE_RUNS} more, from other people",
                    rejected.join(", ")
                )?,
            }
        }
        let [needed, all] = self.rate_hz;
        if needed > 0.0 {
            writeln!(
                f,
                "the job needs {needed:.1} of {all:.1} frames a second; a step with fewer is not judged (overload)"
            )?;
        }
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
    if bounds.max == u32::MAX {
        format!("{}..", bounds.min)
    } else {
        format!("{}..{}", bounds.min, bounds.max)
    }
}
