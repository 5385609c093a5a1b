//! A recording as a picture: one lane per feature and context, bands for IUs and activities (the paper's
//! segmentation figure, for this recording).

use std::fmt::Write as _;

use andon_core::couple::{Context, Couple, Sight};

use super::Names;

/// A stretch of time with a label.
#[derive(Clone, Debug)]
pub struct Band {
    /// What it is.
    pub label: String,
    /// When it began, in nanoseconds.
    pub began_ns: u64,
    /// When it ended, in nanoseconds.
    pub ended_ns: u64,
}

/// Everything that is drawn of one hand.
#[derive(Clone, Debug, Default)]
pub struct Timeline {
    /// The name of the hand.
    pub title: String,
    /// Feature couples, one per frame of the grid.
    pub couples: Vec<Couple>,
    /// IUs in order.
    pub ius: Vec<Band>,
    /// Activities in order.
    pub activities: Vec<Band>,
}

// Pixels: a page that a browser shows without scrolling sideways, and lanes that a finger can point at.
const WIDTH: f64 = 1200.0;
const LEFT: f64 = 150.0;
const RIGHT: f64 = 20.0;
const LANE: f64 = 34.0;
const GAP: f64 = 8.0;
const HEAD: f64 = 34.0;

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

// The colours of the lane of contexts, and what they say.
const SEEN: (&str, &str) = ("#333333", "seen");
const ASSUMED: (&str, &str) = ("#e69f00", "assumed");
const UNSEEN: (&str, &str) = ("#cc3311", "unseen");
const NO_HAND: (&str, &str) = ("#bbbbbb", "no hand seen");

struct Axis {
    began_ns: u64,
    ended_ns: u64,
}

impl Axis {
    fn x(&self, ns: u64) -> f64 {
        let span = (self.ended_ns - self.began_ns).max(1) as f64;
        LEFT + (WIDTH - LEFT - RIGHT) * ns.saturating_sub(self.began_ns) as f64 / span
    }
}

/// Draws the timelines of all hands below each other as one SVG.
pub fn draw(timelines: &[Timeline], names: &Names, bins: u8) -> String {
    let times = || timelines.iter().flat_map(|timeline| &timeline.couples).map(|couple| couple.captured_ns);
    let axis = Axis { began_ns: times().min().unwrap_or(0), ended_ns: times().max().unwrap_or(1) };
    let mut body = String::new();
    let mut y = 10.0;
    for timeline in timelines {
        y = draw_timeline(&mut body, timeline, names, bins, &axis, y);
    }
    y = draw_seconds(&mut body, &axis, y);
    y = draw_legend(&mut body, y);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{y:.0}\" viewBox=\"0 0 {WIDTH} {y:.0}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{body}</svg>\n"
    )
}

fn draw_timeline(
    out: &mut String,
    timeline: &Timeline,
    names: &Names,
    bins: u8,
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
    let mut motions = timeline.couples.iter().filter_map(|couple| couple.motion);
    let is_flat = motions.all(|motion| motion.0[1] == 0 && motion.0[4] == 0);
    for (feature, (title, min, max)) in FEATURES.iter().enumerate() {
        // Plane mode has no elevation, and an empty lane shows nothing. With one angle less, the other needs no letter.
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
        // A letter is about 6.5 pixels wide. A label that does not fit is in the tool tip.
        if (end - x) > 6.5 * band.label.chars().count() as f64 {
            text(out, x + 4.0, y + LANE / 2.0 + 4.0, "start", "normal", &band.label);
        }
    }
}

