//! Encoder and segmenter on anything that may happen on a bench.

use crate::common::bench::{Bench, PERIOD_NS, encode, shapes};
use crate::common::script::{Motions, Part, Still, Strokes, Toward, idle, part, stream};
use andon_core::config::{Contact, Method};
use andon_core::couple::{Context, Couples, Encoder, Refused, Unseen};
use andon_core::input::{Frame, Hand, Object, Point, Side};
use andon_core::object::ObjectShape;
use andon_core::segment::{Event, HandEvent, JobSegmenter};
use proptest::prelude::*;

const TOOL: u16 = 5;
const BOX: u16 = 7;

/// A hand that takes a tool to several positions, some of them at the box, and may let go of it in between. It is no faster than people are.
fn worker() -> impl Strategy<Value = Vec<Frame>> {
    let leg = (-30..30i16, -30..30i16, 15..40usize, any::<bool>(), any::<bool>());
    prop::collection::vec(leg, 1..5).prop_map(|legs| {
        let mut bench = Bench::new(&[(TOOL, [0.0, 0.0]), (BOX, [0.2, 0.1])]);
        bench.hand(Side::Right, [0.0, -0.2]).rest(8).go([0.0, 0.0], 12).rest(8).hold(Side::Right, TOOL);
        for (x, y, frames, to_the_box, lets_go) in legs {
            let to = if to_the_box { [0.2, 0.09] } else { [f32::from(x) / 100.0, f32::from(y) / 100.0] };
            bench.go(to, frames).rest(8);
            if lets_go {
                bench.let_go(Side::Right);
            }
        }
        bench.frames
    })
}

fn encoder() -> Encoder {
    Encoder::new(Method::default(), &shapes(&[TOOL, BOX])).unwrap()
}

/// A possible sequence of contexts of one hand.
fn parts() -> impl Strategy<Value = Vec<Part>> {
    let motions = prop_oneof![
        Just(Still),
        (1..9i8).prop_map(Toward),
        (1..7usize).prop_map(|strokes: usize| -> Motions { Strokes(strokes) })
    ];
    let one = (0..6usize, 1..60usize, motions).prop_map(|(which, frames, motions)| {
        let context = [[1, 5, 0, 0], [1, 5, 5, 7], [1, 5, 5, 8], [1, 6, 0, 0], [1, 6, 6, 5], [0; 4]][which];
        part(context, frames, motions)
    });
    prop::collection::vec(one, 1..12).prop_map(|mut parts| {
        parts.push(idle(5));
        parts
    })
}

