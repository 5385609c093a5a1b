//! Every fixed capacity of the method, with its reason. Full is an answer, never a panic.

/// Hands in one frame: one worker, two hands.
pub const HANDS: usize = 2;

/// Objects in one frame: what a bench of 1.5 m holds with a marker each, and the paper's largest scene has 6.
pub const OBJECTS: usize = 32;

/// Interaction points of one object: a grasp frame per side and a working surface (paper III-A.1).
pub const INTERACTION_POINTS: usize = 8;

/// Longest IU that is compared, in frames: 68 s at 30 Hz. A longer one is `TooLong` by any taught bound.
pub const IU_FRAMES: usize = 2048;

/// IUs of one activity: the paper's longest has 4; a real one with tool changes has a dozen.
pub const ACTIVITY_IUS: usize = 32;

/// Nominal activities of one job that are candidates at the same time.
pub const ACTIVITIES: usize = 32;

/// Longest `persist_frames`: half a second at 30 Hz; a verdict that waits longer is not prompt.
pub const PERSIST_FRAMES: usize = 15;

/// Longest window of the opening-closing filter: a second at 30 Hz, longer than any stroke that should survive it.
pub const FILTER_FRAMES: usize = 31;

/// Nominal IUs that one hand's IU is compared with at the same time where the memory for them lies inside the judge: variants of one
/// activity and activities that begin with the same object. Both hands together take 170 kB, which fits the stack of any thread, copies included.
pub const TRIALS: usize = 4;
