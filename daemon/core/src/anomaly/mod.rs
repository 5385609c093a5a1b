//! Couples in, verdicts out: Algorithm 1 of the paper (III-D), applied while the work goes on.
//!
//! # Important terms
//!
//! - *Nominal activity*: a taught sequence of nominal IUs, an element of the list `J`. Several may be variants of one activity.
//! - *Places*: for each nominal activity, how many of its IUs may have come. It is `i` of Algorithm 1, or several where not all was seen.
//! - *Candidate*: a nominal activity in which the open activity has a place: an element of `J \ L`.
//! - *Comparison*: the open IU against a nominal IU that it may be. It is *lost* when it cannot come out right any more. The IU is wrong when all are.
//! - *Following*: once no candidate is left, the other IUs are still judged, each on its own, against the nearest nominal activity.
//! - *Nearest*: the nominal activity with the smallest ratio of distance to threshold. Where motions say nothing, it has the context soonest.
//! - *Matched*: the activity has reached the last IU of a candidate. It *waits* for its verdict while a longer candidate may go on.
//! - *Step*: what an activity is to the job. One that was not shown, with parts of the job, breaks no law and is not judged: a *note* asks
//!   whether it was right. So does another order, a repetition or another hand that was not shown.
//! - *Release state*: the hand has let go of an object that still touches another. It lasts until the next touch, which says nothing about the work.
//!   So it is judged by its context alone, at its beginning.
//! - *Settle*: to decide on an activity once all events of one frame have been taken for both hands.
//! - *Doubtful*: so little was seen that several contexts are possible: one may have come, gone or been another one ([`Unseen::CHANGE`]).
//! - *Certain*: seen well enough that it has happened. An IU that began in doubt is judged once its context has been shown without doubt.
//! - *Start seen*: nothing of the open job can have happened before what was seen of it. Otherwise what is missing accuses nobody.
//! - *Conclude*: to give the verdict on an IU, an activity or a job, which happens exactly once; *early*, if it is before the end.
//!
//! What the paper leaves open is decided as follows. `C`, `L` and `i` start again with every activity. An IU is wrong as soon as the minimum of the
//! newest DTW row is above the thresholds of all comparisons: it never falls. Lengths and reversals have taught bounds, because DTW forgives a
//! repeated motion that is cut short. A rest at either end costs nothing ([`Job::has_free_ends`]). A hand may also correct its grip (`ended`),
//! think better of a touch or put right what it has done (`grip`).
//!
//! # Doubt
//!
//! One law: **a verdict is what all completions of the unseen agree on; anything else is not judged.** Whatever observations are deleted from a
//! recording, its verdicts stay or become not judged. It depends on four quantities, each of which less observation only makes wider:
//!
//! - *Where a hand is in an activity* is the set of its places (`places`). What takes less than twice as long as a gap may have come in it. An IU
//!   that may not have happened leaves the places before it, and its frames count as hidden until it is certain.
//! - *What has come of a job* lies between what was judged and that with what may have come unseen (`progress`). Unseen may have come what was hidden
//!   for half as long as the quickest person needs. So may what came before the first frame, and what a part that was never seen is used for. A fault
//!   needs the wider end, a right job the narrower one. What lies where the job begins has not come.
//! - *A measure* lies between what was seen and that with what fits into the gaps (`observation`). It is wrong if all of it is out of its bounds.
//! - *A DTW distance* over a gap is the least that any motion there could have led to. An IU of which less than half was measured is never right. One
//!   of which fewer frames were captured than the job needs ([`Job::min_captured`]) is neither right nor wrong.
//!
//! Three things widen the doubt beyond a gap. An activity that was not judged may go on with the same part, unless the hand was certainly idle
//! (`hand_doubt`). An activity in progress may have ended, and one that came again, or after all had come, may be of the next piece (`progress`).
//! Where nobody watched for long enough, what is seen next may be of another piece. No job is right that spans such a gap
//! (`progress::another_piece`).
//!
//! A verdict of *not judged* names what was missing most in all that it depends on. An activity and a job name the first such thing in them.
//!
//! Some things are assumed, so that more is judged. Hidden strokes go on at the pace of those that were seen, in at most a quarter of an IU
//! (`observation`). The first step that is seen begins its piece, and both hands are at the same piece (`progress::order`). What was not seen keeps
//! the order of six runs or more (`progress`).

