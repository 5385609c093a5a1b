//! A run: one recording of a whole job, encoded, segmented and judged by the code that runs live.

use crate::job_file::sha256_hex;
use crate::recording::{self, NamedObject, Recording, TrackError};
use andon_core::anomaly::{self, Judge};
use andon_core::config::Method;
use andon_core::couple::{self, Context, Couples, Encoder, Motion};
use andon_core::input::{ObjectShape, Side};
use andon_core::job::Job;
use andon_core::segment::{Event, JobSegmenter};
use andon_core::verdict::Verdict;

/// One Interaction Unit of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Iu {
    /// The context that it is in.
    pub context: Context,
    /// Its motion after the opening-closing filter, one a frame of the grid.
    pub motion: Vec<Motion>,
    /// How often the motion turned back.
    pub reversals: u32,
    /// When it began, in nanoseconds of the recording.
    pub began_ns: u64,
    /// When the next one began.
    pub ended_ns: u64,
    /// False where hand or object were out of sight for too long.
    pub sighted: bool,
}

/// One activity of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Activity {
    /// Whose hand.
    pub side: Side,
    /// Its IUs in order.
    pub ius: Vec<Iu>,
}

impl Activity {
    /// The contexts of its IUs in order.
    pub fn contexts(&self) -> Vec<Context> {
        self.ius.iter().map(|iu| iu.context).collect()
    }
}

/// One recording of a whole job, encoded and segmented.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its name, without folders.
    pub name: String,
    /// SHA-256 of the bytes that it was read from, in hexadecimal.
    pub sha256: String,
    /// The objects that may appear in it.
    pub objects: Vec<NamedObject>,
    /// What the judge takes, in time order.
    pub couples: Vec<Couples>,
    /// Its activities in the order in which they began.
    pub activities: Vec<Activity>,
}

/// Why a recording is no run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The track file was refused.
    #[error(transparent)]
    Track(#[from] TrackError),
    /// The encoder does not take the method or the objects.
    #[error("{name}: the recording cannot be encoded: {unusable:?}")]
    Unusable {
        /// The run's name.
        name: String,
        /// Why.
        unusable: couple::Unusable,
    },
}

impl Run {
    /// Reads, encodes and segments a track file. `name` is how reports call it.
    ///
    /// # Errors
    /// The first line that cannot be trusted, or a method or objects that cannot be used.
    pub fn read(name: &str, bytes: &[u8], method: &Method) -> Result<Self, RunError> {
        Self::new(name, &sha256_hex(bytes), &recording::read(name, bytes)?, method)
    }

    /// Encodes and segments a recording. `sha256` is that of the bytes it comes from.
    ///
    /// # Errors
    /// If the method or the objects cannot be used.
    pub fn new(name: &str, sha256: &str, recording: &Recording, method: &Method) -> Result<Self, RunError> {
        let unusable = |unusable| RunError::Unusable { name: name.to_owned(), unusable };
        let shapes: Vec<ObjectShape> = recording.header.shapes();
        let mut encoder = Encoder::new(*method, &shapes).map_err(unusable)?;
        let mut segmenter =
            JobSegmenter::new(method).map_err(|fault| unusable(couple::Unusable::Method(fault)))?;
        let mut couples: Vec<Couples> = Vec::with_capacity(recording.frames.len());
        for frame in &recording.frames {
            // A refused frame has changed nothing; the reader lets none through.
            let _ = encoder.step(frame, &mut |made| couples.push(made));
        }
        encoder.flush(&mut |made| couples.push(made));
        let mut collector = Collector::default();
        for couples in &couples {
            segmenter.step(couples, &mut |event| collector.take(event));
        }
        segmenter.finish(&mut |event| collector.take(event));
        Ok(Self {
            name: name.to_owned(),
            sha256: sha256.to_owned(),
            objects: recording.header.objects.clone(),
            couples,
            activities: collector
                .activities
                .into_iter()
                .filter(|activity| !activity.ius.is_empty())
                .collect(),
        })
    }

    /// The verdicts of the live judge on this run.
    ///
    /// # Errors
    /// If the method or the job cannot be used.
    pub fn judge(&self, job: &Job<'_>, method: &Method) -> Result<Vec<Verdict>, anomaly::Unusable> {
        let mut judge = Judge::<Vec<_>>::with_memory(job, *method)?;
        let mut verdicts = Vec::new();
        for couples in &self.couples {
            judge.step(couples, &mut |verdict| verdicts.push(verdict));
        }
        judge.finish(&mut |verdict| verdicts.push(verdict));
        Ok(verdicts)
    }
}

/// Gathers the events of the segmenter into activities and IUs.
#[derive(Default)]
struct Collector {
    activities: Vec<Activity>,
    /// The activity that each hand is in, right then left.
    open: [Option<usize>; 2],
    /// The motion of the IU that each hand is in.
    motion: [Vec<Motion>; 2],
}

impl Collector {
    fn take(&mut self, event: Event) {
        match event {
            Event::ActivityBegan { side, .. } => {
                self.open[slot(side)] = Some(self.activities.len());
                self.activities.push(Activity { side, ius: Vec::new() });
            }
            Event::IuBegan { side, .. } => self.motion[slot(side)].clear(),
            Event::IuFrame { side, motion, .. } => self.motion[slot(side)].push(motion),
            Event::IuEnded { side, iu } => {
                let motion = std::mem::take(&mut self.motion[slot(side)]);
                let activity = self.open[slot(side)].and_then(|open| self.activities.get_mut(open));
                // Without a frame there is nothing to compare.
                if let Some(activity) = activity.filter(|_| !motion.is_empty()) {
                    activity.ius.push(Iu {
                        context: iu.context,
                        motion,
                        reversals: iu.reversals,
                        began_ns: iu.began_ns,
                        ended_ns: iu.ended_ns,
                        sighted: iu.sighted,
                    });
                }
            }
            Event::ActivityEnded { side, .. } => self.open[slot(side)] = None,
            Event::JobBegan { .. } | Event::Eru { .. } | Event::JobEnded { .. } => {}
        }
    }
}

fn slot(side: Side) -> usize {
    match side {
        Side::Right => 0,
        Side::Left => 1,
    }
}
