//! Couples in, verdicts out: Algorithm 1 of the paper (III-D) with the additions of DESIGN 4, "Anomaly".

mod activity;
mod alignment;
mod conclude;
mod hand;
mod progress;
mod trial;

pub use trial::Memory;

use crate::capacity::{ACTIVITIES, ACTIVITY_IUS, HANDS, IU_FRAMES, TRIALS};
use crate::config::{Method, MethodFault};
use crate::couple::{Context, Couples};
use crate::dtw::OnlineDtw;
use crate::input::Side;
use crate::job::{Bounds, Job, NominalIu};
use crate::segment::{Event, JobSegmenter};
use crate::verdict::Verdict;
use hand::HandJudge;
use progress::Progress;

/// Why a job cannot be judged against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unusable {
    /// A constant is out of its range.
    Method(MethodFault),
    /// No nominal activity, or more than [`ACTIVITIES`].
    Activities {
        /// Activities given.
        given: usize,
    },
    /// A nominal activity has no IU, or more than [`ACTIVITY_IUS`].
    Ius {
        /// Place of the nominal activity in the job, from 0.
        nominal: usize,
        /// IUs given.
        given: usize,
    },
    /// An IU has an idle context, no reference or one longer than [`IU_FRAMES`] (the release state, which is judged by its
    /// context alone, needs none), a threshold that is not a number from 0, or bounds whose least is over the most; or the first IU
    /// is not a touch.
    Iu {
        /// Place of the nominal activity in the job, from 0.
        nominal: usize,
        /// Place of the IU in the activity, from 0.
        iu: usize,
    },
    /// So many nominal activities have an IU in the same context, more than [`TRIALS`].
    Trials {
        /// How many.
        needed: usize,
    },
}

impl core::fmt::Display for Unusable {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Method(fault) => fault.fmt(f),
            Self::Activities { given } => {
                write!(
                    f,
                    "a job of {given} nominal activities: it must have 1 to {ACTIVITIES}; split the job"
                )
            }
            Self::Ius { nominal, given } => write!(
                f,
                "nominal activity {nominal} has {given} IUs: it must have 1 to {ACTIVITY_IUS}; teach the job anew"
            ),
            Self::Iu { nominal, iu } => write!(
                f,
                "IU {iu} of nominal activity {nominal} is damaged (idle context, a reference of 0 or over {IU_FRAMES} \
                 frames, a threshold under 0, or bounds the wrong way round): teach the job anew"
            ),
            Self::Trials { needed } => write!(
                f,
                "{needed} nominal activities have an IU in the same context, and {TRIALS} can be told apart at once: split the \
                 job, or judge it with memory of its own"
            ),
        }
    }
}

impl core::error::Error for Unusable {}

/// Judges a job as it happens.
///
/// Every IU, every activity and every job gets exactly one verdict:
/// - An IU as soon as its context fits no candidate, its motion fits none any more, it lasts too long or is out of sight; else at its end.
///   The release state has no motion of a hand and is judged by its context when it begins.
/// - An activity as soon as it cannot be right any more (its first wrong IU, or all its candidates would come at the wrong time or twice), or
///   when it equals a nominal one to its end and no longer candidate could go on; else when the next activity begins.
/// - A job when all its nominal activities are done, or at its end. Its reason is the first fault in it. Until all nominal activities
///   are done right a wrong one may be done again; the job stays an anomaly.
#[derive(Clone, Debug)]
pub struct Judge<'a, M = heapless::Vec<OnlineDtw<'a>, TRIALS>> {
    segmenter: JobSegmenter,
    bench: Bench<'a, M>,
}

/// The judges of both hands, and the job that they share.
#[derive(Clone, Debug)]
struct Bench<'a, M> {
    hands: [HandJudge<'a, M>; HANDS],
    progress: Progress<'a>,
}

impl<'a> Judge<'a> {
    /// Starts before the first touch, with all memory inside: about 20 kB for each of [`TRIALS`] trials of each hand.
    ///
    /// # Errors
    /// If a constant or a part of the job cannot be used, or it needs more trials.
    pub fn new(job: &'a Job<'a>, method: Method) -> Result<Self, Unusable> {
        check(job)?;
        let needed = Side::ALL.map(|side| trial::needed(job, side)).into_iter().max().unwrap_or(0);
        if needed > TRIALS {
            return Err(Unusable::Trials { needed });
        }
        Self::with_memory(job, method)
    }
}

