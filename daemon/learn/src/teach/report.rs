//! What teaching found, and whether the job can be trusted.

use super::kind::is_on_the_way;
use super::noticed::{self, what_more_would_bring};
use super::order;
use super::people::People;
use super::sequence::{Disagreement, Occluded};
use super::statement::Statement;
use super::threshold::min_false_alarms;
use super::trust::{Doubt, Outlier};
use crate::distribution::{Distribution, LEGEND, Right};
use crate::job_file::{JobFile, TaughtIu, context_words};
use crate::rule::ThresholdRule;
use crate::strictness::Strictness;
use andon_core::bounds::Bounds;
use andon_core::couple::Context;
use std::fmt;

/// A threshold that depends on fewer demonstrations than this is reported: people are asked to show a job five times.
const ENOUGH_DEMONSTRATIONS: u32 = 5;

/// What was taught of one IU of a nominal activity, and what it depends on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct IuReport {
    /// Index of the activity in the job, from 0.
    pub(super) activity: u16,
    /// Index of the IU in the activity, from 0.
    pub(super) iu: usize,
    pub(super) taught: TaughtIu,
    /// Mean and standard deviation of the DTW distances that the threshold is derived from.
    pub(super) distance: [f64; 2],
    /// The demonstrations do not agree in the number of strokes.
    pub(super) is_by_feel: bool,
}

impl IuReport {
    /// The threshold, in words where the motion is no law.
    pub(super) fn threshold_words(&self) -> String {
        let threshold = self.taught.threshold;
        if threshold < f32::MAX { format!("{threshold:.2}") } else { "any".to_owned() }
    }
}

/// What teaching found. `Display` prints it for people.
#[derive(Clone, Debug, PartialEq)]
pub struct TeachReport {
    /// Number of different runs that were given.
    pub runs: usize,
    /// What speaks against learning from them.
    pub doubts: Vec<Doubt>,
    /// The runs that were left out, and why.
    pub disagreements: Vec<Disagreement>,
    /// What was not learnt because too little of it was seen.
    pub occluded: Vec<Occluded>,
    /// The names of the runs that a job taught with the others rejects; `None` if it was not tried.
    pub rejected: Option<Vec<String>>,
    /// What leaving one run out has shown, a sentence each; empty if it was not asked for.
    pub left_out: Vec<Statement>,
    /// What they do not show for sure of where hands and objects meet, a sentence each, with what to do.
    pub unsure: Vec<String>,
    /// Demonstrations with a pause that the others do not have, and that is no anomaly.
    pub(super) pauses: Vec<Outlier>,
    /// Demonstrations that stand out where the others make no law of it.
    pub(super) questions: Vec<Outlier>,
    pub(super) people: People,
    pub(super) ius: Vec<IuReport>,
    pub(super) job: JobFile,
    /// From how many frames per second on the runs are recognised; 0 where that was not measured.
    pub recognised_hz: f32,
}

impl TeachReport {
    /// Before anything was found for this job.
    pub(super) fn of(job: JobFile) -> Self {
        Self {
            runs: 0,
            doubts: Vec::new(),
            disagreements: Vec::new(),
            occluded: Vec::new(),
            rejected: None,
            left_out: Vec::new(),
            unsure: Vec::new(),
            pauses: Vec::new(),
            questions: Vec::new(),
            people: People::IN_GENERAL,
            ius: Vec::new(),
            job,
            recognised_hz: 0.0,
        }
    }

    /// Whether nothing speaks against learning from the runs.
    pub fn is_trusted(&self) -> bool {
        self.doubts.is_empty()
    }

    fn used(&self) -> usize {
        self.runs - self.disagreements.len()
    }

