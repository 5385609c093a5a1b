//! What the encoder says is in doubt: contacts that began or ended unseen, from frames of a scripted worker.

use crate::common::bench::{Bench, encode, encode_shapes, shapes};
use andon_core::config::Contact;
use andon_core::couple::{Couple, Unseen, Visibility};
use andon_core::input::{Frame, Side};
use andon_core::object::ContactRegion;

const TOOL: u16 = 5;
const BOX: u16 = 7;
const CUP: u16 = 9;

/// The couples of one hand.
fn couples_of(bench: &Bench, side: Side) -> Vec<Couple> {
    couples_in(bench, &bench.frames, side)
}

/// The couples of one hand in other frames of this bench.
fn couples_in(bench: &Bench, frames: &[Frame], side: Side) -> Vec<Couple> {
    encode(&bench.ids(), frames).iter().map(|couples| couples.hands[side.index()]).collect()
}

/// Nothing is seen in these frames.
fn hide_all(frames: &mut [Frame]) {
    for frame in frames {
        frame.hands.clear();
        frame.objects.clear();
    }
}

/// What a hand does with a tool at a box that it carries the tool past, in as many frames, without those that `hide` takes.
fn passing(frames: usize, hide: impl Fn(&mut [Frame])) -> Vec<Couple> {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.025]), (BOX, [0.3, 0.045])]);
    bench.hand(Side::Right, [-0.3, -0.3]).rest(20).go([0.0, 0.0], 20);
    bench.hold(Side::Right, TOOL).go([0.6, 0.0], frames).rest(20);
    hide(&mut bench.frames);
    let couples = couples_in(&bench, &bench.frames, Side::Right).into_iter();
    couples.filter(|couple| couple.context.0[3] == BOX).collect()
}

#[test]
fn two_that_are_seen_as_they_pass_each_other_may_touch_if_they_came_together_unseen() {
    // They are beside each other in frames 83 to 88.
    assert_eq!(passing(90, |_| {}), []);
    for missed in 80..95 {
        assert_eq!(
            passing(90, |frames| hide_all(&mut frames[missed..=missed])),
            [],
            "without frame {missed}"
        );
    }
    // The hand takes the tool unseen.
    let may_touch = passing(90, |frames| hide_all(&mut frames[20..82]));
    // What they do until then may be the way to each other, so neither position nor motion is measured.
    let is_in_doubt = |couple: &Couple| {
        couple.lacks(Unseen::CHANGE) && couple.position.is_none() && couple.motion.is_none()
    };
    assert!(!may_touch.is_empty() && may_touch.iter().all(is_in_doubt), "{may_touch:?}");
}

#[test]
fn two_that_pass_so_slowly_that_they_may_have_stopped_in_a_missing_frame_may_touch() {
    assert_eq!(passing(120, |_| {}), []);
    let hidden = (95..110).map(|missed| passing(120, |frames| hide_all(&mut frames[missed..=missed])));
    let may_touch: Vec<Couple> = hidden.flatten().collect();
    assert!(!may_touch.is_empty() && may_touch.iter().all(|couple| couple.lacks(Unseen::CHANGE)));
}

/// Who stirs never rests.
#[test]
fn what_moves_for_less_than_the_contact_that_the_runs_show_touches() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.2, 0.0])]);
    bench.hand(Side::Right, [0.0, 0.0]).rest(20).hold(Side::Right, TOOL).go([0.15, 0.04], 15);
    let arrived = bench.frames.len();
    for _ in 0..4 {
        bench.go([0.25, 0.04], 12).go([0.15, 0.04], 12);
    }
    let frames_at_box = |contact: Option<Contact>| {
        let mut shapes = shapes(&[TOOL, BOX]);
        let met = contact.map(|contact| ContactRegion { with: TOOL, points: Default::default(), contact });
        shapes[1].contact_regions.extend(met);
        let couples = encode_shapes(&shapes, &bench.frames);
        couples[arrived..].iter().filter(|couples| couples.hands[0].context.0[3] == BOX).count()
    };
    assert_eq!(frames_at_box(None), 0, "it passes by what it would touch within 3 cm");
    let stirs = frames_at_box(Some(Contact { on_m: 0.08, off_m: 0.12 }));
    assert!(stirs + 5 >= bench.frames.len() - arrived, "{stirs}");
}

