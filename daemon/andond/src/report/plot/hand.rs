//! The features, IUs and activities of one hand (the paper's segmentation figure, for this recording).

use std::fmt::Write as _;

use andon_core::couple::{Context, Couple, Visibility};

use super::{
    ASSUMED, Angles, Axis, Band, GAP, LEFT, NO_HAND, RIGHT, SEEN, Timeline, UNSEEN, WIDTH, dot, rectangle,
    text,
};
use crate::report::Names;

const LANE: f64 = 34.0;
const CURVE: &str = "#0072b2";
const HEAD: f64 = 34.0;

/// The width of a letter in pixels, about.
const LETTER: f64 = 6.2;

/// The features of `x_m` in the paper's order and notation, with where their lane begins and ends.
const FEATURES: [(&str, f64, f64); 7] = [
    ("a hand", -1.0, 1.0),
    ("θ hand → oj", 0.0, 8.0),
    ("φ hand → oj", 0.0, 8.0),
    ("jm hand, oj", 0.0, 1.0),
    ("θ oj → ol", 0.0, 8.0),
    ("φ oj → ol", 0.0, 8.0),
    ("jm oj, ol", 0.0, 1.0),
];

/// Ten colours that stay apart for colour-blind eyes (Okabe and Ito, and two greys).
const COLOURS: [&str; 10] = [
    "#f3c15d", "#8fcdf0", "#7fcfb4", "#f5ee8e", "#9db8e8", "#efa27a", "#e3b0cd", "#cccccc", "#b3d9a6",
    "#c4c4ea",
];

/// Draws the lanes of a hand from this height on; the height at which they end.
pub(super) fn draw(
    out: &mut String,
    timeline: &Timeline,
    names: &Names,
    angles: Angles,
    axis: &Axis,
    mut y: f64,
) -> f64 {
    text(out, 10.0, y + 18.0, "start", "bold", &timeline.title);
    y += HEAD;
    for (title, bands) in [("activity", &timeline.activities), ("IU", &timeline.ius)] {
        draw_bands(out, title, bands, axis, y);
        y += LANE + GAP;
    }
    draw_context(out, timeline, names, axis, y);
    y += LANE + GAP;
    let Angles { bins, is_flat } = angles;
    for (feature, (title, min, max)) in FEATURES.iter().enumerate() {
        // With one angle less, the other needs no letter.
        if is_flat && title.starts_with('θ') {
            continue;
        }
        let title = if is_flat { title.replace('φ', "direction") } else { (*title).to_owned() };
        let max = if *max > 1.0 { f64::from(bins) } else { *max };
        draw_steps(out, &title, (*min, max), timeline, feature, axis, y);
        y += LANE + GAP;
    }
    y + GAP
}

fn draw_bands(out: &mut String, title: &str, bands: &[Band], axis: &Axis, y: f64) {
    text(out, LEFT - 10.0, y + LANE / 2.0 + 4.0, "end", "normal", title);
    let mut labels: Vec<&str> = bands.iter().map(|band| band.label.as_str()).collect();
    labels.sort_unstable();
    labels.dedup();
    for band in bands {
        let colour = labels.binary_search(&band.label.as_str()).map_or(0, |at| at % COLOURS.len());
        let (x, end) = (axis.x(band.began_ns), axis.x(band.ended_ns));
        rectangle(out, x, y, end - x, LANE, COLOURS[colour], &band.label);
        let lines = fitted(&band.label, end - x - 8.0);
        // Centred: one line of 14 pixels, or two.
        let first = y + LANE / 2.0 + 4.0 - 7.0 * lines.len().saturating_sub(1) as f64;
        for (row, line) in lines.iter().enumerate() {
            text(out, x + 4.0, first + 14.0 * row as f64, "start", "normal", line);
        }
    }
}

/// A label in one line, or in two where it is too wide for one. None where it does not fit: it is in the tool tip.
fn fitted(label: &str, width: f64) -> Vec<String> {
    let fits = |line: &str| LETTER * line.chars().count() as f64 <= width;
    if fits(label) {
        return vec![label.to_owned()];
    }
    let spaces = label.match_indices(' ').map(|(at, _)| [&label[..at], &label[at + 1..]]);
    let halves = spaces.min_by_key(|halves| halves.map(|half| half.chars().count()).into_iter().max());
    let halves = halves.filter(|halves| halves.iter().all(|half| fits(half)));
    halves.map(|halves| halves.map(str::to_owned).to_vec()).unwrap_or_default()
}

