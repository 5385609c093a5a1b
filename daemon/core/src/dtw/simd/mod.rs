//! The SIMD path: 32 cells at once with the 256-bit vectors of x86-64-v3, found at run time.
//!
//! It computes the same whole numbers as the portable path. It takes only motions that have symbols, and costs that two
//! bytes can hold: ordinal, and circular with 4, 5, 6, 8, 10 or 12 bins. All else goes the portable way.

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

/// The last row of a strip of 32 rows: column `j` is at `BORDER_ZERO - j`. Backwards, because the vector that holds the last row's cell in its
/// last lane is stored whole: what is written beside it are columns that are written again later.
pub(super) type Border = [i32; BORDER_ROOM];

/// Where column 0 is: after all columns, and those that a strip's last steps touch beyond them.
pub(super) const BORDER_ZERO: usize = IU_FRAMES + 2 * BLOCK;

/// Its length.
pub(super) const BORDER_ROOM: usize = BORDER_ZERO + BLOCK;