mod activity;
mod algorithm;
mod comparison;
mod ended;
mod grip;
mod hand;
mod hand_doubt;
mod measure;
mod observation;
mod occlusion;
mod places;
mod progress;
mod settle;
mod twice;

pub use comparison::Memory;

use crate::bounds::Bounds;
use crate::capacity::{ACTIVITIES, ACTIVITY_IUS, COMPARISONS, HANDS, IU_FRAMES};
use crate::config::{Method, MethodFault};
use crate::couple::{Context, Couple, Couples, Unseen, Visibility};
use crate::dtw::OnlineDtw;
use crate::input::Side;
use crate::job::{Job, NominalIu};
use crate::segment::{self, HandEvent, JobSegmenter, Start};
use crate::verdict::Verdict;
use hand::HandJudge;
use occlusion::OcclusionLog;
use progress::Progress;
use twice::Twice;

/// Why work cannot be judged against a job.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unusable {
    /// A constant is out of its range.
    #[error(transparent)]
    Method(MethodFault),
    /// There is no nominal activity, or there are more than [`ACTIVITIES`].
    #[error("a job of {given} nominal activities: it must have 1 to {ACTIVITIES}; split the job")]
    Activities {
        /// How many there are.
        given: usize,
    },
    /// A nominal activity has no IU, or more than [`ACTIVITY_IUS`].
    #[error(
        "nominal activity {nominal} has {given} IUs: it must have 1 to {ACTIVITY_IUS}; teach the job again"
    )]
    Ius {
        /// Index of the nominal activity in the job, from 0.
        nominal: usize,
        /// How many IUs it has.
        given: usize,
    },
    /// An IU has an idle context, or no reference (a release state needs none), or one longer than [`IU_FRAMES`]. Or its threshold is negative or not
    /// a number, or bounds have a minimum above the maximum. Or the first IU is not a touch.
    #[error(
        "IU {iu} of nominal activity {nominal} is damaged (idle context, a reference of 0 or over {IU_FRAMES} frames, \
         a threshold below 0, or a minimum above its maximum): teach the job again"
    )]
    Iu {
        /// Index of the nominal activity in the job, from 0.
        nominal: usize,
        /// Index of the IU in the activity, from 0.
        iu: usize,
    },
    /// The number of an activity is [`ACTIVITIES`] or more, its law names one that the job lacks, or laws put it behind itself.
    #[error(
        "the law of activity {activity} cannot be kept (a number of {ACTIVITIES} or more, another activity that there is not, \
         or a circle): teach the job again"
    )]
    Law {
        /// The number of the activity.
        activity: u16,
    },
    /// More than [`COMPARISONS`] nominal activities have an IU in the same context.
    #[error(
        "{needed} nominal activities have an IU in the same context, but only {COMPARISONS} can be compared at once: \
         split the job, or give the judge more memory"
    )]
    Comparisons {
        /// How many have.
        needed: usize,
    },
}

/// What the judge tells, in the order in which it happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A job began: with the first touch, or on command.
    JobBegan {
        /// When, in nanoseconds.
        began_ns: u64,
    },
    /// An IU, an activity or a job has its verdict.
    Verdict(Verdict),
}

impl Event {
    /// The verdict, if it is one.
    pub fn verdict(self) -> Option<Verdict> {
        if let Self::Verdict(verdict) = self { Some(verdict) } else { None }
    }
}

