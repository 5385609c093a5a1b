//! Measures what is gained by moving a hidden object with the hand that carries it.
//!
//! In the clips the markers stay in view while a part is held. Here they are hidden: from every tenth frame on, each marker that was found is
//! withheld for a second. The pose that follows the hand is compared with the marker that was really found. So is the pose that stays where the
//! marker was last seen. The same is done with objects at rest that no hand holds: they must not be taken along.

use crate::clip::{Change, Clip, Shown};
use crate::errors::{Errors, distance};
use crate::{Error, usual_perceiver};
use andon_perception::carried::{CarriedObjects, PlacedHand};
use andon_perception::detections::PlacedObject;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// How many frames after the marker was hidden the pose is compared: 0.1 s to 1 s.
const COMPARED_AFTER: [usize; 5] = [3, 7, 15, 22, 29];

/// A marker is hidden from every tenth frame on.
const HIDDEN_EVERY: usize = 10;

/// What was perceived of a frame.
struct Perceived {
    captured_ns: u64,
    hands: Vec<PlacedHand>,
    objects: Vec<PlacedObject>,
    /// Objects that are really there: their ids, and whether the hand carries them.
    truth: Vec<(u16, bool)>,
}

#[derive(Default)]
struct Comparison {
    following_mm: Errors,
    staying_mm: Errors,
    /// How often the object was not taken for a carried one.
    not_followed: usize,
}

/// By what the object does, and the frames after its marker was hidden.
type Comparisons = BTreeMap<(&'static str, usize), Comparison>;

pub(crate) fn run(clips: &[PathBuf], runtime: &Path) -> Result<(), Error> {
    let mut comparisons = Comparisons::new();
    let (mut carried, mut undetected) = (0, 0);
    for path in clips {
        let frames = perceive(path, runtime)?;
        for frame in &frames {
            for (id, _) in frame.truth.iter().filter(|(_, is_carried)| *is_carried) {
                carried += 1;
                undetected += usize::from(with_id(&frame.objects, *id).is_none());
            }
        }
        hide_markers(&frames, &mut comparisons);
    }
    println!("an object is carried in {carried} frames, and its marker is not found in {undetected} of them");
    println!("mm from where the marker was found, median and 95 %: following the hand | staying");
    for ((what, after), Comparison { following_mm, staying_mm, not_followed }) in &comparisons {
        println!(
            "{what}, hidden for {after:2} frames: {} | {}   followed {} of {}",
            summary(following_mm),
            summary(staying_mm),
            following_mm.count(),
            following_mm.count() + not_followed
        );
    }
    Ok(())
}

fn perceive(path: &Path, runtime: &Path) -> Result<Vec<Perceived>, Error> {
    let mut clip = Clip::open(path, &Change::default())?;
    let mut perceiver = usual_perceiver(runtime, &clip.truth)?;
    let mut frames = Vec::new();
    while let Some(Shown { captured_ns, image, truth, .. }) = clip.next()? {
        let detections = perceiver.perceive(image, captured_ns)?;
        frames.push(Perceived {
            captured_ns,
            hands: detections.hands.iter().map(PlacedHand::from).collect(),
            objects: detections.objects.iter().map(PlacedObject::from).collect(),
            truth: truth.objects.iter().map(|object| (object.id, object.is_carried)).collect(),
        });
    }
    Ok(frames)
}

/// Hides each marker from every start on.
fn hide_markers(frames: &[Perceived], comparisons: &mut Comparisons) {
    let mut before = CarriedObjects::default();
    for start in 1..frames.len() {
        let last = &frames[start - 1];
        before.step(last.captured_ns, &last.hands, &last.objects);
        if start % HIDDEN_EVERY == 0 {
            for &(id, is_carried) in &last.truth {
                if let Some(last_seen) = with_id(&last.objects, id) {
                    hide_marker(before.clone(), &frames[start..], last_seen, is_carried, comparisons);
                }
            }
        }
    }
}

/// Hides the marker of one object from the first of these frames on.
fn hide_marker(
    mut carried: CarriedObjects,
    frames: &[Perceived],
    last_seen: &PlacedObject,
    is_carried: bool,
    comparisons: &mut Comparisons,
) {
    let id = last_seen.id;
    let what = if is_carried { "carried" } else { "at rest" };
    for (after, frame) in (1..=COMPARED_AFTER[COMPARED_AFTER.len() - 1]).zip(frames) {
        let others: Vec<_> = frame.objects.iter().filter(|object| object.id != id).copied().collect();
        let placed = carried.step(frame.captured_ns, &frame.hands, &others);
        let is_compared = COMPARED_AFTER.contains(&after) && frame.truth.contains(&(id, is_carried));
        let Some(found) = with_id(&frame.objects, id).filter(|_| is_compared) else { continue };
        let comparison = comparisons.entry((what, after)).or_default();
        comparison.staying_mm.push(distance_mm(last_seen, found));
        match with_id(&placed, id) {
            Some(following) => comparison.following_mm.push(distance_mm(following, found)),
            None => comparison.not_followed += 1,
        }
    }
}

fn with_id(objects: &[PlacedObject], id: u16) -> Option<&PlacedObject> {
    objects.iter().find(|object| object.id == id)
}

fn distance_mm(one: &PlacedObject, two: &PlacedObject) -> f64 {
    1e3 * distance(one.position_m.map(f64::from), two.position_m.map(f64::from))
}

fn summary(errors: &Errors) -> String {
    format!("{:6.1} {:6.1}", errors.median(), errors.quantile(0.95))
}
