//! The segmentation of both hands and of the job that they share.

use super::{Event, Segmenter, Start};
use crate::capacity::HANDS;
use crate::config::{Method, MethodFault};
use crate::couple::{Context, Couple, Couples, Unseen};
use crate::input::Side;

/// An open job.
#[derive(Clone, Copy, Debug)]
struct OpenJob {
    began_ns: u64,
    /// When a hand last acted in it.
    ended_ns: u64,
    /// A hand has touched something in it, and all nominal activities are done.
    touched: bool,
    matched: bool,
}

/// What is known of the time without a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Between {
    /// A job may be under way, so that a pause may be one in the middle of it.
    Unknown,
    /// A job has ended, or the first one is about to begin.
    Jobs,
    /// There has been a pause since then, and nothing has moved.
    Paused,
}

/// Segments the couples of both hands. Each hand has its own activities; both share the job.
///
/// A job begins with the first touch or on command. It ends on command, and once [`job_matched`](Self::job_matched) was set, with the touch that begins
/// the next job. It also ends after a *pause*, when no hand has been seen for `idle_end_ms`, if it is matched or if objects have moved meanwhile. Else it
/// goes on when the worker is back. Frames that are missing are no pause, and one shows that the next job has not begun only while the bench is seen.
#[derive(Clone, Debug)]
pub struct JobSegmenter {
    hands: [Segmenter; HANDS],
    period_ns: u64,
    /// A bench that is hidden for longer is out of sight.
    hidden_ns: u64,
    idle_end_ns: u64,
    /// The time of the newest couples.
    newest_ns: u64,
    /// For how long no hand has been seen and nothing has moved, in frames that were captured.
    handless_ns: u64,
    /// For how long the bench has been in sight besides.
    resting_ns: u64,
    /// When the bench was last seen.
    bench_ns: u64,
    /// An encoder that has started again does not see an object that had been in sight, and has not seen a hand yet.
    has_lost_object: bool,
    between: Between,
    /// Since when something has been carried so, and nobody has been told.
    unseen_since_ns: Option<u64>,
    /// What was not seen since a hand last began to act: [`Unseen::MOVER`], and [`Unseen::CARRIER`], so that the next job may have begun.
    since_touch: Unseen,
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
            period_ns: method.period_ns(),
            hidden_ns: (u64::from(method.persist_frames) + 1) * method.period_ns(),
            idle_end_ns: u64::from(method.idle_end_ms) * 1_000_000,
            newest_ns: 0,
            handless_ns: 0,
            resting_ns: 0,
            bench_ns: 0,
            has_lost_object: false,
            between: Between::Unknown,
            unseen_since_ns: None,
            since_touch: Unseen::EMPTY,
            job: None,
        })
    }

    /// Takes the next couples.
    pub fn step(&mut self, couples: &Couples, emit: &mut impl FnMut(Event)) {
        let now_ns = couples.captured_ns;
        self.watch_for_pause(couples);
        let touches = couples.hands.iter().any(|couple| self.begins_activity(couple));
        let is_pause = self.handless_ns >= self.idle_end_ns;
        if self.job.is_some_and(|job| {
            job.matched && (touches || is_pause) || job.touched && is_pause && self.is_disturbed()
        }) {
            self.end(now_ns, emit);
        }
        if touches && self.job.is_none() {
            let start = if self.between == Between::Paused { Start::Seen } else { Start::Unseen };
            self.begin(now_ns, start, emit);
        }
        self.newest_ns = now_ns;
        for (hand, couple) in self.hands.iter_mut().zip(&couples.hands) {
            hand.step(couple, &mut |event| emit(Event::Hand(couple.side, event)));
        }
        if let Some(job) = &mut self.job {
            job.touched |= touches;
            if couples.hands.iter().any(|couple| couple.context != Context::IDLE) {
                job.ended_ns = now_ns.saturating_add(self.period_ns);
            }
        }
        self.since_touch = self.since_touch.when(!touches);
    }

    fn watch_for_pause(&mut self, couples: &Couples) {
        let is_hand_seen = couples.hands.iter().any(Couple::is_hand_seen);
        let moves = couples.unseen & (Unseen::MOVER | Unseen::CARRIER);
        if !moves.is_empty() || is_hand_seen {
            (self.handless_ns, self.resting_ns) = (0, 0);
        } else if !couples.lacks(Unseen::FRAME) && self.newest_ns > 0 {
            let elapsed_ns = couples.captured_ns.saturating_sub(self.newest_ns).min(2 * self.period_ns);
            self.handless_ns = self.handless_ns.saturating_add(elapsed_ns);
            self.resting_ns = self.resting_ns.saturating_add(elapsed_ns);
        }
        let is_out_of_sight = couples.captured_ns.saturating_sub(self.bench_ns) > self.hidden_ns;
        self.has_lost_object &= !couples.out_of_sight.is_empty() && !is_hand_seen;
        if !couples.lacks(Unseen::BENCH) && !self.has_lost_object {
            self.bench_ns = couples.captured_ns;
        }
        if is_out_of_sight {
            self.resting_ns = 0;
        }
        self.since_touch |= moves;
        if self.job.is_none_or(|job| job.matched) && moves.intersects(Unseen::CARRIER) {
            self.unseen_since_ns.get_or_insert(couples.captured_ns);
        }
        let is_moved = moves.intersects(Unseen::MOVER) || self.since_touch.intersects(Unseen::CARRIER);
        let has_rested = self.job.is_none() && self.resting_ns >= self.idle_end_ns;
        self.between = match self.between {
            Between::Jobs | Between::Paused if has_rested && !is_moved => Between::Paused,
            Between::Paused if is_out_of_sight || is_moved => Between::Jobs,
            before => before,
        };
    }

    /// Whether an activity would begin with this couple, if it were the next one.
    pub fn begins_activity(&self, couple: &Couple) -> bool {
        self.hands[couple.side.index()].begins_activity(couple)
    }

    /// Whether objects have moved since a hand last began to act, while no hand was seen.
    pub fn is_disturbed(&self) -> bool {
        self.since_touch.intersects(Unseen::MOVER)
    }

    /// Whether it is known that no job is under way, or that all of it is done.
    pub fn is_between_jobs(&self) -> bool {
        self.job.map_or(self.between != Between::Unknown, |job| job.matched)
    }

    /// No job is under way, or it is not known whether one is.
    pub fn set_between_jobs(&mut self, is_between_jobs: bool) {
        self.between = if is_between_jobs { Between::Jobs } else { Between::Unknown };
    }

    /// The encoder has started again between these couples: it does not know that an object which it does not see was in sight before.
    pub fn forget(&mut self, before: &Couples, after: &Couples) {
        let is_lost = (after.out_of_sight & before.out_of_sight) != after.out_of_sight;
        self.has_lost_object |= before.lacks(Unseen::BENCH) || is_lost;
    }

    /// Since when an unseen hand had worked without a job, if a pause or the end of the recording has ended that. It is told once.
    pub fn take_unseen(&mut self, has_ended: bool) -> Option<u64> {
        let is_over = self.job.is_none() && (has_ended || self.handless_ns >= self.idle_end_ns);
        self.unseen_since_ns.take_if(|_| is_over)
    }

    /// Begins a job on command, with the next couples. An open job ends first; objects that the hands touch count as new touches.
    pub fn start(&mut self, emit: &mut impl FnMut(Event)) {
        self.finish(emit);
        self.hands.iter_mut().for_each(Segmenter::forget_touch);
        self.begin(self.newest_ns.saturating_add(self.period_ns), Start::Commanded, emit);
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

    fn begin(&mut self, began_ns: u64, start: Start, emit: &mut impl FnMut(Event)) {
        self.job = Some(OpenJob { began_ns, ended_ns: began_ns, touched: false, matched: false });
        (self.between, self.since_touch) = (Between::Jobs, self.since_touch.without(Unseen::CARRIER));
        let unseen_since_ns = self.unseen_since_ns.take();
        emit(Event::JobBegan { began_ns, start, unseen_since_ns });
    }

    fn end(&mut self, now_ns: u64, emit: &mut impl FnMut(Event)) {
        for (hand, side) in self.hands.iter_mut().zip(Side::ALL) {
            hand.finish(now_ns, &mut |event| emit(Event::Hand(side, event)));
        }
        if let Some(OpenJob { began_ns, ended_ns, .. }) = self.job.take() {
            // A job that began on command may end before the frame that it was to begin with.
            emit(Event::JobEnded { began_ns, ended_ns: ended_ns.min(now_ns).max(began_ns) });
        }
    }
}
