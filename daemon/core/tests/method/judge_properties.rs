//! The judge, which takes frame after frame, against Algorithm 1 on whole IUs; and properties of the verdicts on any work.

use crate::common::script::{Motions, Part, Still, Strokes, Toward, idle, ius, part, stream, teach};
use crate::common::work::{between_rests, with_free_ends};
use andon_core::anomaly::Judge;
use andon_core::config::Method;
use andon_core::couple::{Context, Couples, Motion, Unseen, Visibility};
use andon_core::input::Side;
use andon_core::job::{Job, Law, NominalActivity, NominalIu};
use andon_core::verdict::{Level, Note, Outcome, Reason, Verdict};
use proptest::prelude::*;

/// Three activities; two of them begin alike.
fn nominal() -> [Vec<Part>; 3] {
    [
        vec![
            part([1, 5, 0, 0], 30, Toward(3)),
            part([1, 5, 5, 6], 64, Strokes(4)),
            part([1, 5, 0, 0], 30, Toward(7)),
        ],
        vec![part([1, 5, 0, 0], 30, Toward(3)), part([1, 5, 5, 7], 40, Still), part([0, 0, 5, 7], 10, Still)],
        vec![part([1, 6, 0, 0], 30, Toward(5)), part([1, 6, 6, 3], 40, Toward(1))],
    ]
}

fn job() -> Job<'static> {
    let taught = teach(&nominal().each_ref().map(Vec::as_slice));
    // No sum of costs is the square of this threshold, so rounding decides nothing.
    let iu = |iu: &NominalIu<'static>| NominalIu { threshold: 2.9317, ..*iu };
    let activities: Vec<NominalActivity<'static>> = taught
        .activities
        .iter()
        .map(|nominal| NominalActivity {
            ius: nominal.ius.iter().map(iu).collect::<Vec<_>>().leak(),
            ..*nominal
        })
        .collect();
    Job { activities: activities.leak(), laws: &[Law { is_once: true, ..Law::FREE }; 3], ..taught }
}

fn job_with(has_free_ends: bool) -> Job<'static> {
    if has_free_ends { with_free_ends(job()) } else { job() }
}

/// The motions of an IU as they are compared. With free ends, that of two parts may have ended in one of the five frames before the last one.
fn compared(motions: Vec<Motion>, context: Context, job: &Job<'_>) -> Vec<Vec<Motion>> {
    if !job.has_free_ends {
        return vec![motions];
    }
    let whole = between_rests(&motions, context);
    let border = if context.is_pair() { 5.min(motions.len() - 1) } else { 0 };
    let ended = |frames: usize| whole[..=motions.len() - frames].to_vec();
    (1..=border).map(ended).chain([whole.clone()]).collect()
}

/// What can go wrong in an activity. Indices are taken modulo the number of parts.
#[derive(Clone, Debug)]
enum Flaw {
    None,
    LeftOut(usize),
    Twice(usize),
    Object(usize, u16),
    Motion(usize, Motions),
    /// Takes this many tenths of the time.
    Tempo(usize, usize),
    /// Is cut off after this many parts and one.
    Cut(usize),
}

fn flaw() -> impl Strategy<Value = Flaw> {
    let index = 0..3usize;
    prop_oneof![
        3 => Just(Flaw::None),
        1 => index.clone().prop_map(Flaw::LeftOut),
        1 => index.clone().prop_map(Flaw::Twice),
        1 => (index.clone(), 5..10u16).prop_map(|(index, object)| Flaw::Object(index, object)),
        1 => (index.clone(), 1..9i8).prop_map(|(index, bin)| Flaw::Motion(index, Toward(bin))),
        1 => (index.clone(), 1..7usize).prop_map(|(index, strokes)| Flaw::Motion(index, Strokes(strokes))),
        2 => (index.clone(), 3..18usize).prop_map(|(index, tenths)| Flaw::Tempo(index, tenths)),
        1 => index.prop_map(Flaw::Cut),
    ]
}