    /// What people should know of a job that can be used, one sentence each; empty if there is nothing.
    pub fn warnings(&self) -> Vec<Statement> {
        let words = |context| self.words(context);
        let left_out = self
            .disagreements
            .iter()
            .map(|found| format!("{} was left out: {}", found.name, found.difference(&words)).into());
        let unsure = self.unsure.iter().cloned().map(Statement::from);
        let pauses = self.pauses.iter().map(|pause| {
            let text =
                format!("{} pauses: {}; a pause this short is accepted", pause.run, pause.figures(&words));
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
            self.variety(),
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
        outlier.distribution(iu.map(|iu| Right::of(&iu.taught, self.rate_hz())))
    }

    fn one_person(&self) -> Option<String> {
        (self.used() > 1 && self.people.one_person > 0.5).then(|| {
            "one person seems to have shown the runs, so other people are given more room. \
             If several people showed them, begin the names of the runs with p1_, p2_ and so on"
                .to_owned()
        })
    }

    fn variety(&self) -> Option<String> {
        let variety = self.people.variety;
        self.people.differ_more().then(|| {
            format!(
                "those who showed the runs seem to differ {variety:.1} times as much as people in general, and bounds of times, strokes and \
                 ways are as much wider. Small faults are right then: where one run is not as the work should be, teach without it"
            )
        })
    }

    fn few_demonstrations(&self) -> Option<String> {
        let fewest = self.ius.iter().min_by_key(|iu| iu.taught.demonstrations)?;
        let few = self.ius.iter().filter(|iu| iu.taught.demonstrations < ENOUGH_DEMONSTRATIONS).count();
        let shown = fewest.taught.demonstrations;
        let missing = ENOUGH_DEMONSTRATIONS.checked_sub(shown).filter(|missing| *missing > 0)?;
        Some(format!(
            "{few} of {} IUs depend on fewer than {ENOUGH_DEMONSTRATIONS} demonstrations, step {}, IU {} on {shown}: show {missing} more",
            self.ius.len(),
            fewest.activity + 1,
            fewest.iu + 1,
        ))
    }

    fn not_seen(&self) -> Option<String> {
        let place = |of: &Occluded| {
            let what = self.words(of.context);
            format!("{} in step {}, IU {} ({what})", of.run, of.activity + 1, of.iu + 1)
        };
        let places: Vec<String> = self.occluded.iter().map(place).collect();
        (!places.is_empty())
            .then(|| format!("too little was seen of {}: not learnt from these", places.join(", ")))
    }

    /// Two IUs one after the other in which a hand has the same part on its way: nothing tells which of them it is.
    fn same_again(&self) -> Option<String> {
        let is_same = |one: &IuReport, next: &IuReport| {
            let key = |of: &IuReport, iu: usize| (of.activity, iu, of.taught.context);
            key(one, one.iu + 1) == key(next, next.iu) && is_on_the_way(next.taught.context)
        };
        let (one, next) =
            self.ius.iter().zip(self.ius.iter().skip(1)).find(|(one, next)| is_same(one, next))?;
        Some(format!(
            "step {}, IU {} and IU {} look the same ({}). Their order and where they end are not judged: put a marker where the part comes to lie",
            one.activity + 1,
            one.iu + 1,
            next.iu + 1,
            self.words(one.taught.context)
        ))
    }

    fn by_feel(&self) -> Option<String> {
        let place = |iu: &IuReport| {
            let TaughtIu { context, reversals, measures, .. } = &iu.taught;
            let shown = measures.shown?.reversals;
            let [least, most, min, max] =
                [shown.min, shown.max, reversals.min, reversals.max].map(|count| f64::from(count) / 2.0);
            let what = self.words(*context);
            let place = format!("step {}, IU {} ({what})", iu.activity + 1, iu.iu + 1);
            Some(format!("{least} to {most} in {place}, so that {min} to {max} are right"))
        };
        let places: Vec<String> = self
            .ius
            .iter()
            .filter(|iu| iu.is_by_feel && iu.taught.reversals.max < u32::MAX)
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
        let ThresholdRule::Conformal { false_alarms } = self.job.provenance.rule else { return None };
        let fewest = self.ius.iter().map(|iu| iu.taught.demonstrations).min()?;
        (false_alarms < min_false_alarms(fewest)).then(|| {
            format!(
                "{fewest} demonstrations of an IU can promise {:.1} % false alarms at best, not {:.1} %",
                100.0 * min_false_alarms(fewest),
                100.0 * false_alarms
            )
        })
    }

    pub(super) fn words(&self, context: Context) -> String {
        context_words(context, |id| self.job.object_name(id))
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
        order::write(&self.job, self.used(), f)?;
        for line in self.findings() {
            writeln!(f, "{line}")?;
        }
        if self.has_distributions() {
            writeln!(f, "  ({LEGEND})")?;
        }
        self.write_table(f)?;
        if self.has_measures() {
            noticed::write(&self.ius, self.rate_hz(), f)?;
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
        let begins = ["not usable, because"].into_iter().chain(std::iter::repeat("  And"));
        let lines = |(begins, doubt): (&str, &Doubt)| {
            let lies = doubt.outlier.as_ref().map(|outlier| self.lies(outlier));
            let sentence = Statement::of_run(format!("{begins} {}.", doubt.sentence), lies);
            [sentence, format!("  What to do: {}.", doubt.remedy).into()]
        };
        let used = self.used();
        let usable = match self.runs {
            _ if used == 1 => "usable with care, because one run shows neither in which order the work may be done nor how much correct runs \
                 differ. Any order is accepted, and the thresholds are a guess from the spread of other people."
                .to_owned(),
            runs if used == runs => {
                format!("usable, because the {runs} runs agree in all their steps and none of them stands out.")
            }
            runs => format!(
                "usable, because {used} of {runs} runs agree in all their steps and none of these stands out; the rest was left out."
            ),
        };
        let usable = self.is_trusted().then(|| usable.into());
        begins.zip(&self.doubts).flat_map(lines).chain(usable).collect()
    }

    pub(super) fn rate_hz(&self) -> f32 {
        self.job.method.rate_hz
    }

    /// The share of right jobs that the bounds may accuse together; 0 where there are none.
    fn share_accused(&self) -> f64 {
        self.job.provenance.bounds.false_alarms
    }

    /// Which runs the others would have rejected, and how many frames the job needs.
    pub(super) fn findings(&self) -> Vec<Statement> {
        let (min_rate_hz, recognised_hz) = (self.job.min_rate_hz, self.recognised_hz);
        let needs = || {
            format!(
                "the job needs {min_rate_hz:.1} of {:.1} frames per second; a step with fewer is not judged (overload)",
                self.rate_hz()
            )
        };
        let recognises =
            || format!("with fewer than {recognised_hz:.1}, some of these runs would not be judged");
        let rate = (min_rate_hz > 0.0).then(needs);
        let rate = rate.into_iter().chain((recognised_hz > min_rate_hz).then(recognises));
        self.left_out.iter().cloned().chain(rate.map(Statement::from)).collect()
    }

    /// Whether a sentence says where a run lies among the others.
    pub(super) fn has_distributions(&self) -> bool {
        let all = [self.summary(), self.warnings(), self.findings()];
        all.iter().flatten().any(|statement| !statement.shown.is_empty())
    }

    /// Whether what was measured in metres and seconds has bounds.
    pub(super) fn has_measures(&self) -> bool {
        self.share_accused() > 0.0
    }

    /// What the bounds promise.
    pub(super) fn promise(&self) -> Vec<String> {
        if !self.has_measures() {
            return Vec::new();
        }
        let strictness = self.job.provenance.strictness.unwrap_or_default();
        vec![
            format!(
                "strictness {} of {}: where these runs differ as people in general, the measures are set to accuse one of {:.0} right jobs; {}; --strictness \
                 changes both",
                strictness.number(),
                Strictness::MAX,
                1.0 / self.share_accused(),
                gives_way(strictness)
            ),
            what_more_would_bring(self.used(), self.share_accused()),
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
                iu.taught.demonstrations,
                range(iu.taught.frames, |frames| self.seconds(frames)),
                range(iu.taught.reversals, |count| count.to_string()),
                iu.distance[0],
                iu.distance[1],
                iu.threshold_words(),
                self.words(iu.taught.context)
            )?;
        }
        writeln!(f, "  shown: number of demonstrations")?;
        writeln!(f, "  seconds, reversals of the motion: from the minimum to the maximum that is right")?;
        writeln!(f, "  distance: of the demonstrations from the learned motion (DTW), mean and deviation")?;
        writeln!(f, "  threshold: the maximum distance that is right")?;
        writeln!(f)
    }

    pub(super) fn seconds(&self, frames: u32) -> String {
        format!("{:.1}", f64::from(frames) / f64::from(self.rate_hz()))
    }
}

fn gives_way(strictness: Strictness) -> String {
    match strictness.contradictions() {
        1 => "a rule gives way to one run that contradicts it".to_owned(),
        usize::MAX => "no rule gives way to a run that contradicts it".to_owned(),
        runs => format!("a rule gives way to {runs} runs that contradict it"),
    }
}

impl Disagreement {
    pub(super) fn sentence(&self, words: &dyn Fn(Context) -> String) -> String {
        format!("{}: {}", self.name, self.difference(words))
    }

    fn difference(&self, words: &dyn Fn(Context) -> String) -> String {
        let Self { activity, iu, .. } = self;
        let (step, iu) = (activity + 1, iu + 1);
        match (self.had.map(words), self.others.map(words)) {
            (Some(had), Some(others)) => {
                format!("in step {step}, IU {iu} it has {had}, the others have {others}")
            }
            (Some(had), None) => {
                format!("its step {step} goes on with {had}, that of the others has ended before")
            }
            (None, Some(others)) if iu == 1 => {
                format!("it has no step {step}, which begins with {others} in the others")
            }
            (None, Some(others)) => {
                format!("its step {step} ends before IU {iu}, that of the others goes on with {others}")
            }
            (None, None) => format!("its step {step} differs from that of the others"),
        }
    }
}

pub(super) fn range(bounds: Bounds, value: impl Fn(u32) -> String) -> String {
    match (bounds.min, bounds.max) {
        (0, u32::MAX) => "any".to_owned(),
        (min, u32::MAX) => format!("from {}", value(min)),
        (min, max) => format!("{} to {}", value(min), value(max)),
    }
}
