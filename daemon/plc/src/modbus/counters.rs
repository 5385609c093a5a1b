//! What clients have done, for the log, for `health` and for the tests.

use std::sync::atomic::{AtomicU64, Ordering};

use super::rejections::Rejections;

/// Counts since the start. They only grow.
#[derive(Debug, Default)]
pub struct Counters {
    /// Connections accepted.
    pub accepted: AtomicU64,
    /// Connections refused: the address is not allowed, or too many were open.
    pub refused: AtomicU64,
    /// Connections that were accepted and have ended.
    pub ended: AtomicU64,
    /// Connections ended because no complete request came in time.
    pub idle_closed: AtomicU64,
    /// Well-formed requests.
    pub requests: AtomicU64,
    /// Well-formed requests answered with an exception: an unknown address, or a write that was refused.
    pub exceptions: AtomicU64,
    /// Those of `exceptions` that were writes of a client that may not write.
    pub writes_refused: AtomicU64,
    /// Malformed requests, each answered with an exception.
    pub malformed: AtomicU64,
    /// Connections ended because their bytes were not Modbus TCP.
    pub unframed: AtomicU64,
    /// Who was refused, and why.
    pub rejections: Rejections,
}

impl Counters {
    pub(super) fn add(counter: &AtomicU64) {
        counter.fetch_add(1, Ordering::Relaxed);
    }
}