/// Judges a job as it happens.
///
/// Every IU, every activity and every job gets exactly one verdict. Touches that turn out to begin none of them get none, and a job of such touches
/// only has not begun.
/// - An IU gets it early if its context or its motion fits no candidate, or if it is too long or out of sight. Else it gets it at its end. A release
///   state gets it when it begins.
/// - An activity gets it with its first wrong IU, or as soon as all its candidates are out of order. It also does when it has matched a candidate and
///   no longer one can go on. Else it gets it when the next activity begins.
/// - A job gets it when all its activities have come, right or wrong, or at its end. The reason is that of its first fault. A wrong
///   activity may be done again before that, but the job remains an anomaly.
#[derive(Clone, Debug)]
pub struct Judge<'a, M = heapless::Vec<OnlineDtw<'a>, COMPARISONS>> {
    period_ns: u64,
    blind_ns: u64,
    /// The time of the newest couples.
    taken_ns: Option<u64>,
    /// The newest couples, unless others follow that do not come from the same frames.
    newest: Option<Couples>,
    twice: Twice,
    /// In how many of the next couples it may still not be seen what a hand held when others were missing.
    unsettled: u32,
    segmenter: JobSegmenter,
    bench: Bench<'a, M>,
}

/// The judges of both hands and the job that they share.
#[derive(Clone, Debug)]
struct Bench<'a, M> {
    hands: [HandJudge<'a, M>; HANDS],
    progress: Progress<'a>,
}

impl<'a> Judge<'a> {
    /// Starts before the first touch, with all memory inside: about 18 kB for each of [`COMPARISONS`] comparisons per hand.
    ///
    /// # Errors
    /// If a constant or a part of the job cannot be used, or the job needs more comparisons.
    pub fn new(job: &'a Job<'a>, method: Method) -> Result<Self, Unusable> {
        check(job)?;
        let needed = comparison::needed(job);
        if needed > COMPARISONS {
            return Err(Unusable::Comparisons { needed });
        }
        Self::with_memory(job, method)
    }
}

