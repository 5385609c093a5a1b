//! A marker that is in view twice is the reason of what is not judged because of it.

use crate::common::bench::{Bench, encode_shapes, shapes};
use crate::common::script::{object, stream};
use crate::common::work::{measure, polish, polish_and_measure};
use andon_core::anomaly::Judge;
use andon_core::config::Method;
use andon_core::couple::{Unseen, Visibility};
use andon_core::input::Frame;
use andon_core::verdict::{Level, Outcome, Reason, Verdict};

const POLISHER: u16 = 5;
const SPARE: u16 = 4;
const METER: u16 = 3;

/// The verdicts on a piece whose polisher is not seen while it polishes; in these frames its marker is in view twice.
fn judged(twice: &[(core::ops::Range<usize>, u16)], at_start_of_job: bool) -> Vec<Verdict> {
    let mut couples = stream(&[&polish(6)[..], &measure()].concat(), &[]);
    for couples in &mut couples[40..110] {
        let couple = &mut couples.hands[0];
        couple.visibility[1] = Visibility::Unseen;
        couple.unseen |= Unseen::CONTEXT | Unseen::CHANGE;
        couple.hidden_object = POLISHER;
    }
    for (frames, object) in twice {
        for couples in &mut couples[frames.clone()] {
            couples.twice |= self::object(*object);
        }
    }
    let job = polish_and_measure();
    let mut judge = Judge::<Vec<_>>::with_memory(&job, Method::default()).unwrap();
    if at_start_of_job {
        judge = judge.at_start_of_job();
    }
    let mut verdicts = Vec::new();
    for couples in &couples {
        judge.step(couples, &mut |event| verdicts.extend(event.verdict()));
    }
    judge.finish(&mut |event| verdicts.extend(event.verdict()));
    verdicts
}

fn reasons(verdicts: &[Verdict]) -> Vec<(Level, Reason, Option<u16>)> {
    let not_judged = verdicts.iter().filter(|verdict| verdict.outcome == Outcome::NotJudged);
    not_judged.map(|verdict| (verdict.level, verdict.reason, verdict.missing.object)).collect()
}

#[test]
fn what_is_not_judged_because_a_marker_is_in_view_twice_says_so() {
    let twice = reasons(&judged(&[(40..110, POLISHER)], true));
    assert!(!twice.is_empty(), "{twice:?}");
    assert!(
        twice.iter().all(|(_, reason, object)| (*reason, *object) == (Reason::MarkerTwice, Some(POLISHER))),
        "{twice:?}"
    );
}

#[test]
fn what_is_not_judged_for_another_reason_keeps_it() {
    for twice in [0..0, 0..5] {
        let unseen = reasons(&judged(&[(twice.clone(), POLISHER)], true));
        let is_unseen = |one: &(Level, Reason, Option<u16>)| one.1 == Reason::ObjectNotSeen;
        assert!(unseen.iter().any(is_unseen), "{twice:?}: {unseen:?}");
        assert!(unseen.iter().all(|one| one.1 != Reason::MarkerTwice), "{twice:?}: {unseen:?}");
    }
}

/// Whichever of them comes first, and although the other one is there for longer.
#[test]
fn of_two_markers_that_are_in_view_twice_at_once_the_one_that_was_missing_is_named() {
    for both in [[(40..110, POLISHER), (40..110, SPARE)], [(0..150, SPARE), (40..110, POLISHER)]] {
        let twice = reasons(&judged(&both, true));
        assert!(!twice.is_empty(), "{both:?}");
        let is_named = |(_, reason, object): &(Level, Reason, Option<u16>)| {
            (*reason, *object) == (Reason::MarkerTwice, Some(POLISHER))
        };
        assert!(twice.iter().all(is_named), "{twice:?}");
    }
}

#[test]
fn a_frame_says_up_to_the_couples_which_markers_it_shows_twice() {
    let mut bench = Bench::new(&[(POLISHER, [0.0, 0.025]), (SPARE, [0.3, 0.0]), (METER, [0.3, 0.3])]);
    bench.rest(30);
    let twice_in = |ids: &[u16]| -> Vec<u16> {
        let show = |frame: &Frame| Frame { twice: ids.iter().copied().collect(), ..frame.clone() };
        let frames: Vec<Frame> = bench.frames.iter().map(show).collect();
        let all = encode_shapes(&shapes(&bench.ids()), &frames);
        let mut objects = all.iter().map(|couples| couples.ids(couples.twice).collect());
        let first = objects.next().unwrap();
        assert!(objects.all(|objects: Vec<u16>| objects == first));
        first
    };
    assert!(twice_in(&[]).is_empty());
    assert_eq!(twice_in(&[POLISHER]), [POLISHER]);
    assert_eq!(twice_in(&[POLISHER, METER]), [METER, POLISHER]);
}

#[test]
fn a_marker_of_no_part_of_the_job_is_no_reason() {
    let spare = reasons(&judged(&[(40..110, SPARE)], true));
    assert_eq!(spare, reasons(&judged(&[], true)));
}
