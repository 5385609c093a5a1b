//! Sets of activities, of objects, and of what was not seen.

use crate::capacity::{ACTIVITIES, OBJECTS};
use core::marker::PhantomData;
use core::ops::{BitAnd, BitOr, BitOrAssign};

// One bit for each member.
const _: () = assert!(ACTIVITIES == u32::BITS as usize && OBJECTS == ACTIVITIES);

/// What an [`ActivitySet`] consists of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Activities;

/// What an [`ObjectSet`] consists of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Objects;

/// A set of activities, each given by its number in the job, or of nominal activities, each given by its index there.
pub type ActivitySet = Set<Activities>;

/// A set of objects, each given by its index among those that an encoder follows ([`Couples::objects`](crate::couple::Couples)).
pub type ObjectSet = Set<Objects>;

/// A set of numbers of one kind. All are below [`ACTIVITIES`] and [`OBJECTS`], which are equal; others are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Set<Of>(u32, PhantomData<Of>);

impl<Of: Copy> Set<Of> {
    /// The set without a member.
    pub const EMPTY: Self = Self::from_bits(0);

    /// The first `count` numbers.
    pub fn first(count: usize) -> Self {
        (0..count).collect()
    }

    /// The set of one number.
    pub const fn of(number: usize) -> Self {
        if number < ACTIVITIES { Self::from_bits(1 << number) } else { Self::EMPTY }
    }

    /// The set of which these are the bits, from the lowest number on.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits, PhantomData)
    }

    /// One bit for each member, from the lowest number on.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// This set, if a condition holds, else none of it.
    #[must_use]
    pub const fn when(self, holds: bool) -> Self {
        if holds { self } else { Self::EMPTY }
    }

    /// Whether it has no member.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether this number is a member.
    pub fn contains(self, number: usize) -> bool {
        self.intersects(Self::of(number))
    }

    /// Whether the two sets have a member in common.
    pub fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// The members of this set that are not in the other.
    pub fn without(self, other: Self) -> Self {
        Self::from_bits(self.0 & !other.0)
    }

    /// Makes this number a member, or none.
    pub(crate) fn set(&mut self, number: usize, is_member: bool) {
        let one = Self::of(number);
        *self = if is_member { *self | one } else { self.without(one) };
    }

    /// The members in ascending order.
    pub fn iter(self) -> impl Iterator<Item = usize> {
        let mut left = self.0;
        core::iter::from_fn(move || {
            let lowest = left.trailing_zeros();
            left &= left.wrapping_sub(1);
            (lowest < u32::BITS).then_some(lowest as usize)
        })
    }

    /// The lowest member.
    pub fn lowest(self) -> Option<usize> {
        self.iter().next()
    }
}

impl<Of: Copy> BitOr for Set<Of> {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self::from_bits(self.0 | other.0)
    }
}

impl<Of: Copy> BitAnd for Set<Of> {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        Self::from_bits(self.0 & other.0)
    }
}

impl<Of: Copy> BitOrAssign for Set<Of> {
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}

impl<Of: Copy> FromIterator<usize> for Set<Of> {
    fn from_iter<I: IntoIterator<Item = usize>>(members: I) -> Self {
        members.into_iter().fold(Self::EMPTY, |set, number| set | Self::of(number))
    }
}