#[test]
fn a_part_that_was_last_seen_to_leave_or_to_meet_another_one_may_have_done_so() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.2, 0.0])]);
    bench.hand(Side::Right, [0.0, 0.0]).rest(20).hold(Side::Right, TOOL).go([0.2, 0.0], 30).rest(20);
    let resting = bench.frames.len();
    bench.go([0.0, 0.0], 20).rest(20);
    let is_at_box = |couple: &Couple| couple.context.0[3] == BOX;
    let couples = couples_of(&bench, Side::Right);
    let left = couples.iter().rposition(is_at_box).unwrap() + 1;
    assert!((resting..resting + 20).contains(&left) && !couples[left].lacks(Unseen::CHANGE), "{left}");
    // Nothing is seen from the second frame in which they are apart on, or are beside each other.
    let met = couples.iter().position(is_at_box).unwrap();
    for (changed, was_at_box) in [(left, true), (met, false)] {
        let mut frames = bench.frames.clone();
        hide_all(&mut frames[changed + 2..]);
        let couples = couples_in(&bench, &frames, Side::Right);
        assert!(couples[changed - 1..=changed].iter().all(|couple| is_at_box(couple) == was_at_box));
        assert_eq!([changed - 1, changed].map(|frame| couples[frame].lacks(Unseen::CHANGE)), [false, true]);
    }
}

#[test]
fn a_part_that_slows_down_behind_another_one_has_passed_it_whatever_frames_are_missing() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.2, 0.0])]);
    bench.hand(Side::Right, [0.0, 0.0]).rest(20).hold(Side::Right, TOOL).go([0.28, 0.0], 24).rest(20);
    let at_box = |frames: &[Frame]| {
        let couples = couples_in(&bench, frames, Side::Right).into_iter();
        couples.filter(|couple| couple.context.0[3] == BOX && !couple.lacks(Unseen::CHANGE)).count()
    };
    assert_eq!(at_box(&bench.frames), 0);
    for missing in 0..1024u32 {
        let mut frames = bench.frames.clone();
        let mut index = 0;
        frames.retain(|_| {
            index += 1;
            !(35..45).contains(&index) || missing >> (index - 35) & 1 == 0
        });
        assert_eq!(at_box(&frames), 0, "without {missing:010b}");
    }
}

#[test]
fn a_part_that_is_let_go_where_the_other_one_was_hidden_may_not_touch_it_any_more() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.0, 0.02])]);
    bench.hand(Side::Right, [0.0, 0.0]).rest(20).hold(Side::Right, TOOL).rest(20);
    // The box lies where it lay.
    bench.hide(BOX).go([0.3, 0.0], 15).let_go(Side::Right).show(BOX).go([0.3, -0.3], 15).rest(20);
    let couples = couples_of(&bench, Side::Right);
    let released: Vec<&Couple> = couples.iter().filter(|couple| couple.context.is_release()).collect();
    assert!(
        !released.is_empty() && released.iter().all(|couple| couple.lacks(Unseen::CHANGE)),
        "{released:?}"
    );
}

#[test]
fn a_hand_at_rest_does_not_hold_what_the_other_one_takes_away() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0])]);
    bench.hand(Side::Left, [-0.01, 0.0]).hand(Side::Right, [0.01, 0.0]).rest(20).hold(Side::Right, TOOL);
    bench.carry([Some([0.4, 0.0]), Some([-0.01, 0.0])], 30).rest(20);
    let last = couples_of(&bench, Side::Left).iter().rposition(|couple| couple.context.is_touch()).unwrap();
    // It is 4.5 cm away in frame 26.
    assert!(last <= 26, "{last}");
}

