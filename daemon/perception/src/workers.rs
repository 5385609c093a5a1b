//! The threads that look at a picture side by side. They are made once, and a frame waits for all of them: nothing is queued.
//!
//! The caller's own thread looks at the hands. A fixed one beside it looks at the markers, then at the second hand. A third one searches
//! for a hand that is missing. The next frame takes what the search has found. So the result does not depend on which thread is faster.

use crate::config::ThreadsConfig;
use crate::error::{PerceptionError, while_doing};
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Fixed threads beside that of their caller, which is one of those that look.
pub(crate) struct Workers(Option<ThreadPool>);

impl Workers {
    /// # Errors
    /// [`PerceptionError::Threads`] when the system refuses the threads; [`PerceptionError::OpenCv`].
    pub(crate) fn new(config: &ThreadsConfig) -> Result<Self, PerceptionError> {
        keep_opencv_to_one_thread()?;
        Ok(Self(if config.count > 1 { Some(pool("look", config.count - 1)?) } else { None }))
    }

    /// Does both, side by side where there are two threads. The first one is done in that of the caller, so that nobody has to be woken for the
    /// longer one.
    pub(crate) fn join<A, B: Send>(
        &self,
        first: impl FnOnce() -> A,
        second: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        let Some(pool) = &self.0 else { return (first(), second()) };
        let mut done = None;
        let first = pool.in_place_scope(|scope| {
            scope.spawn(|_| done = Some(second()));
            first()
        });
        // The scope has waited for it, and would have passed its panic on.
        (first, done.expect("the second part has ended with its scope"))
    }
}

/// Keeps OpenCV from dividing each step among threads of its own. They wait for the next one by asking for it again and again and, once in many
/// thousands of times, for ever.
///
/// # Errors
/// [`PerceptionError::OpenCv`].
pub(crate) fn keep_opencv_to_one_thread() -> Result<(), PerceptionError> {
    opencv::core::set_num_threads(1).map_err(while_doing("setting the number of its threads"))
}

/// A thread for what may take longer than a frame. It has the priority of the others: no role of a station may change its own.
///
/// # Errors
/// As [`Workers::new`].
pub(crate) fn aside() -> Result<ThreadPool, PerceptionError> {
    pool("search", 1)
}

fn pool(name: &'static str, count: usize) -> Result<ThreadPool, PerceptionError> {
    ThreadPoolBuilder::new()
        .num_threads(count)
        .thread_name(move |index| format!("{name}-{index}"))
        .build()
        .map_err(|error| PerceptionError::Threads { reason: error.to_string() })
}