fn distance(a: &[Point], b: &[Point]) -> f64 {
    let square =
        |a: &Point, b: &Point| (0..2).map(|k| (f64::from(a[k]) - f64::from(b[k])).powi(2)).sum::<f64>();
    a.iter().flat_map(|a| b.iter().map(move |b| square(a, b))).fold(f64::INFINITY, f64::min).sqrt()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    /// Of all paths over two edges, the one with the shortest first edge, then second edge, is the one that Dijkstra's search finds.
    #[test]
    fn the_path_from_the_hand_is_the_shortest_of_all(
        at in prop::collection::vec((-40..40i16, -40..40i16, 0..628i16), 1..12),
        tips in [(-20..20i16, -20..20i16), (-20..20i16, -20..20i16), (-20..20i16, -20..20i16)],
    ) {
        let millimetres = |x: i16| f32::from(x) / 1000.0;
        let tips = tips.map(|(x, y)| [millimetres(x), millimetres(y), 0.0]);
        let own = [[0.0, 0.0, 0.0], [0.02, 0.0, 0.0]];
        let on_m = f64::from(Method::default().hand_contact.on_m);
        // Two objects that are seen to lie still from the first frame on touch up to midway between the distances of a contact.
        let Contact { on_m: begins_m, off_m: ends_m } = Method::default().object_contact;
        let lies_m = f64::from(f32::midpoint(begins_m, ends_m));
        let mut frame = Frame::default();
        let mut points: Vec<(u16, Vec<Point>)> = Vec::new();
        for (id, (x, y, yaw)) in (1..).zip(at) {
            let (position, yaw) = ([millimetres(x), millimetres(y), 0.0], f32::from(yaw) / 100.0);
            let orientation = [(yaw / 2.0).cos(), 0.0, 0.0, (yaw / 2.0).sin()];
            frame.objects.push(Object { id, position, orientation }).unwrap();
            let turned = |p: &Point| [position[0] + yaw.cos() * p[0], position[1] + yaw.sin() * p[0], 0.0];
            points.push((id, own.iter().map(turned).collect()));
        }
        let wrist = [0.0, -0.2, 0.0];
        frame.hands.push(Hand { side: Side::Left, score: 1.0, wrist, middle_knuckle: [0.0, -0.1, 0.0], tips }).unwrap();

        // Distances that rounding could move across a limit or across each other are left out.
        let mut all: Vec<f64> = points.iter().map(|(_, there)| distance(&tips, there)).collect();
        for (index, (_, here)) in points.iter().enumerate() {
            all.extend(points[index + 1..].iter().map(|(_, there)| distance(here, there)));
        }
        all.extend([on_m, lies_m]);
        all.sort_by(f64::total_cmp);
        let near: Vec<f64> = all.into_iter().filter(|distance| *distance <= lies_m).collect();
        prop_assume!(near.windows(2).all(|pair| pair[1] - pair[0] > 1e-6));

        let edge = |a: &[Point], b: &[Point], max: f64| Some(distance(a, b)).filter(|distance| *distance < max);
        let mut paths: Vec<(f64, f64, Context)> = Vec::new();
        for (j, at_j) in &points {
            let Some(first) = edge(&tips, at_j, on_m) else { continue };
            paths.push((first, f64::INFINITY, Context([2, *j, 0, 0])));
            for (l, at_l) in points.iter().filter(|(l, _)| l != j) {
                paths.extend(edge(at_j, at_l, lies_m).map(|second| (first, second, Context([2, *j, *j, *l]))));
            }
        }
        let best = paths.into_iter().min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let expected = best.map_or(Context::IDLE, |(.., context)| context);

        let shapes: Vec<ObjectShape> = points
            .iter()
            .map(|(id, _)| ObjectShape { id: *id, interaction_points: own.into_iter().collect(), ..ObjectShape::default() })
            .collect();
        let mut encoder = Encoder::new(Method::default(), &shapes).unwrap();
        let mut couples = Vec::new();
        for k in 0..20 {
            let frame = Frame { captured_ns: k * PERIOD_NS, ..frame.clone() };
            encoder.step(&frame, &mut |made: Couples| couples.push(made)).unwrap();
        }
        // That the hand rests is known once the motion was measured.
        let measured = &couples[Method::default().persist_frames.into()..];
        prop_assert!(!measured.is_empty());
        prop_assert!(measured.iter().all(|couples| couples.hands[1].context == expected), "{:?}", expected);
    }

    /// A context changes as a whole, and each lasts as long as a change takes to be believed.
    #[test]
    fn every_context_lasts(frames in worker()) {
        let couples = encode(&[TOOL, BOX], &frames);
        let mut runs = couples.chunk_by(|a, b| a.hands[0].context == b.hands[0].context).rev().skip(1);
        prop_assert!(runs.all(|run| run.len() >= usize::from(Method::default().persist_frames)));
    }

    /// Frames that come late, twice or out of order are refused, and the couples are the same as without them.
    #[test]
    fn refused_frames_change_nothing(frames in worker(), stale in prop::collection::vec((0..400usize, 0..400usize), 1..20)) {
        let mut encoder = encoder();
        let mut couples = Vec::new();
        for (index, frame) in frames.iter().enumerate() {
            encoder.step(frame, &mut |made| couples.push(made)).unwrap();
            for (_, which) in stale.iter().filter(|(after, _)| after % frames.len() == index) {
                let stale = &frames[which % (index + 1)];
                let is_repeated = stale.captured_ns == frame.captured_ns;
                let refused = if is_repeated { Refused::Repeated } else { Refused::Late };
                prop_assert_eq!(encoder.step(stale, &mut |made| couples.push(made)), Err(refused));
            }
        }
        encoder.flush(&mut |made| couples.push(made));
        prop_assert_eq!(couples, encode(&[TOOL, BOX], &frames));
    }

    /// Whatever frames are lost for less than `blind_ms`: the grid has no gap, the last poses are held, and nothing is out of sight.
    #[test]
    fn gaps_are_held_on_the_grid(frames in worker(), lost in prop::collection::vec((1..400usize, 1..20usize), 1..6)) {
        let last = frames.len() - 1;
        let is_lost = |index: usize| {
            lost.iter().any(|(from, count)| (from % last..from % last + count).contains(&index))
        };
        // 700 ms are 21 frames. What is lost longer is cut short: a case that is left out counts among those that a run may leave out.
        let mut kept = vec![0];
        for index in 1..=last {
            if index == last || !is_lost(index) || index - kept[kept.len() - 1] == 21 {
                kept.push(index);
            }
        }
        let mut encoder = encoder();
        let mut couples = Vec::new();
        for index in &kept {
            encoder.step(&frames[*index], &mut |made| couples.push(made)).unwrap();
        }
        encoder.flush(&mut |made| couples.push(made));
        prop_assert_eq!(couples.len(), frames.len());
        for (index, (couples, frame)) in couples.iter().zip(&frames).enumerate() {
            prop_assert!(couples.captured_ns.abs_diff(frame.captured_ns) < PERIOD_NS / 100);
            prop_assert_eq!(couples.hands[0].is_hand_seen(), kept.contains(&index));
            prop_assert_eq!(!couples.lacks(Unseen::FRAME), kept.contains(&index));
            prop_assert!(couples.hands[0].is_in_sight());
        }
    }

    /// ERUs tile their IU, IUs tile the time in which the hand acts, and each frame is in one of them.
    #[test]
    fn ius_tile_the_time_and_erus_tile_the_ius(parts in parts()) {
        let couples = stream(&parts, &[]);
        let mut segmenter = JobSegmenter::new(&Method::default()).unwrap();
        let mut events = Vec::new();
        couples.iter().for_each(|couples| segmenter.step(couples, &mut |event| events.push(event)));
        segmenter.finish(&mut |event| events.push(event));

        let (mut frames, mut erus) = (0, Vec::new());
        let mut tiles = Vec::new();
        for event in events {
            match event {
                Event::Hand(_, HandEvent::IuFrame { captured_ns, .. }) => {
                    prop_assert_eq!(captured_ns % PERIOD_NS, 0);
                    frames += 1;
                }
                Event::Hand(_, HandEvent::Eru { began_ns, ended_ns, .. }) => erus.push((began_ns, ended_ns)),
                Event::Hand(_, HandEvent::IuEnded(iu)) => {
                    prop_assert_eq!((iu.began_ns, iu.ended_ns), (erus[0].0, erus[erus.len() - 1].1));
                    prop_assert!(erus.windows(2).all(|pair| pair[0].1 == pair[1].0));
                    prop_assert_eq!(iu.frames, frames);
                    prop_assert_eq!(u64::from(iu.frames) * PERIOD_NS, iu.ended_ns - iu.began_ns);
                    (frames, erus) = (0, Vec::new());
                    tiles.push(iu);
                }
                _ => {}
            }
        }
        // The runs of equal contexts, counted over the couples themselves.
        let runs = couples.chunk_by(|a, b| a.hands[0].context == b.hands[0].context);
        let acting: Vec<(Context, u64, usize)> = runs
            .map(|run| (run[0].hands[0].context, run[0].captured_ns, run.len()))
            .filter(|(context, ..)| *context != Context::IDLE)
            .collect();
        let tiled: Vec<_> = tiles.iter().map(|iu| (iu.context, iu.began_ns, iu.frames as usize)).collect();
        prop_assert_eq!(tiled, acting);
    }
}
