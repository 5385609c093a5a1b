//! The job file: a taught job that people can read and programs can trust.
//!
//! It is TOML with a format, a version and a checksum. A file is refused if it is damaged, has another version or exceeds a capacity of
//! the method; the error says where. [`JobFile::with_job`] lends the [`Job`] that the judge needs.
//!
//! A job is known by a hash of its text, with its keys and comments. A PLC asks for it, and verdicts and recordings name it. So a job that was read
//! keeps the text that it was read from, and with it its hash, until something of it is changed ([`OlderText`]).

mod checksum;
mod error;
mod names;
mod parse;
mod runs;
mod shown;
mod text;
mod validate;

pub use error::{JobFault, JobFileError};
pub use shown::ShownValues;
pub(crate) use shown::of_runs;
pub use text::context_words;
pub(crate) use text::{sequence_words, side_of};

use crate::recording::{NamedObject, object_name, shapes};
use crate::rule::{BoundsRule, ThresholdRule};
use crate::strictness::Strictness;
use andon_core::bounds::Bounds;
use andon_core::config::Method;
use andon_core::couple::{Context, Motion};
use andon_core::job::{Job, JobObject, Law, LocalCost, MeasureBounds, NominalActivity, NominalIu};
use andon_core::object::ObjectShape;
use andon_core::set::ActivitySet;
use serde::Deserialize;

pub(crate) const FORMAT: &str = "andon.job";

pub(crate) const VERSION: i64 = 2;

/// One IU of a nominal activity, owned.
#[derive(Clone, Debug, PartialEq)]
pub struct TaughtIu {
    /// The context of the IU.
    pub context: Context,
    /// Maximum DTW distance of a correct execution.
    pub threshold: f32,
    /// Bounds of its duration, in frames of the grid.
    pub frames: Bounds,
    /// Bounds of the number of times that the motion reverses its direction.
    pub reversals: Bounds,
    /// Bounds of what it measures in metres.
    pub measures: MeasureBounds,
    /// What each of the runs measured, of which the measures have the ranges; `None` of a job that was taught before it was kept.
    pub shown: Option<ShownValues>,
    /// The barycentre, one motion per frame of the grid.
    pub reference: Vec<Motion>,
    /// The number of demonstrations that the threshold is derived from.
    pub demonstrations: u32,
}

/// One nominal activity, owned.
#[derive(Clone, Debug, PartialEq)]
pub struct TaughtActivity {
    /// Index of the activity of the job that this sequence fulfils, from 0.
    pub activity: u16,
    /// Its IUs in order.
    pub ius: Vec<TaughtIu>,
}

impl TaughtActivity {
    /// The contexts of its IUs in order.
    pub fn contexts(&self) -> Vec<Context> {
        self.ius.iter().map(|iu| iu.context).collect()
    }
}

/// What stands between an activity and one before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RelationKind {
    /// It is law that the other one has begun.
    Begin,
    /// It is law that the other one has ended.
    End,
    /// The other one had begun in all runs, without enough evidence for a law.
    Usual,
}

impl RelationKind {
    /// Its word in the job file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Begin => "begin",
            Self::End => "end",
            Self::Usual => "usual",
        }
    }
}

/// The relation of an activity to one before it, with its evidence.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Relation {
    /// The number of the activity that comes before.
    pub activity: u16,
    /// What stands between them.
    #[serde(rename = "law")]
    pub kind: RelationKind,
    /// How many runs have both.
    pub runs: u16,
    /// The mean time between the two beginnings, in seconds.
    pub gap_s: f32,
}

/// What the order of the job asks of one activity.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaughtStep {
    /// Whether all runs have it.
    #[serde(rename = "required")]
    pub is_required: bool,
    /// The nominal activities, by their indices in the job, that do a part of what other runs do in one and that it completes. It is required where
    /// one of them was done.
    #[serde(default)]
    pub completes: Vec<u16>,
    /// Whether a second time has no place in the job.
    #[serde(rename = "once")]
    pub is_once: bool,
    /// Whether other IUs may come between those of the sequences, see [`Law::allows_insertions`].
    #[serde(default, rename = "insertions")]
    pub allows_insertions: bool,
    /// How many runs have it.
    pub runs: u16,
    /// Its relations to activities before it.
    pub after: Vec<Relation>,
    /// The ids of the objects that it moves for good from where they lie at the beginning. The file has that with these.
    #[serde(skip)]
    pub moves: Vec<u16>,
}

/// A recording that a job was taught from.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Its name, without folders.
    pub name: String,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
    /// Whether it was left out because it disagrees with the others.
    pub left_out: bool,
}

/// Where a job comes from.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Name and version of the program that taught it.
    pub program: String,
    /// When it was taught, in the caller's words.
    pub date: String,
    /// How the thresholds were chosen.
    pub rule: ThresholdRule,
    /// How the bounds of duration and of reversals were chosen.
    pub bounds: BoundsRule,
    /// How strict it was asked to be; `None` of a job that was taught before that was asked.
    pub strictness: Option<Strictness>,
    /// Whether somebody has said that the order matters, or that it does not.
    pub order: Option<bool>,
    /// The recordings that it was taught from.
    #[serde(default, rename = "source")]
    pub sources: Vec<Source>,
}

