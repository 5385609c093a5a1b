//! Clusters of IUs: by motion, by context, and by both (paper III-C).
//!
//! [`by_motion`] is k-means with DTW distances and DBA centroids, with k chosen at the elbow of the within-cluster sum of squares (WCSS).
//! [`by_context`] is DBSCAN. Together they give each IU the pair `(m_i, c_j)`.

mod context;
mod elbow;
mod motion;

pub use context::by_context;
pub use motion::{MotionClusters, by_motion};

/// How many IUs of each kind are in each cluster.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// Number of IUs by `[kind][cluster]`.
    pub counts: Vec<Vec<usize>>,
}

impl Table {
    /// Counts the IUs by kind and cluster: IU `i` is of kind `kinds[i]` and in cluster `labels[i]`.
    pub fn new(kinds: &[usize], labels: &[usize]) -> Self {
        let size = |values: &[usize]| values.iter().max().map_or(0, |max| max + 1);
        let mut counts = vec![vec![0; size(labels)]; size(kinds)];
        for (&kind, &label) in kinds.iter().zip(labels) {
            counts[kind][label] += 1;
        }
        Self { counts }
    }

    /// The cluster that most IUs of a kind are in; ties go to the smaller number.
    pub fn home(&self, kind: usize) -> Option<usize> {
        let row = self.counts.get(kind)?;
        (0..row.len()).max_by_key(|&label| (row[label], std::cmp::Reverse(label)))
    }
}
