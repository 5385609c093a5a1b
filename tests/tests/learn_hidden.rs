//! What is right stays right, or is not judged, whatever is missing. A part is never seen, hidden between two pieces or misread, or couples are
//! missing.
#![allow(clippy::unwrap_used)]

#[path = "learn_vmci/capture.rs"]
#[allow(dead_code)]
mod capture;

use andon_core::config::Method;
use andon_core::input::Frame;
use andon_core::verdict::{Level, Outcome, Verdict};
use andon_learn::job_file::JobFile;
use andon_learn::recording::Recording;
use andon_learn::run::Run;
use andon_learn::teach::{TeachOptions, teach};
use andon_tests::deletion::{jobs, judged, judged_with_restart, length_s, one_after_the_other};
use andon_tests::environment;
use andon_tests::rate::Rate;
use andon_tests::simulator::{Flaw, Noise, Performance, Random, TwoHanded, perform, perform_with_two_hands};

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

/// The runs of these people that are right.
fn right_by(job: &JobFile, persons: std::ops::Range<u64>) -> Vec<(u64, Recording)> {
    let shown = persons.map(|person| (person, shop(person, Flaw::None)));
    shown.filter(|(_, whole)| jobs(&judged(job, whole)) == [Outcome::Ok]).collect()
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

fn accused(verdicts: &[Verdict]) -> Vec<&Verdict> {
    verdicts.iter().filter(|verdict| verdict.outcome == Outcome::Anomaly).collect()
}

fn mocap() -> (JobFile, Vec<Recording>) {
    let all: Vec<Recording> = (1..=9).map(|number| capture::Capture::read(number).recording()).collect();
    (taught(&all, capture::method(), true), all)
}

/// No frame shows the marker of the part.
#[test]
fn a_part_that_is_never_seen_accuses_nobody() {
    let job = shop_job();
    let mut found = Vec::new();
    for (person, whole) in right_by(&job, 6..10) {
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

/// The parts are hidden when a job ends, and seen again when the next one has begun or is about to.
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

/// The box of the next piece is hidden while it is moved after a right job, and the hand is seen.
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
        let border_s = length_s(whole) + 1.0;
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

/// A marker that is misread in one frame would make a path too long at once.
#[test]
fn a_part_that_is_elsewhere_for_one_frame_accuses_nobody() {
    let job = shop_job();
    let mut found = Vec::new();
    let mut of = 0;
    for (person, whole) in right_by(&job, 6..8) {
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
}

/// Couples are missing between those of two encoders.
#[test]
fn encode_that_starts_again_in_the_middle_of_a_step_accuses_nobody() {
    let job = shop_job();
    let mut found = Vec::new();
    let mut of = 0;
    for (person, whole) in right_by(&job, 6..10) {
        for tenths in (10..100).step_by(5) {
            for gap_s in [0.3, 1.0, 2.0, 3.0] {
                if f64::from(tenths) / 10.0 + gap_s > length_s(&whole) - 1.0 {
                    continue;
                }
                of += 1;
                let verdicts = judged_with_restart(&job, &whole, (f64::from(tenths) / 10.0, gap_s));
                if !accused(&verdicts).is_empty() {
                    found.push((person, f64::from(tenths) / 10.0, gap_s));
                }
            }
        }
    }
    assert!(found.is_empty(), "{} of {of}: {found:?}", found.len());
}

/// What is read as something else for one to six frames. It is a marker somewhere else, two markers as each other, or the two hands as each other.
fn misread(whole: &Recording, random: &mut Random) -> Recording {
    let mut left = whole.clone();
    let ids: Vec<u16> = whole.header.objects.iter().map(|object| object.shape.id).collect();
    let (kind, frames, first) = (random.index(3), 1 + random.index(6), random.index(whole.frames.len()));
    let [one, other] = [0, 1].map(|_| ids[random.index(ids.len())]);
    let apart_m = random.between(-0.3, 0.3) as f32;
    for frame in left.frames.iter_mut().skip(first).take(frames) {
        match kind {
            0 => {
                let read = frame.objects.iter_mut().find(|object| object.id == one);
                read.into_iter().for_each(|object| object.position[0] += apart_m);
            }
            1 => frame.objects.iter_mut().for_each(|object| {
                object.id = match object.id {
                    id if id == one => other,
                    id if id == other => one,
                    id => id,
                };
            }),
            _ => frame.hands.iter_mut().for_each(|hand| hand.side = hand.side.other()),
        }
    }
    left
}

/// `ANDON_CASES` chooses how many misreadings. What is read elsewhere by less than a hand moves in a frame cannot be told from that.
#[test]
fn what_is_misread_for_some_frames_seldom_accuses_anybody() {
    let (seed, cases) = (environment::seed(), environment::number("ANDON_CASES", 60));
    let with_two_hands = |work| {
        move |person| {
            let noise = Noise::default();
            perform_with_two_hands(&Performance { seed: SEED, person, repetition: 1, noise }, work, false)
        }
    };
    type Show = Box<dyn Fn(u64) -> Recording>;
    let shows: [Show; 4] = [
        Box::new(|person| shop(person, Flaw::None)),
        Box::new(with_two_hands(TwoHanded::HoldWhileWorking)),
        Box::new(with_two_hands(TwoHanded::HandOver)),
        Box::new(with_two_hands(TwoHanded::SymmetricalLift)),
    ];
    let mut found = Vec::new();
    for (work, show) in shows.iter().enumerate() {
        let job = taught(&(1..=5).map(show).collect::<Vec<_>>(), Method::default(), false);
        let all = (6..12).map(show);
        let right: Vec<Recording> = all.filter(|one| jobs(&judged(&job, one)) == [Outcome::Ok]).collect();
        found.push(Rate::of((0..cases).map(|case| {
            let mut random = Random::new(seed, &[work as u64, case]);
            let left = misread(&right[random.index(right.len())], &mut random);
            !accused(&judged(&job, &left)).is_empty()
        })));
    }
    Rate::of_groups(found).expect_at_most(0.05, "right jobs accused");
}
