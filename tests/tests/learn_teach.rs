//! From runs to a job file that can be trusted: what teaching keeps, reports and refuses.
#![allow(clippy::unwrap_used)]

use andon_core::config::Method;
use andon_core::input::Frame;
use andon_core::verdict::{Level, Outcome, Reason, Verdict};
use andon_learn::job_file::{JobFault, JobFile};
use andon_learn::rule::ThresholdRule;
use andon_learn::run::Run;
use andon_learn::teach::{TeachError, TeachOptions, TeachReport, teach};
use andon_tests::deletion::Deletion;
use andon_tests::simulator::{Expected, Flaw, Noise, Performance, Random, perform};

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
    job.with_job(|lent| run.judge(lent, &Method::default())).unwrap()
}

fn job_is(outcome: Outcome, verdicts: &[Verdict]) -> bool {
    verdicts.iter().any(|verdict| verdict.level == Level::Job && verdict.outcome == outcome)
}

#[test]
fn the_same_runs_give_the_same_bytes() {
    assert_eq!(taught(&correct(3)).0.to_toml(), taught(&correct(3)).0.to_toml());
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

#[test]
fn the_shipped_job_is_as_the_code_writes_it() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../config/jobs/polish-and-measure.toml");
    let text = std::fs::read_to_string(path).unwrap();
    assert_eq!(JobFile::parse(path, text.as_bytes()).unwrap().to_toml(), text);
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
    let warning = report.warnings().into_iter().find(|warning| warning.contains("p7_r1")).unwrap();
    assert!(warning.contains("activity 2, IU 2"), "{warning}");
    assert!(warning.contains("meter"), "{warning}");
    let left_out: Vec<bool> = job.provenance.sources.iter().map(|source| source.left_out).collect();
    assert_eq!(left_out, [false, false, true, false, false]);
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
    assert!(error.to_string().contains("have no activity in common"), "{error}");
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

/// What a line sees of a run that looks at every so many frames only.
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
    let every = (all / job.min_rate_hz).round() as usize;
    assert!(every > 1 && job.min_rate_hz > 1.0, "{}", job.min_rate_hz);
    assert!(
        report.to_string().contains(&format!("needs {:.1} of {all:.1} frames", job.min_rate_hz)),
        "{report}"
    );
    for person in 1..=4 {
        let said = |flaw, every| judged(&job, &thinned(person, flaw, every));
        if job_is(Outcome::Ok, &said(Flaw::None, 1)) {
            assert!(job_is(Outcome::Ok, &said(Flaw::None, every)), "person {person}");
        }
        let few = said(Flaw::None, every + 2);
        assert!(job_is(Outcome::NotJudged, &few), "person {person}");
        assert!(few.iter().all(|verdict| verdict.outcome != Outcome::Anomaly), "person {person}");
        assert!(few.iter().any(|verdict| verdict.reason == Reason::Overload), "person {person}");
        assert!(!job_is(Outcome::Ok, &said(Flaw::J1, every + 2)), "person {person}");
    }
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