#[test]
fn a_hand_keeps_a_hidden_part_that_the_other_one_carries_with_it_and_then_unseen() {
    let mut bench = Bench::new(&[(BOX, [0.0, 0.0])]);
    bench.hand(Side::Right, [0.02, 0.0]).hand(Side::Left, [-0.02, 0.0]).rest(20);
    bench.hold(Side::Right, BOX).carry([Some([0.02, 0.1]), Some([-0.02, 0.1])], 10);
    bench.hide(BOX).carry([Some([0.02, 0.15]), Some([-0.02, 0.15])], 5);
    bench.leave(Side::Right).carry([None, Some([-0.02, 0.3])], 15);
    let couples = couples_of(&bench, Side::Left);
    assert!(couples[3..].iter().all(|couple| couple.context.is_touch()));
}

#[test]
fn what_a_seen_hand_carries_unseen_is_not_in_a_hand_that_is_seen_with_something_else() {
    for is_tool_hidden in [false, true] {
        let mut bench = Bench::new(&[(TOOL, [0.3, 0.0]), (BOX, [-0.3, 0.0])]);
        bench.hand(Side::Right, [0.3, 0.0]).hand(Side::Left, [-0.3, 0.0]).rest(20);
        bench.hold(Side::Right, TOOL).hold(Side::Left, BOX).carry([Some([0.3, 0.1]), Some([-0.3, 0.1])], 20);
        let hidden = bench.frames.len();
        if is_tool_hidden {
            bench.hide(TOOL);
        }
        // The box comes to within a hand's breadth of the tool, but not to it.
        bench.hide(BOX).carry([Some([0.3, 0.2]), Some([0.14, 0.2])], 20);
        let couples = couples_of(&bench, Side::Right);
        assert_eq!(couples[hidden..].iter().all(|couple| !couple.lacks(Unseen::CONTEXT)), !is_tool_hidden);
    }
}

#[test]
fn a_part_that_was_seen_in_the_hand_is_held_as_it_was_then() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0])]);
    bench.hand(Side::Right, [0.0, 0.0]).hold(Side::Right, TOOL).go([0.4, 0.0], 20);
    // It goes out of sight before it is known that the hand holds it.
    bench.frames[5..].iter_mut().for_each(|frame| frame.objects.clear());
    let couples = couples_of(&bench, Side::Right);
    assert!(couples.iter().all(|couple| couple.context.0[..2] == [1, TOOL]), "{couples:?}");
    assert!(couples[7..].iter().all(|couple| couple.distances[0] < 0.01), "{couples:?}");
}

#[test]
fn a_hand_keeps_a_part_that_moved_on_while_it_was_not_seen() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0])]);
    bench.hand(Side::Right, [0.0, 0.0]).rest(20).hold(Side::Right, TOOL).go([0.4, 0.0], 30).rest(20);
    let mut frames = bench.frames.clone();
    // The tool is seen 6 cm farther than the hand was when it is hidden too.
    frames[30..36].iter_mut().for_each(|frame| frame.hands.clear());
    frames[34..46].iter_mut().for_each(|frame| frame.objects.clear());
    let couples = encode(&bench.ids(), &frames);
    assert!(couples[3..].iter().all(|couples| couples.hands[0].context.0 == [1, TOOL, 0, 0]));
}

#[test]
fn a_part_in_two_hands_goes_on_with_the_one_that_is_seen() {
    for stays in Side::ALL {
        let away = |to: [f32; 2]| if stays == Side::Right { [Some(to), None] } else { [None, Some(to)] };
        let mut bench = Bench::new(&[(BOX, [0.0, 0.0])]);
        bench.hand(Side::Right, [0.0, 0.0]).hand(Side::Left, [0.0, 0.0]).rest(20);
        bench.hold(Side::Right, BOX).carry([Some([0.0, 0.1]); 2], 10);
        bench.leave(stays.other()).hide(BOX).carry(away([0.0, 0.3]), 15).rest(10);
        let couples = couples_of(&bench, stays);
        assert!(couples[3..].iter().all(|couple| couple.context.is_touch()), "{stays:?}");
    }
}

