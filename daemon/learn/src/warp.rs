//! The DTW of [`andon_core::dtw`], with memory that grows as needed.

use andon_core::couple::Motion;
use andon_core::dtw::{self, LocalCosts, Refused, Scratch};
use andon_core::job::LocalCost;

/// Working memory for distances and warping paths under one local cost.
#[derive(Clone, Debug)]
pub struct Warp {
    costs: LocalCosts,
    scratch: Box<Scratch>,
    matrix: Vec<dtw::Cells>,
}

impl Warp {
    /// Empty memory for this local cost.
    pub fn new(cost: LocalCost) -> Self {
        Self { costs: LocalCosts::new(cost), scratch: Box::default(), matrix: Vec::new() }
    }

    /// The DTW distance: the root of the sum of the squared local costs along the warping path.
    ///
    /// # Errors
    /// If a sequence is empty or longer than an IU may be.
    pub fn distance(&mut self, a: &[Motion], b: &[Motion]) -> Result<f64, Refused> {
        dtw::distance(&self.costs, a, b, &mut self.scratch)
    }

    /// The DTW distance, or `None` if it exceeds `bound`.
    ///
    /// # Errors
    /// If a sequence is empty or longer than an IU may be.
    pub fn distance_within(
        &mut self,
        a: &[Motion],
        b: &[Motion],
        bound: f64,
    ) -> Result<Option<f64>, Refused> {
        dtw::distance_within(&self.costs, a, b, bound, &mut self.scratch)
    }

    /// Calls `visit` with each pair of frame indices `(in a, in b)` of the warping path, from the last to the first.
    ///
    /// # Errors
    /// If a sequence is empty or longer than an IU may be.
    pub fn align(
        &mut self,
        a: &[Motion],
        b: &[Motion],
        visit: impl FnMut((usize, usize)),
    ) -> Result<(), Refused> {
        let needed = dtw::path_memory(a.len(), b.len());
        if self.matrix.len() < needed {
            self.matrix.resize(needed, dtw::Cells::default());
        }
        dtw::path(&self.costs, a, b, &mut self.matrix, &mut self.scratch)?.1.for_each(visit);
        Ok(())
    }

    /// The distances between all pairs of sequences.
    ///
    /// # Errors
    /// If a sequence is empty or longer than an IU may be.
    pub fn matrix(&mut self, sequences: &[impl AsRef<[Motion]>]) -> Result<DistanceMatrix, Refused> {
        let side = sequences.len();
        let mut values = vec![0.0; side * side];
        for i in 0..side {
            for j in 0..i {
                let distance = self.distance(sequences[i].as_ref(), sequences[j].as_ref())?;
                values[i * side + j] = distance;
                values[j * side + i] = distance;
            }
        }
        Ok(DistanceMatrix { side, values })
    }
}

/// A symmetric matrix of DTW distances.
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceMatrix {
    side: usize,
    values: Vec<f64>,
}

impl DistanceMatrix {
    /// The distance between sequences `i` and `j`.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        self.values[i * self.side + j]
    }

    /// The member of a group with the smallest sum of squared distances to the group; `None` if the group is empty.
    pub fn medoid(&self, group: &[usize]) -> Option<usize> {
        let spread = |i: usize| group.iter().map(|&j| self.get(i, j).powi(2)).sum::<f64>();
        group.iter().copied().min_by(|&a, &b| spread(a).total_cmp(&spread(b)).then(a.cmp(&b)))
    }
}
