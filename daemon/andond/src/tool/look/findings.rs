//! What a person should know of what was seen: one sentence for each thing, with what to do where it is not good enough.

use andon_board::Finding;
use andon_core::input::Side;
use andon_host::config::{Config, Object};
use andon_host::video::pipe::PictureFormat;

use super::inspector::{Inspection, side_px};

/// Mean grey level below which it is too dark. The shipped clips darkened by ffmpeg's `eq=brightness=-0.25` have 12: without a camera's noise
/// all is found there, and with it there is no reserve.
const DARK: f32 = 15.0;
/// Share of white pixels from which on parts of the bench are dazzled. Paper that is as white as a marker's edge has no edge to it.
const DAZZLED: f32 = 0.15;
/// Noise, in grey levels, from which on hands begin to be missed. With ffmpeg's `noise=alls=20:allf=t` the shipped clips have 13, and the hand is
/// found in 99.4 % of the frames. With `alls=40` they have 26, and 1 %.
const NOISY: f32 = 10.0;
/// Of the step across an edge, less than this lies within two pixels where the lens is out of focus. Blurred by ffmpeg's `gblur=2` the shipped clips
/// have 0.63, and every marker is found as before. By `gblur=3` they have 0.57, and markers of 30 pixels are lost.
const SOFT: f32 = 0.6;
/// A marker this near to the edge of the picture leaves it with the next movement, in sides of the marker.
const EDGE_SIDES: f32 = 0.5;

/// A hand is lost rather than withdrawn if fewer than this share of pictures show it, from the first to the last that does.
const HELD: f32 = 0.5;

fn finding(is_good: bool, about: &str, sentence: impl Into<String>) -> Finding {
    Finding { is_good, about: about.to_owned(), sentence: sentence.into() }
}

/// Everything that the pictures say, in the order in which it is put right.
pub(super) fn sentences(inspections: &[Inspection], config: &Config, format: PictureFormat) -> Vec<Finding> {
    if inspections.is_empty() {
        return Vec::new();
    }
    let mut lines = vec![light(inspections), sharpness(inspections)];
    let dictionary = config.perception.dictionary;
    let sizes = Sizes {
        needed_px: dictionary.needed_side_px() as f32,
        wanted_px: dictionary.wanted_side_px() as f32,
    };
    let marked = config.objects.iter().filter(|object| object.marker_id().is_some());
    lines.extend(marked.map(|object| part(inspections, object, sizes, format)));
    lines.extend(config.perception.hands.iter().map(|side| hand(inspections, *side)));
    lines.extend(strangers(inspections));
    lines
}

fn mean(values: impl Iterator<Item = f32>) -> f32 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}

/// The middle one; of an even number the greater.
fn median(mut values: Vec<f32>) -> Option<f32> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f32::total_cmp).1)
}

fn light(inspections: &[Inspection]) -> Finding {
    let grey = |inspection: &Inspection| {
        mean(inspection.picture.cells.iter().flatten().map(|level| f32::from(*level)))
    };
    let (level, white, noise) = (
        mean(inspections.iter().map(grey)),
        mean(inspections.iter().map(|inspection| inspection.picture.white)),
        mean(inspections.iter().map(|inspection| inspection.picture.noise)),
    );
    let figures = format!("mean level {level:.0} of 255, noise {noise:.0}, {:.0} % white", 100.0 * white);
    let advice = if level < DARK {
        "it is dark: more light, or a longer exposure"
    } else if white > DAZZLED {
        "parts of the picture are white: less light, or a shorter exposure"
    } else if noise > NOISY {
        "the picture is noisy: more light, so that the camera amplifies less"
    } else {
        return finding(true, "light", figures);
    };
    finding(false, "light", format!("{advice} ({figures})"))
}

fn sharpness(inspections: &[Inspection]) -> Finding {
    match median(inspections.iter().filter_map(|inspection| inspection.picture.sharpness).collect()) {
        None => finding(
            false,
            "sharpness",
            "no sharp edge is in the picture: put parts into view, or focus the lens",
        ),
        Some(share) if share < SOFT => {
            let sentence = format!(
                "{:.0} % of an edge lies within two pixels, and {:.0} % are needed: focus the lens at the height of the parts, and clean it",
                100.0 * share,
                100.0 * SOFT
            );
            finding(false, "sharpness", sentence)
        }
        Some(share) => {
            finding(true, "sharpness", format!("{:.0} % of an edge lies within two pixels", 100.0 * share))
        }
    }
}

/// How large a marker must be in the picture, and how large it should be, by its side in pixels.
#[derive(Clone, Copy)]
struct Sizes {
    needed_px: f32,
    wanted_px: f32,
}