#[test]
fn a_hand_beside_parts_that_neither_touch_nor_are_apart_is_clear() {
    // The box lies between the two distances of a contact.
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.038, 0.0]), (CUP, [-0.02, 0.0])]);
    bench.hand(Side::Right, [-0.3, 0.0]).rest(20).go([-0.02, 0.0], 20).rest(60);
    assert!(
        couples_of(&bench, Side::Right)
            .iter()
            .all(|couple| !couple.lacks(Unseen::CONTEXT) && !couple.lacks(Unseen::CHANGE))
    );
}

#[test]
fn a_hand_that_takes_a_part_may_touch_what_is_hidden_at_its_other_end() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.29, 0.0])]);
    bench.hand(Side::Right, [-0.3, 0.0]).rest(20).hide(BOX).go([0.0, 0.0], 20).rest(20);
    let mut shapes = shapes(&bench.ids());
    shapes[0].interaction_points.push([0.25, 0.0, 0.0]).unwrap();
    let couples = encode_shapes(&shapes, &bench.frames);
    let mut touches =
        couples.iter().map(|couples| couples.hands[0]).filter(|couple| couple.context.is_touch());
    assert!(touches.clone().count() > 10 && touches.all(|couple| couple.lacks(Unseen::CONTEXT)));
}

#[test]
fn a_frame_that_is_missing_hides_no_release() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0])]);
    // In frame 45 alone the hand is farther away than a touch begins.
    bench.hand(Side::Right, [0.0, 0.0]).rest(40).go([0.0405, 0.0], 6).go([0.03, 0.0], 5).rest(20);
    let released = |frames: &[Frame]| {
        let couples = encode(&bench.ids(), frames);
        couples.iter().skip(20).position(|couples| !couples.hands[0].context.is_touch())
    };
    let mut frames = bench.frames.clone();
    frames.remove(40);
    assert_eq!((released(&bench.frames), released(&frames)), (Some(20), Some(20)));
}

#[test]
fn a_part_that_vanishes_as_it_moves_may_have_been_given_by_a_hand_that_has_not_been_seen_for_long() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0])]);
    bench.hand(Side::Left, [0.0, 0.0]).hand(Side::Right, [0.5, 0.0]).rest(20).hold(Side::Left, TOOL);
    bench.carry([None, Some([0.4, 0.0])], 60).rest(20);
    bench.frames[60..].iter_mut().for_each(|frame| frame.objects.clear());
    let seen = bench.frames.clone();
    bench.frames[20..].iter_mut().for_each(|frame| frame.hands.retain(|hand| hand.side == Side::Right));
    for missing in [None, Some(54), Some(55), Some(56)] {
        let mut frames = bench.frames.clone();
        missing.into_iter().for_each(|missing: usize| frames[missing].objects.clear());
        let clear: Vec<bool> = encode(&bench.ids(), &frames)
            .iter()
            .map(|couples| !couples.hands[0].lacks(Unseen::CONTEXT))
            .collect();
        assert!(clear[..54].iter().all(|is_clear| *is_clear), "without frame {missing:?}");
        assert!(clear[60..].iter().all(|is_clear| !is_clear), "without frame {missing:?}");
    }
    // What vanishes while both hands are seen elsewhere is in neither.
    let mut slides = seen;
    for frame in &mut slides {
        frame.hands[1].tips.iter_mut().for_each(|tip| tip[1] -= 0.5);
        frame.hands[1].middle_knuckle[1] -= 0.5;
        frame.hands[1].wrist[1] -= 0.5;
    }
    let couples = encode(&bench.ids(), &slides);
    assert!(couples.iter().all(|couples| !couples.hands[0].lacks(Unseen::CONTEXT)));
}

#[test]
fn a_part_that_is_seen_in_the_hand_is_so_from_then_on_wherever_it_was_assumed() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0])]);
    bench.hand(Side::Right, [0.08, 0.0]).rest(60);
    // The hand is so near the tool that it may hide it.
    bench.frames[20..30].iter_mut().for_each(|frame| frame.objects.clear());
    bench.frames[30..].iter_mut().for_each(|frame| frame.objects[0].position[0] = 0.08);
    let couples = couples_of(&bench, Side::Right);
    // Whether it rests there is not known before.
    assert_eq!(couples.iter().position(|couple| couple.context.is_touch()), Some(33));
}

