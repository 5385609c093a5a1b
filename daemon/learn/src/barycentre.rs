//! DBA: the DTW barycentre of motions (Petitjean et al. 2011), on integer features.
//!
//! Each round aligns every sequence with the barycentre and gives each of its frames the best motion for all frames
//! aligned with it. "Best" is exact: feature by feature the whole number in range with the least sum of local costs
//! (ties to the lowest). For `ordinal` features that is the rounded mean; for directions under `circular` it is the
//! bin, or rest, with the least sum of squared chords. So a barycentre is a motion as it could be seen, and its row
//! in a job file can be read.

use crate::warp::{DistanceMatrix, Warp};
use andon_core::couple::Motion;
use andon_core::dtw::Refused;
use andon_core::job::LocalCost;

/// Rounds of DBA. It has converged after 3 to 6 on recorded IUs.
const ROUNDS: usize = 10;

/// Values that a feature can have: -1..=120, the most bins that the method allows.
const VALUES: usize = 122;

/// How often each value of each feature was seen at one place; -1 comes first.
type Counts = [[u32; VALUES]; 7];

/// Places of the barycentre, from the last to the first, with the motions aligned with them.
type Alignment = Vec<(usize, Motion)>;

fn count(alignments: &[Alignment], places: usize) -> Vec<Counts> {
    let mut counts = vec![[[0; VALUES]; 7]; places];
    for (place, motion) in alignments.iter().flatten() {
        change(&mut counts[*place], *motion, u32::wrapping_add);
    }
    counts
}

fn change(counts: &mut Counts, motion: Motion, by: fn(u32, u32) -> u32) {
    for (counts, value) in counts.iter_mut().zip(motion.0) {
        let seen = &mut counts[(i16::from(value) + 1).clamp(0, VALUES as i16 - 1) as usize];
        *seen = by(*seen, 1);
    }
}

/// Best value, and cost of each value against each, for every feature under one local cost.
#[derive(Clone, Debug)]
pub struct Barycentres {
    /// `cost[direction or not][best][seen]`.
    direction: Vec<Vec<f64>>,
    number: Vec<Vec<f64>>,
}

impl Barycentres {
    /// Tables for this cost, and directions of `bins` bins.
    pub fn new(cost: LocalCost, bins: u8) -> Self {
        let mut warp = Warp::new(cost);
        let at = |place: usize, value: i8| {
            let mut motion = Motion::default();
            motion.0[place] = value;
            motion
        };
        // The squared distance of two sequences of one frame is their local cost; one frame is never refused.
        let mut local = |place, best, seen| {
            warp.distance(&[at(place, best)], &[at(place, seen)]).unwrap_or_default().powi(2)
        };
        let mut table = |place: usize, values: std::ops::RangeInclusive<i8>| -> Vec<Vec<f64>> {
            let costs = |best| values.clone().map(|seen| local(place, best, seen)).collect();
            values.clone().map(costs).collect()
        };
        Self { direction: table(2, 0..=bins.min(VALUES as u8 - 2) as i8), number: table(0, -1..=1) }
    }

    /// The barycentre of the sequences `group` chooses; `distances` are those of all sequences.
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

    /// The barycentre, and if asked for, those of the group without each of its members in turn.
    ///
    /// Without a member: its frames are taken out of the last round's alignment, which costs one pass in place of a whole DBA for
    /// each member. The alignment itself has seen the member; on recorded IUs the distances come out as those of a
    /// whole DBA to within some percent (see the tests of `teach`).
    ///
    /// # Errors
    /// As [`of`](Self::of).
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
        for _ in 0..ROUNDS {
            alignments.clear();
            for &member in group {
                let sequence = sequences[member];
                let mut alignment = Vec::with_capacity(sequence.len() + barycentre.len());
                warp.align(sequence, &barycentre, |(seen, place)| alignment.push((place, sequence[seen])))?;
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

    /// The best motions without those of one alignment. The counts are as before when it returns.
    fn without(&self, alignment: &Alignment, counts: &mut [Counts], barycentre: &[Motion]) -> Vec<Motion> {
        let mut best = barycentre.to_vec();
        for same in alignment.chunk_by(|a, b| a.0 == b.0) {
            let place = same[0].0;
            same.iter().for_each(|(_, motion)| change(&mut counts[place], *motion, u32::wrapping_sub));
            best[place] = self.best(&counts[place]);
            same.iter().for_each(|(_, motion)| change(&mut counts[place], *motion, u32::wrapping_add));
        }
        best
    }

    fn best(&self, counts: &Counts) -> Motion {
        let mut motion = Motion::default();
        for (place, (best, counts)) in motion.0.iter_mut().zip(counts).enumerate() {
            // Counts start at -1; directions at 0.
            let (table, least) =
                if matches!(place, 1 | 2 | 4 | 5) { (&self.direction, 0) } else { (&self.number, -1) };
            let seen = &counts[(least + 1) as usize..];
            let sum = |costs: &Vec<f64>| {
                costs.iter().zip(seen).map(|(cost, count)| cost * f64::from(*count)).sum::<f64>()
            };
            let choice =
                (0..table.len()).min_by(|&a, &b| sum(&table[a]).total_cmp(&sum(&table[b])).then(a.cmp(&b)));
            *best = choice.unwrap_or_default() as i8 + least as i8;
        }
        motion
    }
}
