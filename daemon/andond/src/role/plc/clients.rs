//! What clients do, as the server counts it, for the log and for health.

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use andon_host::log::{code, log};
use andon_host::role::Liveness;
use andon_plc::modbus::{Cause, Counters, Rejection};

/// How often what clients did is logged: a broken one sends a thousand requests per second.
const LOG_EVERY: Duration = Duration::from_secs(1);
/// A client that is refused tries again for ever: it is named again after this time only.
const NAME_AGAIN: Duration = Duration::from_secs(600);
/// Clients that are remembered as named. Beyond that one is named more often than needed.
const NAMED: usize = 256;

/// Logs what the counters have counted since the last look.
pub(super) struct Clients {
    counters: Arc<Counters>,
    looked: Instant,
    logged: Counted,
    /// When a refused client was named last.
    named: HashMap<Rejection, Instant>,
}

/// A reading of the counters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Counted {
    accepted: u64,
    ended: u64,
    writes_refused: u64,
    bad: u64,
}

impl Counted {
    fn of(counters: &Counters) -> Self {
        let read = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let writes_refused = read(&counters.writes_refused);
        let exceptions = read(&counters.exceptions).saturating_sub(writes_refused);
        Self {
            // Before those that have begun, so that no connection ends before it began.
            ended: read(&counters.ended),
            accepted: read(&counters.accepted),
            writes_refused,
            bad: exceptions + read(&counters.malformed) + read(&counters.unframed),
        }
    }

    fn open(self) -> u64 {
        self.accepted.saturating_sub(self.ended)
    }
}

impl Clients {
    pub(super) fn new(counters: Arc<Counters>) -> Self {
        Self { counters, looked: Instant::now(), logged: Counted::default(), named: HashMap::new() }
    }

    /// To be called in every turn; looks once per second.
    pub(super) fn log(&mut self, liveness: &mut Liveness) {
        if self.looked.elapsed() < LOG_EVERY {
            return;
        }
        self.looked = Instant::now();
        let now = Counted::of(&self.counters);
        let before = std::mem::replace(&mut self.logged, now);
        let writes = now.writes_refused - before.writes_refused;
        let bad = now.bad.saturating_sub(before.bad);
        // A client that opens a connection for each request counts as connected all the time.
        if before.open() == 0 && now.open() > 0 {
            log!(code::PLC_CONNECTED, "{} clients are connected", now.open());
        }
        if before.open() > 0 && now.accepted == before.accepted && now.open() == 0 {
            log!(code::PLC_DISCONNECTED, "no client is connected any more");
        }
        self.name_refused();
        if bad > 0 {
            log!(code::PLC_BAD_REQUEST, "{bad} requests were refused");
        }
        (0..writes + bad).for_each(|_| liveness.refused());
    }

    /// Names each client that was refused, once in a while.
    fn name_refused(&mut self) {
        for (rejection, count) in self.counters.rejections.take() {
            if self.named.get(&rejection).is_some_and(|at| at.elapsed() < NAME_AGAIN) {
                continue;
            }
            if self.named.len() == NAMED {
                self.named.clear();
            }
            self.named.insert(rejection, Instant::now());
            log_refused(rejection, count);
        }
    }
}

fn log_refused((address, cause): (IpAddr, Cause), count: u64) {
    match cause {
        Cause::NotAllowed => {
            log!(code::PLC_CLIENT_REFUSED, { address = %address }, "{address} may not connect: it is not in plc.allow ({count} tries)");
        }
        Cause::TooMany => log!(
            code::PLC_CLIENT_REFUSED,
            remedied: "{address} could not connect: the maximum number of connections is open ({count} tries). \
                       Close those that are not needed"
        ),
        Cause::WritesOff => {
            log!(code::PLC_WRITE_REFUSED, { address = %address }, "{address} may not write: plc.writes is false ({count} tries)");
        }
        Cause::NoCommander => {
            log!(code::PLC_WRITE_REFUSED, { address = %address }, "{address} may only read: it is not in plc.commanders ({count} tries)");
        }
    }
}
