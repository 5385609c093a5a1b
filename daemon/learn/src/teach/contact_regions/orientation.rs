//! Parts that turn without meaning, such as round ones.

use super::trajectory::Trajectories;
use crate::teach::sequence::MIN_RUNS;
use nalgebra::Vector3;

/// The mean of directions that are the same, and of directions that have nothing in common. The length of the mean of unit vectors is 1 where all are
/// alike. It is about one by the root of their number where none is. With 0.9 or 0.975 none of 70 jobs differs, nor with 0.35 or 0.85: none has a
/// round part. Without the first one 3 do. Without the second one 31 do, and 3 right runs fewer are accepted.
const ALIGNED_MEAN: f32 = 0.95;
const UNALIGNED_MEAN: f32 = 0.7;

/// Whether the orientation of an object differs from run to run where the way on which it is carried first does not. It would then turn all
/// directions that are measured in its frame of reference.
pub(super) fn means_nothing(object: usize, shown: &[Trajectories]) -> bool {
    let ways: Vec<[Vector3<f32>; 2]> = shown.iter().filter_map(|run| run.first_way(object)).collect();
    let mean =
        |which: usize| ways.iter().map(|way| way[which]).sum::<Vector3<f32>>().norm() / ways.len() as f32;
    ways.len() >= MIN_RUNS && mean(0) > ALIGNED_MEAN && mean(1) < UNALIGNED_MEAN
}