/// A part by its marker: whether it is seen, and is large enough in the picture.
fn part(inspections: &[Inspection], object: &Object, sizes: Sizes, format: PictureFormat) -> Finding {
    let Sizes { needed_px, wanted_px } = sizes;
    let seen: Vec<[[f32; 2]; 4]> =
        inspections.iter().filter_map(|inspection| inspection.part(object.id)).collect();
    let about = object.name.as_str();
    let twice = inspections.iter().filter(|inspection| inspection.twice.contains(&object.id)).count();
    // What is read once is a lucky pattern.
    if twice * 4 > inspections.len() {
        let sentence = format!(
            "its marker {} is in view twice, and which one is the part is not known: take the other print away, or give it another id",
            object.marker_id().unwrap_or(object.id)
        );
        return finding(false, about, sentence);
    }
    let Some(width) = median(seen.iter().map(side_px).collect()) else {
        return finding(false, about, unseen(inspections, object.marker_id().unwrap_or(object.id)));
    };
    let share = share(seen.len(), inspections.len());
    if width.round() < needed_px {
        // Rounded up, so that it is enough.
        let print_mm = (1000.0 * object.marker_side_m.unwrap_or_default() * wanted_px / width).ceil();
        let sentence = format!(
            "its marker is {width:.0} px wide; {wanted_px:.0} are needed: come nearer, or print it at {print_mm:.0} mm ({share})"
        );
        return finding(false, about, sentence);
    }
    let near_edge = seen.iter().filter(|corners| is_at_edge(corners, format)).count();
    if 2 * near_edge > seen.len() {
        let sentence = format!(
            "it lies at the edge of the picture, and is lost when it is moved: turn the camera ({share})"
        );
        return finding(false, about, sentence);
    }
    let enough = if width.round() < wanted_px {
        format!("enough, with little reserve for noise and dim light: {wanted_px:.0} are better")
    } else {
        format!("{wanted_px:.0} are needed")
    };
    finding(true, about, format!("its marker is {width:.0} px wide; {enough} ({share})"))
}

/// Why a marker is in no picture.
fn unseen(inspections: &[Inspection], id: u16) -> String {
    let count =
        |odd: usize| inspections.iter().filter(|inspection| inspection.odd[odd].contains(&id)).count();
    // What is read once is a lucky pattern.
    let often = |odd: usize| count(odd) > 1 || inspections.len() == 1 && count(odd) == 1;
    if often(0) {
        return format!(
            "its marker {id} is seen in the mirror only: the picture is mirrored, as for a selfie. Turn that off in the camera or its program"
        );
    }
    if often(1) {
        return format!(
            "its marker {id} is seen only where black and white are exchanged: the picture is a negative, or the marker was printed as one"
        );
    }
    format!(
        "its marker {id} is not seen: is it in view, flat, whole, with white around it, and printed by `andond markers`?"
    )
}

fn is_at_edge(corners: &[[f32; 2]; 4], format: PictureFormat) -> bool {
    let room = EDGE_SIDES * side_px(corners);
    let is_near = |at: f32, length: u32| at < room || at > length as f32 - 1.0 - room;
    corners.iter().any(|[x, y]| is_near(*x, format.width) || is_near(*y, format.height))
}

fn hand(inspections: &[Inspection], side: Side) -> Finding {
    let about = format!("{} hand", side.name());
    let has_hand = |inspection: &Inspection| inspection.has_hand(side);
    let between = inspections.iter().position(has_hand).zip(inspections.iter().rposition(has_hand));
    let Some((first, last)) = between else {
        let others =
            inspections.iter().filter(|inspection| inspection.hands > inspection.seen.hands().len()).count();
        if 4 * others > inspections.len() {
            let sentence = "not seen, but a hand that perception.hands does not name is in view: name both, or the one that works here";
            return finding(false, &about, sentence);
        }
        // Nobody needs to work while the bench is set up.
        return finding(true, &about, "not seen: hold it over the bench to try it");
    };
    let seen = inspections.iter().filter(|inspection| inspection.has_hand(side)).count();
    let said = share(seen, inspections.len());
    if (seen as f32) < HELD * (last - first + 1) as f32 {
        let advice = "it is lost again and again: more light, the wrist in view, or the hand bare";
        return finding(false, &about, format!("{advice} ({said})"));
    }
    finding(true, &about, said)
}

/// Markers that belong to no part.
fn strangers(inspections: &[Inspection]) -> Option<Finding> {
    let mut ids: Vec<u16> =
        inspections.iter().flat_map(|inspection| inspection.others.iter().map(|marker| marker.id)).collect();
    ids.sort_unstable();
    // What is read once is a lucky pattern.
    let often = |id: &u16| ids.iter().filter(|other| *other == id).count() * 4 > inspections.len();
    let mut known: Vec<u16> = ids.iter().filter(|id| often(id)).copied().collect();
    known.dedup();
    if !known.is_empty() {
        let listed: Vec<String> = known.iter().map(u16::to_string).collect();
        let (word, are, them) =
            if known.len() == 1 { ("marker", "is", "it") } else { ("markers", "are", "them") };
        let sentence = format!(
            "{word} {} {are} in view and in no [[objects]]: add {them} to the station file, or take {them} away; those of the bench may lie there \
             for `andond calibrate`",
            listed.join(", ")
        );
        return Some(finding(false, "others", sentence));
    }
    let is_foreign =
        inspections.iter().filter(|inspection| inspection.foreign > 0).count() * 2 > inspections.len();
    is_foreign.then(|| {
        let sentence =
            "markers of another dictionary are in view: print those of `andond markers`, or name theirs in perception.dictionary";
        finding(false, "others", sentence)
    })
}

fn share(seen: usize, of: usize) -> String {
    if of == 1 {
        "seen".to_owned()
    } else {
        format!("seen in {:.0} % of the pictures", 100.0 * seen as f32 / of as f32)
    }
}

#[cfg(test)]
mod tests;