impl<'a, M: Memory<'a>> Judge<'a, M> {
    /// Starts before the first touch, with memory for as many trials as the job needs, of the caller's kind:
    /// `Judge::<Vec<_>>::with_memory(&job, method)`.
    ///
    /// # Errors
    /// If a constant or a part of the job cannot be used.
    pub fn with_memory(job: &'a Job<'a>, method: Method) -> Result<Self, Unusable> {
        check(job)?;
        let segmenter = JobSegmenter::new(&method).map_err(Unusable::Method)?;
        Ok(Self {
            segmenter,
            bench: Bench {
                hands: [HandJudge::new(Side::Right, job), HandJudge::new(Side::Left, job)],
                progress: Progress::new(job),
            },
        })
    }

    /// Takes the next couples.
    pub fn step(&mut self, couples: &Couples, emit: &mut impl FnMut(Verdict)) {
        let Self { segmenter, bench } = self;
        bench.progress.now_ns = couples.captured_ns;
        bench.progress.known_ns = couples.known_ns;
        segmenter.step(couples, &mut |event| bench.take(&event, Some(couples), emit));
        let Bench { hands, progress } = bench;
        for (hand, couple) in hands.iter_mut().zip(&couples.hands) {
            hand.go_on(couple, progress, emit);
        }
        for (hand, couple) in hands.iter_mut().zip(&couples.hands) {
            hand.settle(segmenter.hand(couple.side), progress, emit);
        }
        segmenter.job_matched(progress.is_matched());
        if hands.iter().all(|hand| hand.is_concluded()) {
            progress.conclude(false, emit);
        }
    }

    /// Starts a job by command: what is open of the one before ends with its verdicts first.
    pub fn start(&mut self, emit: &mut impl FnMut(Verdict)) {
        let Self { segmenter, bench } = self;
        segmenter.start(&mut |event| bench.take(&event, None, emit));
    }

    /// Ends the job by command, or at the end of a recording: what is open ends with its verdicts.
    pub fn finish(&mut self, emit: &mut impl FnMut(Verdict)) {
        let Self { segmenter, bench } = self;
        segmenter.finish(&mut |event| bench.take(&event, None, emit));
    }
}

impl<'a, M: Memory<'a>> Bench<'a, M> {
    /// Takes what the segmenter says about `couples`, or about a command.
    fn take(&mut self, event: &Event, couples: Option<&Couples>, emit: &mut impl FnMut(Verdict)) {
        let Self { hands, progress } = self;
        match *event {
            Event::JobBegan { began_ns } => progress.begin(began_ns),
            Event::ActivityBegan { side, context, began_ns } => {
                hands[side.place()].begin_activity(context, began_ns, progress);
            }
            Event::IuBegan { side, .. } => {
                let couple = couples.map(|couples| &couples.hands[side.place()]);
                if let Some(couple) = couple {
                    hands[side.place()].begin_iu(couple, progress, emit);
                }
            }
            Event::IuFrame { side, motion, reversals, .. } => {
                hands[side.place()].frame(&motion, reversals, progress, emit)
            }
            Event::Eru { .. } => {}
            Event::IuEnded { side, iu } => hands[side.place()].end_iu(&iu, progress, emit),
            Event::ActivityEnded { side, .. } => hands[side.place()].end_activity(progress, emit),
            Event::JobEnded { .. } => progress.conclude(true, emit),
        }
    }
}

/// Whether a job can be judged against.
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
        if let Some(iu) = activity
            .ius
            .iter()
            .position(|iu| !is_usable(iu))
            .or_else(|| activity.ius[0].context.is_release().then_some(0))
        {
            return Err(Unusable::Iu { nominal, iu });
        }
    }
    Ok(())
}

fn is_usable(iu: &NominalIu<'_>) -> bool {
    let ordered = |bounds: &Bounds| bounds.least <= bounds.most;
    iu.context != Context::IDLE
        && (usize::from(!iu.context.is_release())..=IU_FRAMES).contains(&iu.reference.len())
        && iu.threshold >= 0.0
        && ordered(&iu.frames)
        && ordered(&iu.reversals)
}
