//! What a reader found: verdicts that accuse what was not seen, and faults that become right when they are not seen any more.
#![allow(clippy::unwrap_used)]

#[path = "learn_vmci/capture.rs"]
#[allow(dead_code)]
mod capture;

use andon_core::anomaly::Judge;
use andon_core::config::{Contact, Method};
use andon_core::couple::Couples;
use andon_core::input::{Frame, Space};
use andon_core::verdict::{Level, Outcome, Verdict};
use andon_learn::job_file::JobFile;
use andon_learn::recording::Recording;
use andon_learn::run::Run;
use andon_learn::teach::{TeachOptions, teach};
use andon_tests::deletion::{jobs, judged, one_after_the_other};
use andon_tests::simulator::{Flaw, Noise, Performance, TwoHanded, perform, perform_with_two_hands};

const SEED: u64 = 71;

fn shop(person: u64, flaw: Flaw) -> Recording {
    perform(&Performance { seed: SEED, person, repetition: 1, noise: Noise::default() }, flaw).0
}

fn taught(all: &[Recording], method: Method, measure_rate: bool) -> JobFile {
    let runs: Vec<Run> = all.iter().map(|one| Run::new("run", "", one, &method).unwrap()).collect();
    teach(&runs, &TeachOptions { measure_rate, ..TeachOptions::new("job", "", method) }).unwrap().0
}

fn shop_job() -> JobFile {
    taught(&(1..=5).map(|person| shop(person, Flaw::None)).collect::<Vec<_>>(), Method::default(), true)
}

fn at_s(recording: &Recording, frame: &Frame) -> f64 {
    (frame.captured_ns - recording.frames[0].captured_ns) as f64 * 1e-9
}

/// The recording with something taken from its frames in a stretch of time.
fn without(whole: &Recording, from_s: f64, to_s: f64, hide: impl Fn(&mut Frame)) -> Recording {
    let mut left = whole.clone();
    for frame in left.frames.iter_mut().filter(|frame| (from_s..to_s).contains(&at_s(whole, frame))) {
        hide(frame);
    }
    left
}

fn everything(frame: &mut Frame) {
    frame.hands.clear();
    frame.objects.clear();
}

fn accused(verdicts: &[Verdict]) -> Vec<&Verdict> {
    verdicts.iter().filter(|verdict| verdict.outcome == Outcome::Anomaly).collect()
}

/// In which tenth of a second after 4.1 s of a covered lens a correct job is accused.
fn accused_behind(job: &JobFile, before: Option<&Recording>, whole: &Recording) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    for from in 0..20 {
        for to in 0..30 {
            let (from_s, to_s) = (f64::from(from) * 0.2, f64::from(from) * 0.2 + 4.1 + f64::from(to) * 0.1);
            let mut covered = without(whole, from_s, to_s, everything);
            covered.frames[0].objects = whole.frames[0].objects.clone();
            let all = before
                .map_or_else(|| covered.clone(), |before| one_after_the_other(&[before, &covered], 1.0));
            if !accused(&judged(job, &all)).is_empty() {
                found.push((from_s, to_s));
            }
        }
    }
    found
}

/// A lens that is covered for `idle_end_ms` is taken for a pause in which nothing moved: what was begun meanwhile is accused.
#[test]
fn frames_in_which_no_part_is_seen_are_no_pause() {
    let job = shop_job();
    let whole = shop(6, Flaw::None);
    assert_eq!(jobs(&judged(&job, &whole)), [Outcome::Ok]);
    let found = accused_behind(&job, None, &whole);
    let next = accused_behind(&job, Some(&whole), &whole);
    assert!(
        found.is_empty() && next.is_empty(),
        "{} and {} of 600: {found:?} {next:?}",
        found.len(),
        next.len()
    );
}

fn mocap() -> (JobFile, Vec<Recording>) {
    let contact = Contact { on_m: 0.08, off_m: 0.11 };
    let method = Method {
        space: Space::Metric,
        rate_hz: capture::RATE_HZ,
        hand_contact: contact,
        object_contact: contact,
        persist_frames: 10,
        ..Method::default()
    };
    let all: Vec<Recording> = (1..=9).map(|number| capture::Capture::read(number).recording()).collect();
    (taught(&all, method, true), all)
}

