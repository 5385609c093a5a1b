//! Measures what is gained by moving a hidden object with the hand that carries it.
//!
//! In the clips the markers stay in view while a part is held. Here they are hidden: from every tenth frame in which the
//! truth says that an object is held and its marker was found, that marker is withheld for a second. Where the object was
//! really detected is what the pose is compared with, and with it the pose that stays where the marker was last seen.
//! The same is done with objects at rest that no hand holds: they must not be taken along.

#[path = "../evaluate/clip.rs"]
#[allow(dead_code, reason = "the other measurement uses all of it")]
mod clip;

use andon_perception::config::MarkerObject;
use andon_perception::held::{Held, PlacedHand, PlacedObject};
use andon_perception::{Detections, Perceiver, PerceptionConfig};
use clap::Parser;
use clip::{Change, Clip};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

type Error = Box<dyn std::error::Error>;

/// Frames after the marker was hidden that are looked at: 0.1 s to 1 s.
const AFTER: [usize; 5] = [3, 7, 15, 22, 29];

/// Every so many frames a marker is hidden.
const EVERY: usize = 10;

#[derive(Parser)]
struct Arguments {
    /// Clips with their truth beside them.
    #[arg(required = true)]
    clips: Vec<PathBuf>,
    /// Folder of the models and ONNX Runtime.
    #[arg(long, env = "ANDON_RUNTIME", default_value = "target/runtime")]
    runtime: PathBuf,
}

/// What was perceived of a frame.
struct Seen {
    captured_ns: u64,
    hands: Vec<PlacedHand>,
    objects: Vec<PlacedObject>,
    /// Objects that the truth says are there: id and whether the hand holds it.
    truth: Vec<(u16, bool)>,
}

#[derive(Default)]
struct Errors {
    followed: Vec<f64>,
    frozen: Vec<f64>,
    /// Times in which the object was not taken for a carried one.
    unfollowed: usize,
}

fn main() -> Result<(), Error> {
    let arguments = Arguments::parse();
    let mut errors: BTreeMap<(&str, usize), Errors> = BTreeMap::new();
    let (mut held, mut undetected) = (0, 0);
    for path in &arguments.clips {
        let frames = perceive(path, &arguments.runtime)?;
        for frame in &frames {
            let carried = frame.truth.iter().filter(|(_, carried)| *carried);
            for (id, _) in carried {
                held += 1;
                undetected += usize::from(of(&frame.objects, *id).is_none());
            }
        }
        hide(&frames, &mut errors);
    }
    println!("held objects in {held} frames, their markers not found in {undetected} of these");
    println!(
        "mm from where the marker was found; median and 95 %, following the hand | staying where it was"
    );
    for ((what, after), Errors { followed, frozen, unfollowed }) in &mut errors {
        println!(
            "{what}, hidden for {after:2} frames: {} | {}   followed {} of {}",
            summary(followed),
            summary(frozen),
            followed.len(),
            followed.len() + *unfollowed
        );
    }
    Ok(())
}

fn perceive(path: &Path, runtime: &Path) -> Result<Vec<Seen>, Error> {
    let mut clip = Clip::open(path, &Change { filter: None, scale: 1.0, mirror: false, jpeg: None })?;
    let objects = clip.truth.objects.iter().map(|&(id, side_m)| MarkerObject { id, side_m }).collect();
    let mut perceiver = Perceiver::new(&PerceptionConfig::new(runtime, objects))?;
    let mut frames = Vec::new();
    while clip.advance()? {
        let truth = clip.truth.frames.get(frames.len()).ok_or("the clip is longer than its truth")?;
        let captured_ns = (frames.len() as f64 / clip.truth.fps * 1e9) as u64;
        let Detections { hands, objects, .. } =
            perceiver.perceive(clip.image()?, captured_ns, frames.len() as u64)?;
        let hand = |hand: &andon_perception::detections::HandDetection| PlacedHand {
            side: hand.side,
            landmarks_m: hand.landmarks_m.map(|[x, y]| [x, y, 0.0]),
        };
        let object = |object: &andon_perception::detections::ObjectDetection| PlacedObject {
            id: object.id,
            position_m: object.position_m,
            orientation: object.orientation,
        };
        frames.push(Seen {
            captured_ns,
            hands: hands.iter().map(hand).collect(),
            objects: objects.iter().map(object).collect(),
            truth: truth.objects.iter().map(|object| (object.id, object.held)).collect(),
        });
    }
    Ok(frames)
}

/// Hides each object's marker from each start on.
fn hide(frames: &[Seen], errors: &mut BTreeMap<(&'static str, usize), Errors>) {
    let mut before = Held::default();
    for start in 1..frames.len() {
        let last = &frames[start - 1];
        before.step(last.captured_ns, &last.hands, &last.objects);
        if start % EVERY != 0 {
            continue;
        }
        for &(id, is_held) in &last.truth {
            let Some(stays) = of(&last.objects, id) else { continue };
            let mut held = before.clone();
            for (after, frame) in frames[start..].iter().enumerate().take(AFTER[AFTER.len() - 1] + 1) {
                let others: Vec<_> = frame.objects.iter().filter(|object| object.id != id).copied().collect();
                let found = held.step(frame.captured_ns, &frame.hands, &others);
                let as_before = frame.truth.contains(&(id, is_held));
                let (true, Some(there)) = (AFTER.contains(&(after + 1)) && as_before, of(&frame.objects, id))
                else {
                    continue;
                };
                let what = if is_held { "held" } else { "at rest" };
                let errors = errors.entry((what, after + 1)).or_default();
                errors.frozen.push(distance(stays, there));
                match of(&found, id) {
                    Some(follows) => errors.followed.push(distance(follows, there)),
                    None => errors.unfollowed += 1,
                }
            }
        }
    }
}

fn of(objects: &[PlacedObject], id: u16) -> Option<&PlacedObject> {
    objects.iter().find(|object| object.id == id)
}

fn distance(one: &PlacedObject, two: &PlacedObject) -> f64 {
    let square = |axis: usize| f64::from(one.position_m[axis] - two.position_m[axis]).powi(2);
    1e3 * (square(0) + square(1) + square(2)).sqrt()
}

fn summary(errors: &mut [f64]) -> String {
    errors.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| errors.get((share * errors.len() as f64) as usize).copied().unwrap_or(f64::NAN);
    format!("{:6.1} {:6.1}", at(0.5), at(0.95))
}
