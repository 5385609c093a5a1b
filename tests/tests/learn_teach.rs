//! From runs to a job file that can be trusted: what teaching keeps, reports and refuses.
#![allow(clippy::unwrap_used)]

use andon_core::config::Method;
use andon_core::input::Frame;
use andon_core::verdict::{Level, Measure, Measured, Outcome, Reason, Verdict};
use andon_learn::distribution::Distribution;
use andon_learn::job_file::{JobFault, JobFile};
use andon_learn::rule::ThresholdRule;
use andon_learn::run::Run;
use andon_learn::run_summary::RunSummary;
use andon_learn::strictness::Strictness;
use andon_learn::teach::{TeachError, TeachOptions, TeachReport, teach};
use andon_tests::deletion::Deletion;
use andon_tests::fuzz::seal;
use andon_tests::simulator::{Expected, Flaw, Noise, Performance, Random, perform};
use andon_tests::station::without_points;

/// The part that the brick is rubbed with.
const POLISHER: u16 = 5;

/// The part that is measured.
const BRICK: u16 = 6;

/// A seed that played no part in the choice of the rules.
const SEED: u64 = 2002;

fn run(person: u64, repetition: u64, flaw: Flaw) -> Run {
    let performance = Performance { seed: SEED, person, repetition, noise: Noise::default() };
    let (recording, _) = perform(&performance, flaw);
    Run::new(&format!("p{person}_r{repetition}"), "", &recording, &Method::default()).unwrap()
}

fn correct(count: u64) -> Vec<Run> {
    (1..=count).map(|person| run(person, 1, Flaw::None)).collect()
}

fn options() -> TeachOptions {
    TeachOptions::new("polish and measure", "2025-01-01", Method::default())
}

fn taught(runs: &[Run]) -> (JobFile, TeachReport) {
    teach(runs, &options()).unwrap()
}

fn judged(job: &JobFile, run: &Run) -> Vec<Verdict> {
    run.judge(job).unwrap()
}

fn job_is(outcome: Outcome, verdicts: &[Verdict]) -> bool {
    verdicts.iter().any(|verdict| verdict.level == Level::Job && verdict.outcome == outcome)
}

#[test]
fn a_part_that_lies_turned_otherwise_in_each_run_and_goes_the_same_way_is_position_only() {
    let turned = |person: u64, turn: f32| {
        let performance = Performance { seed: SEED, person, repetition: 1, noise: Noise::default() };
        let mut recording = without_points(perform(&performance, Flaw::None).0);
        for object in recording.frames.iter_mut().flat_map(|frame| &mut frame.objects) {
            if object.id == BRICK {
                let [w, _, _, z] = object.orientation;
                let (sin, cos) = (turn / 2.0).sin_cos();
                object.orientation = [w * cos - z * sin, 0.0, 0.0, w * sin + z * cos];
            }
        }
        Run::new(&format!("{person}"), "", &recording, &Method::default()).unwrap()
    };
    for (turns, is_position_only) in [([0.0; 5], false), ([0.0, 1.3, 2.5, 3.8, 5.0], true)] {
        let runs: Vec<Run> = (1..=5).zip(turns).map(|(person, turn)| turned(person, turn)).collect();
        let (job, report) = teach(&runs, &TeachOptions { order_matters: Some(false), ..options() }).unwrap();
        let found = job.objects.iter().filter(|object| object.shape.is_position_only);
        let found: Vec<u16> = found.map(|object| object.shape.id).collect();
        assert_eq!(found, if is_position_only { vec![BRICK] } else { vec![] }, "{report}");
        assert_eq!(report.to_string().contains("only its position counts"), is_position_only, "{report}");
        let read = JobFile::parse("job.toml", job.to_toml().as_bytes()).unwrap();
        assert_eq!(read.objects, job.objects);
    }
}

#[test]
fn a_run_shows_its_steps_where_nobody_says_where_parts_are_touched() {
    let performance = Performance { seed: SEED, person: 1, repetition: 1, noise: Noise::default() };
    let recording = without_points(perform(&performance, Flaw::None).0);
    let run = Run::new("p1", "", &recording, &Method::default()).unwrap();
    let seen = RunSummary::of(&run, &Method::default());
    let steps: Vec<&str> = seen.steps.iter().map(|(step, _)| step.as_str()).collect();
    assert_eq!(
        steps,
        ["right hand: polisher at brick", "right hand: brick at meter"],
        "{:?}",
        run.activities.len()
    );
}

