//! What the worker of the judge's tests is to do, and what the judge says of it.

use super::bench::PERIOD_NS;
use super::script::{Part, Still, Strokes, Toward, idle, part, short, stream, teach};
use andon_core::anomaly::{Event, Judge};
use andon_core::config::Method;
use andon_core::couple::{Context, Couples, Motion};
use andon_core::job::{Job, Law, NominalActivity, NominalIu};
use andon_core::set::ActivitySet;
use andon_core::verdict::{Level, Verdict};

/// Two activities that must come one after the other, each once, as 6 runs have shown.
pub(crate) const IN_ORDER: [Law; 2] = [
    Law { is_once: true, runs: 6, ..Law::FREE },
    Law { after_begin: ActivitySet::of(0), is_once: true, runs: 6, ..Law::FREE },
];

pub(crate) fn polish(strokes: usize) -> [Part; 4] {
    [
        part([1, 5, 0, 0], 30, Toward(3)),
        part([1, 5, 5, 6], 16 * strokes, Strokes(strokes)),
        part([1, 5, 0, 0], 30, Toward(7)),
        idle(20),
    ]
}

pub(crate) fn measure() -> [Part; 4] {
    [
        part([1, 6, 0, 0], 30, Toward(5)),
        part([1, 6, 6, 3], 40, Still),
        part([0, 0, 6, 3], 20, Still),
        idle(20),
    ]
}

pub(crate) fn polish_and_measure() -> Job<'static> {
    teach(&[&polish(6), &measure()])
}

/// Any motion is near enough, so that only context and bounds count.
pub(crate) fn forgiving(job: Job<'static>) -> Job<'static> {
    let ius = |nominal: &NominalActivity<'static>| -> &'static [NominalIu<'static>] {
        nominal.ius.iter().map(|iu| NominalIu { threshold: 100.0, ..*iu }).collect::<Vec<_>>().leak()
    };
    let activities: Vec<_> =
        job.activities.iter().map(|nominal| NominalActivity { ius: ius(nominal), ..*nominal }).collect();
    Job { activities: activities.leak(), ..job }
}

/// Motions in a context as they are compared where it does not matter how long a hand rests at either end.
pub(crate) fn between_rests(motions: &[Motion], context: Context) -> Vec<Motion> {
    let rest = [Motion::at_rest(context)];
    [&rest, motions, &rest].concat()
}

/// The same job, in which it does not matter how long a hand rests at either end of an IU.
pub(crate) fn with_free_ends(job: Job<'static>) -> Job<'static> {
    let iu = |iu: &NominalIu<'static>| NominalIu {
        reference: between_rests(iu.reference, iu.context).leak(),
        ..*iu
    };
    let activity = |nominal: &NominalActivity<'static>| NominalActivity {
        ius: nominal.ius.iter().map(iu).collect::<Vec<_>>().leak(),
        ..*nominal
    };
    let activities: Vec<_> = job.activities.iter().map(activity).collect();
    Job { activities: activities.leak(), has_free_ends: true, ..job }
}

pub(crate) fn judged(job: &Job<'_>, couples: &[Couples]) -> Vec<Verdict> {
    let mut judge = Judge::<Vec<_>>::with_memory(job, Method::default()).unwrap().at_start_of_job();
    let mut verdicts = Vec::new();
    for couples in couples {
        judge.step(couples, &mut |event| verdicts.extend(event.verdict()));
    }
    judge.finish(&mut |event| verdicts.extend(event.verdict()));
    verdicts
}

#[track_caller]
pub(crate) fn expect(job: &Job<'_>, right: &[Part], expected: &[&str]) -> Vec<Verdict> {
    let verdicts = judged(job, &stream(right, &[]));
    assert_eq!(verdicts.iter().map(short).collect::<Vec<_>>(), expected);
    verdicts
}

pub(crate) const POLISH_OK: [&str; 4] = ["r0.0 IuOk", "r0.1 IuOk", "r0.2 IuOk", "r0 ActivityOk!"];

/// The beginnings of jobs and the verdicts on them, in their order.
pub(crate) fn jobs(job: &Job<'_>, couples: &[Couples]) -> Vec<String> {
    let mut judge = Judge::<Vec<_>>::with_memory(job, Method::default()).unwrap().at_start_of_job();
    let mut jobs = Vec::new();
    let mut take = |event| match event {
        Event::JobBegan { began_ns } => jobs.push(format!("began in frame {}", began_ns / PERIOD_NS)),
        Event::Verdict(verdict) if verdict.level == Level::Job => jobs.push(short(&verdict)),
        Event::Verdict(_) => {}
    };
    couples.iter().for_each(|couples| judge.step(couples, &mut take));
    judge.finish(&mut take);
    jobs
}

pub(crate) fn away(frames: usize) -> Part {
    Part { seen: false, ..idle(frames) }
}

/// A part is brought from a place to another one and left there.
pub(crate) fn bring(from: u16, to: u16, direction: i8) -> [Part; 5] {
    [
        part([1, 5, 5, from], 20, Still),
        part([1, 5, 0, 0], 30, Toward(direction)),
        part([1, 5, 5, to], 20, Still),
        part([0, 0, 5, to], 20, Still),
        idle(5),
    ]
}
