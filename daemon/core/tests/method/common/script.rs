//! Couples of a scripted worker, part by part, and jobs taught from them.

use andon_core::bounds::{Bounds, Range};
use andon_core::capacity::OBJECTS;
use andon_core::config::Method;
use andon_core::couple::{Context, Couple, Couples, Motion, Unseen, Visibility};
use andon_core::input::{Point, Side};
use andon_core::job::{Job, JobObject, LocalCost, MeasureBounds, NominalActivity, NominalIu, Shown};
use andon_core::segment::{HandEvent, Iu, Measures, Segmenter};
use andon_core::set::{ActivitySet, ObjectSet};
use andon_core::verdict::{Outcome, Reason, Verdict};

use super::bench::PERIOD_NS;

/// What a hand does in one part.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Motions {
    /// It rests.
    Still,
    /// It moves in this direction.
    Toward(i8),
    /// It makes this many strokes back and forth.
    Strokes(usize),
}
pub(crate) use Motions::{Still, Strokes, Toward};

/// A number of frames in one context.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub(crate) context: [u16; 4],
    pub(crate) frames: usize,
    pub(crate) motions: Motions,
    /// Whether the object that the hand acts on is in sight.
    pub(crate) sighted: bool,
    /// Whether the hand is seen.
    pub(crate) seen: bool,
}

pub(crate) fn part(context: [u16; 4], frames: usize, motions: Motions) -> Part {
    Part { context, frames, motions, sighted: true, seen: true }
}

pub(crate) fn idle(frames: usize) -> Part {
    part([0; 4], frames, Still)
}

impl Part {
    fn direction(&self, frame: usize) -> i8 {
        match self.motions {
            Still => 0,
            Toward(direction) => direction,
            Strokes(strokes) => [1, 5][frame * 2 * strokes / self.frames % 2],
        }
    }

    fn motion(&self, frame: usize) -> Motion {
        let direction = self.direction(frame);
        match self.context {
            [0, 0, 0, 0] => Motion::default(),
            [0, 0, ..] => Motion([0, 0, 0, 0, 0, direction, 0]),
            [_, _, _, 0] => Motion([0, 0, direction, 1, 0, 0, 0]),
            _ => Motion([0, 0, direction, 1, 0, direction, 0]),
        }
    }
}

/// The position 2 cm on in this direction, of 8.
fn walked(position: &mut Point, direction: i8) -> Point {
    let angle = f32::from(direction - 1) * std::f32::consts::FRAC_PI_4;
    if direction > 0 {
        position[0] += 0.02 * angle.cos();
        position[1] += 0.02 * angle.sin();
    }
    *position
}

fn visibility(is_seen: bool) -> Visibility {
    if is_seen { Visibility::Seen } else { Visibility::Unseen }
}

fn couples_of(side: Side, parts: &[Part]) -> Vec<Couple> {
    let frames = parts.iter().flat_map(|part| (0..part.frames).map(move |frame| (part, frame)));
    let mut position = [0.0; 3];
    frames
        .enumerate()
        .map(|(index, (part, frame))| {
            let position = (part.seen && part.sighted).then(|| walked(&mut position, part.direction(frame)));
            Couple {
                motion: Some(part.motion(frame)),
                position,
                tips: position,
                context: Context(part.context),
                distances: [0.01, 0.01],
                visibility: [visibility(part.seen), visibility(part.sighted), Visibility::Seen],
                unseen: (Unseen::CONTEXT | Unseen::CHANGE).when(!(part.seen && part.sighted)),
                // It is known how exactly it was seen.
                drift_m: 0.001,
                ..Couple::idle(side, index as u64 * PERIOD_NS)
            }
        })
        .collect()
}

/// The parts of all tests have no higher ids.
const PARTS: usize = 16;

/// The ids of those parts, and of one more object for each of sixteen activities, which uses that and moves it for good.
const OBJECTS_OF_ALL: [u16; OBJECTS] = {
    let mut ids = [0; OBJECTS];
    let mut index = 0;
    while index < OBJECTS {
        ids[index] = index as u16 + 1;
        index += 1;
    }
    ids
};

/// The part with this id.
pub(crate) fn object(id: u16) -> ObjectSet {
    ObjectSet::of(usize::from(id) - 1)
}

/// Objects that these activities use and move for good, one each.
pub(crate) fn objects_of(activities: ActivitySet) -> ObjectSet {
    activities.iter().map(|activity| PARTS + activity).collect()
}

/// The couples of both hands. The hand that ends first is idle and out of the picture for the rest.
pub(crate) fn stream(right: &[Part], left: &[Part]) -> Vec<Couples> {
    let [right, left] = [couples_of(Side::Right, right), couples_of(Side::Left, left)];
    (0..right.len().max(left.len()))
        .map(|index| {
            let captured_ns = index as u64 * PERIOD_NS;
            let hand = |couples: &[Couple], side| {
                couples.get(index).copied().unwrap_or(Couple::idle(side, captured_ns))
            };
            let hands = [hand(&right, Side::Right), hand(&left, Side::Left)];
            Couples {
                captured_ns,
                known_ns: captured_ns + 5 * PERIOD_NS,
                unseen: Unseen::EMPTY,
                objects: OBJECTS_OF_ALL,
                at_start: ObjectSet::EMPTY,
                out_of_sight: ObjectSet::EMPTY,
                twice: ObjectSet::EMPTY,
                hands,
            }
        })
        .collect()
}

