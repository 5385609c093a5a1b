//! Distances, clusters and barycentres of the IUs of a folder.

use super::kind::Kind;
use super::matrix::Matrix;
use crate::cluster::{MotionClusters, Table, by_context, by_motion};
use crate::folder::Labelled;
use andon_core::config::Method;
use andon_core::couple::{Context, Motion};
use andon_core::dtw::Refused;
use andon_core::job::LocalCost;
use andon_learn::barycentre::Barycentres;
use andon_learn::run::{Iu, RunError};
use andon_learn::teach::TeachError;
use andon_learn::warp::{DistanceMatrix, Warp};

/// Maximum number of clusters that is tried; 10 in the paper.
const MAX_CLUSTERS: usize = 10;

/// One IU that is compared with the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Index of its kind.
    pub kind: usize,
    /// The number of the person.
    pub person: u32,
    /// Repetition number.
    pub repetition: u32,
    /// The name of its run.
    pub run: String,
    /// Its context.
    pub context: Context,
    /// Its motion, one per frame of the grid.
    pub motion: Vec<Motion>,
}

/// What the IUs of a folder have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    /// Which IUs are compared.
    pub kinds: Vec<Kind>,
    /// The IUs in the order of kind, person and repetition.
    pub samples: Vec<Sample>,
    /// The DTW distances between the samples.
    pub distances: DistanceMatrix,
    /// The clusters of the samples' motions.
    pub motion: MotionClusters,
    /// The cluster of each sample's context.
    pub context: Vec<usize>,
    /// The barycentre of each kind, one motion per frame; empty for a kind without samples.
    pub barycentres: Vec<Vec<Motion>>,
    /// How motions are compared.
    pub cost: LocalCost,
}

/// Why an analysis failed.
#[derive(Debug, thiserror::Error)]
pub enum AnalysisError {
    /// No recording has an IU with a hand.
    #[error(
        "no recording has an interaction with a hand: check interaction points and contact distances (`andond segment` shows the contacts)"
    )]
    Nothing,
    /// An IU cannot be compared.
    #[error("an IU cannot be compared: {0}")]
    Iu(#[from] Refused),
    /// The recordings cannot be encoded with the objects of all of them.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Where hands and objects meet cannot be learned.
    #[error(transparent)]
    Teach(#[from] TeachError),
}

impl Analysis {
    /// Compares and clusters the IUs of these kinds. `seed` is that of k-means++; `progress` is called with the share that is done, 0 to 1.
    ///
    /// # Errors
    /// If there is no IU of these kinds, or one is too long to be compared.
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
            (0..samples.len()).filter(|&index| samples[index].kind == kind).collect()
        };
        let barycentres = (0..kinds.len())
            .map(|kind| match members(kind).as_slice() {
                [] => Ok(Vec::new()),
                group => tables.of(&mut warp, &motions, &distances, group),
            })
            .collect::<Result<_, _>>()?;
        let motion = by_motion(&motions, &distances, cost, method.bins, MAX_CLUSTERS, seed, progress)?;
        let contexts: Vec<Context> = samples.iter().map(|sample| sample.context).collect();
        let context = by_context(&contexts);
        Ok(Self { kinds, samples, distances, motion, context, barycentres, cost })
    }

    /// The numbers of the people, in ascending order.
    pub fn people(&self) -> Vec<u32> {
        let mut people: Vec<u32> = self.samples.iter().map(|sample| sample.person).collect();
        people.sort_unstable();
        people.dedup();
        people
    }

    /// How many IUs of each kind are in each motion cluster.
    pub fn motion_table(&self) -> Table {
        Table::new(&self.kind_of_samples(), &self.motion.labels)
    }

    /// How many IUs of each kind are in each context cluster.
    pub fn context_table(&self) -> Table {
        Table::new(&self.kind_of_samples(), &self.context)
    }

    /// How many IUs of each kind are in each pair of a motion cluster and a context cluster. The pairs are in the order of the columns.
    pub(super) fn table_of_both(&self) -> (Table, Vec<(usize, usize)>) {
        let pairs: Vec<(usize, usize)> =
            self.motion.labels.iter().copied().zip(self.context.iter().copied()).collect();
        let mut distinct = pairs.clone();
        distinct.sort_unstable();
        distinct.dedup();
        let column =
            |pair: &(usize, usize)| distinct.iter().position(|other| other == pair).unwrap_or_default();
        let labels: Vec<usize> = pairs.iter().map(column).collect();
        (Table::new(&self.kind_of_samples(), &labels), distinct)
    }

    fn kind_of_samples(&self) -> Vec<usize> {
        self.samples.iter().map(|sample| sample.kind).collect()
    }

    /// The single-subject confidence matrix of a person: the distances between all their IUs, scaled to 0..1.
    pub fn single_subject(&self, person: u32) -> Matrix {
        let indices: Vec<usize> =
            (0..self.samples.len()).filter(|&index| self.samples[index].person == person).collect();
        let label = |&index: &usize| {
            let sample = &self.samples[index];
            (sample.kind, format!("u{} r{}", sample.kind + 1, sample.repetition))
        };
        Matrix::new(indices.iter().map(label).collect(), |i, j| self.distances.get(indices[i], indices[j]))
    }

    /// The multi-subject confidence matrix: one row per kind and person, with the mean distances between all their repetitions, scaled to
    /// 0..1.
    pub fn multi_subject(&self) -> Matrix {
        let mut groups: Vec<((usize, u32), Vec<usize>)> = Vec::new();
        for (index, sample) in self.samples.iter().enumerate() {
            let key = (sample.kind, sample.person);
            match groups.last_mut() {
                Some((last, group)) if *last == key => group.push(index),
                _ => groups.push((key, vec![index])),
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
