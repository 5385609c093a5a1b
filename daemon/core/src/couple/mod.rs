//! The feature couple `X = (x_m, x_c)` of one hand in one frame (paper III-A.3), and the [`Encoder`] that makes it.

mod contact;
mod encoder;
pub(crate) mod geometry;
mod grid;
mod interaction;
mod kinematics;
pub(crate) mod noise;
mod poses;
mod scene;

pub use encoder::{Encoder, Refused, Unusable};
pub use noise::jitter_bound_m;

use crate::capacity::{HANDS, OBJECTS};
use crate::input::{Point, Side};
use crate::set::{ObjectSet, Set};

/// Motion features `x_m = [a_h, θ_hj, φ_hj, jm_hj, θ_jl, φ_jl, jm_jl]` (paper III-A.3).
///
/// `a_h` ∈ {-1, 0, 1}; `θ` elevation and `φ` azimuth are direction bins, 1..=N around the circle and 0 = at rest;
/// `jm` ∈ {0, 1}. In plane mode both `θ` are 0. A feature without meaning in its context (there is no `o_l`) is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Motion(pub [i8; 7]);

impl Motion {
    /// That of a hand that rests in this context, in which everything rests with it.
    pub fn at_rest(context: Context) -> Self {
        Self([0, 0, 0, 1, 0, 0, context.is_pair().into()])
    }

    /// Whether `o_j` is at rest on the bench, where there is an `o_l`.
    pub fn is_pair_at_rest(&self) -> bool {
        self.0[4..6] == [0, 0]
    }
}

/// Context features `x_c = [ID_h, ID_oj, ID_oj, ID_ol]` (paper III-A.3).
///
/// `[h, j, 0, 0]`: the hand touches `o_j` alone. `[h, j, j, l]`: and `o_j` touches `o_l`.
/// `[0, 0, j, l]`: the hand has let go and `o_j` still touches `o_l`. All zero: idle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Context(pub [u16; 4]);

impl Context {
    /// Nothing is touched. Idle time is not an IU.
    pub const IDLE: Self = Self([0; 4]);

    /// `o_j`, or 0. A hand that has let go of it may still be at it.
    pub(crate) fn o_j(self) -> u16 {
        self.0[2].max(self.0[1])
    }

    /// The hand touches something.
    pub fn is_touch(self) -> bool {
        self.0[0] != 0
    }

    /// The hand touches something that touches something else.
    pub fn is_pair(self) -> bool {
        self.is_touch() && self.0[3] != 0
    }

    /// Whether this object is touched by the hand or by another object, or was until the hand let go. Its id is not 0.
    pub fn involves(self, object: u16) -> bool {
        self.0[1..].contains(&object)
    }

    /// The context if this hand touched what is touched.
    #[must_use]
    pub fn by_hand(self, side: Side) -> Self {
        let Self([_, first, j, l]) = self;
        if self.is_touch() { Self([side as u16, first, j, l]) } else { self }
    }

    /// The context with one part in place of another.
    #[must_use]
    pub(crate) fn with_part(self, part: u16, by: u16) -> Self {
        let Self([hand, parts @ ..]) = self;
        let [first, j, l] = parts.map(|id| if id == part { by } else { id });
        Self([hand, first, j, l])
    }

    /// The hand has let go of something that still touches something else.
    pub fn is_release(self) -> bool {
        !self.is_touch() && self != Self::IDLE
    }
}

/// How far the pose of a hand or object can be relied on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Visibility {
    /// It was seen in this frame.
    #[default]
    Seen,
    /// It was not, and is taken to be where it was last seen, or to move with the hand that carries it.
    Assumed,
    /// It has been out of sight for longer than `blind_ms`.
    Unseen,
}

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

/// Whether a hand waits for the other one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Waiting {
    /// It works, or neither does.
    #[default]
    No,
    /// It may rest at what it acts on while the other one works: either was not measured.
    Unknown,
    /// It rests at what it acts on, and the other one works: it moves, or holds what it has brought to another object.
    Yes,
}

