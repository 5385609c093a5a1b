//! Sets of activities.

use crate::capacity::ACTIVITIES;
use core::ops::{BitAnd, BitOr, BitOrAssign};

// One bit per activity.
const _: () = assert!(ACTIVITIES <= u32::BITS as usize);

/// A set of activities, each given by its number in the job, or of nominal activities, each given by its index there. All are below
/// [`ACTIVITIES`]; others are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ActivitySet(u32);

impl ActivitySet {
    /// The set without a member.
    pub const EMPTY: Self = Self(0);

    /// The first `count` activities, at most [`ACTIVITIES`].
    pub fn first(count: usize) -> Self {
        (0..count).collect()
    }

    /// The set of one activity.
    pub const fn of(activity: usize) -> Self {
        if activity < ACTIVITIES { Self(1 << activity) } else { Self::EMPTY }
    }

    /// The set of which these are the bits, from the lowest number on.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// One bit for each member, from the lowest number on.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Whether it has no member.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether this activity is a member.
    pub fn contains(self, activity: usize) -> bool {
        self.intersects(Self::of(activity))
    }

    /// Whether the two sets have a member in common.
    pub fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// The members of this set that are not in the other.
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// The members in the order of their indices.
    pub fn iter(self) -> impl Iterator<Item = usize> {
        let mut left = self.0;
        core::iter::from_fn(move || {
            let lowest = left.trailing_zeros();
            left &= left.wrapping_sub(1);
            (lowest < u32::BITS).then_some(lowest as usize)
        })
    }

    /// The member with the lowest index.
    pub fn lowest(self) -> Option<usize> {
        self.iter().next()
    }
}

impl BitOr for ActivitySet {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitAnd for ActivitySet {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOrAssign for ActivitySet {
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}

impl FromIterator<usize> for ActivitySet {
    fn from_iter<I: IntoIterator<Item = usize>>(members: I) -> Self {
        members.into_iter().fold(Self::EMPTY, |set, activity| set | Self::of(activity))
    }
}