/// Several activities, each with a flaw or none, with idle time in between.
fn work() -> impl Strategy<Value = Vec<Part>> {
    let done = |(which, flaw): (usize, Flaw)| {
        let mut parts = nominal()[which].clone();
        let count = parts.len();
        match flaw {
            Flaw::None => {}
            Flaw::LeftOut(index) => drop(parts.remove(index % count)),
            Flaw::Twice(index) => parts.insert(index % count, parts[index % count]),
            Flaw::Object(index, object) => {
                let context = &mut parts[index % count].context;
                context[if context[3] == 0 { 1 } else { 3 }] = object;
            }
            Flaw::Motion(index, motions) => parts[index % count].motions = motions,
            Flaw::Tempo(index, tenths) => {
                let frames = &mut parts[index % count].frames;
                *frames = *frames * tenths / 10;
            }
            Flaw::Cut(index) => parts.truncate(1 + index),
        }
        parts.push(idle(10));
        parts
    };
    prop::collection::vec((0..3usize, flaw()), 1..5)
        .prop_map(move |all| all.into_iter().flat_map(done).collect())
}

/// Whether the hand is idle and goes on in the context in which it was before. That may be one IU, which Algorithm 1 does not know.
fn lets_go_in_the_middle(work: &[Part]) -> bool {
    let contexts = |parts: &[Part]| parts[0].context == parts[2].context && parts[1].context == [0; 4];
    work.windows(3).any(contexts)
}

fn judged(job: &Job<'_>, couples: &[Couples]) -> Vec<Verdict> {
    let mut judge = Judge::<Vec<_>>::with_memory(job, Method::default()).unwrap().at_start_of_job();
    let mut verdicts = Vec::new();
    couples.iter().for_each(|couples| judge.step(couples, &mut |event| verdicts.extend(event.verdict())));
    judge.finish(&mut |event| verdicts.extend(event.verdict()));
    verdicts
}

/// Algorithm 1 of the paper on whole IUs, with naive DTW in `f64`.
mod oracle {
    use super::*;

    fn cost(a: &Motion, b: &Motion) -> f64 {
        let point = |bin: i8| match bin {
            0 => [0.0, 0.0],
            bin => [
                (f64::from(bin) * std::f64::consts::TAU / 8.0).cos(),
                (f64::from(bin) * std::f64::consts::TAU / 8.0).sin(),
            ],
        };
        let directions = [1, 2, 4, 5].map(|f| {
            let ([ax, ay], [bx, by]) = (point(a.0[f]), point(b.0[f]));
            (ax - bx).powi(2) + (ay - by).powi(2)
        });
        let numbers = [0, 3, 6].map(|f| (f64::from(a.0[f]) - f64::from(b.0[f])).powi(2));
        directions.iter().chain(&numbers).sum()
    }

    /// The distance of the nearest.
    pub(super) fn min_dtw(all: &[Vec<Motion>], reference: &[Motion]) -> f64 {
        all.iter().map(|motions| dtw(motions, reference)).fold(f64::INFINITY, f64::min)
    }

    fn dtw(a: &[Motion], b: &[Motion]) -> f64 {
        let mut sums = vec![vec![f64::INFINITY; b.len() + 1]; a.len() + 1];
        sums[0][0] = 0.0;
        for i in 1..=a.len() {
            for j in 1..=b.len() {
                let before = sums[i - 1][j - 1].min(sums[i - 1][j]).min(sums[i][j - 1]);
                sums[i][j] = before + cost(&a[i - 1], &b[j - 1]);
            }
        }
        sums[a.len()][b.len()].sqrt()
    }

    /// The compared properties of an IU that has ended.
    pub(super) struct Seen {
        pub(super) context: Context,
        /// As it is compared.
        pub(super) motions: Vec<Vec<Motion>>,
        pub(super) frames: u32,
        pub(super) reversals: u32,
    }

    pub(super) fn is_similar(seen: &Seen, nominal: &NominalIu<'_>) -> bool {
        let within = (nominal.frames.min..=nominal.frames.max).contains(&seen.frames)
            && (nominal.reversals.min..=nominal.reversals.max).contains(&seen.reversals);
        let motion = || within && min_dtw(&seen.motions, nominal.reference) <= f64::from(nominal.threshold);
        // A release state has no motion of a hand.
        seen.context == nominal.context && (seen.context.0[0] == 0 || motion())
    }

