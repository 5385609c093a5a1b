//! The SIMD path: 32 cells at once with the 256-bit vectors of x86-64-v3, found at run time.
//!
//! It computes the same integers as the portable path. It takes only motions that have symbols and costs that fit two bytes. Those are ordinal costs,
//! normalised ones with up to 15 bins, and circular ones with 4, 5, 6, 8, 10 or 12 bins. Everything else takes the portable path.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(not(target_arch = "x86_64"))]
mod none;

#[cfg(target_arch = "x86_64")]
pub(super) use avx2::Simd;
#[cfg(not(target_arch = "x86_64"))]
pub(super) use none::Simd;
