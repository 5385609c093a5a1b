//! Which IUs are alike, in motion and in context (paper III-C, IV-A).
//!
//! [`Kind`]s say which IUs are compared, [`Analysis`] computes distances, clusters and barycentres, [`report`] draws them.

mod kind;
mod matrix;
mod picture;
mod report;

pub use kind::Kind;
pub use matrix::Matrix;
pub use report::{Report, report};

use crate::barycentre::Barycentres;
use crate::cluster::{MotionClusters, Table, by_context, by_motion};
use crate::folder::Labelled;
use crate::run::Iu;
use crate::warp::{DistanceMatrix, Warp};
use andon_core::config::Method;
use andon_core::couple::{Context, Motion};
use andon_core::dtw::Refused;
use andon_core::job::LocalCost;

/// Most clusters that are tried: 10 in the paper.
const MOST_CLUSTERS: usize = 10;

/// One IU that is compared with the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Its kind, as place among the kinds.
    pub kind: usize,
    /// Who.
    pub person: u32,
    /// The how-manieth time.
    pub repetition: u32,
    /// The run it is in.
    pub run: String,
    /// Its context.
    pub context: Context,
    /// Its motion.
    pub motion: Vec<Motion>,
}

/// What the IUs of a folder have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    /// Which IUs are compared.
    pub kinds: Vec<Kind>,
    /// The IUs, by kind, person and repetition.
    pub samples: Vec<Sample>,
    /// Their DTW distances.
    pub distances: DistanceMatrix,
    /// Clusters of motions.
    pub motion: MotionClusters,
    /// The cluster of each IU's context.
    pub context: Vec<usize>,
    /// The barycentre of each kind.
    pub barycentres: Vec<Vec<Motion>>,
    /// How motions are compared.
    pub cost: LocalCost,
    /// The names of the objects, by id.
    pub objects: Vec<(u16, String)>,
}

/// Why nothing was analysed.
#[derive(Debug, thiserror::Error)]
pub enum AnalysisError {
    /// No recording has an IU with a hand.
    #[error(
        "no recording has an interaction of a hand: check interaction points and contact distances (`andond segment` shows the contacts)"
    )]
    Nothing,
    /// An IU cannot be compared.
    #[error("an IU cannot be compared: {0}")]
    Iu(#[from] Refused),
}

impl Analysis {
    /// Compares and clusters the IUs of these kinds. `seed` is that of k-means++; `progress` is called with the share that is done.
    ///
    /// # Errors
    /// If no IU is of these kinds, or one is longer than can be compared.
    pub fn new(
        all: &[Labelled],
        kinds: Vec<Kind>,
        method: &Method,
        cost: LocalCost,
        seed: u64,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Self, AnalysisError> {
        let samples = samples(all, &kinds);
        let motions: Vec<&[Motion]> = samples.iter().map(|sample| sample.motion.as_slice()).collect();
        if motions.is_empty() {
            return Err(AnalysisError::Nothing);
        }
        let mut warp = Warp::new(cost);
        let distances = warp.matrix(&motions)?;
        let tables = Barycentres::new(cost, method.bins);
        let members = |kind: usize| -> Vec<usize> {
            (0..samples.len()).filter(|&place| samples[place].kind == kind).collect()
        };
        let barycentres = (0..kinds.len())
            .map(|kind| match members(kind).as_slice() {
                [] => Ok(Vec::new()),
                group => tables.of(&mut warp, &motions, &distances, group),
            })
            .collect::<Result<_, _>>()?;
        let motion = by_motion(&motions, &distances, cost, method.bins, MOST_CLUSTERS, seed, progress)?;
        let contexts: Vec<Context> = samples.iter().map(|sample| sample.context).collect();
        let mut objects: Vec<(u16, String)> = all
            .iter()
            .flat_map(|one| &one.run.objects)
            .map(|object| (object.shape.id, object.name.clone()))
            .collect();
        objects.sort();
        objects.dedup_by_key(|(id, _)| *id);
        let context = by_context(&contexts);
        Ok(Self { kinds, samples, distances, motion, context, barycentres, cost, objects })
    }

    /// The people, in order.
    pub fn people(&self) -> Vec<u32> {
        let mut people: Vec<u32> = self.samples.iter().map(|sample| sample.person).collect();
        people.sort_unstable();
        people.dedup();
        people
    }

    /// How many IUs of each kind are in each cluster of motions.
    pub fn motion_table(&self) -> Table {
        Table::new(&self.kind_of_samples(), &self.motion.labels)
    }

    /// How many IUs of each kind are in each cluster of contexts.
    pub fn context_table(&self) -> Table {
        Table::new(&self.kind_of_samples(), &self.context)
    }

    fn kind_of_samples(&self) -> Vec<usize> {
        self.samples.iter().map(|sample| sample.kind).collect()
    }

    /// The single-subject confidence matrix of a person: distances between all IUs of theirs, scaled to 0..1.
    pub fn single_subject(&self, person: u32) -> Matrix {
        let places: Vec<usize> =
            (0..self.samples.len()).filter(|&place| self.samples[place].person == person).collect();
        let label = |&place: &usize| {
            let sample = &self.samples[place];
            (sample.kind, format!("u{} r{}", sample.kind + 1, sample.repetition))
        };
        Matrix::new(places.iter().map(label).collect(), |i, j| self.distances.get(places[i], places[j]))
    }

    /// The multi-subject confidence matrix: mean distance between all repetitions of one kind by one person and all of another,
    /// scaled to 0..1.
    pub fn multi_subject(&self) -> Matrix {
        let mut groups: Vec<((usize, u32), Vec<usize>)> = Vec::new();
        for (place, sample) in self.samples.iter().enumerate() {
            let key = (sample.kind, sample.person);
            match groups.last_mut() {
                Some((last, group)) if *last == key => group.push(place),
                _ => groups.push((key, vec![place])),
            }
        }
        let label =
            |((kind, person), _): &((usize, u32), Vec<usize>)| (*kind, format!("u{} s{person}", kind + 1));
        Matrix::new(groups.iter().map(label).collect(), |i, j| {
            let (a, b) = (&groups[i].1, &groups[j].1);
            let sum: f64 = a.iter().flat_map(|&m| b.iter().map(move |&n| self.distances.get(m, n))).sum();
            sum / (a.len() * b.len()) as f64
        })
    }
}

fn samples(all: &[Labelled], kinds: &[Kind]) -> Vec<Sample> {
    let mut samples = Vec::new();
    for (kind, what) in kinds.iter().enumerate() {
        for one in all.iter().filter(|one| one.what == what.what) {
            let Some(iu) = what.find(&one.run) else { continue };
            let Iu { context, motion, .. } = iu.clone();
            let Labelled { person, repetition, .. } = *one;
            samples.push(Sample { kind, person, repetition, run: one.run.name.clone(), context, motion });
        }
    }
    samples.sort_by_key(|sample| (sample.kind, sample.person, sample.repetition));
    samples
}