    /// How many IUs are right from the first on, and which nominal activities equal all of them.
    pub(super) fn algorithm_1<'a>(job: &Job<'a>, ius: &[Seen]) -> (usize, Vec<NominalActivity<'a>>) {
        let mut candidates: Vec<NominalActivity<'a>> = job.activities.to_vec();
        for (i, seen) in ius.iter().enumerate() {
            candidates.retain(|nominal| nominal.ius.get(i).is_some_and(|nominal| is_similar(seen, nominal)));
            if candidates.is_empty() {
                return (i, candidates);
            }
        }
        // Whether a release state comes at the end is left to chance.
        let is_over = |rest: &[NominalIu<'_>]| rest.iter().all(|iu| iu.context.is_release());
        candidates.retain(|nominal| is_over(&nominal.ius[ius.len()..]));
        (ius.len(), candidates)
    }
}

/// For each activity, the verdict on it and those on its IUs in their order.
fn by_activity(verdicts: &[Verdict]) -> Vec<(Verdict, Vec<Verdict>)> {
    let activities = verdicts.iter().filter(|verdict| verdict.level == Level::Activity);
    let mut activities: Vec<Verdict> = activities.copied().collect();
    activities.sort_by_key(|activity| activity.began_ns);
    let next = |index: usize| activities.get(index + 1).map_or(u64::MAX, |next: &Verdict| next.began_ns);
    let ius = |index: usize, activity: &Verdict| {
        let of_it = verdicts
            .iter()
            .filter(|iu| iu.level == Level::Iu && (activity.began_ns..next(index)).contains(&iu.began_ns));
        let mut ius: Vec<Verdict> = of_it.copied().collect();
        ius.sort_by_key(|iu| iu.iu);
        ius
    };
    activities.iter().enumerate().map(|(index, activity)| (*activity, ius(index, activity))).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(128) })]

    /// The judge decides as early as it can; Algorithm 1, which knows the whole IUs, decides the same.
    #[test]
    fn no_early_verdict_is_contradicted_by_algorithm_1_on_whole_ius(work in work(), has_free_ends: bool) {
        prop_assume!(!lets_go_in_the_middle(&work));
        let job = job_with(has_free_ends);
        let verdicts = judged(&job, &stream(&work, &[]));
        let mut seen = ius(Side::Right, &work).into_iter().peekable();
        let mut done = Vec::new();
        for (activity, ius) in by_activity(&verdicts) {
            if activity.activity == 0 {
                // Another job begins.
                done.clear();
            }
            let mut whole = Vec::new();
            for verdict in &ius {
                let (iu, motions) = seen.next().unwrap();
                prop_assert_eq!((verdict.began_ns, verdict.context), (iu.began_ns, iu.context));
                let (context, reversals, frames) = (iu.context, iu.measures.reversals, motions.len() as u32);
                whole.push(oracle::Seen { context, motions: compared(motions, context, &job), frames, reversals });
            }
            if activity.note == Some(Note::Step) {
                let opening = |ius: &[NominalIu<'_>]| [ius[0].context.0[0], ius[0].context.0[1]];
                let first = [activity.context.0[0], activity.context.0[1]];
                prop_assert!(job.activities.iter().all(|nominal| opening(nominal.ius) != first), "{:?}", ius);
                continue;
            }
            let (right, equal) = oracle::algorithm_1(&job, &whole);
            let ok: Vec<bool> = ius.iter().map(|verdict| verdict.outcome == Outcome::Ok).collect();
            prop_assert!(ok[..right].iter().all(|ok| *ok), "{:?}", ius);
            prop_assert!(right == ius.len() || !ok[right], "{:?}", ius);
            let repeated = equal.iter().all(|nominal| done.contains(&nominal.activity));
            let expected = if equal.is_empty() || repeated { Outcome::Anomaly } else { Outcome::Ok };
            prop_assert_eq!(activity.outcome, expected, "{:?}", ius);
            done.extend(equal.iter().map(|nominal| nominal.activity));
        }
        prop_assert!(seen.next().is_none(), "every IU has a verdict");
    }

    #[test]
    fn the_distance_of_a_verdict_is_that_to_the_nearest_nominal_iu(work in work(), has_free_ends: bool) {
        let job = job_with(has_free_ends);
        let whole = ius(Side::Right, &work);
        for verdict in judged(&job, &stream(&work, &[])) {
            let (Some(distance), Outcome::Ok) = (verdict.distance, verdict.outcome) else { continue };
            let (iu, motions) = whole.iter().find(|(iu, _)| iu.began_ns == verdict.began_ns).unwrap();
            let motions = compared(motions.clone(), iu.context, &job);
            let of_nearest = job.activities.iter().filter(|nominal| Some(nominal.activity) == verdict.nearest);
            let distances: Vec<f64> = of_nearest
                .flat_map(|nominal| nominal.ius)
                .filter(|iu| iu.context == verdict.context)
                .map(|iu| oracle::min_dtw(&motions, iu.reference))
                .collect();
            let near = |exact: &f64| (f64::from(distance) - exact).abs() <= 1e-5 * exact + 1e-6;
            prop_assert!(distances.iter().any(near), "{} {:?}", distance, distances);
        }
    }

    /// An IU of which any part was not sighted is not OK, unless it was decided before; nor is its activity or job.
    #[test]
    fn nothing_is_ok_that_was_not_seen(work in work(), blind in prop::collection::vec(0..600usize, 1..4), frames in 1..20usize) {
        let mut couples = stream(&work, &[]);
        for from in blind {
            for couples in couples.iter_mut().skip(from).take(frames) {
                couples.hands[0].visibility[0] = Visibility::Unseen;
                couples.hands[0].unseen |= Unseen::CONTEXT | Unseen::CHANGE;
            }
        }
        let verdicts = judged(&job(), &couples);
        // A release state is decided in its first frame; what is out of sight later does not count.
        let unseen = |verdict: &Verdict| {
            let its = couples.iter().filter(|couples| (verdict.began_ns..verdict.ended_ns).contains(&couples.captured_ns));
            its.map(|couples| couples.hands[0]).any(|couple| !couple.is_in_sight() && couple.context.is_touch())
        };
        let has_passed = verdicts.iter().any(|one| one.level == Level::Iu && one.reason == Reason::Passing);
        for verdict in &verdicts {
            match verdict.outcome {
                Outcome::Ok => prop_assert!(!unseen(verdict), "{:?}", verdict),
                // Of a part that only passed another one it is not known whether it touched that.
                Outcome::NotJudged if verdict.reason == Reason::Passing => {
                    let is_of_pair = verdict.context.is_pair() || verdict.level != Level::Iu;
                    prop_assert!(is_of_pair && has_passed, "{:?}", verdict);
                }
                // The first frames may be those of another job.
                Outcome::NotJudged if verdict.level == Level::Job && verdict.reason == Reason::BeginningNotSeen => {}
                // A job of which no step came has nothing to be compared with.
                Outcome::NotJudged if verdict.level == Level::Job && verdict.reason == Reason::Unknown => {
                    let is_right_step = |one: &Verdict| one.level == Level::Activity && one.outcome == Outcome::Ok;
                    let mut of_it = verdicts.iter().filter(|one| (verdict.began_ns..verdict.ended_ns).contains(&one.began_ns));
                    prop_assert!(!of_it.any(is_right_step), "{:?}", verdict);
                }
                // A frame or two are named only where nothing else was missing.
                Outcome::NotJudged => {
                    let is_said = matches!(verdict.reason, Reason::HandNotSeen | Reason::Blind);
                    prop_assert!(is_said, "{:?}", verdict);
                }
                Outcome::Anomaly => {}
            }
        }
    }

    /// A judge that was copied in the middle of the work gives the same verdicts.
    #[test]
    fn a_copy_of_the_judge_continues_with_the_same_verdicts(work in work(), at in 0..400usize) {
        let (job, couples) = (job(), stream(&work, &[]));
        let whole = judged(&job, &couples);
        let (before, after) = couples.split_at(at.min(couples.len()));
        let mut verdicts = Vec::new();
        let mut judge = Judge::<Vec<_>>::with_memory(&job, Method::default()).unwrap().at_start_of_job();
        before.iter().for_each(|couples| judge.step(couples, &mut |event| verdicts.extend(event.verdict())));
        let mut copy = judge.clone();
        judge.finish(&mut |_| {});
        after.iter().for_each(|couples| copy.step(couples, &mut |event| verdicts.extend(event.verdict())));
        copy.finish(&mut |event| verdicts.extend(event.verdict()));
        prop_assert_eq!(verdicts, whole);
    }
}
