//! The segmentation of one hand.

use super::filter::OpeningClosing;
use super::measures::{Measures, Meter, WORLDS};
use super::way::Way;
use super::{HandEvent, Iu};
use crate::capacity::{ACTIVITIES, FILTER_FRAMES};
use crate::config::{Method, MethodFault};
use crate::couple::{Context, Couple, Motion, Unseen, Visibility, Waiting};
use crate::input::Side;
use heapless::{Deque, Vec};

/// Maximum number of frames in the filter: its delay of `4h` frames, and the newest one.
const FILTER_ROOM: usize = 2 * FILTER_FRAMES;

#[derive(Clone, Copy, Debug)]
struct OpenIu {
    so_far: Iu,
    meter: Meter,
    /// The open ERU, in which `X` is constant: its motion, and when it began.
    eru: Option<(Motion, u64)>,
    /// Frames since the newest one whose motion was measured.
    unmeasured: u32,
}

#[derive(Clone, Copy, Debug)]
struct OpenActivity {
    /// The context of its first IU.
    context: Context,
    began_ns: u64,
    /// When the last of its IUs that have ended did so.
    ended_ns: u64,
}

/// Segments the couples of one hand (paper III-B).
///
/// - A new ERU begins when any element of the filtered `X` changes.
/// - A new IU begins when `x_c` changes.
/// - A new activity begins when the hand touches an object other than the first one of the activity. So it does when the hand touches that one again
///   after the activity has matched a nominal activity to its last IU.
///
/// Frames whose motion was not measured bypass the filter and are reported where they belong.
///
/// The hand is idle while `x_c` is zero, and also in a release state that belongs to no activity.
#[derive(Clone, Debug)]
pub struct Segmenter {
    side: Side,
    filter: OpeningClosing,
    /// The frames in the filter: the time of each, and how many before it were not measured.
    in_filter: Deque<(u64, u32), FILTER_ROOM>,
    /// The context of the newest couple.
    context: Context,
    iu: Option<OpenIu>,
    /// The newest IU that has ended. That one, if it is not over, so that a touch in its context goes on with it.
    ended: Option<OpenIu>,
    interrupted: Option<OpenIu>,
    /// The way of the hand with `o_j`, which ends where that leaves the `o_l` that it came to, and the way that begins there.
    ways: [Way; 2],
    /// In how many frames in a row, up to now, it was not clear what the hand does.
    unclear: u32,
    activity: Option<OpenActivity>,
    /// Once that equals a nominal activity, to its last IU: the contexts with which a longer one would continue.
    continuations: Option<Vec<Context, ACTIVITIES>>,
}

impl Segmenter {
    /// Starts idle.
    ///
    /// # Errors
    /// If a constant is out of its range.
    pub fn new(side: Side, method: &Method) -> Result<Self, MethodFault> {
        method.check()?;
        Ok(Self {
            side,
            filter: OpeningClosing::new(method.filter_frames),
            in_filter: Deque::new(),
            context: Context::IDLE,
            iu: None,
            ended: None,
            interrupted: None,
            ways: [const { Way::after(0) }; 2],
            unclear: 0,
            activity: None,
            continuations: None,
        })
    }

    /// Takes the next couple of this hand.
    pub fn step(&mut self, couple: &Couple, emit: &mut impl FnMut(HandEvent)) {
        let now_ns = couple.captured_ns;
        if couple.context != self.context {
            self.end_iu(now_ns, emit);
            self.change_ways(couple.context);
        } else if couple.context.is_pair() && self.iu.as_ref().is_some_and(|iu| iu.meter.is_empty()) {
            // It is not known yet that the two are together: the hand may still be on its way.
            self.ways[1] = Way::after(self.unclear);
        }
        self.unclear = if couple.lacks(Unseen::CONTEXT) { self.unclear.saturating_add(1) } else { 0 };
        self.ways.iter_mut().for_each(|way| way.push(couple.tips));
        if self.begins_activity(couple) {
            self.end_activity(emit);
            self.begin_activity(couple, emit);
        }
        self.context = couple.context;
        if self.iu.is_none() && self.activity.is_some() && couple.context != Context::IDLE {
            self.begin_iu(couple, emit);
        }
        if let Some(iu) = &mut self.iu {
            iu.so_far.frames = iu.so_far.frames.saturating_add(1);
            iu.so_far.waited = iu.so_far.waited.saturating_add((couple.waiting == Waiting::Yes).into());
            iu.so_far.is_in_sight &= couple.is_in_sight();
            iu.so_far.seen =
                iu.so_far.seen.saturating_add((couple.worst_visibility() == Visibility::Seen).into());
            iu.meter.push(couple.position, couple.drift_m);
            let Some(motion) = couple.motion else {
                iu.unmeasured = iu.unmeasured.saturating_add(1);
                return;
            };
            iu.so_far.measured = iu.so_far.measured.saturating_add(1);
            // There is room: the filter releases a frame as soon as it is full.
            let _ = self.in_filter.push_back((now_ns, core::mem::take(&mut iu.unmeasured)));
            if let Some(motion) = self.filter.push(motion) {
                self.take_filtered(motion, emit);
            }
        }
    }

    /// The measures of the open IU so far, as in [`Iu::measures`] and in [`Iu::measures_at_pace`]; those of nothing if none is open.
    pub fn measures(&self) -> [Measures; WORLDS] {
        self.iu.as_ref().map(|iu| iu.meter.measures(&self.ways[0])).unwrap_or_default()
    }

