//! k-means with DTW as the distance and DBA barycentres as centroids (paper III-C, IV-A).

use super::elbow::elbow;
use andon_core::couple::Motion;
use andon_core::dtw::Refused;
use andon_core::job::LocalCost;
use andon_learn::barycentre::Barycentres;
use andon_learn::warp::{DistanceMatrix, Warp};
use oorandom::Rand64;

/// Number of restarts for each k, as in the paper.
const RESTARTS: usize = 10;

/// Maximum number of rounds of one restart; it settles after 3 to 8.
const MAX_ROUNDS: usize = 30;

/// Clusters by motion.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionClusters {
    /// For k = 1, 2, ... the minimum of all restarts of the WCSS, the sum of squared DTW distances to the centroids.
    pub wcss: Vec<f64>,
    /// The k that was chosen by the elbow rule.
    pub k: usize,
    /// The cluster of each sequence at that k. Clusters are numbered from 0 in the order in which they first appear.
    pub labels: Vec<usize>,
}

/// Clusters sequences for each k from 1 to `max_k`, with 10 restarts each. `distances` are those between all sequences, `bins` is the number
/// of direction bins, and `seed` is that of k-means++ (Arthur and Vassilvitskii 2007). `progress` is called with the share that is done, 0 to 1.
///
/// # Errors
/// If there is no sequence, or one is empty or longer than an IU may be.
pub fn by_motion(
    sequences: &[&[Motion]],
    distances: &DistanceMatrix,
    cost: LocalCost,
    bins: u8,
    max_k: usize,
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
    let max_k = max_k.min(sequences.len());
    let mut solutions: Vec<Solution> = Vec::new();
    for k in 1..=max_k {
        let mut restart_progress = |share: f64| progress(((k - 1) as f64 + share) / max_k as f64);
        solutions.push(means.best_of_restarts(k, &mut restart_progress)?);
    }
    let wcss: Vec<f64> = solutions.iter().map(|solution| solution.wcss).collect();
    let k = elbow(&wcss);
    let chosen = solutions.into_iter().nth(k - 1).ok_or(Refused::Empty)?;
    Ok(MotionClusters { wcss, k, labels: numbered(&chosen.labels) })
}

/// Numbers the clusters from 0 in the order in which they first appear.
fn numbered(labels: &[usize]) -> Vec<usize> {
    let mut order: Vec<usize> = Vec::new();
    for label in labels {
        if !order.contains(label) {
            order.push(*label);
        }
    }
    let index = |label: &usize| order.iter().position(|other| other == label).unwrap_or_default();
    labels.iter().map(index).collect()
}

struct Solution {
    wcss: f64,
    labels: Vec<usize>,
}

/// k-means over the sequences.
struct Means<'a> {
    sequences: &'a [&'a [Motion]],
    distances: &'a DistanceMatrix,
    warp: Warp,
    tables: Barycentres,
    random: Rand64,
}

impl Means<'_> {
    /// The solution with the smallest WCSS of all restarts; the first of equal ones.
    fn best_of_restarts(&mut self, k: usize, progress: &mut dyn FnMut(f64)) -> Result<Solution, Refused> {
        // A single cluster leaves nothing to choose.
        let restarts = if k == 1 { 1 } else { RESTARTS };
        let mut best = self.solve(k)?;
        progress(1.0 / restarts as f64);
        for restart in 1..restarts {
            let found = self.solve(k)?;
            if found.wcss < best.wcss {
                best = found;
            }
            progress((restart + 1) as f64 / restarts as f64);
        }
        Ok(best)
    }

    fn solve(&mut self, k: usize) -> Result<Solution, Refused> {
        let mut centroids: Vec<Vec<Motion>> =
            self.seeds(k).into_iter().map(|seed| self.sequences[seed].to_vec()).collect();
        let mut best: Option<Solution> = None;
        for _ in 0..MAX_ROUNDS {
            let (labels, wcss) = self.assign(&centroids)?;
            // DBA on integers may stop lowering the sum while labels still change; that is the end.
            if best.as_ref().is_some_and(|best| wcss >= best.wcss) {
                break;
            }
            let groups = groups(&labels, k);
            best = Some(Solution { wcss, labels });
            for (centroid, group) in centroids.iter_mut().zip(&groups) {
                // A cluster that has lost all its members keeps its centroid.
                if !group.is_empty() {
                    *centroid = self.tables.of(&mut self.warp, self.sequences, self.distances, group)?;
                }
            }
        }
        best.ok_or(Refused::Empty)
    }

    /// k-means++: each further seed is drawn with a probability proportional to its squared distance to the nearest seed so far. Returns the
    /// indices of the sequences.
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
            // If every sequence equals a seed, any of them will do.
            seeds.push(chosen.unwrap_or(count - 1));
        }
        seeds
    }

    /// The nearest centroid of each sequence, and the WCSS.
    fn assign(&mut self, centroids: &[Vec<Motion>]) -> Result<(Vec<usize>, f64), Refused> {
        let mut labels = Vec::with_capacity(self.sequences.len());
        let mut wcss = 0.0;
        for sequence in self.sequences {
            let mut min = (0, f64::INFINITY);
            for (label, centroid) in centroids.iter().enumerate() {
                if let Some(distance) = self.warp.distance_within(sequence, centroid, min.1)?
                    && distance < min.1
                {
                    min = (label, distance);
                }
            }
            labels.push(min.0);
            wcss += min.1 * min.1;
        }
        Ok((labels, wcss))
    }
}

/// The indices of the members of each cluster.
fn groups(labels: &[usize], k: usize) -> Vec<Vec<usize>> {
    let mut groups = vec![Vec::new(); k];
    for (index, &label) in labels.iter().enumerate() {
        groups[label].push(index);
    }
    groups
}