/// A taught job with everything that is needed to judge by it.
#[derive(Clone, Debug, PartialEq)]
pub struct JobFile {
    /// The number by which a PLC selects the job.
    pub id: u32,
    /// The name that people use for the job.
    pub name: String,
    /// What the order asks of each activity, by its number.
    pub steps: Vec<TaughtStep>,
    /// The objects at which a hand was shown to rest or to steady.
    pub passive_contacts: Vec<u16>,
    /// How motions are compared.
    pub cost: LocalCost,
    /// The job's [`max_slowdown`](Job::max_slowdown), 1 or more.
    pub max_slowdown: f32,
    /// The job's [`has_free_ends`](Job::has_free_ends).
    pub has_free_ends: bool,
    /// How many frames per second must be processed for the job to be judged; 0 where that was not measured.
    pub min_rate_hz: f32,
    /// The constants that the job was taught with and must be judged with.
    pub method: Method,
    /// The objects on the bench.
    pub objects: Vec<NamedObject>,
    /// The nominal activities.
    pub activities: Vec<TaughtActivity>,
    /// Where it comes from.
    pub provenance: Provenance,
    /// What people call the steps, by their numbers; empty of a job that was taught before steps had names. No hash covers them: whoever
    /// changes a name has changed no job.
    pub step_names: Vec<String>,
    /// The text that it was read from, where this build has other words for the same job.
    pub older: Option<OlderText>,
}

/// A text in the words of an older build. It is that of its job for as long as the job is what was read.
#[derive(Clone, Debug, PartialEq)]
pub struct OlderText {
    /// As it was read, without the names of the steps.
    read: String,
    /// The same job as it is written now.
    now: String,
}

impl JobFile {
    /// Lends the job to `judge`, which may run for as long as it likes: a role runs its whole loop inside.
    pub fn with_job<T>(&self, judge: impl FnOnce(&Job<'_>) -> T) -> T {
        let ius: Vec<Vec<NominalIu<'_>>> = self
            .activities
            .iter()
            .map(|activity| activity.ius.iter().map(TaughtIu::lend).collect())
            .collect();
        let activities: Vec<NominalActivity<'_>> = self
            .activities
            .iter()
            .zip(&ius)
            .map(|(taught, ius)| NominalActivity { activity: taught.activity, ius })
            .collect();
        let laws: Vec<Law> = self.steps.iter().map(TaughtStep::law).collect();
        let objects: Vec<JobObject> =
            self.objects.iter().map(|object| self.use_of(object.shape.id)).collect();
        let Self { cost, max_slowdown, has_free_ends, .. } = *self;
        let min_captured = self.min_rate_hz / self.method.rate_hz;
        judge(&Job {
            activities: &activities,
            laws: &laws,
            objects: &objects,
            passive_contacts: &self.passive_contacts,
            cost,
            max_slowdown,
            has_free_ends,
            min_captured,
        })
    }

    /// The shapes of the objects as the encoder needs them.
    pub fn shapes(&self) -> Vec<ObjectShape> {
        shapes(&self.objects)
    }

    /// What the job does with this object.
    fn use_of(&self, id: u16) -> JobObject {
        let uses = |taught: &&TaughtActivity| taught.ius.iter().any(|iu| iu.context.involves(id));
        let used_by = self.activities.iter().filter(uses).map(|taught| usize::from(taught.activity));
        let steps = self.steps.iter().enumerate();
        let moved_by = steps.filter(|(_, step)| step.moves.contains(&id)).map(|(number, _)| number);
        JobObject { id, used_by: used_by.collect(), moved_by: moved_by.collect() }
    }

    /// Identifies the model: the same text gives the same number on every machine.
    pub fn model_hash(&self) -> u64 {
        checksum::model_hash(&self.to_toml())
    }

    /// The contexts of the IUs of an activity, as most runs have it.
    pub fn step_contexts(&self, number: usize) -> Vec<Context> {
        let first = self.activities.iter().find(|taught| usize::from(taught.activity) == number);
        first.map(TaughtActivity::contexts).unwrap_or_default()
    }

    /// What an activity of the job is called: by the file, or else by what is done with which parts.
    pub fn step_name(&self, number: usize) -> String {
        self.step_names.get(number).cloned().unwrap_or_else(|| self.proposed_name(number))
    }

    /// The name that a person has given an activity; `None` where it has none, or still the one that was proposed.
    pub fn given_name(&self, number: usize) -> Option<&str> {
        let name = self.step_names.get(number)?;
        (*name != self.proposed_name(number)).then_some(name)
    }

    /// What a person calls an object: its name, or its id if the file does not have it.
    pub fn object_name(&self, id: u16) -> String {
        object_name(&self.objects, id)
    }
}

impl TaughtStep {
    fn law(&self) -> Law {
        let after = |kind: RelationKind| -> ActivitySet {
            let of_kind = self.after.iter().filter(|relation| relation.kind == kind);
            of_kind.map(|relation| usize::from(relation.activity)).collect()
        };
        Law {
            after_begin: after(RelationKind::Begin),
            after_end: after(RelationKind::End),
            usually_after: after(RelationKind::Usual),
            is_required: self.is_required,
            completes: self.completes.iter().map(|index| usize::from(*index)).collect(),
            is_once: self.is_once,
            allows_insertions: self.allows_insertions,
            runs: self.runs,
        }
    }
}

impl TaughtIu {
    fn lend(&self) -> NominalIu<'_> {
        NominalIu {
            context: self.context,
            reference: &self.reference,
            threshold: self.threshold,
            frames: self.frames,
            reversals: self.reversals,
            measures: self.measures,
        }
    }
}
