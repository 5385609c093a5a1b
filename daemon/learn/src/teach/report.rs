//! What teaching found, and whether the job can be trusted.

use super::iu_report::IuReport;
use super::kind::is_on_the_way;
use super::meetings::Unsure;
use super::noticed::{Noticed, what_more_would_bring};
use super::options::TeachOptions;
use super::order::OrderReport;
use super::sequence::{Blind, Disagreement};
use super::statement::Statement;
use super::threshold::min_false_alarms;
use super::trust::{Doubt, Outlier, summary};
use crate::distribution::{Distribution, LEGEND};
use crate::job_file::context_words;
use crate::recording::{NamedObject, object_name};
use crate::rule::ThresholdRule;
use crate::strictness::Strictness;
use andon_core::bounds::Bounds;
use andon_core::couple::Context;
use std::fmt;

/// A threshold that depends on fewer demonstrations than this is reported: people are asked to show a job five times.
const ENOUGH_DEMONSTRATIONS: usize = 5;

/// What teaching found. `Display` prints it for people.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TeachReport {
    /// Number of different runs that were given.
    pub runs: usize,
    /// What speaks against learning from them.
    pub doubts: Vec<Doubt>,
    /// Demonstrations with a pause that the others do not have, and that is no anomaly.
    pub pauses: Vec<Outlier>,
    /// Demonstrations that stand out where the others make no law of it.
    pub questions: Vec<Outlier>,
    /// The runs that were left out, and why.
    pub disagreements: Vec<Disagreement>,
    /// What was not learnt because too little of it was seen.
    pub blind: Vec<Blind>,
    /// The steps of the job and their order.
    pub order: OrderReport,
    /// The names of the runs that a job taught with the others rejects; `None` if it was not tried.
    pub rejected: Option<Vec<String>>,
    /// What leaving one run out has shown, a sentence each; empty if it was not asked for.
    pub left_out: Vec<Statement>,
    /// What they do not show for sure of where hands and objects meet.
    pub unsure: Vec<Unsure>,
    /// How probable it is that one person showed all of them.
    pub one_person: f64,
    /// How many frames per second the job needs.
    pub min_rate_hz: f32,
    /// How many frames per second the runs were encoded with.
    pub rate_hz: f32,
    /// How strict the job is.
    pub strictness: Strictness,
    /// The share of right jobs that the bounds may accuse together; 0 where there are none.
    pub false_alarms: f64,
    /// The rule by which the thresholds were chosen.
    pub rule: ThresholdRule,
    /// Each IU of each nominal sequence.
    pub ius: Vec<IuReport>,
    pub(super) objects: Vec<NamedObject>,
}

impl TeachReport {
    /// A report of nothing yet.
    pub(super) fn of(options: &TeachOptions) -> Self {
        Self {
            rate_hz: options.method.rate_hz,
            strictness: options.strictness,
            false_alarms: options.bounds.false_alarms,
            rule: options.rule,
            ..Self::default()
        }
    }

    /// Whether nothing speaks against learning from the runs.
    pub fn is_trusted(&self) -> bool {
        self.doubts.is_empty()
    }

    /// Number of runs that were learnt from.
    fn used(&self) -> usize {
        self.runs - self.disagreements.len()
    }

    /// What people should know of a job that can be used, one sentence each; empty if there is nothing.
    pub fn warnings(&self) -> Vec<Statement> {
        let words = |context| self.words(context);
        let left_out =
            self.disagreements.iter().map(|found| format!("left out was {}", found.sentence(&words)).into());
        let unsure = self.unsure.iter().map(|unsure| unsure.to_string().into());
        let pauses = self.pauses.iter().map(|pause| {
            let text = format!("{} is slow: {}; so short a pause is right", pause.run, pause.figures(&words));
            Statement::of_run(text, Some(self.lies(pause)))
        });
        let questions = self.questions.iter().map(|odd| {
            let figures = odd.figures(&words);
            let run = &odd.run;
            let text = format!("{run} stands out: {figures}: kept; if it was a fault, teach --without {run}");
            Statement::of_run(text, Some(self.lies(odd)))
        });
        let others = [
            self.few_demonstrations(),
            self.one_person(),
            self.not_seen(),
            self.same_again(),
            self.by_feel(),
            self.false_alarms(),
        ];
        left_out
            .chain(pauses)
            .chain(questions)
            .chain(unsure)
            .chain(others.into_iter().flatten().map(Statement::from))
            .collect()
    }

    /// Where a demonstration lies among the others.
    fn lies(&self, outlier: &Outlier) -> Distribution {
        let mut ius = self.ius.iter();
        let iu = ius.find(|iu| (iu.activity, iu.iu) == (outlier.activity, outlier.iu));
        outlier.distribution(iu.map(|iu| self.noticed().right(iu)))
    }