/// The IUs of one hand, each with its filtered motions.
pub(crate) fn ius(side: Side, parts: &[Part]) -> Vec<(Iu, Vec<Motion>)> {
    let mut segmenter = Segmenter::new(side, &Method::default()).unwrap();
    let mut ius = Vec::new();
    let mut motions = Vec::new();
    let mut take = |event: HandEvent| match event {
        HandEvent::IuFrame { motion, .. } => motions.push(motion),
        HandEvent::IuEnded(iu) => ius.push((iu, std::mem::take(&mut motions))),
        _ => {}
    };
    let couples = couples_of(side, parts);
    couples.iter().for_each(|couple| segmenter.step(couple, &mut take));
    segmenter.finish(couples.len() as u64 * PERIOD_NS, &mut take);
    ius
}

/// A job from one demonstration of each activity. Thresholds are 3; lengths may differ by half, reversals by one. Its memory is
/// leaked, because tests are short.
pub(crate) fn teach(activities: &[&[Part]]) -> Job<'static> {
    let nominal: Vec<NominalActivity<'static>> = activities
        .iter()
        .enumerate()
        .map(|(number, parts)| {
            let side = if parts[0].context[0] == 2 { Side::Left } else { Side::Right };
            let ius: Vec<NominalIu<'static>> = ius(side, parts)
                .into_iter()
                .map(|(iu, motions)| NominalIu {
                    context: iu.context,
                    reference: motions.leak(),
                    threshold: 3.0,
                    frames: Bounds { min: iu.frames / 2, max: iu.frames + iu.frames / 2 },
                    reversals: Bounds {
                        min: iu.measures.reversals.saturating_sub(1),
                        max: iu.measures.reversals + 1,
                    },
                    measures: MeasureBounds { shown: Some(shown(&iu)), ..MeasureBounds::ANY },
                })
                .collect();
            NominalActivity { activity: number as u16, ius: ius.leak() }
        })
        .collect();
    let object = |id: u16| {
        let uses = |nominal: &&NominalActivity<'_>| nominal.ius.iter().any(|iu| iu.context.involves(id));
        let used_by = nominal.iter().filter(uses).map(|nominal| usize::from(nominal.activity)).collect();
        JobObject { id, used_by, moved_by: ActivitySet::EMPTY }
    };
    let other = |(number, id): (usize, u16)| JobObject {
        id,
        used_by: ActivitySet::of(number),
        moved_by: ActivitySet::of(number),
    };
    let others = OBJECTS_OF_ALL.into_iter().skip(PARTS).enumerate().map(other);
    let objects: Vec<JobObject> = (1..=PARTS as u16).map(object).chain(others).collect();
    Job {
        activities: nominal.leak(),
        laws: &[],
        objects: objects.leak(),
        passive_contacts: &[],
        cost: LocalCost::Circular { bins: 8 },
        max_slowdown: 2.0,
        has_free_ends: false,
        min_captured: 0.0,
    }
}

/// What one demonstration shows.
fn shown(iu: &Iu) -> Shown {
    let Measures { reversals, stroke_m, path_m, detour_m, lateral_m, .. } = iu.measures;
    let metres = |metres: f32| Range { min: metres, max: metres };
    Shown {
        frames: Bounds { min: iu.frames, max: iu.frames },
        reversals: Bounds { min: reversals, max: reversals },
        stroke_m: metres(stroke_m.unwrap_or_default()),
        path_m: metres(path_m),
        detour_m,
        lateral_m,
        axis: 0.0,
        place_m: 0.0,
    }
}

/// A verdict in short, such as `r0.1 IuOk`, `l2 ActivityAnomaly NotCompleted` or `JobOk`; `!` marks an early one.
pub(crate) fn short(verdict: &Verdict) -> String {
    let side = match verdict.side {
        Some(Side::Right) => "r",
        Some(Side::Left) => "l",
        None => "",
    };
    let subject = match (verdict.side, verdict.iu) {
        (Some(_), Some(iu)) => format!("{side}{}.{iu} ", verdict.activity),
        (Some(_), None) => format!("{side}{} ", verdict.activity),
        (None, _) => String::new(),
    };
    let reason = match verdict.reason {
        Reason::None => String::new(),
        reason => format!(" {reason:?}"),
    };
    let outcome = match verdict.outcome {
        Outcome::NotJudged => "NotJudged".to_owned(),
        outcome => format!("{:?}{outcome:?}", verdict.level),
    };
    format!("{subject}{outcome}{reason}{}", if verdict.early { "!" } else { "" })
}
