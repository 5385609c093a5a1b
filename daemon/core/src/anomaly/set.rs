//! Sets of nominal activities.

use crate::capacity::ACTIVITIES;
use core::ops::{BitOr, BitOrAssign};

// One bit per nominal activity.
const _: () = assert!(ACTIVITIES <= u32::BITS as usize);

/// A set of nominal activities, each given by its index in the job.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ActivitySet(u32);

impl ActivitySet {
    pub(super) const EMPTY: Self = Self(0);

    /// The first `count` nominal activities, at most [`ACTIVITIES`].
    pub(super) fn first(count: usize) -> Self {
        (0..count.min(ACTIVITIES)).collect()
    }

    /// The set of one nominal activity.
    pub(super) fn of(nominal: usize) -> Self {
        Self(1 << nominal)
    }

    pub(super) fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub(super) fn contains(self, nominal: usize) -> bool {
        self.0 >> nominal & 1 == 1
    }

    /// Whether the two sets have a member in common.
    pub(super) fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// The members of this set that are not in the other.
    pub(super) fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// The members in the order of their indices.
    pub(super) fn iter(self) -> impl Iterator<Item = usize> {
        (0..ACTIVITIES).filter(move |nominal| self.contains(*nominal))
    }

    /// The member with the lowest index.
    pub(super) fn lowest(self) -> Option<usize> {
        self.iter().next()
    }
}

impl BitOr for ActivitySet {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for ActivitySet {
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}

impl FromIterator<usize> for ActivitySet {
    fn from_iter<I: IntoIterator<Item = usize>>(members: I) -> Self {
        members.into_iter().fold(Self::EMPTY, |set, nominal| set | Self::of(nominal))
    }
}