impl<'a, M: Memory<'a>> Judge<'a, M> {
    /// Starts before the first touch, with memory of the caller's choice for as many comparisons as the job needs, such as
    /// `Judge::<Vec<_>>::with_memory(&job, method)`.
    ///
    /// # Errors
    /// If a constant or a part of the job cannot be used.
    pub fn with_memory(job: &'a Job<'a>, method: Method) -> Result<Self, Unusable> {
        check(job)?;
        let segmenter = JobSegmenter::new(&method).map_err(Unusable::Method)?;
        Ok(Self {
            period_ns: method.period_ns(),
            blind_ns: u64::from(method.blind_ms) * 1_000_000,
            taken_ns: None,
            newest: None,
            twice: Twice::default(),
            unsettled: 0,
            segmenter,
            bench: Bench {
                hands: [Side::Right, Side::Left].map(|side| HandJudge::new(side, job, &method)),
                progress: Progress::new(
                    job,
                    method.persist_frames.into(),
                    Side::ALL.map(|side| OcclusionLog::new(side, method.period_ns())),
                ),
            },
        })
    }

    /// The first couples are those of the beginning of a job, such as in a recording of a whole one. Otherwise the judge may have been
    /// started in the middle of a job, and accuses nothing that would have another explanation then.
    #[must_use]
    pub fn at_start_of_job(mut self) -> Self {
        self.bench.hands.iter_mut().for_each(|hand| hand.doubt.begin());
        self.bench.progress.expect_start();
        self.between_jobs()
    }

    /// No job is under way, so that a pause is none in the middle of a job: it shows that the next one begins.
    #[must_use]
    pub fn between_jobs(mut self) -> Self {
        self.segmenter.set_between_jobs(true);
        self
    }

    /// Whether it is known that no job is under way, or that all of it is done.
    pub fn is_between_jobs(&self) -> bool {
        self.segmenter.is_between_jobs()
    }

    /// Takes the next couples. Where some are missing before them, nothing was seen, and after `blind_ms` all is out of sight. So it is with those
    /// that were on their way when the encoder started again. It does not see at once then what a hand holds.
    pub fn step(&mut self, couples: &Couples, emit: &mut impl FnMut(Event)) {
        let couples = &self.bench.progress.of_job(couples);
        self.twice.follow(couples.ids(couples.twice), couples.captured_ns);
        if let Some(newest) = self.newest.replace(*couples) {
            let until_ns = couples.captured_ns.saturating_sub(self.period_ns / 2);
            let mut elapsed_ns = self.period_ns;
            while newest.captured_ns + elapsed_ns < until_ns && elapsed_ns <= self.blind_ns + self.period_ns {
                let visibility =
                    if elapsed_ns > self.blind_ns { Visibility::Unseen } else { Visibility::Assumed };
                let captured_ns = newest.captured_ns + elapsed_ns;
                self.take(&newest.unseen_at(captured_ns, couples.known_ns, visibility), emit);
                elapsed_ns += self.period_ns;
            }
            if elapsed_ns > self.period_ns {
                self.unsettled = self.bench.forget();
                self.segmenter.forget(&newest, couples);
            }
        }
        let mut couples = *couples;
        if self.unsettled > 0 {
            self.unsettled -= 1;
            couples.hands.iter_mut().for_each(|couple| couple.unseen |= Unseen::CHANGE);
        }
        self.take(&couples, emit);
    }

    fn take(&mut self, couples: &Couples, emit: &mut impl FnMut(Event)) {
        self.observe(couples);
        let ends_job = self.ends_job(couples);
        let Self { segmenter, bench, .. } = self;
        segmenter.job_matched(ends_job);
        let is_next_begun = ends_job && couples.hands.iter().any(|couple| segmenter.begins_activity(couple));
        segmenter.step(couples, &mut |event| {
            if is_next_begun {
                bench.break_off_held(event, couples);
            }
            bench.take(event, Some(couples));
        });
        segmenter.take_unseen(false).into_iter().for_each(|began_ns| bench.conclude_unseen(began_ns));
        let Bench { hands, progress } = bench;
        for (hand, couple) in hands.iter_mut().zip(&couples.hands) {
            let measures = segmenter.hand(couple.side).measures();
            hand.continue_iu(couple, measures, progress);
        }
        for (hand, couple) in hands.iter_mut().zip(&couples.hands) {
            hand.settle(segmenter.hand(couple.side), progress);
        }
        hands.iter_mut().for_each(|hand| hand.check_order(progress));
        if hands.iter().zip(&couples.hands).any(|(hand, couple)| hand.is_seen_at_step(couple)) {
            // From here on the piece is the same while it is watched.
            progress.unwatched = 0;
        }
        if hands.iter().all(|hand| hand.is_concluded()) {
            progress.conclude(false);
        }
        self.tell(emit);
    }

    /// Tells what was decided since it was last called.
    fn tell(&mut self, emit: &mut impl FnMut(Event)) {
        let told = &mut self.bench.progress.told;
        told.iter().for_each(|event| emit(self.twice.named(*event)));
        told.clear();
    }

    /// How many frames of the grid after the newest couples these come, at least 1. Of a long gap, not all have couples.
    fn frames_to(&mut self, captured_ns: u64) -> u32 {
        let newest_ns = self.taken_ns.replace(captured_ns).unwrap_or(captured_ns);
        let elapsed_ns = captured_ns.saturating_sub(newest_ns).saturating_add(self.period_ns / 2);
        u32::try_from(elapsed_ns / self.period_ns).unwrap_or(u32::MAX).max(1)
    }

    /// Takes how much the next couples show, and what has happened without a hand.
    fn observe(&mut self, couples: &Couples) {
        let frames = self.frames_to(couples.captured_ns);
        let Self { segmenter, bench, .. } = self;
        bench.progress.watch(couples, frames);
        bench.progress.now_ns = couples.captured_ns;
        bench.progress.known_ns = couples.known_ns;
        for (hand, couple) in bench.hands.iter_mut().zip(&couples.hands) {
            hand.observe(couple, frames, &mut bench.progress);
        }
        bench.progress.set_at_start(couples);
        bench.progress.set_out_of_sight(couples);
        if couples.lacks(Unseen::CARRIER) {
            bench.progress.doubt_start();
            let hands = bench.hands.iter_mut().zip(&couples.hands);
            hands
                .filter(|(_, couple)| !couple.is_hand_seen())
                .for_each(|(hand, _)| hand.doubt.may_be_remainder = true);
        }
        if couples.lacks(Unseen::MOVER) {
            bench.progress.set_moved_unseen();
            // What a hand does with the same part afterwards may be another activity, and so may what it did meanwhile.
            for (hand, couple) in bench.hands.iter_mut().zip(&couples.hands) {
                if couple.context == Context::IDLE && hand.lose_place() {
                    segmenter.hand(couple.side).activity_matched(&[]);
                }
            }
        }
        // What a hand does with the same part afterwards is not the remainder of what it did before.
        let is_idle = |couple: &Couple| couple.context == Context::IDLE && !couple.lacks(Unseen::CHANGE);
        if bench.progress.is_reset() && couples.hands.iter().all(is_idle) {
            segmenter.finish(&mut |event| bench.take(event, None));
        }
    }

    /// Whether the open job has come to its end, so that a touch in these couples begins another one. A touch that begins an activity ends
    /// the one before it, which has its verdict then.
    fn ends_job(&mut self, couples: &Couples) -> bool {
        let Self { segmenter, bench, .. } = self;
        let is_disturbed = segmenter.is_disturbed() || couples.lacks(Unseen::MOVER);
        let begins_next = couples.hands.iter().any(|couple| {
            let may_go_on = bench.hands[couple.side.index()].doubt.may_go_on(couple.context);
            segmenter.begins_activity(couple)
                && bench.progress.begins_next_job(couple, is_disturbed, may_go_on)
        });
        // What comes out wrong only now may be done again in this job.
        let wrong = bench.progress.wrong();
        for couple in &couples.hands {
            if segmenter.begins_activity(couple) {
                let hand = segmenter.hand(couple.side);
                hand.finish(couples.captured_ns, &mut |event| {
                    bench.take(segment::Event::Hand(couple.side, event), Some(couples));
                });
            }
        }
        let progress = &bench.progress;
        let mut touches = couples.hands.iter().filter(|couple| segmenter.begins_activity(couple)).peekable();
        let goes_on = touches.peek().is_some()
            && touches.all(|couple| progress.goes_on_with(couple.context, is_disturbed));
        begins_next || progress.is_matched_with(wrong) && !goes_on
    }

    /// Starts a job on command. The open job, if any, ends first, with its verdicts.
    pub fn start(&mut self, emit: &mut impl FnMut(Event)) {
        let Self { segmenter, bench, .. } = self;
        self.newest = None;
        segmenter.start(&mut |event| bench.take(event, None));
        bench.hands.iter_mut().for_each(|hand| hand.doubt.begin());
        self.tell(emit);
    }

    /// The couples break off here, and what comes next does not follow from them: a source has started again. Ends the open job, with its
    /// verdicts; what is missing from it accuses nobody.
    pub fn break_off(&mut self, emit: &mut impl FnMut(Event)) {
        let Bench { hands, progress } = &mut self.bench;
        for hand in hands {
            hand.doubt.lose();
            hand.break_off();
        }
        progress.break_off();
        self.newest = None;
        self.finish(emit);
        self.segmenter.set_between_jobs(false);
        self.bench.hands.iter_mut().for_each(|hand| hand.is_broken_off = false);
    }

    /// Ends the open job on command or at the end of a recording, with its verdicts.
    pub fn finish(&mut self, emit: &mut impl FnMut(Event)) {
        let Self { segmenter, bench, .. } = self;
        segmenter.finish(&mut |event| bench.take(event, None));
        segmenter.take_unseen(true).into_iter().for_each(|began_ns| bench.conclude_unseen(began_ns));
        self.tell(emit);
    }
}