fn draw_context(out: &mut String, timeline: &Timeline, names: &Names, axis: &Axis, y: f64) {
    text(out, LEFT - 10.0, y + LANE / 2.0 + 4.0, "end", "normal", "context");
    let mut contexts: Vec<_> = timeline.couples.iter().map(|couple| couple.context).collect();
    contexts.sort_unstable();
    contexts.dedup();
    let look = |couple: &Couple| (couple.context, visibility(couple));
    let mut runs = timeline.couples.chunk_by(|a, b| look(a) == look(b)).peekable();
    while let Some(run) = runs.next() {
        let (first, last) = (&run[0], &run[run.len() - 1]);
        let x = axis.x(first.captured_ns);
        let next_ns = runs.peek().map_or(last.captured_ns, |next| next[0].captured_ns);
        let width = axis.x(next_ns) - x;
        let level = contexts.binary_search(&first.context).unwrap_or(0) as f64;
        let step = LANE / contexts.len().max(1) as f64;
        let (colour, visibility) = visibility(first);
        let label = format!("{:?} {}, {visibility}", first.context.0, names.context(first.context));
        rectangle(out, x, y + LANE - (level + 1.0) * step, width.max(2.0), step, colour, &label);
    }
}

/// The colour and the word for what was seen of what the context depends on. A hand that touches nothing may be anywhere, and need not be in
/// the picture; but then it is not known to be idle.
fn visibility(couple: &Couple) -> (&'static str, &'static str) {
    match couple.worst_visibility() {
        Visibility::Seen if is_out_of_picture(couple) => NO_HAND,
        Visibility::Seen => SEEN,
        Visibility::Assumed => ASSUMED,
        Visibility::Unseen => UNSEEN,
    }
}

fn is_out_of_picture(couple: &Couple) -> bool {
    couple.context == Context::IDLE && !couple.is_hand_seen()
}

fn draw_steps(
    out: &mut String,
    title: &str,
    range: (f64, f64),
    timeline: &Timeline,
    feature: usize,
    axis: &Axis,
    y: f64,
) {
    text(out, LEFT - 10.0, y + LANE / 2.0 + 4.0, "end", "normal", title);
    let _ = writeln!(
        out,
        "<rect x=\"{LEFT}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{LANE}\" fill=\"#f4f4f4\"/>",
        WIDTH - LEFT - RIGHT
    );
    let point = |couple: &Couple| {
        let motion = couple.motion.filter(|_| !is_out_of_picture(couple))?;
        let share = (f64::from(motion.0[feature]) - range.0) / (range.1 - range.0).max(1.0);
        Some((axis.x(couple.captured_ns), y + LANE - 2.0 - (LANE - 4.0) * share.clamp(0.0, 1.0)))
    };
    let points: Vec<_> = timeline.couples.iter().map(point).collect();
    let mut path = String::new();
    // There is a gap in the line where nothing was measured.
    for run in points.chunk_by(|a, b| a.is_some() == b.is_some()) {
        let mut measured = run.iter().flatten();
        let Some((x, level)) = measured.next() else { continue };
        if run.len() == 1 {
            dot(out, *x, *level, 2.0, CURVE, title);
            continue;
        }
        let _ = write!(path, "M{x:.1} {level:.1}");
        for (x, level) in measured {
            let _ = write!(path, "H{x:.1}V{level:.1}");
        }
    }
    let _ = writeln!(out, "<path d=\"{path}\" fill=\"none\" stroke=\"{CURVE}\" stroke-width=\"1.2\"/>");
}

#[cfg(test)]
mod tests {
    use super::*;
    use andon_core::couple::Motion;
    use andon_core::input::Side;

    #[test]
    fn a_feature_that_was_measured_in_one_frame_only_is_a_dot_and_one_of_several_frames_a_line() {
        let measured = |number: u64| matches!(number, 3 | 10..20);
        let couple = |number| Couple {
            context: Context([1, 6, 0, 0]),
            motion: measured(number).then_some(Motion([1; 7])),
            ..Couple::idle(Side::Right, number * 33_333_333)
        };
        let timeline = Timeline { couples: (0..30).map(couple).collect(), ..Timeline::default() };
        let mut out = String::new();
        let axis = Axis { began_ns: 0, ended_ns: 1_000_000_000 };
        draw_steps(&mut out, "a hand", (-1.0, 1.0), &timeline, 0, &axis, 0.0);
        assert_eq!((out.matches("<circle").count(), out.matches('M').count()), (1, 1), "{out}");
        assert_eq!(out.matches('H').count(), 9, "{out}");
    }

    #[test]
    fn a_label_that_is_too_wide_takes_two_lines_or_none() {
        assert_eq!(fitted("brick left at meter", 200.0), ["brick left at meter"]);
        assert_eq!(fitted("brick left at meter", 70.0), ["brick left", "at meter"]);
        assert!(fitted("brick left at meter", 50.0).is_empty());
        assert!(fitted("polisher", 10.0).is_empty());
    }
}