#[test]
fn an_object_that_is_first_seen_in_the_hand_may_have_been_there_before() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.3, 0.0])]);
    bench.hide(TOOL).hand(Side::Right, [0.0, 0.0]).rest(20).show(TOOL).rest(20);
    bench.go([0.3, 0.0], 20).rest(20);
    for couple in couples_of(&bench, Side::Right) {
        assert_eq!(couple.lacks(Unseen::ARRIVAL), couple.context.0[1] == TOOL, "{couple:?}");
    }
}

#[test]
fn an_object_that_is_first_seen_at_a_hand_that_holds_another_one_may_be_what_it_holds() {
    let is_object_ambiguous = |cup: [f32; 2]| {
        let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (CUP, cup)]);
        bench.hide(CUP).hand(Side::Right, [0.0, 0.0]).rest(30).hold(Side::Right, TOOL).rest(20);
        bench.show(CUP).rest(20);
        couples_of(&bench, Side::Right).last().unwrap().lacks(Unseen::TAKING)
    };
    assert_eq!([[0.0, 0.02], [0.0, 0.3]].map(is_object_ambiguous), [true, false]);
}

#[test]
fn an_object_that_is_first_seen_at_what_the_hand_holds_may_have_been_touched_before() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.01, 0.0])]);
    bench.hide(BOX).hand(Side::Right, [0.3, 0.0]).rest(20).go([0.0, 0.0], 20).rest(20).show(BOX).rest(20);
    let couples = couples_of(&bench, Side::Right);
    assert!(couples.iter().any(|couple| couple.lacks(Unseen::ARRIVAL)));
    for couple in couples {
        assert_eq!(couple.lacks(Unseen::ARRIVAL), couple.context.0[3] == BOX, "{couple:?}");
    }
}

/// The hand goes on being seen: it is the part that cannot be followed.
#[test]
fn a_part_of_which_too_few_frames_come_is_carried_although_no_hand_is_known_to_hold_it() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.6, 0.2])]);
    bench.hand(Side::Right, [0.0, 0.0]).rest(30);
    bench.hold(Side::Right, TOOL).go([0.5, 0.0], 40).rest(30);
    for (every, is_carried) in [(1, false), (3, false), (8, true), (12, true)] {
        let frames: Vec<Frame> = bench.frames.iter().step_by(every).cloned().collect();
        let couples = encode(&bench.ids(), &frames);
        assert_eq!(couples.iter().any(|couples| couples.lacks(Unseen::CARRIER)), is_carried, "1 of {every}");
    }
    // It is only elsewhere after a gap.
    let (before, after) = (&bench.frames[..30], &bench.frames[70..]);
    let couples = encode(&bench.ids(), &[before, after].concat());
    assert!(!couples.iter().any(|couples| couples.lacks(Unseen::CARRIER)));
}

#[test]
fn a_part_that_was_hidden_longer_than_the_hand_and_is_then_elsewhere_has_moved_unseen() {
    let moved = |hidden: bool| {
        let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.6, 0.2])]);
        bench.hand(Side::Right, [0.3, -0.3]).rest(30);
        if hidden {
            bench.hide(TOOL).rest(30).leave(Side::Right).rest(60);
        }
        bench.hand(Side::Right, [0.3, -0.3]).rest(10);
        let mut frames = bench.show(TOOL).rest(30).frames.clone();
        let (from, count) = (frames.len() - 30, frames.len());
        for object in frames[from..count].iter_mut().flat_map(|frame| &mut frame.objects) {
            if object.id == TOOL {
                object.position[0] = 0.2;
            }
        }
        encode(&bench.ids(), &frames).iter().filter(|couples| couples.lacks(Unseen::MOVER)).count()
    };
    assert_eq!(moved(true), 1);
    assert_eq!(moved(false), 0, "a hand was seen all the time");
}