    fn one_person(&self) -> Option<String> {
        (self.used() > 1 && self.one_person > 0.5).then(|| {
            "the runs are as alike as those of one person, so other people are given more room: runs of other people would narrow it"
                .to_owned()
        })
    }

    fn few_demonstrations(&self) -> Option<String> {
        let fewest = self.ius.iter().min_by_key(|iu| iu.demonstrations)?;
        let few = self.ius.iter().filter(|iu| iu.demonstrations < ENOUGH_DEMONSTRATIONS).count();
        let missing =
            ENOUGH_DEMONSTRATIONS.checked_sub(fewest.demonstrations).filter(|missing| *missing > 0)?;
        Some(format!(
            "{few} of {} IUs depend on fewer than {ENOUGH_DEMONSTRATIONS} demonstrations, step {}, IU {} on {}: show {missing} more",
            self.ius.len(),
            fewest.activity + 1,
            fewest.iu + 1,
            fewest.demonstrations
        ))
    }

    fn not_seen(&self) -> Option<String> {
        let place = |blind: &Blind| {
            let what = self.words(blind.context);
            format!("{} in step {}, IU {} ({what})", blind.run, blind.activity + 1, blind.iu + 1)
        };
        let places: Vec<String> = self.blind.iter().map(place).collect();
        (!places.is_empty())
            .then(|| format!("too little was seen of {}: not learnt from these", places.join(", ")))
    }

    /// Two IUs one after the other in which a hand has the same part on its way: nothing tells which of them it is.
    fn same_again(&self) -> Option<String> {
        let is_same = |one: &IuReport, next: &IuReport| {
            (one.activity, one.iu + 1, one.context) == (next.activity, next.iu, next.context)
                && is_on_the_way(next.context)
        };
        let (one, next) =
            self.ius.iter().zip(self.ius.iter().skip(1)).find(|(one, next)| is_same(one, next))?;
        Some(format!(
            "step {}, IU {} and IU {} look the same ({}), so that their order and where they end is not judged: put a marker where the part comes to lie",
            one.activity + 1,
            one.iu + 1,
            next.iu + 1,
            self.words(one.context)
        ))
    }

    /// IUs whose strokes are made by feel.
    fn by_feel(&self) -> Option<String> {
        let place = |iu: &IuReport| {
            let shown = iu.measures.shown?.reversals;
            let [least, most, min, max] = [shown.min, shown.max, iu.reversals.min, iu.reversals.max]
                .map(|count| f64::from(count) / 2.0);
            let what = self.words(iu.context);
            let place = format!("step {}, IU {} ({what})", iu.activity + 1, iu.iu + 1);
            Some(format!("{least} to {most} in {place}, so that {min} to {max} are right"))
        };
        let places: Vec<String> = self
            .ius
            .iter()
            .filter(|iu| iu.is_by_feel && iu.reversals.max < u32::MAX)
            .filter_map(place)
            .collect();
        (!places.is_empty()).then(|| {
            format!(
                "the runs do not agree in the number of strokes: {}; if one number is right, leave out the runs with others",
                places.join(", ")
            )
        })
    }

    fn false_alarms(&self) -> Option<String> {
        let ThresholdRule::Conformal { false_alarms } = self.rule else { return None };
        let fewest = self.ius.iter().map(|iu| iu.demonstrations).min()?;
        (false_alarms < min_false_alarms(fewest)).then(|| {
            format!(
                "{fewest} demonstrations of an IU can promise {:.1} % false alarms at best, not {:.1} %",
                100.0 * min_false_alarms(fewest),
                100.0 * false_alarms
            )
        })
    }

    /// A context in words, with the names of the objects.
    pub(super) fn words(&self, context: Context) -> String {
        context_words(context, |id| object_name(&self.objects, id))
    }
}

impl fmt::Display for TeachReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for line in self.summary() {
            writeln!(f, "{line}")?;
        }
        for warning in self.warnings() {
            writeln!(f, "note: {warning}")?;
        }
        write!(f, "{}", self.order)?;
        for line in self.findings() {
            writeln!(f, "{line}")?;
        }
        if self.has_distributions() {
            writeln!(f, "  ({LEGEND})")?;
        }
        self.write_table(f)?;
        if self.has_measures() {
            write!(f, "{}", self.noticed())?;
        }
        for line in self.promise() {
            writeln!(f, "{line}")?;
        }
        Ok(())
    }
}