impl<'a, M: Memory<'a>> Bench<'a, M> {
    /// The encoder has started again, and the next job may have begun. Returns for how many frames it may not see that a hand holds something.
    fn forget(&mut self) -> u32 {
        self.progress.never_seen = None;
        self.progress.doubt_start();
        for hand in &mut self.hands {
            // Nothing was watched before, so the next activity may be the remainder of one.
            (hand.doubt.may_be_remainder, hand.doubt.is_begun_late) = (true, true);
        }
        self.hands[0].doubt.min_idle_frames()
    }

    /// A hand that was not seen has worked since then: whatever it did is not judged.
    fn conclude_unseen(&mut self, began_ns: u64) {
        self.progress.begin(began_ns, Start::Unseen, None);
        self.progress.set_unseen();
        self.progress.conclude(true);
    }

    /// A hand has begun the next piece, and the IU of the other one ends with the job. While that hand keeps what it acts with, or that still touches
    /// something, it is still at it.
    fn break_off_held(&mut self, event: segment::Event, couples: &Couples) {
        let segment::Event::Hand(side, HandEvent::IuEnded(iu)) = event else { return };
        let next = couples.hands[side.index()].context;
        if next != Context::IDLE && next.o_j() == iu.context.o_j() {
            self.hands[side.index()].break_off();
        }
    }

    /// Takes an event of the segmentation, which comes from `couples` or from a command.
    fn take(&mut self, event: segment::Event, couples: Option<&Couples>) {
        let Self { hands, progress } = self;
        match event {
            segment::Event::JobBegan { began_ns, start, unseen_since_ns } => {
                let all = couples.iter().flat_map(|couples| &couples.hands);
                let mut touches = all.filter(|couple| couple.context.is_touch());
                if touches.any(|couple| hands[couple.side.index()].doubt.may_go_on(couple.context)) {
                    progress.doubt_start();
                }
                progress.begin(began_ns, start, unseen_since_ns);
                if start != Start::Unseen {
                    for hand in hands {
                        hand.doubt.begin();
                        // After a pause or on command nobody puts right what was done before.
                        hand.last_done = None;
                    }
                }
            }
            segment::Event::Hand(side, event) => {
                if let HandEvent::ActivityBegan { context, .. } = event {
                    // What the other hand goes on with is not put right.
                    let other = &mut hands[side.other().index()];
                    other.last_done = other.last_done.filter(|last| last.context.0[1] != context.0[1]);
                }
                let couple = couples.map(|couples| &couples.hands[side.index()]);
                hands[side.index()].take(event, couple, progress);
            }
            segment::Event::JobEnded { .. } => {
                // Whoever moved things unseen before a pause may go on unseen after it.
                if couples.is_some_and(|couples| couples.hands.iter().all(|couple| !couple.is_hand_seen())) {
                    progress.assume_end();
                }
                progress.conclude(true);
            }
        }
    }
}

