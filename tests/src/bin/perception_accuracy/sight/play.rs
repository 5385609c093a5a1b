//! Plays a clip to which something is done, and hears what is said.

use super::Said;
use super::deeds::{CLEARED, Case, Deed};
use crate::Error;
use crate::clip::{Change, Clip};
use crate::truth::Truth;
use andon_perception::config::{HandsConfig, MarkersConfig, ThreadsConfig};
use andon_perception::sight::{Expected, Observation, SightMonitor, Trouble};
use andon_perception::{Dictionary, ImageView, Perceiver, PerceptionConfig, PixelFormat};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// What every picture is like that a camera gives.
const CAMERA: &str = "noise=alls=4:allf=t";

/// Frames before the change, and how many are changed.
const BEFORE: usize = 105;
const CHANGED: usize = 105;
/// For a camera that was moved, which is found later.
const MOVED: usize = 165;
/// Frames that are shown after the change.
const AFTER: usize = 75;

/// Shows a clip and hears what is said of it.
pub(super) fn play(path: &Path, case: &Case, runtime: &Path) -> Result<Said, Error> {
    let mut play = Play::open(path, case)?;
    let mut station = perceiver(runtime, &play.plain.truth, None)?;
    let mut wrong_station = match &case.deed {
        deed @ (Deed::HideHands | Deed::OtherIds | Deed::OtherDictionary) => {
            Some(perceiver(runtime, &play.plain.truth, Some(deed))?)
        }
        _ => None,
    };
    let mut sight = SightMonitor::new(Expected { rate_hz: None, hands: true, is_calibrated: true });
    let mut said = play.nothing_said();
    let mut dropped = 0;
    while let Some(picture) = play.next()? {
        if picture.is_left_out {
            dropped += 1;
            continue;
        }
        let perceiver = match &mut wrong_station {
            Some(wrong) if picture.is_changed => wrong,
            _ => &mut station,
        };
        let seen = perceiver.perceive(picture.image, picture.at_ns)?;
        said.note(
            sight.step(&Observation::new(&seen, std::mem::take(&mut dropped))),
            picture.at_ns as f64 / 1e9,
        );
    }
    Ok(said)
}

/// A clip to which something is done for a while.
struct Play {
    deed: Deed,
    plain: Clip,
    changed: Clip,
    when: Range<usize>,
    /// The picture that is shown again and again.
    held: Vec<u8>,
    noise: u32,
}

struct Picture<'a> {
    at_ns: u64,
    image: ImageView<'a>,
    is_changed: bool,
    is_left_out: bool,
}

impl Play {
    fn open(path: &Path, case: &Case) -> Result<Self, Error> {
        let change = |filter: String| Change { filter: Some(filter), ..Change::default() };
        let plain = Clip::open(path, &change(CAMERA.into()))?;
        let (shown, filter) = match &case.deed {
            Deed::Filter(filter) => (path.to_owned(), filter.as_str()),
            Deed::Empty => (path.to_owned(), CLEARED),
            Deed::OtherClip => (other_clip(path), "null"),
            _ => (path.to_owned(), "null"),
        };
        let frames = plain.truth.frames.len();
        let when = match case.deed {
            // What was wrong from the beginning is mended in the end. Hands are missed when parts have been moved.
            Deed::OtherIds | Deed::OtherDictionary | Deed::HideHands => 0..frames - AFTER,
            Deed::Empty => 0..frames,
            _ if case.expected == Some(Trouble::CameraMoved) => BEFORE..BEFORE + MOVED,
            _ => BEFORE..BEFORE + CHANGED,
        };
        let changed = Clip::open(&shown, &change(format!("{filter},{CAMERA}")))?;
        Ok(Self { deed: case.deed.clone(), plain, changed, when, held: Vec::new(), noise: 1 })
    }

    /// What is said before the first picture.
    fn nothing_said(&self) -> Said {
        let Truth { rate_hz, frames, .. } = &self.plain.truth;
        let is_moving = |index: &usize| frames[*index].objects.iter().any(|object| object.is_carried);
        let begin = match self.deed {
            Deed::HideHands => self.when.clone().find(is_moving).unwrap_or_default(),
            _ => self.when.start,
        };
        let [begin_s, end_s] = [begin, self.when.end].map(|frame| frame as f64 / rate_hz);
        Said { begin_s, end_s, spells: Vec::new(), newest: None }
    }

    /// The next picture; `None` after the last.
    fn next(&mut self) -> Result<Option<Picture<'_>>, Error> {
        let Some(shown) = self.plain.next()?.filter(|shown| shown.index < self.when.end + AFTER) else {
            return Ok(None);
        };
        let other = self.changed.next()?.ok_or("the changed clip is shorter")?;
        let is_changed = self.when.contains(&shown.index);
        let bytes = match self.deed {
            Deed::Freeze | Deed::Pause if is_changed => {
                if self.held.is_empty() {
                    self.held = shown.bytes.to_vec();
                }
                if matches!(self.deed, Deed::Pause) {
                    shake(&mut self.held, &mut self.noise);
                }
                &self.held[..]
            }
            _ if is_changed => other.bytes,
            _ => shown.bytes,
        };
        let (width, height) = (shown.image.width(), shown.image.height());
        let is_one_of = |of: usize| shown.index.is_multiple_of(of);
        Ok(Some(Picture {
            at_ns: shown.captured_ns,
            image: ImageView::new(width, height, width * 3, PixelFormat::Bgr8, bytes)?,
            is_changed,
            is_left_out: is_changed && matches!(self.deed, Deed::Skip(of) if !is_one_of(of)),
        }))
    }
}

/// The least noise that a camera has.
fn shake(picture: &mut [u8], noise: &mut u32) {
    for pixel in picture.iter_mut().step_by(97) {
        // Numerical Recipes' generator.
        *noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *pixel = pixel.wrapping_add((*noise >> 31) as u8).max(1);
    }
}

/// The longest clip of the same person, or another one.
fn other_clip(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let person = name.split('_').next().unwrap_or_default();
    let others = ["none_r1", "none_r3"].map(|what| format!("{person}_{what}.mp4"));
    path.with_file_name(others.iter().find(|other| **other != name).unwrap_or(&others[0]))
}

/// A perceiver for the station of a clip, or for a station with something wrong about it.
fn perceiver(runtime: &Path, truth: &Truth, wrong: Option<&Deed>) -> Result<Perceiver, Error> {
    let mut markers = MarkersConfig { objects: truth.objects.clone(), ..MarkersConfig::default() };
    let mut hands = HandsConfig::default();
    match wrong {
        Some(Deed::OtherIds) => markers.objects.iter_mut().for_each(|object| object.marker += 20),
        Some(Deed::OtherDictionary) => {
            let other = Dictionary::all().find(|dictionary| dictionary.name() == "DICT_5X5_50");
            markers.dictionary = other.ok_or("OpenCV has no such dictionary")?;
        }
        Some(Deed::HideHands) => hands.sides.clear(),
        _ => {}
    }
    Ok(Perceiver::new(
        &PerceptionConfig { runtime: runtime.into(), hands, markers, threads: ThreadsConfig::default() },
        None,
    )?)
}
