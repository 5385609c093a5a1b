//! k-means with DTW as the distance and DBA barycentres as centroids (paper III-C, IV-A).

use super::elbow::elbow;
use crate::barycentre::Barycentres;
use crate::warp::{DistanceMatrix, Warp};
use andon_core::couple::Motion;
use andon_core::dtw::Refused;
use andon_core::job::LocalCost;
use oorandom::Rand64;

/// Restarts for each k, as in the paper.
const RESTARTS: usize = 10;

/// Rounds of one restart; it has settled after 3 to 8.
const ROUNDS: usize = 30;

/// Clusters by motion, for each k and for the best.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionClusters {
    /// Least WCSS (sum of squared DTW distances to the centroid) of all restarts for k = 1, 2, ...
    pub wcss: Vec<f64>,
    /// k by the elbow rule.
    pub k: usize,
    /// The cluster of each sequence at that k, numbered in the order in which they first appear.
    pub labels: Vec<usize>,
    /// The centroid of each cluster at that k.
    pub centroids: Vec<Vec<Motion>>,
}

/// Clusters sequences for k = 1..=`most` with 10 restarts each, seeded by k-means++ (Arthur and Vassilvitskii 2007) from `seed`.
/// `progress` is called with the share that is done.
///
/// # Errors
/// If there is no sequence, or one is empty or longer than an IU may be.
pub fn by_motion(
    sequences: &[&[Motion]],
    distances: &DistanceMatrix,
    cost: LocalCost,
    bins: u8,
    most: usize,
    seed: u64,
    progress: &mut dyn FnMut(f64),
) -> Result<MotionClusters, Refused> {
    let mut means = Means {
        sequences,
        distances,
        warp: Warp::new(cost),
        tables: Barycentres::new(cost, bins),
        random: Rand64::new(u128::from(seed)),
    };
    let mut best: Vec<Solution> = Vec::new();
    let most = most.min(sequences.len());
    for k in 1..=most {
        // One cluster has no choice to make.
        let restarts = if k == 1 { 1 } else { RESTARTS };
        let mut least: Option<Solution> = None;
        for restart in 0..restarts {
            let found = means.solve(k)?;
            if least.as_ref().is_none_or(|least| found.wcss < least.wcss) {
                least = Some(found);
            }
            progress(((k - 1) as f64 + (restart + 1) as f64 / restarts as f64) / most as f64);
        }
        best.extend(least);
    }
    let wcss: Vec<f64> = best.iter().map(|solution| solution.wcss).collect();
    let k = elbow(&wcss);
    let chosen = best.into_iter().nth(k - 1).ok_or(Refused::Empty)?;
    Ok(chosen.numbered(wcss, k))
}

struct Solution {
    wcss: f64,
    labels: Vec<usize>,
    centroids: Vec<Vec<Motion>>,
}

impl Solution {
    fn numbered(self, wcss: Vec<f64>, k: usize) -> MotionClusters {
        let mut order: Vec<usize> = Vec::new();
        for label in &self.labels {
            if !order.contains(label) {
                order.push(*label);
            }
        }
        let place = |label: &usize| order.iter().position(|other| other == label).unwrap_or_default();
        MotionClusters {
            wcss,
            k,
            labels: self.labels.iter().map(place).collect(),
            centroids: order.iter().map(|&label| self.centroids[label].clone()).collect(),
        }
    }
}

struct Means<'a> {
    sequences: &'a [&'a [Motion]],
    distances: &'a DistanceMatrix,
    warp: Warp,
    tables: Barycentres,
    random: Rand64,
}

impl Means<'_> {
    fn solve(&mut self, k: usize) -> Result<Solution, Refused> {
        let mut centroids: Vec<Vec<Motion>> =
            self.seeds(k).into_iter().map(|seed| self.sequences[seed].to_vec()).collect();
        let mut best: Option<Solution> = None;
        for _ in 0..ROUNDS {
            let (labels, wcss) = self.assign(&centroids)?;
            // DBA on whole numbers may not lower the sum any more although labels still change: then it is over.
            if best.as_ref().is_some_and(|best| wcss >= best.wcss) {
                break;
            }
            let groups = groups(&labels, k);
            best = Some(Solution { wcss, labels, centroids: centroids.clone() });
            for (centroid, group) in centroids.iter_mut().zip(&groups) {
                // A cluster that has lost all its members keeps its centroid.
                if !group.is_empty() {
                    *centroid = self.tables.of(&mut self.warp, self.sequences, self.distances, group)?;
                }
            }
        }
        best.ok_or(Refused::Empty)
    }

    /// k-means++: each next seed with a chance in proportion to its squared distance to the nearest seed so far.
    fn seeds(&mut self, k: usize) -> Vec<usize> {
        let count = self.sequences.len();
        let mut seeds = vec![self.random.rand_range(0..count as u64) as usize];
        while seeds.len() < k {
            let nearest = |i: usize| {
                seeds.iter().map(|&s| self.distances.get(i, s)).fold(f64::INFINITY, f64::min).powi(2)
            };
            let weights: Vec<f64> = (0..count).map(nearest).collect();
            let mut left = self.random.rand_float() * weights.iter().sum::<f64>();
            let chosen = weights.iter().position(|weight| {
                left -= weight;
                left < 0.0
            });
            // All are equal to a seed: then any will do.
            seeds.push(chosen.unwrap_or(count - 1));
        }
        seeds
    }

    fn assign(&mut self, centroids: &[Vec<Motion>]) -> Result<(Vec<usize>, f64), Refused> {
        let mut labels = Vec::with_capacity(self.sequences.len());
        let mut wcss = 0.0;
        for sequence in self.sequences {
            let mut least = (0, f64::INFINITY);
            for (label, centroid) in centroids.iter().enumerate() {
                if let Some(distance) = self.warp.distance_within(sequence, centroid, least.1)?
                    && distance < least.1
                {
                    least = (label, distance);
                }
            }
            labels.push(least.0);
            wcss += least.1 * least.1;
        }
        Ok((labels, wcss))
    }
}

fn groups(labels: &[usize], k: usize) -> Vec<Vec<usize>> {
    let mut groups = vec![Vec::new(); k];
    for (place, &label) in labels.iter().enumerate() {
        groups[label].push(place);
    }
    groups
}