/// Checks that work can be judged against a job.
fn check(job: &Job<'_>) -> Result<(), Unusable> {
    let activities = job.activities;
    if activities.is_empty() || activities.len() > ACTIVITIES {
        return Err(Unusable::Activities { given: activities.len() });
    }
    for (nominal, activity) in activities.iter().enumerate() {
        let given = activity.ius.len();
        if given == 0 || given > ACTIVITY_IUS {
            return Err(Unusable::Ius { nominal, given });
        }
        let damaged = activity.ius.iter().position(|iu| !is_usable(iu));
        if let Some(iu) = damaged.or(activity.ius[0].context.is_release().then_some(0)) {
            return Err(Unusable::Iu { nominal, iu });
        }
    }
    job.misplaced().map_or(Ok(()), |activity| Err(Unusable::Law { activity }))
}

fn is_usable(iu: &NominalIu<'_>) -> bool {
    let is_ordered = |bounds: &Bounds| bounds.min <= bounds.max;
    iu.context != Context::IDLE
        && (usize::from(!iu.context.is_release())..=IU_FRAMES).contains(&iu.reference.len())
        && iu.threshold >= 0.0
        && is_ordered(&iu.frames)
        && is_ordered(&iu.reversals)
        && iu.measures.path_m.min <= iu.measures.path_m.max
        && iu.measures.max_detour_m >= 0.0
        && iu.measures.max_lateral_m >= 0.0
        && iu.measures.stroke_m.min <= iu.measures.stroke_m.max
}
