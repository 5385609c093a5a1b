//! What was not seen, where that leaves more than one possibility.

use crate::set::Set;

/// What an [`Unseen`] consists of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Observations;

/// The observations that are missing in one frame. Empty: one context is possible, and nothing else has happened.
pub type Unseen = Set<Observations>;

impl Unseen {
    /// There was no frame.
    pub const FRAME: Self = Self::of(0);
    /// The frame does not show the context itself. The hand is missing, or an object that it acts on, was at or may have taken, or one that its
    /// object may touch.
    pub const CONTEXT: Self = Self::of(1);
    /// Too little was seen around the frame: a context may have come, gone or changed unseen, or may be another one.
    pub const CHANGE: Self = Self::of(2);
    /// What the hand took: it may have been another object than `o_j`.
    pub const TAKING: Self = Self::of(3);
    /// `o_j` or `o_l`, up to just before this began: the hand may have done before what it is seen to do now.
    pub const ARRIVAL: Self = Self::of(4);
    /// How `o_j` or `o_l` came from where it lay before it was hidden to where this began. A hand has moved it, and may have done then what this one
    /// is seen to do now.
    pub const MOVE: Self = Self::of(5);
    /// Who has moved an object that lies elsewhere than before: a hand was overlooked, or somebody rearranged the bench.
    pub const MOVER: Self = Self::of(6);
    /// The hand that carries an object which moves.
    pub const CARRIER: Self = Self::of(7);
    /// Any object, or one that lay in sight when a hand was seen last, or since: what becomes of it is not known.
    pub const BENCH: Self = Self::of(8);
}