#[test]
fn a_bench_is_hidden_where_a_part_vanishes_without_a_hand_but_not_because_one_lies_under_another() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.3, 0.0])]);
    bench.hand(Side::Right, [0.3, 0.0]).rest(20).hide(BOX).rest(40).leave(Side::Right).rest(20);
    let hidden = |frames: &[Frame]| -> Vec<usize> {
        let couples = encode(&bench.ids(), frames);
        (0..couples.len()).filter(|frame| couples[*frame].lacks(Unseen::BENCH)).collect()
    };
    assert!(hidden(&bench.frames).is_empty());
    let mut frames = bench.frames.clone();
    hide_all(&mut frames[65..70]);
    assert_eq!(hidden(&frames), (65..70).collect::<Vec<_>>());
    frames[75].objects.clone_from(&bench.frames[0].objects);
    assert_eq!(hidden(&frames), (65..70).chain(76..80).collect::<Vec<_>>(), "the box was in sight again");
    let mut frames = bench.frames.clone();
    frames[55].objects.clone_from(&bench.frames[0].objects);
    assert_eq!(hidden(&frames), (60..80).collect::<Vec<_>>(), "the box vanished just before the hand");
}

#[test]
fn a_hand_that_was_last_seen_to_move_away_may_have_let_go_before() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0])]);
    bench.hand(Side::Right, [0.0, 0.0]).rest(40).go([0.3, 0.0], 20);
    // In frame 43 the hand is 2 cm away.
    hide_all(&mut bench.frames[44..60]);
    let couples = couples_of(&bench, Side::Right);
    // One frame that is hidden is enough.
    assert!(couples[40..42].iter().all(|couple| couple.context.is_touch() && couple.lacks(Unseen::CHANGE)));
    assert!(couples[3..38].iter().all(|couple| !couple.lacks(Unseen::CHANGE)));
}

#[test]
fn a_hand_that_was_last_seen_to_move_along_a_part_may_have_let_go_of_it() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0])]);
    bench.hand(Side::Right, [0.0, 0.0]).rest(40).go([0.3, 0.0], 20);
    // In frame 43 the hand is at the other end of the tool.
    hide_all(&mut bench.frames[44..60]);
    let mut shapes = shapes(&bench.ids());
    shapes[0].interaction_points.push([0.02, 0.0, 0.0]).unwrap();
    let couples = encode_shapes(&shapes, &bench.frames);
    let is_doubtful = |frame: usize| couples[frame].hands[0].lacks(Unseen::CHANGE);
    assert!(couples[41].hands[0].context.is_touch() && is_doubtful(40) && is_doubtful(41));
    assert!(!is_doubtful(30));
}

#[test]
fn what_is_elsewhere_for_a_few_frames_is_misread_and_what_stays_there_was_moved() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.3, 0.0])]);
    bench.hand(Side::Right, [0.0, 0.0]).rest(20).hold(Side::Right, TOOL).rest(60);
    let leapt = |frames: std::ops::Range<usize>| -> Vec<Couple> {
        let mut leapt = bench.frames.clone();
        leapt[frames].iter_mut().for_each(|frame| frame.objects[0].position[0] += 0.25);
        encode(&bench.ids(), &leapt).iter().map(|couples| couples.hands[0]).collect()
    };
    for couples in [leapt(40..41), leapt(40..45)] {
        assert!(couples[20..].iter().all(|couple| couple.context.0 == [1, TOOL, 0, 0]), "{couples:?}");
        assert!(
            couples[40].visibility[1] != Visibility::Seen && couples[45].visibility[1] == Visibility::Seen
        );
    }
    let couples = leapt(40..80);
    assert!(couples[50..].iter().all(|couple| couple.context.0[1] != TOOL), "the hand is not there");
}

#[test]
fn what_moves_fast_is_seen_all_the_way() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0])]);
    // Half a metre in a third of a second.
    bench.hand(Side::Right, [0.0, 0.0]).rest(20).hold(Side::Right, TOOL).go([0.5, 0.0], 10).rest(20);
    let couples = couples_of(&bench, Side::Right);
    assert!(couples.iter().all(|couple| couple.visibility == [Visibility::Seen; 3]), "{couples:?}");
}