/// The feature couple of one hand on one frame of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Couple {
    /// Whose couple it is.
    pub side: Side,
    /// The time that the couple describes, in nanoseconds: that of its frame, not that at which it became known.
    pub captured_ns: u64,
    /// Motion features. `None` where a position was seen too seldom to measure its motion, or where it is not known whether `o_j` and `o_l` touch.
    pub motion: Option<Motion>,
    /// Context features.
    pub context: Context,
    /// Where the hand acts, in metres: `o_j` in the frame of reference of `o_l`, or without `o_l` the finger tips in the bench frame. `None` where it was
    /// not seen, the hand does not act, or it is not known whether the two touch.
    pub position: Option<Point>,
    /// The finger tips in the bench frame, in metres, known in the same way. `None` where they were neither seen nor assumed to be at what the hand
    /// carries, or the hand does not act.
    pub tips: Option<Point>,
    /// How far apart two positions of `o_j`, relative to `o_l` if there is one, may be by drift, in metres; 0 where not known.
    pub drift_m: f32,
    /// Minimum distances from the hand to `o_j` and from `o_j` to `o_l`, in metres; infinite where there is no such contact.
    pub distances: [f32; 2],
    /// The visibility of the hand, of `o_j` and of `o_l`; what the context does not have is seen.
    pub visibility: [Visibility; 3],
    /// Whether the hand waits for the other one.
    pub waiting: Waiting,
    /// What was not seen of it: all but [`Unseen::MOVER`], [`Unseen::CARRIER`] and [`Unseen::BENCH`].
    pub unseen: Unseen,
    /// The id of a hidden object because of which the frame does not show the context. 0 where there is none.
    pub hidden_object: u16,
}

impl Couple {
    /// A hand that touches nothing and was not seen.
    pub fn idle(side: Side, captured_ns: u64) -> Self {
        Self {
            side,
            captured_ns,
            motion: Some(Motion::default()),
            context: Context::IDLE,
            position: None,
            tips: None,
            drift_m: 0.0,
            distances: [f32::INFINITY; 2],
            visibility: [Visibility::Unseen, Visibility::Seen, Visibility::Seen],
            waiting: Waiting::No,
            unseen: Unseen::CONTEXT | Unseen::CHANGE,
            hidden_object: 0,
        }
    }

    /// The couple at another time of which no frame shows anything: what was done goes on for all that is known.
    fn unseen_at(&self, captured_ns: u64, visibility: Visibility) -> Self {
        Self {
            captured_ns,
            motion: None,
            position: None,
            tips: None,
            visibility: self.visibility.map(|before| before.max(visibility)),
            waiting: if self.context.is_touch() { Waiting::Unknown } else { Waiting::No },
            unseen: self.unseen | Unseen::FRAME | Unseen::CONTEXT | Unseen::CHANGE,
            ..*self
        }
    }

    /// Whether any of these was not seen.
    pub fn lacks(&self, observations: Unseen) -> bool {
        self.unseen.intersects(observations)
    }

    /// Whether the hand itself was seen in this frame, rather than kept from an earlier one.
    pub fn is_hand_seen(&self) -> bool {
        self.visibility[0] == Visibility::Seen
    }

    /// The worst visibility of what the context depends on; a hand that touches nothing may be anywhere.
    pub fn worst_visibility(&self) -> Visibility {
        let relevant = if self.context.is_touch() { &self.visibility[..] } else { &self.visibility[1..] };
        relevant.iter().copied().max().unwrap_or_default()
    }

    /// Whether nothing that the context depends on has been out of sight for longer than `blind_ms`.
    pub fn is_in_sight(&self) -> bool {
        self.worst_visibility() != Visibility::Unseen
    }
}

/// The couples of both hands on one frame of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Couples {
    /// The time that the couples describe, in nanoseconds: that of the frame, or of the grid where no frame came.
    pub captured_ns: u64,
    /// The time of the newest frame that they depend on, in nanoseconds: `persist_frames` later, or less at the end of a recording.
    pub known_ns: u64,
    /// What was not seen of the bench: [`Unseen::FRAME`] where the grid was filled, [`Unseen::MOVER`], [`Unseen::CARRIER`] and [`Unseen::BENCH`].
    pub unseen: Unseen,
    /// The ids of the objects that are followed, ascending, then 0: those of the sets below.
    pub objects: [u16; OBJECTS],
    /// The objects that lie where they do at the beginning of the job.
    pub at_start: ObjectSet,
    /// The objects that have never been seen or not for longer than `blind_ms`.
    pub out_of_sight: ObjectSet,
    /// The objects whose markers the newest frame shows twice.
    pub twice: ObjectSet,
    /// Right hand, then left hand.
    pub hands: [Couple; HANDS],
}

impl Couples {
    /// Whether any of these was not seen.
    pub fn lacks(&self, observations: Unseen) -> bool {
        self.unseen.intersects(observations)
    }

    /// The ids of the objects in this set.
    pub fn ids(&self, objects: ObjectSet) -> impl Iterator<Item = u16> {
        objects.iter().map(|index| self.objects[index])
    }

    /// The couples at another time of which no frame shows anything.
    pub(crate) fn unseen_at(&self, captured_ns: u64, known_ns: u64, visibility: Visibility) -> Self {
        Self {
            captured_ns,
            known_ns,
            unseen: Unseen::FRAME | Unseen::BENCH,
            at_start: if visibility == Visibility::Unseen { ObjectSet::EMPTY } else { self.at_start },
            hands: self.hands.map(|couple| couple.unseen_at(captured_ns, visibility)),
            ..*self
        }
    }
}
