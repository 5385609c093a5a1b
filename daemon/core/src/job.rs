//! A taught job: the list `J` of nominal activities with their references and thresholds (paper III-D).
//!
//! Core borrows all of it from the caller, who loads the job file and owns its memory.
//!
//! A DTW distance is a sum over frames, so a threshold grows with the length of the IU, up to [`Job::max_slowdown`]. Without that 6 of 15
//! runs of real people were accused at half the speed, and none is with it.

use crate::bounds::{Around, Bounds, Range};
use crate::couple::{Context, Motion};
use crate::input::Side;
use crate::set::ActivitySet;

/// How two motion features are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocalCost {
    /// As in the paper (IV-A). Every feature is a number, divided by the length of its range so that all lie in `[0, 1]`. The cost is the squared
    /// Euclidean distance. A direction is one of the N + 1 numbers 0 to N, the acceleration one of 3, joint motion one of 2. The opening-closing filter,
    /// which the paper applies after this, takes minima and maxima only, so that it makes no difference which comes first.
    Normalised {
        /// N, the number of direction bins around the circle.
        bins: u8,
    },
    /// As `Normalised`, but without the division: every feature counts in its own unit.
    Ordinal,
    /// Directions are points on the unit circle and rest is its centre; the other features are compared as in `Ordinal`.
    Circular {
        /// N, the number of direction bins around the circle.
        bins: u8,
    },
}

impl LocalCost {
    /// How people and files name it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Normalised { .. } => "normalised",
            Self::Ordinal => "ordinal",
            Self::Circular { .. } => "circular",
        }
    }
}

/// What the runs that were shown measured in an IU, from minimum to maximum. It decides nothing: a verdict names it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// How long they lasted without what the hand waited for the other one, in frames of the grid.
    pub frames: Bounds,
    /// How often the motion reversed; where some of it was hidden, as often as it most likely did.
    pub reversals: Bounds,
    /// Mean length of a stroke, in metres; 0 where there was no whole one.
    pub stroke_m: Range,
    /// Length of the path, in metres.
    pub path_m: Range,
    /// How much longer than the straight way it was at most, in metres.
    pub detour_m: f32,
    /// How far off the straight line the way of the hand led at most, in metres.
    pub lateral_m: f32,
    /// How far the direction of the path was away from the centre of [`MeasureBounds::axis`] at most.
    pub axis: f32,
    /// How far the mean position was away from the centre of [`MeasureBounds::place_m`] at most, in metres.
    pub place_m: f32,
}

/// The right measures of an IU in metres, see [`Measures`](crate::segment::Measures).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureBounds {
    /// Mean length of a stroke.
    pub stroke_m: Range,
    /// Length of the path.
    pub path_m: Range,
    /// Maximum of how much longer the path is than the straight way. It decides instead of the maximum of the path where it is finite.
    pub max_detour_m: f32,
    /// Maximum of how far off the straight line the way of the hand leads.
    pub max_lateral_m: f32,
    /// The direction of the path.
    pub axis: Around<2>,
    /// Mean position.
    pub place_m: Around<3>,
    /// What was shown; `None` where that is not known, and then no verdict names a measure.
    pub shown: Option<Shown>,
}

impl MeasureBounds {
    /// Everything is right.
    pub const ANY: Self = Self {
        stroke_m: Range { min: 0.0, max: f32::INFINITY },
        path_m: Range { min: 0.0, max: f32::INFINITY },
        max_detour_m: f32::INFINITY,
        max_lateral_m: f32::INFINITY,
        axis: Around { centre: [0.0; 2], max: f32::INFINITY },
        place_m: Around { centre: [0.0; 3], max: f32::INFINITY },
        shown: None,
    };
}

/// One IU of a nominal activity.
#[derive(Clone, Copy, Debug)]
pub struct NominalIu<'a> {
    /// Its context.
    pub context: Context,
    /// The barycentre of its demonstrations, one motion per frame of the grid.
    pub reference: &'a [Motion],
    /// Maximum DTW distance that is right for an execution no longer than the reference, in the units of dtaidistance's
    /// `dtw_ndim.distance`. For a slower execution it grows, see [`slowdown_factor`].
    pub threshold: f32,
    /// How long it may last, in frames of the grid; at most so long without what the hand waits for the other one.
    pub frames: Bounds,
    /// How often the motion may reverse: shows that a repeated motion was cut short.
    pub reversals: Bounds,
    /// What it may measure in metres.
    pub measures: MeasureBounds,
}

/// The share of the time that was shown in which a person in a hurry does the same. With half of it 49 of 3,700 drawn streams of couples and frames are
/// told otherwise. Without it, as if nobody hurried, it is 90, and 3 tests fail.
const FASTEST_SHARE: f32 = 0.6;

/// At least one in this many frames of a reference is work, and not a wait. With one in two, 6 of 3,700 drawn streams differ, and without
/// this limit 8.
const FRAMES_PER_WORK_FRAME: u32 = 4;

impl NominalIu<'_> {
    /// In how few frames it may have been done unseen; 0 for what comes without a hand. Who waited worked for less than the reference lasts.
    pub(crate) fn quickest(&self) -> u32 {
        let length = self.reference.len() as u32;
        let worked = self
            .measures
            .shown
            .map_or(length, |shown| shown.frames.min.clamp(length / FRAMES_PER_WORK_FRAME, length));
        let least = (FASTEST_SHARE * worked as f32) as u32;
        if self.context.is_touch() { self.frames.min.max(least) } else { 0 }
    }
}

