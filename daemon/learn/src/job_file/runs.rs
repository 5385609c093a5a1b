//! References as run lengths: a row of text a ERU, `"frames: a_h θ_hj φ_hj jm_hj θ_jl φ_jl jm_jl"`.

use andon_core::capacity::IU_FRAMES;
use andon_core::couple::Motion;

/// One row for each run of equal motions.
pub(super) fn rows(reference: &[Motion]) -> Vec<String> {
    reference
        .chunk_by(|a, b| a == b)
        .map(|run| {
            let features: Vec<String> = run[0].0.iter().map(ToString::to_string).collect();
            format!("{}: {}", run.len(), features.join(" "))
        })
        .collect()
}

/// The motions of all rows; never more than [`IU_FRAMES`].
///
/// # Errors
/// What is wrong with which row, from 1.
pub(super) fn motions(rows: &[String]) -> Result<Vec<Motion>, String> {
    let mut motions = Vec::new();
    for (place, row) in rows.iter().enumerate() {
        let (count, motion) = run(row).ok_or_else(|| {
            format!("row {} is {row:?}; a row is \"frames: \" and seven whole numbers", place + 1)
        })?;
        if count == 0 || motions.len() + count > IU_FRAMES {
            return Err(format!("row {} brings it to more than {IU_FRAMES} frames, or adds none", place + 1));
        }
        motions.resize(motions.len() + count, motion);
    }
    Ok(motions)
}

fn run(row: &str) -> Option<(usize, Motion)> {
    let (count, features) = row.split_once(':')?;
    let mut motion = Motion::default();
    let mut words = features.split_ascii_whitespace();
    for feature in &mut motion.0 {
        *feature = words.next()?.parse().ok()?;
    }
    words.next().is_none().then_some((count.trim().parse().ok().filter(|count| *count <= IU_FRAMES)?, motion))
}