fn draw_context(out: &mut String, timeline: &Timeline, names: &Names, axis: &Axis, y: f64) {
    text(out, LEFT - 10.0, y + LANE / 2.0 + 4.0, "end", "normal", "context");
    let mut contexts: Vec<_> = timeline.couples.iter().map(|couple| couple.context).collect();
    contexts.sort_unstable();
    contexts.dedup();
    let look = |couple: &Couple| (couple.context, sight(couple));
    for run in timeline.couples.chunk_by(|a, b| look(a) == look(b)) {
        let (first, last) = (&run[0], &run[run.len() - 1]);
        let x = axis.x(first.captured_ns);
        let width = axis.x(last.captured_ns) - x;
        let level = contexts.binary_search(&first.context).unwrap_or(0) as f64;
        let step = LANE / contexts.len().max(1) as f64;
        let (colour, sight) = sight(first);
        let label = format!("{:?} {}, {sight}", first.context.0, names.context(first.context));
        rectangle(out, x, y + LANE - (level + 1.0) * step, width.max(1.0), step, colour, &label);
    }
}

/// The colour and the word for what was seen of what the context rests on. A hand that touches nothing may be anywhere, and need not be in
/// the picture; but then it is not known to be idle.
fn sight(couple: &Couple) -> (&'static str, &'static str) {
    match couple.worst_sight() {
        Sight::Seen if is_out_of_picture(couple) => NO_HAND,
        Sight::Seen => SEEN,
        Sight::Assumed => ASSUMED,
        Sight::Unseen => UNSEEN,
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
    let mut path = String::new();
    // There is a gap in the line where nothing was measured.
    let mut is_drawn = false;
    for couple in &timeline.couples {
        let measured = couple.motion.filter(|_| !is_out_of_picture(couple));
        let was_drawn = std::mem::replace(&mut is_drawn, measured.is_some());
        let Some(motion) = measured else { continue };
        let share = (f64::from(motion.0[feature]) - range.0) / (range.1 - range.0).max(1.0);
        let (x, level) = (axis.x(couple.captured_ns), y + LANE - 2.0 - (LANE - 4.0) * share.clamp(0.0, 1.0));
        let _ =
            if was_drawn { write!(path, "H{x:.1}V{level:.1}") } else { write!(path, "M{x:.1} {level:.1}") };
    }
    let _ = writeln!(out, "<path d=\"{path}\" fill=\"none\" stroke=\"#0072b2\" stroke-width=\"1.2\"/>");
}

fn draw_seconds(out: &mut String, axis: &Axis, y: f64) -> f64 {
    let span_s = (axis.ended_ns - axis.began_ns) as f64 / 1e9;
    // About a dozen marks on whole seconds.
    let step = (span_s / 12.0).ceil().max(1.0) as u64;
    for second in (0..=span_s as u64).step_by(step as usize) {
        let x = axis.x(axis.began_ns + second * 1_000_000_000);
        text(out, x, y + 12.0, "middle", "normal", &format!("{second} s"));
    }
    y + 24.0
}

/// What the colours of the contexts say; a gap in a feature was not measured.
fn draw_legend(out: &mut String, y: f64) -> f64 {
    text(out, LEFT - 10.0, y + 12.0, "end", "normal", "context:");
    for (index, (colour, word)) in [SEEN, ASSUMED, UNSEEN, NO_HAND].into_iter().enumerate() {
        let x = LEFT + 110.0 * index as f64;
        rectangle(out, x, y + 4.0, 18.0, 8.0, colour, word);
        text(out, x + 24.0, y + 12.0, "start", "normal", word);
    }
    y + 24.0
}

/// Writes a text.
pub(crate) fn text(out: &mut String, x: f64, y: f64, anchor: &str, weight: &str, label: &str) {
    let _ = writeln!(
        out,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-weight=\"{weight}\">{}</text>",
        escape(label)
    );
}

/// Draws a rectangle with a tool tip.
pub(crate) fn rectangle(out: &mut String, x: f64, y: f64, width: f64, height: f64, colour: &str, tip: &str) {
    let _ = writeln!(
        out,
        "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"{colour}\"><title>{}</title></rect>",
        escape(tip)
    );
}

fn escape(words: &str) -> String {
    words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
