//! The SIMD path: 32 cells at once with the 256-bit vectors of x86-64-v3, found at run time.
//!
//! It computes the same integers as the portable path. It takes only motions that have symbols and costs that fit two bytes. Those are ordinal costs,
//! normalised ones with up to 15 bins, and circular ones with 4, 5, 6, 8, 10 or 12 bins. Everything else takes the portable path.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod digits;
#[cfg(not(target_arch = "x86_64"))]
mod none;

#[cfg(target_arch = "x86_64")]
pub(super) use avx2::Simd;
#[cfg(not(target_arch = "x86_64"))]
pub(super) use none::Simd;

use super::symbols::BLOCK;
use crate::capacity::IU_FRAMES;

/// The last row of a strip of 32 rows: column `j` is at `BORDER_ZERO - j`. It runs backwards because the vector whose last lane holds the last row's
/// cell is stored whole. Its other lanes land on columns that are written again later.
pub(super) type Border = [i32; BORDER_ROOM];

/// Where column 0 is: after all columns and those that the last steps of a strip touch beyond them.
pub(super) const BORDER_ZERO: usize = IU_FRAMES + 2 * BLOCK;

/// Length of a [`Border`].
pub(super) const BORDER_ROOM: usize = BORDER_ZERO + BLOCK;
