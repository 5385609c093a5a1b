//! The DTW of [`andon_core::dtw`] for two whole sequences, with memory that grows as needed: their distance, and the warping path.

use andon_core::couple::Motion;
use andon_core::dtw::{LocalCosts, OnlineDtw, Refused};
use andon_core::job::LocalCost;

/// Working memory for distances and warping paths under one local cost.
#[derive(Clone, Debug)]
pub struct Warp {
    costs: LocalCosts,
    /// The matrix of the newest path, row by row.
    matrix: Vec<u32>,
}

impl Warp {
    /// Empty memory for this local cost.
    pub fn new(cost: LocalCost) -> Self {
        Self { costs: LocalCosts::new(cost), matrix: Vec::new() }
    }

    /// The DTW distance: the root of the sum of the squared local costs along the warping path.
    ///
    /// # Errors
    /// If a sequence is empty or longer than an IU may be.
    pub fn distance(&mut self, a: &[Motion], b: &[Motion]) -> Result<f64, Refused> {
        // No distance is greater than this bound.
        Ok(self.distance_within(a, b, f64::INFINITY)?.unwrap_or(f64::INFINITY))
    }

    /// The DTW distance, or `None` if it exceeds `bound`; that is often known long before the end.
    ///
    /// # Errors
    /// If a sequence is empty or longer than an IU may be.
    pub fn distance_within(
        &mut self,
        a: &[Motion],
        b: &[Motion],
        bound: f64,
    ) -> Result<Option<f64>, Refused> {
        // Fewer rows are faster.
        let [frames, reference] = if a.len() <= b.len() { [a, b] } else { [b, a] };
        let mut dtw = OnlineDtw::new(&self.costs, reference)?;
        for frame in frames {
            dtw.append(frame)?;
            if dtw.lower_bound() > bound {
                return Ok(None);
            }
        }
        let distance = dtw.distance().ok_or(Refused::Empty)?;
        Ok(Some(distance).filter(|distance| *distance <= bound))
    }

    /// Calls `visit` with each pair of frame indices `(in a, in b)` of a warping path with the minimum sum, from the last to the first. Of equally good
    /// steps the diagonal one is taken, else the one along `a`, as dtaidistance does.
    ///
    /// # Errors
    /// If a sequence is empty or longer than an IU may be.
    pub fn align(
        &mut self,
        a: &[Motion],
        b: &[Motion],
        visit: impl FnMut((usize, usize)),
    ) -> Result<(), Refused> {
        let newest = a.len().checked_sub(1).ok_or(Refused::Empty)?;
        let mut dtw = OnlineDtw::new(&self.costs, b)?;
        self.matrix.clear();
        for frame in a {
            dtw.append(frame)?;
            self.matrix.extend_from_slice(dtw.row());
        }
        // A cell outside of the matrix is reached by no path.
        let cell = |i: Option<usize>, j: Option<usize>| {
            i.zip(j).map_or(u32::MAX, |(i, j)| self.matrix[i * b.len() + j])
        };
        let before = |&(i, j): &(usize, usize)| {
            let [up, left] = [i.checked_sub(1), j.checked_sub(1)];
            let [diagonal_cell, up_cell, left_cell] =
                [cell(up, left), cell(up, Some(j)), cell(Some(i), left)];
            if diagonal_cell <= up_cell.min(left_cell) {
                up.zip(left)
            } else if up_cell <= left_cell {
                up.map(|i| (i, j))
            } else {
                left.map(|j| (i, j))
            }
        };
        std::iter::successors(Some((newest, b.len() - 1)), before).for_each(visit);
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;
    use serde_json::{Value, from_value};

    fn motions() -> impl Strategy<Value = Vec<Motion>> {
        let frame = (-1..=1i8, 0..=7i8, 0..=1i8)
            .prop_map(|(a_h, turn, joint)| Motion([a_h, 0, turn, joint, 0, turn, 1]));
        prop::collection::vec(frame, 1..60)
    }

    fn path(warp: &mut Warp, a: &[Motion], b: &[Motion]) -> Vec<(usize, usize)> {
        let mut pairs = Vec::new();
        warp.align(a, b, |pair| pairs.push(pair)).unwrap();
        pairs
    }

    #[test]
    fn warping_paths_are_those_of_dtaidistance() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/golden/dtw/vectors.json");
        let all: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        let motions =
            |values: &Value| from_value::<Vec<[i8; 7]>>(values.clone()).unwrap().into_iter().map(Motion);
        for vector in all["ordinal"].as_array().unwrap() {
            let [a, b]: [Vec<Motion>; 2] = ["a", "b"].map(|key| motions(&vector[key]).collect());
            let mut pairs = path(&mut Warp::new(LocalCost::Ordinal), &a, &b);
            pairs.reverse();
            assert_eq!(pairs, from_value::<Vec<(usize, usize)>>(vector["path"].clone()).unwrap());
        }
    }

    #[test]
    fn sequences_of_unusable_length_are_refused() {
        let (mut warp, one) = (Warp::new(LocalCost::Ordinal), [Motion::default()]);
        let long = vec![Motion::default(); andon_core::capacity::IU_FRAMES + 1];
        let too_long = Refused::TooLong { frames: long.len() };
        assert_eq!(warp.distance(&[], &one), Err(Refused::Empty));
        assert_eq!(warp.distance(&one, &long), Err(too_long));
        assert_eq!(warp.distance_within(&one, &[], 1.0), Err(Refused::Empty));
        assert_eq!(warp.distance_within(&one, &one, f64::NAN), Ok(None));
        assert_eq!(warp.align(&[], &one, |_| ()), Err(Refused::Empty));
        assert_eq!(warp.align(&long, &one, |_| ()), Err(too_long));
    }

    proptest! {
        #[test]
        fn a_distance_is_within_itself_and_the_costs_of_its_path_add_up_to_it(
            a in motions(),
            b in motions(),
            local in prop::sample::select(vec![LocalCost::Ordinal, LocalCost::Circular { bins: 8 }]),
        ) {
            let mut warp = Warp::new(local);
            let distance = warp.distance(&a, &b).unwrap();
            prop_assert_eq!(warp.distance(&b, &a).unwrap(), distance);
            for (bound, within) in [
                (distance, Some(distance)),
                (f64::INFINITY, Some(distance)),
                (distance.next_down(), None),
                (distance / 2.0, Some(distance).filter(|distance| *distance == 0.0)),
            ] {
                prop_assert_eq!(warp.distance_within(&a, &b, bound).unwrap(), within);
            }
            let pairs = path(&mut warp, &a, &b);
            prop_assert_eq!(pairs[0], (a.len() - 1, b.len() - 1));
            prop_assert_eq!(*pairs.last().unwrap(), (0, 0));
            for step in pairs.windows(2) {
                let [(i, j), (k, l)] = [step[0], step[1]];
                prop_assert!([(1, 1), (1, 0), (0, 1)].contains(&(i - k, j - l)));
            }
            if local == LocalCost::Ordinal {
                let squares = pairs.iter().map(|(i, j)| a[*i].0.iter().zip(b[*j].0).map(|(x, y)| f64::from(x - y).powi(2)).sum::<f64>());
                prop_assert!((squares.sum::<f64>().sqrt() - distance).abs() < 1e-9);
            }
            let costs = pairs.iter().map(|(i, j)| warp.distance(&a[*i..=*i], &b[*j..=*j]).unwrap().powi(2));
            prop_assert!((costs.sum::<f64>().sqrt() - distance).abs() < 1e-9);
        }
    }
}
