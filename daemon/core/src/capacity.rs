//! Every fixed capacity of the method, with its reason. A full container is reported to the caller; it never panics.

/// Hands in one frame: one worker, two hands.
pub const HANDS: usize = 2;

/// Objects in one frame: as many as fit on a bench of 1.5 m with a marker each. The paper's largest scene has 6.
pub const OBJECTS: usize = 32;

/// Objects of which it is said at the same time that their markers are in view twice. More on one bench is a sheet of spare prints.
pub const TWINS: usize = 5;

/// Interaction points of one object: a few grasp frames and working surfaces (paper III-A.1).
pub const INTERACTION_POINTS: usize = 8;

/// Others that meet one object: the hand, and the parts that are joined to it or worked with it.
pub const CONTACT_REGIONS: usize = 8;

/// Length of the longest IU that is compared, in frames, with the rests at its ends: 68 s at 30 Hz. A longer one is not judged: only a hand that
/// waits for the other one is right for so long.
pub const IU_FRAMES: usize = 2048;

/// IUs of one activity: the longest in the paper has 4, one with tool changes a dozen.
pub const ACTIVITY_IUS: usize = 32;

/// Nominal activities of one job. Sets of them are the bits of a `u32`.
pub const ACTIVITIES: usize = 32;

/// Events of one frame. At most three verdicts on what ends and two on what begins for each hand, and two beginnings and five verdicts for jobs.
pub const EVENTS: usize = 17;

/// Longest `persist_frames`: half a second at 30 Hz. A verdict that waits longer is not prompt.
pub const PERSIST_FRAMES: usize = 15;

/// Longest window of the opening-closing filter: one second at 30 Hz, longer than any stroke that should pass it.
pub const FILTER_FRAMES: usize = 31;

/// Nominal IUs with which an IU of one hand is compared at once, where the memory for the comparisons lies inside the judge. They are variants of one
/// activity, and activities that begin with the same object. For both hands together this takes 140 kB, which fits the stack of any thread, copies
/// included.
pub const COMPARISONS: usize = 4;