fn position(frame: &Frame, id: u16) -> Option<[f32; 3]> {
    frame.objects.iter().find(|object| object.id == id).map(|object| object.position)
}

#[test]
fn a_part_that_is_put_down_beside_where_it_lay_is_not_moved_for_good() {
    // The hand puts the polisher down this far from its first place.
    let put_down = |person: u64, away_m: f32| {
        let performance = Performance { seed: SEED, person, repetition: 1, noise: Noise::default() };
        let (mut recording, _) = perform(&performance, Flaw::None);
        let positions: Vec<_> = recording.frames.iter().map(|frame| position(frame, POLISHER)).collect();
        let [first, last] = [positions.iter().flatten().next(), positions.iter().flatten().next_back()];
        let ([x, y, _], last) = (*first.unwrap(), *last.unwrap());
        let is_elsewhere =
            |at: &Option<[f32; 3]>| at.is_some_and(|at| (at[0] - last[0]).hypot(at[1] - last[1]) > 0.01);
        let put_down = positions.iter().rposition(is_elsewhere).unwrap();
        let shift = [x - away_m - last[0], y - last[1]];
        for (index, frame) in recording.frames.iter_mut().enumerate().skip(put_down - 30) {
            let share = ((index + 30 - put_down) as f32 / 30.0).min(1.0);
            let shifted = |at: &mut [f32; 3]| (0..2).for_each(|axis| at[axis] += share * shift[axis]);
            frame
                .objects
                .iter_mut()
                .filter(|object| object.id == POLISHER)
                .for_each(|object| shifted(&mut object.position));
            for hand in &mut frame.hands {
                hand.tips.iter_mut().chain([&mut hand.wrist, &mut hand.middle_knuckle]).for_each(shifted);
            }
        }
        Run::new(&format!("{person}"), "", &recording, &Method::default()).unwrap()
    };
    for (away_m, is_for_good) in [(0.06, false), (0.3, true)] {
        let (job, _) = taught(&[put_down(1, away_m), put_down(2, away_m)]);
        let polisher = job.objects.iter().find(|object| object.shape.id == POLISHER).unwrap();
        assert_eq!(polisher.shape.start.is_some(), is_for_good, "{away_m} m: {:?}", polisher.shape.start);
    }
}

#[test]
fn the_same_runs_give_the_same_bytes() {
    assert_eq!(taught(&correct(3)).0.to_toml(), taught(&correct(3)).0.to_toml());
}

#[test]
fn a_job_that_is_taught_again_as_it_was_taught_has_the_same_bytes() {
    for strictness in [1, 5].map(Strictness::new) {
        let options =
            TeachOptions { id: 4, order_matters: Some(true), rule: ThresholdRule::PAPER, ..options() };
        let (job, _) = teach(&correct(3), &options.with_strictness(strictness.unwrap())).unwrap();
        let read = JobFile::parse("job.toml", job.to_toml().as_bytes()).unwrap();
        let (again, _) = teach(&correct(3), &TeachOptions::of_job(&read, "2025-01-01")).unwrap();
        assert_eq!(again.to_toml(), job.to_toml());
    }
}

#[test]
fn a_stricter_job_notices_more_and_says_what_it_promises() {
    let runs = correct(5);
    let taught = [1, 3, 5]
        .map(|number| teach(&runs, &options().with_strictness(Strictness::new(number).unwrap())).unwrap());
    let path_m = |job: &JobFile| job.activities[0].ius[1].measures.path_m;
    for pair in taught.windows(2) {
        let [loose, strict] = [&pair[0].0, &pair[1].0].map(path_m);
        assert!(loose.min < strict.min && strict.max < loose.max, "{loose:?} {strict:?}");
    }
    for ((job, report), (number, one_in)) in taught.iter().zip([(1, 133), (3, 33), (5, 8)]) {
        let promise = format!("the measures are set to accuse one of {one_in} right jobs");
        assert!(report.to_string().contains(&promise), "{report}");
        assert!(job.to_toml().contains(&format!("\nstrictness = {number}\n")));
    }
}

