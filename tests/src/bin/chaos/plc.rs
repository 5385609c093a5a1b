//! A PLC that polls the status word.

use andon_ipc::MonotonicTime;
use andon_tests::line::{Modbus, status};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The cycle of a PLC.
const SCAN: Duration = Duration::from_millis(5);
/// The PLC's timeout: an answer that takes longer does not count.
const TIMEOUT: Duration = Duration::from_millis(500);

/// Polls the status word until it is stopped.
pub(crate) struct Plc {
    /// When it last saw the line ready, and when it last saw it not ready or had no answer.
    ready_ns: Arc<AtomicU64>,
    not_ready_ns: Arc<AtomicU64>,
    end: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Plc {
    pub(crate) fn watch(port: u16) -> Self {
        let (ready_ns, not_ready_ns) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicU64::new(0)));
        let end = Arc::new(AtomicBool::new(false));
        let (ready, not_ready, stop) = (Arc::clone(&ready_ns), Arc::clone(&not_ready_ns), Arc::clone(&end));
        let poll = move || {
            let mut client = None;
            while !stop.load(Ordering::Relaxed) {
                let asked = Instant::now();
                client = client.or_else(|| Modbus::connect(port).ok());
                let answer = client.as_mut().map(Modbus::status);
                let is_ready = matches!(answer, Some(Ok(word)) if word & status::READY != 0);
                if !matches!(answer, Some(Ok(_))) {
                    client = None;
                }
                let newest = if is_ready && asked.elapsed() < TIMEOUT { &ready } else { &not_ready };
                newest.store(MonotonicTime::now().nanoseconds(), Ordering::Relaxed);
                std::thread::sleep(SCAN);
            }
        };
        Self { ready_ns, not_ready_ns, end, thread: Some(std::thread::spawn(poll)) }
    }

    /// Whether it has seen the line ready since this time.
    pub(crate) fn ready_since(&self, ns: u64) -> bool {
        self.ready_ns.load(Ordering::Relaxed) >= ns
    }

    /// Whether it has seen the line not ready since this time.
    pub(crate) fn dropped_since(&self, ns: u64) -> bool {
        self.not_ready_ns.load(Ordering::Relaxed) > ns
    }

    pub(crate) fn stop(&mut self) {
        self.end.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }
}
