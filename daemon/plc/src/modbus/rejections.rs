//! Who was refused and why, for the log: the counters say only how often.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Mutex, PoisonError};

/// Clients that are remembered between two looks of the log. One who tries many addresses must not fill the memory.
const REMEMBERED: usize = 64;

/// Why a client was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Cause {
    /// Its address may not connect.
    NotAllowed,
    /// As many connections are open as there may be.
    TooMany,
    /// It wanted to write, and nobody may.
    WritesOff,
    /// It wanted to write, and only others may.
    NoCommander,
}

/// A refused client and why.
pub type Rejection = (IpAddr, Cause);

/// How often each client was refused since the last look.
#[derive(Debug, Default)]
pub struct Rejections(Mutex<BTreeMap<Rejection, u64>>);

impl Rejections {
    pub(super) fn add(&self, address: IpAddr, cause: Cause) {
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = seen.len();
        if let Some(count) = seen.get_mut(&(address, cause)) {
            *count += 1;
        } else if known < REMEMBERED {
            seen.insert((address, cause), 1);
        }
    }

    /// All of them; the next look begins at none.
    pub fn take(&self) -> BTreeMap<Rejection, u64> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