#[test]
fn the_report_says_what_would_be_noticed_of_each_step_and_what_more_runs_would_bring() {
    let report = taught(&correct(5)).1.to_string();
    let begin = report.find("what would be noticed: the smallest difference").unwrap();
    let rows: Vec<&str> = report[begin..].lines().skip(2).take(5).collect();
    // Six strokes: one less is noticed or one more, and half a second less.
    let strokes: Vec<&str> = rows[1].split_whitespace().collect();
    assert_eq!(strokes[..2], ["1", "2"], "{report}");
    let [less, more] = [strokes[2], strokes[3]].map(|figure| figure.parse::<f64>().unwrap());
    assert!((-2.0..0.0).contains(&less) && (0.5..2.5).contains(&more), "{report}");
    assert!(report.contains("5 more runs like these would bring these bounds "), "{report}");
}

#[test]
fn a_verdict_on_half_of_the_strokes_counts_them() {
    let (job, _) = taught(&correct(5));
    let verdicts = judged(&job, &run(6, 1, Flaw::J1));
    for level in [Level::Iu, Level::Activity, Level::Job] {
        let wrong = |verdict: &&Verdict| verdict.level == level && verdict.outcome == Outcome::Anomaly;
        let measured = verdicts.iter().find(wrong).unwrap().measured.unwrap();
        let Measured { measure, value, shown_min, shown_max } = measured;
        assert_eq!((measure, value, shown_min, shown_max), (Measure::Strokes, 3.0, 6.0, 6.0));
    }
}

#[test]
fn a_job_file_is_read_as_it_was_written() {
    for rule in
        [ThresholdRule::PAPER, ThresholdRule::default(), ThresholdRule::Conformal { false_alarms: 0.05 }]
    {
        let (job, _) = teach(&correct(3), &TeachOptions { rule, ..options() }).unwrap();
        assert_eq!(JobFile::parse("job.toml", job.to_toml().as_bytes()).unwrap(), job);
    }
}

/// Some job files have all that the runs measured, and the shipped one has only the ranges.
#[test]
fn a_job_file_that_calls_the_lateral_deviation_bow_is_still_read_and_has_its_own_hash() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../config/jobs/polish-and-measure.toml");
    let shipped = JobFile::parse(path, &std::fs::read(path).unwrap()).unwrap();
    for (job, kept) in [(taught(&correct(4)).0, "\nbow_m = ["), (shipped, ", bow_m = 0")] {
        let job = JobFile { step_names: Vec::new(), ..job };
        let old = seal(&job.to_toml().replace("lateral_deviation_m", "bow_m")).unwrap();
        assert!(["\nmax_bow_m = 0", kept].iter().all(|key| old.contains(key)), "{old}");
        let read = JobFile::parse("old.toml", old.as_bytes()).unwrap();
        assert_eq!((read.to_toml(), read.model_hash() == job.model_hash()), (old, false));
        assert_eq!(JobFile { older: None, ..read }, job);
    }
}

#[test]
fn a_changed_digit_is_noticed() {
    let text = taught(&correct(3)).0.to_toml();
    let index = text.find("threshold = ").unwrap() + "threshold = ".len();
    let mut bytes = text.into_bytes();
    bytes[index] = if bytes[index] == b'9' { b'8' } else { bytes[index] + 1 };
    let error = JobFile::parse("job.toml", &bytes).unwrap_err();
    assert!(matches!(error.fault, JobFault::Checksum { .. }), "{error}");
}

#[test]
fn one_run_is_enough_with_a_warning() {
    let (job, report) = taught(&correct(1));
    assert!(report.to_string().starts_with("usable with care, because one run shows neither"), "{report}");
    assert!(job_is(Outcome::Ok, &judged(&job, &run(5, 1, Flaw::None))));
    assert!(job_is(Outcome::Anomaly, &judged(&job, &run(5, 1, Flaw::J1))));
}

#[test]
fn a_run_that_disagrees_is_named_with_the_iu_where_it_does() {
    let mut runs = correct(4);
    runs.insert(2, run(7, 1, Flaw::J2));
    let (job, report) = taught(&runs);
    let mut warnings = report.warnings().into_iter().map(|warning| warning.text);
    let warning = warnings.find(|warning| warning.contains("p7_r1")).unwrap();
    assert!(warning.contains("its step 2 ends before IU 2"), "{warning}");
    assert!(warning.contains("meter"), "{warning}");
    let left_out: Vec<bool> = job.provenance.sources.iter().map(|source| source.left_out).collect();
    assert_eq!(left_out, [false, false, true, false, false]);
}

