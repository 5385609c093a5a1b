//! Clusters of IUs: by motion, by context, and by both (paper III-C).
//!
//! [`by_motion`] is k-means with DTW and DBA centroids; k is chosen by the elbow of the WCSS. [`by_context`] is DBSCAN.
//! Together they give each IU the pair `(m_i, c_j)`.

mod context;
mod elbow;
mod motion;

pub use context::{EPSILON, by_context};
pub use elbow::elbow;
pub use motion::{MotionClusters, by_motion};

/// How many IUs of each kind fell into each cluster.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// Rows are kinds, columns are clusters.
    pub counts: Vec<Vec<usize>>,
}

impl Table {
    /// Counts `labels[i]` for the kind `kinds[i]`.
    pub fn new(kinds: &[usize], labels: &[usize]) -> Self {
        let size = |values: &[usize]| values.iter().max().map_or(0, |most| most + 1);
        let mut counts = vec![vec![0; size(labels)]; size(kinds)];
        for (&kind, &label) in kinds.iter().zip(labels) {
            counts[kind][label] += 1;
        }
        Self { counts }
    }

    /// The cluster that most IUs of a kind are in.
    pub fn home(&self, kind: usize) -> Option<usize> {
        let row = self.counts.get(kind)?;
        (0..row.len()).max_by_key(|&label| (row[label], std::cmp::Reverse(label)))
    }

    /// The share of the IUs that are in the cluster that is home to their kind.
    pub fn purity(&self) -> f64 {
        let at_home: usize = self.counts.iter().filter_map(|row| row.iter().max()).sum();
        let all: usize = self.counts.iter().flatten().sum();
        if all == 0 { 0.0 } else { at_home as f64 / all as f64 }
    }
}
