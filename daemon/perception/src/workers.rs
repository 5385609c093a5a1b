//! The threads that look at a picture side by side. They are made once, and a frame waits for all of them: nothing is queued.

use crate::config::ThreadsConfig;
use crate::error::PerceptionError;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Fixed threads.
pub(crate) struct Workers(Option<ThreadPool>);

impl Workers {
    /// # Errors
    /// [`PerceptionError::Threads`] when the system refuses the threads.
    pub(crate) fn new(config: &ThreadsConfig) -> Result<Self, PerceptionError> {
        // A single one would only take the work from its caller.
        Ok(Self(if config.count > 1 { Some(pool("look", config.count)?) } else { None }))
    }

    /// Does both, side by side where there are two threads. The longer one comes first.
    pub(crate) fn join<A: Send, B: Send>(
        &self,
        first: impl FnOnce() -> A + Send,
        second: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        match &self.0 {
            Some(pool) => pool.join(first, second),
            None => (first(), second()),
        }
    }
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