    /// Whether an activity would begin with this couple, if it were the next one.
    pub fn begins_activity(&self, couple: &Couple) -> bool {
        let [hand, j, ..] = couple.context.0;
        let touches = hand != 0 && (self.context.0[0] == 0 || self.context.0[1] != j);
        touches
            && self.activity.is_none_or(|activity| {
                let goes_on = |next: &Vec<_, _>| next.contains(&couple.context);
                activity.context.0[1] != j || !self.continuations.as_ref().is_none_or(goes_on)
            })
    }

    /// The activity has matched a nominal activity to its last IU. If its first object is touched again, that begins a new one, unless the context is
    /// one of `continuations`, by whichever hand. At most [`ACTIVITIES`] contexts, the maximum number of candidates, are used.
    pub fn activity_matched(&mut self, continuations: &[Context]) {
        let by_this_hand = continuations.iter().take(ACTIVITIES).map(|context| context.by_hand(self.side));
        self.continuations = self.activity.map(|_| by_this_hand.collect());
    }

    /// The IU that has ended last is not over, because the hand let go in the middle of its activity. A touch in the same context goes on with it.
    pub fn interrupt(&mut self) {
        self.interrupted = self.ended.take().or(self.interrupted);
    }

    /// Ends the open IU and the open activity at `ended_ns`. A touch that continues begins nothing until the hand has let go.
    pub fn finish(&mut self, ended_ns: u64, emit: &mut impl FnMut(HandEvent)) {
        self.end_iu(ended_ns, emit);
        self.end_activity(emit);
    }

    /// An object that the hand touches already counts as a new touch.
    pub fn forget_touch(&mut self) {
        self.context = Context::IDLE;
    }

    /// The next couple has this context.
    fn change_ways(&mut self, next: Context) {
        let [hand, j, _, l] = next.0;
        let [way, next_way] = &mut self.ways;
        let begun = Way::after(self.unclear);
        if !next.is_touch() || self.context.0[..2] != [hand, j] {
            (*way, *next_way) = (begun.clone(), begun);
        } else if l != 0 {
            *next_way = begun;
        } else {
            *way = next_way.clone();
        }
    }

    fn begin_activity(&mut self, couple: &Couple, emit: &mut impl FnMut(HandEvent)) {
        let (context, began_ns) = (couple.context, couple.captured_ns);
        self.activity = Some(OpenActivity { context, began_ns, ended_ns: began_ns });
        self.continuations = None;
        self.interrupted = None;
        emit(HandEvent::ActivityBegan { context, began_ns });
    }

    fn end_activity(&mut self, emit: &mut impl FnMut(HandEvent)) {
        if let Some(OpenActivity { context, began_ns, ended_ns, .. }) = self.activity.take() {
            emit(HandEvent::ActivityEnded { context, began_ns, ended_ns });
        }
    }

    fn begin_iu(&mut self, couple: &Couple, emit: &mut impl FnMut(HandEvent)) {
        let (context, began_ns) = (couple.context, couple.captured_ns);
        // The activity continues, so whether it matches is open again.
        self.continuations = None;
        self.ended = None;
        self.iu = self.interrupted.take().filter(|iu| iu.so_far.context == context);
        if self.iu.is_some() {
            emit(HandEvent::IuResumed);
        } else {
            let so_far = Iu { context, began_ns, is_in_sight: true, ..Iu::default() };
            self.iu = Some(OpenIu { so_far, meter: Meter::default(), eru: None, unmeasured: 0 });
            emit(HandEvent::IuBegan { context, began_ns });
        }
    }

    fn end_iu(&mut self, ended_ns: u64, emit: &mut impl FnMut(HandEvent)) {
        while let Some(motion) = self.filter.flush() {
            self.take_filtered(motion, emit);
        }
        self.filter.clear();
        if let Some(OpenIu { so_far, meter, eru, unmeasured }) = self.iu.take() {
            self.ended = Some(OpenIu { so_far, meter, eru: None, unmeasured: 0 });
            let context = so_far.context;
            if unmeasured > 0 {
                emit(HandEvent::IuUnmeasured(unmeasured));
            }
            if let Some((motion, began_ns)) = eru {
                emit(HandEvent::Eru { context, motion, began_ns, ended_ns });
            }
            let [measures, measures_at_pace] = meter.measures(&self.ways[0]);
            let iu = Iu { ended_ns, measures, measures_at_pace, ..so_far };
            emit(HandEvent::IuEnded(iu));
            if let Some(activity) = &mut self.activity {
                activity.ended_ns = ended_ns;
            }
        }
    }

    /// Takes the next frame that leaves the filter.
    fn take_filtered(&mut self, motion: Motion, emit: &mut impl FnMut(HandEvent)) {
        let (Some(iu), Some((now_ns, unmeasured))) = (&mut self.iu, self.in_filter.pop_front()) else {
            return;
        };
        let context = iu.so_far.context;
        if unmeasured > 0 {
            emit(HandEvent::IuUnmeasured(unmeasured));
        }
        if iu.eru.is_none_or(|(before, _)| before != motion) {
            let ended = iu.eru.replace((motion, now_ns));
            if let Some((motion, began_ns)) = ended {
                emit(HandEvent::Eru { context, motion, began_ns, ended_ns: now_ns });
            }
        }
        emit(HandEvent::IuFrame { motion, captured_ns: now_ns });
    }
}