/// After a right job the box of the next piece is hidden while it is moved, the hand is seen: the rest of the activity is accused.
#[test]
fn a_part_that_is_hidden_while_the_next_job_begins_accuses_nobody() {
    let (job, all) = mocap();
    let mut found = Vec::new();
    let mut of = 0;
    for (index, whole) in all.iter().enumerate() {
        let both = one_after_the_other(&[whole, whole], 1.0);
        if jobs(&judged(&job, &both)) != [Outcome::Ok; 2] || !accused(&judged(&job, &both)).is_empty() {
            continue;
        }
        let border_s = andon_tests::deletion::length_s(whole) + 1.0;
        for from in 0..10 {
            for seconds in [1.0, 2.0, 3.0, 4.0] {
                let from_s = border_s + f64::from(from) * 0.5;
                let left = without(&both, from_s, from_s + seconds, |frame| {
                    frame.objects.retain(|object| object.id != capture::BOX);
                });
                of += 1;
                if !accused(&judged(&job, &left)).is_empty() {
                    found.push((index + 1, from_s - border_s, seconds));
                }
            }
        }
    }
    assert!(found.is_empty(), "{} of {of}: {found:?}", found.len());
}

/// Half of the strokes, of which some are not seen, become right: those that were hidden are counted as if there had been as many.
#[test]
fn half_of_the_strokes_are_not_right_because_frames_are_missing() {
    let work = TwoHanded::HoldWhileWorking;
    let one = |person, is_faulty| {
        perform_with_two_hands(
            &Performance { seed: SEED, person, repetition: 1, noise: Noise::default() },
            work,
            is_faulty,
        )
    };
    let job = taught(&(1..=5).map(|person| one(person, false)).collect::<Vec<_>>(), Method::default(), false);
    let mut found = Vec::new();
    let mut of = 0;
    for person in 6..14 {
        let wrong = one(person, true);
        if accused(&judged(&job, &wrong)).is_empty() {
            continue;
        }
        for (seen, hidden) in [(1, 1), (2, 1), (2, 2), (3, 3), (4, 4), (2, 4), (1, 3), (1, 4)] {
            let mut left = wrong.clone();
            for (index, frame) in left.frames.iter_mut().enumerate() {
                if index % (seen + hidden) >= seen {
                    frame.objects.clear();
                }
            }
            of += 1;
            if jobs(&judged(&job, &left)) == [Outcome::Ok] {
                found.push((person, seen, hidden));
            }
        }
    }
    assert!(found.is_empty(), "{} of {of} are right (person, seen, hidden): {found:?}", found.len());
}

/// What a judge gets where `encode` is killed and starts again: the couples that were held back never come, and a new encoder begins.
fn with_encode_restarted(job: &JobFile, whole: &Recording, at: f64, gap_s: f64) -> Vec<Verdict> {
    let part = |is_in: &dyn Fn(f64) -> bool| -> Vec<Couples> {
        let mut part = whole.clone();
        part.frames.retain(|frame| is_in(at_s(whole, frame)));
        Run::new("run", "", &part, &job.method).unwrap().couples_for(job).unwrap().to_vec()
    };
    let mut couples = part(&|s| s < at);
    couples.truncate(couples.len() - usize::from(job.method.persist_frames));
    couples.extend(part(&|s| s >= at + gap_s));
    job.with_job(|lent| {
        let mut judge = Judge::<Vec<_>>::with_memory(lent, job.method).unwrap();
        let mut verdicts = Vec::new();
        couples.iter().for_each(|couples| judge.step(couples, &mut |event| verdicts.extend(event.verdict())));
        judge.finish(&mut |event| verdicts.extend(event.verdict()));
        verdicts
    })
}

