//! The job file: a taught job as a person can read it and a program can trust it.
//!
//! TOML with a format, a version and a checksum. What is damaged, or of another version, or breaks a capacity of
//! the method is refused; the fault says where. [`JobFile::with_job`] lends the [`Job`] that the judge takes.

mod checksum;

mod error;
mod parse;
mod runs;
mod text;
mod validate;

pub use checksum::sha256_hex;
pub use error::{JobFault, JobFileError};
pub(crate) use text::context_words;

use crate::recording::NamedObject;
use crate::teach::{BoundsRule, ThresholdRule};
use andon_core::config::Method;
use andon_core::couple::{Context, Motion};
use andon_core::job::{Bounds, Job, LocalCost, NominalActivity, NominalIu};

/// The value of `format`.
pub const FORMAT: &str = "andon.job";

/// The value of `version`.
pub const VERSION: i64 = 1;

/// One IU of a nominal activity, owned.
#[derive(Clone, Debug, PartialEq)]
pub struct TaughtIu {
    /// The context that it is in.
    pub context: Context,
    /// Greatest DTW distance that is right.
    pub threshold: f32,
    /// How long it may last, in frames of the grid.
    pub frames: Bounds,
    /// How often the motion may turn back.
    pub reversals: Bounds,
    /// The barycentre, one motion a frame of the grid.
    pub reference: Vec<Motion>,
    /// How many demonstrations the threshold rests on.
    pub demonstrations: u32,
}

/// One nominal activity, owned.
#[derive(Clone, Debug, PartialEq)]
pub struct TaughtActivity {
    /// Which activity of the job this sequence fulfils.
    pub activity: u16,
    /// Its IUs in order.
    pub ius: Vec<TaughtIu>,
}

/// A file that a job was taught from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// Its name, without folders.
    pub name: String,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
    /// Whether it was left out of the barycentres, because it disagrees with the others.
    pub left_out: bool,
}

/// Where a job comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// Program and version that taught it.
    pub program: String,
    /// When it was taught, as the caller says it.
    pub date: String,
    /// How thresholds were chosen.
    pub rule: ThresholdRule,
    /// How duration and reversal bounds were chosen.
    pub bounds: BoundsRule,
    /// What it was taught from.
    pub sources: Vec<Source>,
}

/// A taught job with all that is needed to judge by it.
#[derive(Clone, Debug, PartialEq)]
pub struct JobFile {
    /// The number that a PLC selects it by.
    pub id: u32,
    /// What a person calls the job.
    pub name: String,
    /// Whether the activities must come in the order of their numbers.
    pub order_matters: bool,
    /// How motions are compared.
    pub cost: LocalCost,
    /// [`Job::slowness`]
    pub slowness: f32,
    /// The constants that it was taught with, and must be judged with.
    pub method: Method,
    /// The objects on the bench.
    pub objects: Vec<NamedObject>,
    /// The nominal activities.
    pub activities: Vec<TaughtActivity>,
    /// Where it comes from.
    pub provenance: Provenance,
}

impl JobFile {
    /// Lends the job to `judge`, which may run for as long as it likes: a role runs its whole loop in there.
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
        let Self { order_matters, cost, slowness, .. } = *self;
        judge(&Job { activities: &activities, order_matters, cost, slowness })
    }

    /// Names the model: the same text gives the same number, on every machine.
    pub fn model_hash(&self) -> u64 {
        checksum::model_hash(&self.to_toml())
    }

    /// What a person calls an object; its number where the file does not name it.
    pub fn object_name(&self, id: u16) -> String {
        object_name(&self.objects, id)
    }
}

/// What a person calls an object; its number where no list names it.
pub(crate) fn object_name(objects: &[NamedObject], id: u16) -> String {
    objects
        .iter()
        .find(|object| object.shape.id == id)
        .map_or_else(|| format!("object {id}"), |object| object.name.clone())
}

impl TaughtIu {
    fn lend(&self) -> NominalIu<'_> {
        NominalIu {
            context: self.context,
            reference: &self.reference,
            threshold: self.threshold,
            frames: self.frames,
            reversals: self.reversals,
        }
    }
}
