//! DBA: the DTW barycentre of motions (Petitjean et al. 2011), on integer features.
//!
//! Each round aligns every sequence with the barycentre. It then gives each frame of the barycentre the best motion for all frames that are aligned
//! with it. "Best" is exact: feature by feature, it is the integer in range with the smallest sum of local costs, of several the smallest. For
//! `ordinal` features that is the rounded mean. For directions under `circular` it is the bin, or rest, with the smallest sum of squared chords. A
//! barycentre is therefore a motion that could be observed, and its row in a job file is readable.

use crate::warp::{DistanceMatrix, Warp};
use andon_core::couple::Motion;
use andon_core::dtw::Refused;
use andon_core::job::LocalCost;

/// Maximum number of rounds of DBA. On recorded IUs it converges after 3 to 6.
const MAX_ROUNDS: usize = 10;

/// Number of values that a feature can have: -1 to 120, the maximum number of bins that the method allows.
const VALUES: usize = 122;

/// How often each value of each feature occurs among the motions aligned with one frame of the barycentre; value -1 has index 0.
type Counts = [[u32; VALUES]; 7];

/// Frame indices of the barycentre, from the last to the first, with the motions aligned with them.
type Alignment = Vec<(usize, Motion)>;

fn count(alignments: &[Alignment], frames: usize) -> Vec<Counts> {
    let mut counts = vec![[[0; VALUES]; 7]; frames];
    for (index, motion) in alignments.iter().flatten() {
        change(&mut counts[*index], *motion, u32::wrapping_add);
    }
    counts
}

/// Adds 1 to the counts of a motion's values, or subtracts it.
fn change(counts: &mut Counts, motion: Motion, by: fn(u32, u32) -> u32) {
    for (counts, value) in counts.iter_mut().zip(motion.0) {
        let count = &mut counts[(i16::from(value) + 1).clamp(0, VALUES as i16 - 1) as usize];
        *count = by(*count, 1);
    }
}

/// Computes barycentres under one local cost.
#[derive(Clone, Debug)]
pub struct Barycentres {
    /// Local cost of a direction in a sequence (row, from 0) against a direction in the barycentre (column, from 0).
    direction: Vec<Vec<f64>>,
    /// The same of the other features, rows and columns from -1.
    number: Vec<Vec<f64>>,
}

impl Barycentres {
    /// Tables for this local cost, and for directions of `bins` bins.
    pub fn new(cost: LocalCost, bins: u8) -> Self {
        let mut warp = Warp::new(cost);
        let at = |index: usize, value: i8| {
            let mut motion = Motion::default();
            motion.0[index] = value;
            motion
        };
        // The squared distance of two sequences of one frame each is their local cost; one frame is never refused.
        let mut local = |index, other, best| {
            warp.distance(&[at(index, other)], &[at(index, best)]).unwrap_or_default().powi(2)
        };
        let mut table = |index: usize, values: std::ops::RangeInclusive<i8>| -> Vec<Vec<f64>> {
            let costs = |other| values.clone().map(|best| local(index, other, best)).collect();
            values.clone().map(costs).collect()
        };
        Self { direction: table(2, 0..=bins.min(VALUES as u8 - 2) as i8), number: table(0, -1..=1) }
    }

    /// The barycentre of the sequences whose indices are in `group`; `distances` are those between all sequences.
    ///
    /// # Errors
    /// If the group or one of its sequences is empty, or a sequence is longer than an IU may be.
    pub fn of(
        &self,
        warp: &mut Warp,
        sequences: &[&[Motion]],
        distances: &DistanceMatrix,
        group: &[usize],
    ) -> Result<Vec<Motion>, Refused> {
        Ok(self.with_left_out(warp, sequences, distances, group, false)?.0)
    }

    /// The barycentre and, if `leave_out` asks for them, the barycentres of the group without each of its members in turn.
    ///
    /// To leave a member out, its frames are removed from the alignment of the last round. That costs one pass per member instead of a whole DBA. The
    /// alignment itself was still made with the member. On recorded IUs the resulting distances agree with those of a whole DBA to within a few
    /// percent.
    ///
    /// # Errors
    /// As for [`of`](Self::of).
    pub fn with_left_out(
        &self,
        warp: &mut Warp,
        sequences: &[&[Motion]],
        distances: &DistanceMatrix,
        group: &[usize],
        leave_out: bool,
    ) -> Result<(Vec<Motion>, Vec<Vec<Motion>>), Refused> {
        let medoid = distances.medoid(group).ok_or(Refused::Empty)?;
        let mut barycentre = sequences[medoid].to_vec();
        let mut alignments: Vec<Alignment> = Vec::new();
        let mut counts = Vec::new();
        for _ in 0..MAX_ROUNDS {
            alignments.clear();
            for &member in group {
                let sequence = sequences[member];
                let mut alignment = Vec::with_capacity(sequence.len() + barycentre.len());
                warp.align(sequence, &barycentre, |(frame, index)| alignment.push((index, sequence[frame])))?;
                alignments.push(alignment);
            }
            counts = count(&alignments, barycentre.len());
            let next: Vec<Motion> = counts.iter().map(|counts| self.best(counts)).collect();
            if next == barycentre {
                break;
            }
            barycentre = next;
        }
        let left_out = if leave_out { alignments.as_slice() } else { &[] };
        let without = |alignment| self.without(alignment, &mut counts, &barycentre);
        let left_out = left_out.iter().map(without).collect();
        Ok((barycentre, left_out))
    }

    /// The barycentre without the motions of one alignment. It leaves the counts as it found them.
    fn without(&self, alignment: &Alignment, counts: &mut [Counts], barycentre: &[Motion]) -> Vec<Motion> {
        let mut best = barycentre.to_vec();
        for same in alignment.chunk_by(|a, b| a.0 == b.0) {
            let index = same[0].0;
            same.iter().for_each(|(_, motion)| change(&mut counts[index], *motion, u32::wrapping_sub));
            best[index] = self.best(&counts[index]);
            same.iter().for_each(|(_, motion)| change(&mut counts[index], *motion, u32::wrapping_add));
        }
        best
    }

    fn best(&self, counts: &Counts) -> Motion {
        let mut motion = Motion::default();
        for (index, (best, counts)) in motion.0.iter_mut().zip(counts).enumerate() {
            // Counts begin at value -1, directions at 0.
            let (table, min) =
                if matches!(index, 1 | 2 | 4 | 5) { (&self.direction, 0) } else { (&self.number, -1) };
            let mut sums = [0.0; VALUES];
            // Few of the values occur.
            for (costs, &count) in
                table.iter().zip(&counts[(min + 1) as usize..]).filter(|(_, count)| **count > 0)
            {
                sums.iter_mut().zip(costs).for_each(|(sum, cost)| *sum += cost * f64::from(count));
            }
            // The first of equal ones.
            let choice = sums[..table.len()].iter().enumerate().min_by(|one, other| one.1.total_cmp(other.1));
            *best = choice.map_or(0, |(value, _)| value) as i8 + min as i8;
        }
        motion
    }
}