/// The frames that are missing between the couples of two encoders are not counted in the IU that goes on.
#[test]
fn encode_that_starts_again_in_the_middle_of_a_step_accuses_nobody() {
    let job = shop_job();
    let mut found = Vec::new();
    let mut of = 0;
    for person in 6..10 {
        let whole = shop(person, Flaw::None);
        if jobs(&judged(&job, &whole)) != [Outcome::Ok] {
            continue;
        }
        for tenths in (10..100).step_by(5) {
            for gap_s in [0.3, 1.0, 2.0, 3.0] {
                of += 1;
                let verdicts = with_encode_restarted(&job, &whole, f64::from(tenths) / 10.0, gap_s);
                if !accused(&verdicts).is_empty() {
                    found.push((person, f64::from(tenths) / 10.0, gap_s));
                }
            }
        }
    }
    assert!(found.is_empty(), "{} of {of}: {found:?}", found.len());
}

/// A part of which no frame shows the marker, from the beginning.
#[test]
fn a_part_that_is_never_seen_accuses_nobody() {
    let job = shop_job();
    let mut found = Vec::new();
    for person in 6..10 {
        let whole = shop(person, Flaw::None);
        if jobs(&judged(&job, &whole)) != [Outcome::Ok] {
            continue;
        }
        for object in &whole.header.objects {
            let id = object.shape.id;
            let left =
                without(&whole, 0.0, f64::INFINITY, |frame| frame.objects.retain(|object| object.id != id));
            let verdicts = judged(&job, &left);
            if let Some(first) = accused(&verdicts).first() {
                found.push((person, id, first.level, first.reason));
            }
        }
    }
    assert!(found.is_empty(), "{found:?}");
}

/// Beyond the law of deletions: a marker that is misread in one frame makes a path too long at once.
#[test]
fn a_part_that_is_elsewhere_for_one_frame_accuses_nobody() {
    let job = shop_job();
    let mut found = Vec::new();
    let mut of = 0;
    for person in 6..8 {
        let whole = shop(person, Flaw::None);
        if jobs(&judged(&job, &whole)) != [Outcome::Ok] {
            continue;
        }
        for object in &whole.header.objects {
            for frame in (30..whole.frames.len() - 30).step_by(7) {
                let mut left = whole.clone();
                for part in left.frames[frame].objects.iter_mut().filter(|part| part.id == object.shape.id) {
                    part.position[0] += 0.3;
                }
                of += 1;
                let verdicts = judged(&job, &left);
                if let Some(first) = accused(&verdicts).first() {
                    found.push((person, object.shape.id, frame, first.reason));
                }
            }
        }
    }
    assert!(found.is_empty(), "{} of {of}: {:?}", found.len(), &found[..found.len().min(8)]);
    let _ = Level::Job;
}

/// Two activities are seen from beginning to end in the wrong order. Because something was hidden for a moment, the first one may have come
/// unseen, so nobody is accused; but then it comes afterwards, in the picture, and the job is right.
#[test]
fn activities_that_were_seen_in_the_wrong_order_are_not_right_because_something_was_hidden_for_a_moment() {
    let work = TwoHanded::LateHand;
    let one = |person, is_faulty| {
        perform_with_two_hands(
            &Performance { seed: 29146, person, repetition: 1, noise: Noise::default() },
            work,
            is_faulty,
        )
    };
    let job = taught(&(1..=5).map(|person| one(person, false)).collect::<Vec<_>>(), Method::default(), false);
    let mut found = Vec::new();
    let mut of = 0;
    for person in 6..14 {
        let wrong = one(person, true);
        if accused(&judged(&job, &wrong)).is_empty() {
            continue;
        }
        let corner = wrong.header.objects[0].shape.id;
        for tenth in 3..30 {
            for seconds in [0.15, 0.3, 0.7] {
                let from_s = f64::from(tenth) * 0.1;
                let once = without(&wrong, from_s, from_s + seconds, |frame| {
                    frame.hands.retain(|hand| hand.side != andon_core::input::Side::Left);
                    frame.objects.retain(|object| object.id != corner);
                });
                let left = without(&once, from_s + seconds + 0.3, from_s + seconds + 1.0, |frame| {
                    frame.objects.retain(|object| object.id != corner);
                });
                of += 1;
                if jobs(&judged(&job, &left)) == [Outcome::Ok] {
                    found.push((person, from_s, seconds));
                }
            }
        }
    }
    assert!(found.is_empty(), "{} of {of} are right: {found:?}", found.len());
}

