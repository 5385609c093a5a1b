//! The threads that look at a picture side by side. They are made once, and a frame waits for all of them: nothing is queued.

use crate::config::ThreadsConfig;
use crate::error::PerceptionError;
use rayon::{ThreadPool, ThreadPoolBuilder};
use rustix::thread::CpuSet;

/// How much less than the others the thread that searches for hands gets of a core that both want, as a nice value: a tenth.
const ASIDE: i32 = 10;
/// The lowest priority that there is.
const LAST: i32 = 19;

/// Fixed threads.
pub(crate) struct Workers(Option<ThreadPool>);

impl Workers {
    /// # Errors
    /// [`PerceptionError::Threads`] when the system refuses the threads, their cores or their priority.
    pub(crate) fn new(config: &ThreadsConfig) -> Result<Self, PerceptionError> {
        // A single one would only take the work from its caller.
        Ok(Self(if config.count > 1 { Some(pool("look", config.count, config)?) } else { None }))
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

/// A thread for what may take longer than a frame. It gives way to the [`Workers`].
///
/// # Errors
/// As [`Workers::new`].
pub(crate) fn aside(config: &ThreadsConfig) -> Result<ThreadPool, PerceptionError> {
    pool("search", 1, &ThreadsConfig { nice: (config.nice + ASIDE).min(LAST), ..config.clone() })
}

fn pool(name: &'static str, count: usize, config: &ThreadsConfig) -> Result<ThreadPool, PerceptionError> {
    let threads =
        ThreadPoolBuilder::new().num_threads(count).thread_name(move |index| format!("{name}-{index}"));
    let failed = |what, reason: String| PerceptionError::Threads { what, reason };
    let pool = threads.build().map_err(|error| failed("be started", error.to_string()))?;
    for placed in pool.broadcast(|_| place(config)) {
        placed.map_err(|(what, errno)| failed(what, errno.to_string()))?;
    }
    Ok(pool)
}

/// Gives the calling thread its cores and its priority.
fn place(config: &ThreadsConfig) -> Result<(), (&'static str, rustix::io::Errno)> {
    if !config.cores.is_empty() {
        let mut cores = CpuSet::new();
        config.cores.iter().for_each(|core| cores.set(*core));
        rustix::thread::sched_setaffinity(None, &cores).map_err(|errno| ("be kept on their cores", errno))?;
    }
    if config.nice != 0 {
        rustix::process::setpriority_process(None, config.nice)
            .map_err(|errno| ("be given their priority", errno))?;
    }
    Ok(())
}