#[test]
fn runs_with_more_objects_together_than_a_bench_may_have_are_refused_with_their_number() {
    let with_objects_from = |first: u16| {
        let performance =
            Performance { seed: SEED, person: 1, repetition: u64::from(first), noise: Noise::default() };
        let (mut recording, _) = perform(&performance, Flaw::None);
        let mut object = recording.header.objects[0].clone();
        for id in first..first + 20 {
            object.shape.id = id;
            recording.header.objects.push(object.clone());
        }
        Run::new("run", "", &recording, &Method::default()).unwrap()
    };
    let refused = teach(&[with_objects_from(100), with_objects_from(200)], &options());
    assert!(matches!(refused, Err(TeachError::Full { what: "objects", max: 32, .. })), "{refused:?}");
}

#[test]
fn nothing_can_be_taught_from_nothing() {
    assert!(matches!(teach(&[], &options()), Err(TeachError::NoRun)));
}

/// A run whose recording was changed.
fn changed(change: impl Fn(&mut Frame)) -> Run {
    let performance = Performance { seed: SEED, person: 1, repetition: 1, noise: Noise::default() };
    let (mut recording, _) = perform(&performance, Flaw::None);
    recording.frames.iter_mut().for_each(change);
    Run::new("changed", "", &recording, &Method::default()).unwrap()
}

#[test]
fn nothing_can_be_taught_from_runs_that_have_nothing_in_common() {
    let without_hands = || changed(|frame| frame.hands.clear());
    let runs = [without_hands(), without_hands()];
    let error = teach(&runs, &options()).unwrap_err();
    assert!(error.to_string().contains("the one run shows no step"), "{error}");
}

/// A release state lasts until the hand comes back.
#[test]
fn a_bound_that_is_open_is_written_as_a_word() {
    let (job, _) = taught(&correct(3));
    let text = job.to_toml();
    assert!(text.contains("frames = [0, \"unbounded\"]\nreversals = [0, \"unbounded\"]\n"), "{text}");
    assert!(!text.contains("4294967295"), "{text}");
    assert_eq!(JobFile::parse("job.toml", text.as_bytes()).unwrap(), job);
}

/// The expected verdict is defined with the flaw, and independent of the method.
#[test]
fn five_runs_distinguish_every_flaw_of_a_shop_floor_from_harmless_variations() {
    let (job, _) = taught(&correct(5));
    for flaw in Flaw::ALL {
        let verdicts = judged(&job, &run(6, 1, flaw));
        let (ok, wrong) = (job_is(Outcome::Ok, &verdicts), job_is(Outcome::Anomaly, &verdicts));
        let as_expected = match flaw.expected() {
            Expected::Ok => ok && !wrong,
            Expected::Anomaly => wrong,
            Expected::NotOk => !ok,
        };
        assert!(as_expected, "{}: {verdicts:#?}", flaw.name());
    }
}

/// What a line that processes only every n-th frame sees of a run.
fn thinned(person: u64, flaw: Flaw, every: usize) -> Run {
    let performance = Performance { seed: SEED, person, repetition: 1, noise: Noise::default() };
    let whole = perform(&performance, flaw).0;
    let left = Deletion::Every(every).of(&whole, &mut Random::new(SEED, &[]));
    Run::new("thinned", "", &left, &Method::default()).unwrap()
}

#[test]
fn a_job_states_the_rate_at_which_its_own_runs_are_still_right_and_below_it_nothing_is_accused_or_right() {
    let (job, report) = taught(&correct(4));
    let all = Method::default().rate_hz;
    let [every, most] = [report.recognised_hz, job.min_rate_hz].map(|hz| (all / hz).round() as usize);
    assert!(most >= every && every > 1 && job.min_rate_hz > 1.0, "{every} {most}");
    assert!(
        report.to_string().contains(&format!("needs {:.1} of {all:.1} frames", job.min_rate_hz)),
        "{report}"
    );
    for person in 1..=4 {
        let said = |flaw, every| judged(&job, &thinned(person, flaw, every));
        if job_is(Outcome::Ok, &said(Flaw::None, 1)) {
            assert!(job_is(Outcome::Ok, &said(Flaw::None, every)), "person {person}");
        }
        assert!(!job_is(Outcome::Anomaly, &said(Flaw::None, most)), "person {person}");
        let few = said(Flaw::None, most + 2);
        assert!(job_is(Outcome::NotJudged, &few), "person {person}");
        assert!(few.iter().all(|verdict| verdict.outcome != Outcome::Anomaly), "person {person}");
        assert!(few.iter().any(|verdict| verdict.reason == Reason::TooFewFrames), "person {person}");
        for every in [every, most, most + 2] {
            assert!(!job_is(Outcome::Ok, &said(Flaw::J1, every)), "person {person}, every {every}th frame");
        }
    }
}

