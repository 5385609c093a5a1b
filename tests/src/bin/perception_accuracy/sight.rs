//! Measures what is said of a picture that something is done to, and after how long.
//!
//! The first seconds of a clip are shown as they are, then changed for some seconds, then as they are again. All pictures have the noise of
//! a camera: rendered ones have none.

use crate::Error;
use crate::clip::{Change, Clip};
use crate::truth::Truth;
use andon_perception::config::{HandsConfig, MarkersConfig};
use andon_perception::sight::{Expected, Look, Sight};
use andon_perception::{Dictionary, ImageView, Perceiver, PerceptionConfig, PixelFormat};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Clips with their truth beside them.
    #[arg(required = true)]
    clips: Vec<PathBuf>,
    /// Only what is done under names that contain this.
    #[arg(long)]
    only: Option<String>,
}

/// What is done.
#[derive(Clone, Copy)]
enum Deed {
    /// An ffmpeg filter.
    Filter(&'static str),
    /// An ffmpeg filter that moves the picture.
    Move(&'static str),
    /// From the beginning the bench is empty.
    Empty,
    /// Another clip of the same person, whose parts lie elsewhere.
    OtherClip,
    /// The same picture again and again.
    Freeze,
    /// The same scene again and again, with new noise in every picture.
    Pause,
    /// Only one of so many pictures is looked at.
    Skip(usize),
    /// No hand is looked for, and one would be wanted.
    HideHands,
    /// From the beginning the station has markers of other ids.
    OtherIds,
    /// From the beginning the station has markers of another dictionary.
    OtherDictionary,
}

/// Under which name what is done, and what should be said.
const DEEDS: [(&str, Deed, &str); 34] = [
    ("black", Deed::Filter("lutyuv=y=16:u=128:v=128"), "Black"),
    ("lens cap with its glow", Deed::Filter("lutyuv=y=20:u=128:v=128"), "Black"),
    ("white", Deed::Filter("lutyuv=y=255:u=128:v=128"), "White"),
    ("hand over the lens", Deed::Filter("drawbox=c=0x6a4030:t=fill,gblur=sigma=5"), "Covered"),
    ("paper over the lens", Deed::Filter("drawbox=c=0xd8d8d0:t=fill"), "Covered"),
    ("cloth, light on one side", Deed::Filter("drawbox=c=0x202838:t=fill,vignette=PI/3:x0=0"), "Covered"),
    ("frozen", Deed::Freeze, "Frozen"),
    ("lens out of focus", Deed::Filter("gblur=sigma=6"), "Blurred"),
    ("water on the lens", Deed::Filter("gblur=sigma=8"), "Blurred"),
    ("far out of focus", Deed::Filter("gblur=sigma=12"), "Blurred"),
    ("noise of a dying sensor", Deed::Filter("noise=alls=100:allf=t"), "Noisy"),
    ("the camera is pushed aside", Deed::Move("scroll=hpos=0.05:vpos=0.03"), "CameraMoved"),
    ("the camera is turned", Deed::Move("rotate=0.08:c=gray"), "CameraMoved"),
    ("the camera comes nearer", Deed::Move("crop=580:435:20:30,scale=640:480"), "CameraMoved"),
    ("every 3rd picture", Deed::Skip(3), "TooFewFrames"),
    ("every 8th picture", Deed::Skip(8), "TooFewFrames"),
    ("markers of other ids", Deed::OtherIds, "NoMarkers"),
    ("markers of another dictionary", Deed::OtherDictionary, "NoMarkers"),
    ("a glove that no hand is seen in", Deed::HideHands, "NoHands"),
    ("nothing", Deed::Filter("null"), "nothing"),
    ("a pause", Deed::Pause, "nothing"),
    ("an empty bench", Deed::Empty, "nothing"),
    ("the bench is rearranged", Deed::OtherClip, "nothing"),
    ("a shadow that wanders", Deed::Filter(WANDERING), "nothing"),
    ("a lamp flickers", Deed::Filter("eq=eval=frame:brightness='0.08*sin(2*PI*t*3)'"), "nothing"),
    ("the bench is cleared", Deed::Filter(CLEARED), "nothing"),
    ("a lamp is switched on", Deed::Filter("eq=brightness=0.15:gamma=1.4"), "nothing"),
    ("a lamp is switched off", Deed::Filter("eq=gamma=0.5"), "nothing"),
    ("it gets darker", Deed::Filter("eq=brightness=-0.25"), "nothing"),
    ("a shadow over two thirds", Deed::Filter("drawbox=w=iw*0.66:c=black@0.5:t=fill"), "nothing"),
    ("a shadow over all", Deed::Filter("drawbox=c=black@0.5:t=fill"), "nothing"),
    ("some noise", Deed::Filter("noise=alls=20:allf=t"), "nothing"),
    ("a soft lens", Deed::Filter("gblur=sigma=1.2"), "nothing"),
    ("every 2nd picture is late", Deed::Skip(2), "nothing"),
];

/// The free part of the table, four times.
const CLEARED: &str =
    "crop=400:240:0:240,split=4[a][b][c][d];[a][b]vstack[l];[c][d]vstack,crop=240:480:0:0[r];[l][r]hstack";

/// A dark stripe that moves across the bench.
const WANDERING: &str = "geq=lum='lum(X,Y)*(1-0.5*between(X-90*T+200,0,220))':cb='cb(X,Y)':cr='cr(X,Y)'";

/// What every picture is like that a camera gives.
const CAMERA: &str = "noise=alls=4:allf=t";

/// Frames before the change, and how many are changed.
const BEFORE: usize = 105;
const CHANGED: usize = 105;
/// For a camera that was moved, which is found later.
const MOVED: usize = 165;
/// Seconds in which a change should be found, and those in which it should be that the camera was moved.
const IN_TIME_S: f64 = 2.0;
const MOVED_IN_TIME_S: f64 = 5.0;

pub(crate) fn run(arguments: &Arguments, runtime: &Path) -> Result<(), Error> {
    let mut wrong = 0;
    for path in &arguments.clips {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let wanted = |deed: &str| arguments.only.as_deref().is_none_or(|only| deed.contains(only));
        for (what, deed, expected) in DEEDS.into_iter().filter(|(what, ..)| wanted(what)) {
            let said = play(path, deed, runtime)?;
            let is_right = said.is(expected);
            wrong += usize::from(!is_right);
            println!("{name} | {what} | {expected} | {said} | {}", if is_right { "right" } else { "WRONG" });
        }
    }
    println!("{wrong} wrong");
    Ok(())
}

/// What was said, in seconds since the change began; what was believed over, in seconds since it ended.
#[derive(Default)]
struct Said {
    /// Trouble, when it was said, when it was over.
    spells: Vec<(String, f64, Option<f64>)>,
}

impl Said {
    fn is(&self, expected: &str) -> bool {
        match &self.spells[..] {
            [] => expected == "nothing",
            [(trouble, after_s, _)] => {
                let in_time_s = if expected == "CameraMoved" { MOVED_IN_TIME_S } else { IN_TIME_S };
                trouble == expected && (0.0..=in_time_s).contains(after_s)
            }
            _ => false,
        }
    }
}

impl std::fmt::Display for Said {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.spells.is_empty() {
            return f.write_str("nothing");
        }
        for (index, (trouble, after_s, over_s)) in self.spells.iter().enumerate() {
            let comma = if index == 0 { "" } else { ", " };
            write!(f, "{comma}{trouble} after {after_s:.1} s")?;
            if let Some(over_s) = over_s {
                write!(f, ", over {over_s:.1} s after the end")?;
            }
        }
        Ok(())
    }
}

fn play(path: &Path, deed: Deed, runtime: &Path) -> Result<Said, Error> {
    let change = |filter: String| Change { filter: Some(filter), ..Change::default() };
    let mut plain = Clip::open(path, &change(CAMERA.into()))?;
    let filter = match deed {
        Deed::Filter(filter) | Deed::Move(filter) => filter,
        Deed::Empty => CLEARED,
        _ => "null",
    };
    let shown_instead = if matches!(deed, Deed::OtherClip) { other_clip(path) } else { path.to_owned() };
    let mut changed = Clip::open(&shown_instead, &change(format!("{filter},{CAMERA}")))?;
    let is_from_beginning = matches!(deed, Deed::OtherIds | Deed::OtherDictionary | Deed::Empty);
    let (mut with_hands, mut without_hands) =
        (perceiver(runtime, &plain.truth, deed, true)?, perceiver(runtime, &plain.truth, deed, false)?);
    let mut sight = Sight::new(Expected { rate_hz: None, hands: true, is_calibrated: true });
    let (begin, end) = match deed {
        _ if is_from_beginning => (0, plain.truth.frames.len()),
        // Long enough for the parts to be moved.
        Deed::HideHands => (0, plain.truth.frames.len()),
        Deed::Move(_) => (BEFORE, BEFORE + MOVED),
        _ => (BEFORE, BEFORE + CHANGED),
    };
    let rate_hz = plain.truth.rate_hz;
    let mut said = Said::default();
    let (mut dropped, mut newest, mut noise) = (0, None, 1_u32);
    let mut held: Vec<u8> = Vec::new();
    let mut first_move_s = None;
    while let Some(shown) = plain.next()? {
        let (index, at_ns) = (shown.index, shown.captured_ns);
        let at_s = at_ns as f64 / 1e9;
        first_move_s =
            first_move_s.or(shown.truth.objects.iter().any(|object| object.is_carried).then_some(at_s));
        let other = changed.next()?.ok_or("the changed clip is shorter")?;
        let is_changed = (begin..end).contains(&index);
        let bytes = match deed {
            Deed::Freeze | Deed::Pause if is_changed => {
                if held.is_empty() {
                    held = shown.bytes.to_vec();
                }
                if matches!(deed, Deed::Pause) {
                    shake(&mut held, &mut noise);
                }
                &held[..]
            }
            _ if is_changed => other.bytes,
            _ => shown.bytes,
        };
        if let Deed::Skip(of) = deed
            && is_changed
            && !index.is_multiple_of(of)
        {
            dropped += 1;
            continue;
        }
        let perceiver = if matches!(deed, Deed::HideHands) { &mut without_hands } else { &mut with_hands };
        let (width, height) = (shown.image.width(), shown.image.height());
        let image = ImageView::new(width, height, width * 3, PixelFormat::Bgr8, bytes)?;
        let seen = perceiver.perceive(image, at_ns)?;
        let spell = sight.step(&Look::new(&seen, std::mem::take(&mut dropped)));
        if spell != newest {
            let end_s = end as f64 / rate_hz;
            if newest.is_some()
                && let Some((_, _, over_s)) = said.spells.last_mut()
            {
                *over_s = Some(at_s - end_s);
            }
            if let Some(spell) = spell {
                let begin_s = match deed {
                    Deed::HideHands => first_move_s.unwrap_or_default(),
                    _ => begin as f64 / rate_hz,
                };
                said.spells.push((format!("{:?}", spell.trouble), at_s - begin_s, None));
            }
            newest = spell;
        }
        if index > end + 60 {
            break;
        }
    }
    Ok(said)
}

/// The least noise that a camera has.
fn shake(picture: &mut [u8], noise: &mut u32) {
    for pixel in picture.iter_mut().step_by(97) {
        // Numerical Recipes' generator.
        *noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *pixel = pixel.wrapping_add((*noise >> 31) as u8).max(1);
    }
}

/// The clip of the other repetition by the same person.
fn other_clip(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let person = name.split('_').next().unwrap_or_default();
    let others = ["none_r1", "J1_r1"].map(|what| format!("{person}_{what}.mp4"));
    path.with_file_name(others.iter().find(|other| **other != name).unwrap_or(&others[0]))
}

fn perceiver(runtime: &Path, truth: &Truth, deed: Deed, hands: bool) -> Result<Perceiver, Error> {
    let mut markers = MarkersConfig { objects: truth.objects.clone(), ..MarkersConfig::default() };
    match deed {
        Deed::OtherIds => markers.objects.iter_mut().for_each(|object| object.id += 20),
        Deed::OtherDictionary => {
            let other = Dictionary::all().find(|dictionary| dictionary.name() == "DICT_5X5_50");
            markers.dictionary = other.ok_or("OpenCV has no such dictionary")?;
        }
        _ => {}
    }
    let mut config = HandsConfig::default();
    if !hands {
        config.sides.clear();
    }
    Ok(Perceiver::new(&PerceptionConfig { runtime: runtime.into(), hands: config, markers }, None)?)
}
