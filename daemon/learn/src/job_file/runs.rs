//! References as run lengths: one row of text per ERU, `"frames: a_h θ_hj φ_hj jm_hj θ_jl φ_jl jm_jl"`.

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

/// The motions of all rows, at most [`IU_FRAMES`].
///
/// # Errors
/// The first row that cannot be read or that makes the reference too long.
pub(super) fn motions(rows: &[String]) -> Result<Vec<Motion>, String> {
    let mut motions = Vec::new();
    for (number, row) in (1..).zip(rows) {
        let unreadable = || format!("row {number} is {row:?}; a row is \"frames: \" and seven integers");
        let (count, motion) = run(row).ok_or_else(unreadable)?;
        if count == 0 || motions.len() + count > IU_FRAMES {
            return Err(format!(
                "row {number} has no frame, or brings the reference to more than {IU_FRAMES} frames"
            ));
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
    let count = count.trim().parse().ok().filter(|count| *count <= IU_FRAMES)?;
    words.next().is_none().then_some((count, motion))
}