impl TeachReport {
    /// Whether the job can be used and why, in one sentence; then, for each doubt, what to do about it.
    pub(super) fn summary(&self) -> Vec<Statement> {
        let (words, lies) = (|context| self.words(context), |outlier: &Outlier| self.lies(outlier));
        summary(self.used(), self.runs, &self.doubts, &words, &lies)
    }

    /// Which runs the others would have rejected, and how many frames the job needs.
    pub(super) fn findings(&self) -> Vec<Statement> {
        let rate = (self.min_rate_hz > 0.0).then(|| {
            Statement::from(format!(
                "the job needs {:.1} of {:.1} frames per second; a step with fewer is not judged (overload)",
                self.min_rate_hz, self.rate_hz
            ))
        });
        self.left_out.iter().cloned().chain(rate).collect()
    }

    /// Whether a sentence says where a run lies among the others.
    pub(super) fn has_distributions(&self) -> bool {
        let all = [self.summary(), self.warnings(), self.findings()];
        all.iter().flatten().any(|statement| !statement.shown.is_empty())
    }

    /// Whether what was measured in metres and seconds has bounds.
    pub(super) fn has_measures(&self) -> bool {
        self.false_alarms > 0.0
    }

    /// What the bounds notice.
    pub(super) fn noticed(&self) -> Noticed<'_> {
        Noticed { ius: &self.ius, rate_hz: self.rate_hz }
    }

    /// What the bounds promise.
    pub(super) fn promise(&self) -> Vec<String> {
        if !self.has_measures() {
            return Vec::new();
        }
        vec![
            format!(
                "strictness {} of {}: where these runs differ as people in general, the measures are set to accuse one of {:.0} right jobs; {}; --strictness \
                 changes both",
                self.strictness.number(),
                Strictness::MAX,
                1.0 / self.false_alarms,
                gives_way(self.strictness)
            ),
            what_more_would_bring(self.order.runs, self.false_alarms),
        ]
    }

    fn write_table(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f)?;
        writeln!(
            f,
            "step  IU  shown  seconds       reversals   distance         threshold  what touches what"
        )?;
        for iu in &self.ius {
            writeln!(
                f,
                "{:>4}  {:>2}  {:>5}  {:<12}  {:<10}  {:>6.2} +- {:<5.2}  {:>9}  {}",
                iu.activity + 1,
                iu.iu + 1,
                iu.demonstrations,
                range(iu.frames, |frames| self.seconds(frames)),
                range(iu.reversals, |count| count.to_string()),
                iu.mean_distance,
                iu.distance_deviation,
                iu.threshold_words(),
                self.words(iu.context)
            )?;
        }
        writeln!(f, "  shown: number of demonstrations")?;
        writeln!(f, "  seconds, reversals of the motion: from the minimum to the maximum that is right")?;
        writeln!(f, "  distance: of the demonstrations from the learned motion (DTW), mean and deviation")?;
        writeln!(f, "  threshold: the maximum distance that is right")?;
        writeln!(f)
    }

    /// So many frames of the grid as seconds.
    pub(super) fn seconds(&self, frames: u32) -> String {
        format!("{:.1}", f64::from(frames) / f64::from(self.rate_hz))
    }
}

/// When a rule gives way to the runs, in words.
fn gives_way(strictness: Strictness) -> String {
    match strictness.contradictions() {
        1 => "a rule gives way to one run that contradicts it".to_owned(),
        usize::MAX => "no rule gives way to a run that contradicts it".to_owned(),
        runs => format!("a rule gives way to {runs} runs that contradict it"),
    }
}

impl Disagreement {
    /// Where the run differs from the others, in words.
    pub(super) fn sentence(&self, words: &dyn Fn(Context) -> String) -> String {
        let Self { name, activity, iu, .. } = self;
        let (step, iu) = (activity + 1, iu + 1);
        match (self.had.map(words), self.others.map(words)) {
            (Some(had), Some(others)) => {
                format!("{name}: in step {step}, IU {iu} it has {had}, the others have {others}")
            }
            (Some(had), None) => {
                format!("{name}: its step {step} goes on with {had}, that of the others has ended before")
            }
            (None, Some(others)) if iu == 1 => {
                format!("{name}: it has no step {step}, which begins with {others} in the others")
            }
            (None, Some(others)) => {
                format!(
                    "{name}: its step {step} ends before IU {iu}, that of the others goes on with {others}"
                )
            }
            (None, None) => format!("{name}: its step {step} differs from that of the others"),
        }
    }
}

/// Bounds in words.
pub(super) fn range(bounds: Bounds, value: impl Fn(u32) -> String) -> String {
    match (bounds.min, bounds.max) {
        (0, u32::MAX) => "any".to_owned(),
        (min, u32::MAX) => format!("from {}", value(min)),
        (min, max) => format!("{} to {}", value(min), value(max)),
    }
}