/// The parts are hidden when a job ends, and seen again before the next one begins: that is taken for the end of the first one's activity.
#[test]
fn parts_that_are_hidden_between_two_pieces_accuse_nobody() {
    let (job, all) = mocap();
    let mut found = Vec::new();
    let mut of = 0;
    for (index, whole) in all.iter().enumerate() {
        let both = one_after_the_other(&[whole, whole], 1.0);
        let verdicts = judged(&job, &both);
        if jobs(&verdicts) != [Outcome::Ok; 2] || !accused(&verdicts).is_empty() {
            continue;
        }
        let ended = verdicts.iter().find(|verdict| verdict.level == Level::Job).unwrap().ended_ns;
        let ended_s = (ended - both.frames[0].captured_ns) as f64 * 1e-9;
        for before in [0.0, 0.1, 0.3, 1.0] {
            for seconds in [1.0, 1.5, 2.0, 3.0, 3.9] {
                let left = without(&both, ended_s - before, ended_s - before + seconds, |frame| {
                    frame.objects.clear()
                });
                of += 1;
                if !accused(&judged(&job, &left)).is_empty() {
                    found.push((index + 1, before, seconds));
                }
            }
        }
    }
    assert!(found.is_empty(), "{} of {of}: {found:?}", found.len());
}

#[test]
fn debug_one() {
    let (job, all) = mocap();
    for (index, from_s, seconds, is_four) in [
        (0usize, 0.0, 4.0, true),
        (0, 1.0, 3.0, true),
        (5, 2.0, 4.0, true),
        (3, 2.5, 4.0, true),
        (0, 0.0, 3.9, false),
        (2, 0.3, 3.0, false),
    ] {
        let whole = &all[index];
        let both = one_after_the_other(&[whole, whole], 1.0);
        let border_s = andon_tests::deletion::length_s(whole) + 1.0;
        let clean = judged(&job, &both);
        let ended = clean.iter().find(|verdict| verdict.level == Level::Job).unwrap().ended_ns;
        let t0 = both.frames[0].captured_ns;
        let ended_s = (ended - t0) as f64 * 1e-9;
        let left = if is_four {
            without(&both, border_s + from_s, border_s + from_s + seconds, |frame| {
                frame.objects.retain(|object| object.id != capture::BOX)
            })
        } else {
            without(&both, ended_s - from_s, ended_s - from_s + seconds, |frame| frame.objects.clear())
        };
        println!("== {index} {from_s} {seconds} {is_four} border {border_s:.2} ended {ended_s:.2}");
        for (name, v) in [("whole", clean), ("left", judged(&job, &left))] {
            for v in v {
                println!(
                    "  {name} {:?} {:?} {:?} {:?} act {} near {:?} ctx {:?} {:.2}..{:.2} {:?} {:?}",
                    v.level,
                    v.outcome,
                    v.reason,
                    v.side,
                    v.activity,
                    v.nearest,
                    v.context.0,
                    (v.began_ns - t0) as f64 * 1e-9,
                    (v.ended_ns - t0) as f64 * 1e-9,
                    v.measured,
                    v.broken
                );
            }
        }
        let run = Run::new("run", "", &left, &job.method).unwrap();
        let mut before = None;
        for c in run.couples_for(&job).unwrap().iter() {
            let h = c.hands.map(|h| {
                (h.context.0, h.sight, h.is_clear, h.is_doubtful, h.is_object_new, h.is_object_displaced)
            });
            if before.as_ref() != Some(&h) && (c.captured_ns - t0) as f64 * 1e-9 > border_s - 2.0 {
                println!("     {:.2} {h:?} {}", (c.captured_ns - t0) as f64 * 1e-9, c.is_bench_hidden);
            }
            before = Some(h);
        }
    }
}