#[test]
fn what_each_run_measured_is_kept_sorted_with_the_job_and_verdicts_name_its_range() {
    let (job, _) = taught(&correct(4));
    let read = JobFile::parse("job.toml", job.to_toml().as_bytes()).unwrap();
    assert_eq!((&read, read.model_hash()), (&job, job.model_hash()));
    let polishing = &read.activities[0].ius[1];
    let (values, shown) = (polishing.shown.clone().unwrap(), polishing.measures.shown.unwrap());
    for of in [
        &values.frames,
        &values.reversals,
        &values.path_m,
        &values.lateral_m,
        &values.place_m,
        &values.distance,
    ] {
        assert!(of.len() == 4 && of.is_sorted(), "{values:?}");
    }
    assert_eq!([values.frames[0], values.frames[3]], [shown.frames.min as f32, shown.frames.max as f32]);
    let mut unsorted = job;
    unsorted.activities[0].ius[1].shown.as_mut().unwrap().frames.reverse();
    let refused = JobFile::parse("job.toml", unsorted.to_toml().as_bytes()).unwrap_err().to_string();
    assert!(refused.contains("activity[0].iu[1].runs.frames: the values must be sorted"), "{refused}");
}

#[test]
fn an_accusation_says_where_the_execution_lies_among_the_runs_also_of_a_job_that_has_only_their_range() {
    let (mut job, _) = taught(&correct(4));
    let half = run(5, 1, Flaw::J1);
    let lies = |job: &JobFile| -> Vec<Distribution> {
        judged(job, &half).iter().filter_map(|verdict| Distribution::of_verdict(job, verdict)).collect()
    };
    let [known] = &lies(&job)[..] else { unreachable!("one IU is wrong") };
    assert_eq!((known.measure, known.runs, known.shown.len()), (Some(Measure::Strokes), 4, 4));
    assert!(known.right.unwrap()[0].is_some_and(|least| known.value < least), "{known}");
    for iu in job.activities.iter_mut().flat_map(|taught| &mut taught.ius) {
        iu.shown = None;
    }
    let old = JobFile::parse("old.toml", job.to_toml().as_bytes()).unwrap();
    let [range] = &lies(&old)[..] else { unreachable!("one IU is wrong") };
    assert_eq!((&range.shown[..], range.runs, range.right), (&[][..], 4, known.right));
    assert_eq!([range.place(), known.place()], ["less than all 4 shown"; 2]);
}

#[test]
fn a_motion_that_differs_says_how_far_the_motions_of_the_runs_are_from_each_other() {
    let (mut job, _) = taught(&correct(4));
    for iu in job.activities.iter_mut().flat_map(|taught| &mut taught.ius) {
        iu.threshold /= 100.0;
    }
    let verdicts = judged(&job, &run(5, 1, Flaw::None));
    let lies = verdicts.iter().find_map(|verdict| Distribution::of_verdict(&job, verdict)).unwrap();
    let [least, most] = lies.right.unwrap();
    assert_eq!((lies.measure, lies.shown.len(), least), (None, 4, None));
    assert!(most.is_some_and(|most| lies.value > most), "{lies}");
}

#[test]
fn a_job_file_that_states_no_rate_is_read_as_before_and_has_its_own_hash() {
    let (mut job, _) = taught(&correct(3));
    job.min_rate_hz = 0.0;
    let text = job.to_toml();
    assert!(!text.contains("min_rate_hz"));
    let read = JobFile::parse("job.toml", text.as_bytes()).unwrap();
    assert_eq!((read.model_hash(), read.to_toml()), (job.model_hash(), text));
}
