//! A second client of the PLC's side, which polls the status word all the time.

use andon_ipc::MonotonicTime;
use andon_tests::line::{Modbus, status};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The cycle of a PLC.
const SCAN: Duration = Duration::from_millis(5);
/// The PLC's timeout: an answer that takes longer does not count.
const TIMEOUT: Duration = Duration::from_millis(500);

/// What the line said when it was asked. Times are of the monotonic clock.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    /// When it was asked.
    pub(crate) asked_ns: u64,
    /// When the answer was there.
    pub(crate) answered_ns: u64,
    /// Whether the line was ready. No answer is none.
    pub(crate) is_ready: bool,
}

/// Polls the status word until it is stopped.
pub(crate) struct Poller {
    answers: Arc<Mutex<Vec<Answer>>>,
    end: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Poller {
    pub(crate) fn start(port: u16) -> Self {
        let (answers, end) = (Arc::new(Mutex::new(Vec::new())), Arc::new(AtomicBool::new(false)));
        let (seen, stop) = (Arc::clone(&answers), Arc::clone(&end));
        let poll = move || {
            let mut client = None;
            while !stop.load(Ordering::Relaxed) {
                let answer = ask(&mut client, port);
                seen.lock().unwrap_or_else(PoisonError::into_inner).push(answer);
                std::thread::sleep(SCAN);
            }
        };
        Self { answers, end, thread: Some(std::thread::spawn(poll)) }
    }

    /// Whether the newest answer that was begun after this time has seen the line ready.
    pub(crate) fn ready_since(&self, ns: u64) -> bool {
        self.answers().last().is_some_and(|answer| answer.is_ready && answer.asked_ns >= ns)
    }

    /// Whether it has seen the line not ready since this time.
    pub(crate) fn dropped_since(&self, ns: u64) -> bool {
        self.first_drop_since(ns).is_some()
    }

    /// The first answer since this time that has seen the line not ready.
    pub(crate) fn first_drop_since(&self, ns: u64) -> Option<Answer> {
        let answers = self.answers();
        let since = answers.iter().rev().take_while(|answer| answer.answered_ns > ns);
        since.filter(|answer| !answer.is_ready).last().copied()
    }

    /// Everything that it has seen, in order.
    pub(crate) fn stop(&mut self) -> Vec<Answer> {
        self.end.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
        std::mem::take(&mut *self.answers())
    }

    fn answers(&self) -> std::sync::MutexGuard<'_, Vec<Answer>> {
        self.answers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn ask(client: &mut Option<Modbus>, port: u16) -> Answer {
    let (asked, asked_ns) = (Instant::now(), MonotonicTime::now().nanoseconds());
    *client = client.take().or_else(|| Modbus::connect(port).ok());
    let answer = client.as_mut().map(Modbus::status);
    let is_ready = matches!(answer, Some(Ok(word)) if word & status::READY != 0);
    if !matches!(answer, Some(Ok(_))) {
        *client = None;
    }
    let answered_ns = MonotonicTime::now().nanoseconds();
    Answer { asked_ns, answered_ns, is_ready: is_ready && asked.elapsed() < TIMEOUT }
}