#[test]
fn an_object_that_was_moved_while_it_was_hidden_may_have_been_used_until_a_hand_begins_with_it() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.5, 0.3])]);
    bench.hand(Side::Right, [-0.3, 0.0]).rest(40).go([0.2, 0.0], 20).rest(20);
    bench.go([0.2, -0.3], 20).rest(20).go([0.2, 0.0], 20).rest(20);
    bench.frames[10..30].iter_mut().for_each(|frame| frame.objects.retain(|object| object.id != TOOL));
    bench.frames[30..].iter_mut().for_each(|frame| frame.objects[0].position[0] = 0.2);
    let couples = couples_of(&bench, Side::Right);
    let began = |pair: &&[Couple]| !pair[0].context.is_touch() && pair[1].context.is_touch();
    let touches: Vec<bool> =
        couples.windows(2).filter(began).map(|pair| pair[1].lacks(Unseen::MOVE)).collect();
    assert_eq!(touches, [true, false]);
}

/// One hand brings the part to what the other one holds.
#[test]
fn a_part_that_was_moved_while_it_was_hidden_is_so_for_both_hands_that_are_at_it() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.5, 0.0])]);
    bench.hand(Side::Right, [0.0, 0.0]).hand(Side::Left, [0.5, 0.0]).rest(30);
    bench.hold(Side::Right, TOOL).hold(Side::Left, BOX);
    bench.carry([Some([0.49, 0.0]), None], 20).rest(40);
    for frame in &mut bench.frames[5..70] {
        frame.objects.retain(|object| object.id != TOOL);
        frame.hands.retain(|hand| hand.side != Side::Right);
    }
    for side in Side::ALL {
        let couples = couples_of(&bench, side);
        assert!(couples.iter().any(|couple| couple.lacks(Unseen::MOVE)), "{side:?}");
    }
}

#[test]
fn what_is_seen_apart_from_a_hand_that_has_let_go_is_not_what_it_took() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (CUP, [0.0, 0.02]), (BOX, [0.3, 0.0])]);
    bench
        .hand(Side::Right, [0.0, -0.3])
        .rest(20)
        .go([0.0, 0.0], 20)
        .hide(CUP)
        .hold(Side::Right, TOOL)
        .rest(10);
    bench.show(CUP).go([0.3, 0.01], 30).rest(20).let_go(Side::Right).go([0.3, -0.3], 30).rest(30);
    let couples = couples_of(&bench, Side::Right);
    let is_object_ambiguous = |is_release: bool| -> Vec<bool> {
        let all = couples.iter().filter(|couple| couple.context.0[2] == TOOL && couple.context.0[3] == BOX);
        all.filter(|couple| couple.context.is_release() == is_release)
            .map(|couple| couple.lacks(Unseen::TAKING))
            .collect()
    };
    let (held, released) = (is_object_ambiguous(false), is_object_ambiguous(true));
    assert!(!held.is_empty() && held.iter().all(|is| *is), "it may hold the cup: {held:?}");
    assert!(!released.is_empty() && !released[released.len() - 1], "it holds nothing: {released:?}");
}

#[test]
fn an_object_is_out_of_sight_until_it_is_seen_and_when_it_is_hidden_for_long() {
    let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.5, 0.3])]);
    bench.hide(TOOL).hand(Side::Right, [-0.3, 0.0]).rest(10).show(TOOL).rest(10).hide(TOOL).rest(40);
    let couples = encode(&bench.ids(), &bench.frames);
    let hidden: Vec<usize> = (0..60).filter(|frame| !couples[*frame].out_of_sight.is_empty()).collect();
    // `blind_ms` are 21 frames.
    assert_eq!(hidden, (0..10).chain(41..60).collect::<Vec<_>>());
    assert_eq!(couples[0].ids(couples[0].out_of_sight).collect::<Vec<_>>(), [TOOL]);
}