/// A nominal activity: the sequence of IUs that it consists of.
#[derive(Clone, Copy, Debug)]
pub struct NominalActivity<'a> {
    /// The number of the activity that this sequence fulfils, from 0 and below
    /// [`ACTIVITIES`](crate::capacity::ACTIVITIES). Several sequences may fulfil the same activity.
    pub activity: u16,
    /// Its IUs in order.
    pub ius: &'a [NominalIu<'a>],
}

/// What a job does with one of its objects. Sets have the numbers of activities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JobObject {
    /// Its id.
    pub id: u16,
    /// The activities in which a hand acts on it or on something that touches it.
    pub used_by: ActivitySet,
    /// The activities that move it away for good from where it lies at the beginning ([`ObjectShape::start`](crate::object::ObjectShape)).
    /// While it lies there, none of them has been done.
    pub moved_by: ActivitySet,
}

/// What the order of a job asks of one of its activities. Sets have the numbers of activities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Law {
    /// The activities that must have begun before it begins.
    pub after_begin: ActivitySet,
    /// The activities that must have ended before it begins.
    pub after_end: ActivitySet,
    /// The activities that had begun before it in all runs, without enough evidence for a law: another order is a note.
    pub usually_after: ActivitySet,
    /// Whether a job without it is not complete. What is optional accuses nobody where it is missing.
    pub is_required: bool,
    /// The indices of the nominal activities that do only a part. Where one of them comes, a job without this activity is not complete either.
    pub completes: ActivitySet,
    /// Whether it must not come a second time; otherwise that is a note.
    pub is_once: bool,
    /// Whether IUs in any other context of the job's objects may come before, between and after those of its nominal activities. It is so because the
    /// runs have only these in common. The hand may let go of the first object and take it again.
    pub allows_insertions: bool,
    /// How many of the runs that were shown have it.
    pub runs: u16,
}

impl Law {
    /// It is required, and may come at any time.
    pub const FREE: Self = Self {
        after_begin: ActivitySet::EMPTY,
        after_end: ActivitySet::EMPTY,
        usually_after: ActivitySet::EMPTY,
        is_required: true,
        completes: ActivitySet::EMPTY,
        is_once: false,
        allows_insertions: false,
        runs: 0,
    };

    /// The activities that must come before it.
    pub fn after(&self) -> ActivitySet {
        self.after_begin | self.after_end
    }
}

/// A taught job.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// The list `J`.
    pub activities: &'a [NominalActivity<'a>],
    /// The law of each activity, by its number; one that has none is [`Law::FREE`].
    pub laws: &'a [Law],
    /// What it does with its objects; with one that is not here, nothing.
    pub objects: &'a [JobObject],
    /// The objects at which a hand was shown to rest or to steady: that is neither a step nor a note.
    pub passive_contacts: &'a [u16],
    /// How motions are compared.
    pub cost: LocalCost,
    /// Maximum of [`slowdown_factor`], at least 1. A slower motion also has less acceleration and more rest, so that each of its frames is farther from
    /// the reference. 1 leaves the thresholds as they are, as in the paper.
    pub max_slowdown: f32,
    /// Whether a frame [`at_rest`](Motion::at_rest) stands before and after each reference of a touch. It is then put before and after each motion that
    /// is judged. A rest at either end of an IU costs nothing, but still counts as time. In the paper it costs as much as any other motion.
    pub has_free_ends: bool,
    /// The share of the frames of the grid that must have been captured during an IU for it to be judged, 0 to 1. With fewer, the motion that was
    /// shown would not be recognised. 0 asks for nothing.
    pub min_captured: f32,
}

impl Job<'_> {
    /// The law of the activity with this number.
    pub fn law(&self, activity: usize) -> Law {
        self.laws.get(activity).copied().unwrap_or(Law::FREE)
    }

    /// What it does with this object.
    pub(crate) fn object(&self, id: u16) -> JobObject {
        let nothing = JobObject { id, used_by: ActivitySet::EMPTY, moved_by: ActivitySet::EMPTY };
        self.objects.iter().find(|object| object.id == id).copied().unwrap_or(nothing)
    }

    /// Whether other IUs may come between those of this nominal activity.
    pub(crate) fn allows_insertions(&self, nominal: usize) -> bool {
        let activity = self.activities.get(nominal);
        activity.is_some_and(|nominal| self.law(nominal.activity.into()).allows_insertions)
    }

    /// Whether this hand acts in it.
    pub(crate) fn is_done_by(&self, side: Side) -> bool {
        let mut ius = self.activities.iter().flat_map(|nominal| nominal.ius);
        ius.any(|iu| iu.context.0[0] == side as u16)
    }

    /// The numbers of its activities.
    pub fn numbers(&self) -> ActivitySet {
        self.activities.iter().map(|nominal| usize::from(nominal.activity)).collect()
    }

    /// The activities whose law is so.
    pub(crate) fn whose_law(&self, is_so: impl Fn(&Law) -> bool) -> ActivitySet {
        self.numbers().iter().filter(|activity| is_so(&self.law(*activity))).collect()
    }

    /// The first activity whose number is too high, or whose law names one that the job does not have. It may also be one that can never come because
    /// laws put it behind itself.
    pub fn misplaced(&self) -> Option<u16> {
        let may_come = |came: ActivitySet| self.whose_law(|law| law.after().without(came).is_empty());
        let came = self.numbers().iter().fold(ActivitySet::EMPTY, |came, _| may_come(came));
        let can_come = |activity: u16| came.contains(activity.into());
        self.activities.iter().map(|nominal| nominal.activity).find(|activity| !can_come(*activity))
    }
}

/// The factor by which the threshold of an IU of this many frames grows. It is its length in those of its reference, from 1 to `max_slowdown`.
pub fn slowdown_factor(frames: u32, reference: usize, max_slowdown: f32) -> f32 {
    (frames as f32 / reference.max(1) as f32).clamp(1.0, max_slowdown.max(1.0))
}
