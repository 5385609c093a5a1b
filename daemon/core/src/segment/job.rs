//! The segmentation of both hands and of the job that they share.

use super::{Event, Segmenter};
use crate::capacity::HANDS;
use crate::config::{Method, MethodFault};
use crate::couple::{Context, Couples};
use crate::input::Side;

/// An open job.
#[derive(Clone, Copy, Debug)]
struct OpenJob {
    began_ns: u64,
    /// When a hand last acted in it.
    ended_ns: u64,
    /// Whether a hand has touched anything in it.
    touched: bool,
    /// Whether all nominal activities are done.
    matched: bool,
}

/// Segments the couples of both hands. Each hand has its own activities; both share the job.
///
/// A job begins with the first touch or on command. It ends on command; when no hand has been seen for `idle_end_ms`, if
/// anything was touched in it; or, once [`job_matched`](Self::job_matched) was set, with the touch that begins the next job.
#[derive(Clone, Debug)]
pub struct JobSegmenter {
    hands: [Segmenter; HANDS],
    period_ns: u64,
    idle_end_ns: u64,
    /// The time of the newest couples.
    newest_ns: u64,
    /// When a hand was last seen.
    seen_ns: u64,
    job: Option<OpenJob>,
}

impl JobSegmenter {
    /// Starts without a job.
    ///
    /// # Errors
    /// If a constant is out of its range.
    pub fn new(method: &Method) -> Result<Self, MethodFault> {
        Ok(Self {
            hands: [Segmenter::new(Side::Right, method)?, Segmenter::new(Side::Left, method)?],
            // The rate is at least 1 Hz.
            period_ns: libm::round(1e9 / f64::from(method.rate_hz)) as u64,
            idle_end_ns: u64::from(method.idle_end_ms) * 1_000_000,
            newest_ns: 0,
            seen_ns: 0,
            job: None,
        })
    }

    /// Takes the next couples.
    pub fn step(&mut self, couples: &Couples, emit: &mut impl FnMut(Event)) {
        let now_ns = couples.captured_ns;
        if couples.hands.iter().any(|couple| couple.seen) {
            self.seen_ns = now_ns;
        }
        let touches =
            self.hands.iter().zip(&couples.hands).any(|(hand, couple)| hand.begins_activity(couple));
        let idle = now_ns.saturating_sub(self.seen_ns) >= self.idle_end_ns;
        if self.job.is_some_and(|job| job.matched && touches || job.touched && idle) {
            self.end(now_ns, emit);
        }
        if touches && self.job.is_none() {
            self.begin(now_ns, emit);
        }
        self.newest_ns = now_ns;
        for (hand, couple) in self.hands.iter_mut().zip(&couples.hands) {
            hand.step(couple, emit);
        }
        if let Some(job) = &mut self.job {
            job.touched |= touches;
            if couples.hands.iter().any(|couple| couple.context != Context::IDLE) {
                job.ended_ns = now_ns.saturating_add(self.period_ns);
            }
        }
    }

    /// Begins a job on command, with the next couples. An open job ends first; objects that the hands touch count as new touches.
    pub fn start(&mut self, emit: &mut impl FnMut(Event)) {
        self.finish(emit);
        self.hands.iter_mut().for_each(Segmenter::forget_touch);
        self.begin(self.newest_ns.saturating_add(self.period_ns), emit);
    }

    /// Ends the job on command or at the end of a recording, after the newest couples.
    pub fn finish(&mut self, emit: &mut impl FnMut(Event)) {
        self.end(self.newest_ns.saturating_add(self.period_ns), emit);
    }

    /// Sets whether all nominal activities of the job are done: then the next touch that begins an activity begins another job.
    pub fn job_matched(&mut self, matched: bool) {
        if let Some(job) = &mut self.job {
            job.matched = matched;
        }
    }

    /// The segmentation of one hand.
    pub fn hand(&mut self, side: Side) -> &mut Segmenter {
        &mut self.hands[side.index()]
    }

    fn begin(&mut self, began_ns: u64, emit: &mut impl FnMut(Event)) {
        self.job = Some(OpenJob { began_ns, ended_ns: began_ns, touched: false, matched: false });
        emit(Event::JobBegan { began_ns });
    }

    fn end(&mut self, now_ns: u64, emit: &mut impl FnMut(Event)) {
        self.hands.iter_mut().for_each(|hand| hand.finish(now_ns, emit));
        if let Some(OpenJob { began_ns, ended_ns, .. }) = self.job.take() {
            // A job that began on command may end before the frame that it was to begin with.
            emit(Event::JobEnded { began_ns, ended_ns: ended_ns.min(now_ns).max(began_ns) });
        }
    }
}
