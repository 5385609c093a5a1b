//! A recording as a picture. It shows what was seen of each hand and part, and for each hand its features and contexts, with bands for IUs and
//! activities.

mod hand;
mod legend;
mod visibility;

use std::fmt::Write as _;

use andon_core::couple::Couple;

use super::Names;
pub use visibility::RecordedVisibility;

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
const GAP: f64 = 8.0;

// Colours that stay apart for colour-blind eyes (Okabe and Ito), and what they say.
const SEEN: (&str, &str) = ("#333333", "seen");
const ASSUMED: (&str, &str) = ("#e69f00", "assumed");
const UNSEEN: (&str, &str) = ("#cc3311", "unseen");
const NO_HAND: (&str, &str) = ("#bbbbbb", "no hand seen");
const MOVED: (&str, &str) = ("#cc79a7", "moved, and no hand was seen to move it");

/// How the directions are counted.
#[derive(Clone, Copy)]
struct Angles {
    /// The number of directions around the circle.
    bins: u8,
    /// There is no elevation.
    is_flat: bool,
}

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

/// Draws what was seen, and below it the timelines of all hands, as one SVG.
pub fn draw(seen: &RecordedVisibility, timelines: &[Timeline], names: &Names, bins: u8) -> String {
    let couples = || timelines.iter().flat_map(|timeline| &timeline.couples);
    let times = || couples().map(|couple| couple.captured_ns);
    let acted = times().min().zip(times().max());
    let spans = || [seen.span_ns(), acted].into_iter().flatten();
    let axis = Axis {
        began_ns: spans().map(|(began_ns, _)| began_ns).min().unwrap_or(0),
        ended_ns: spans().map(|(_, ended_ns)| ended_ns).max().unwrap_or(1),
    };
    // Plane mode has no elevation, and an empty lane shows nothing.
    let mut motions = couples().filter_map(|couple| couple.motion);
    let is_flat = motions.all(|motion| motion.0[1] == 0 && motion.0[4] == 0);
    let mut body = String::new();
    text(&mut body, 10.0, 28.0, "start", "bold", "what was seen");
    let mut y = seen.draw(&mut body, names, &axis, 40.0) + GAP;
    for timeline in timelines {
        y = hand::draw(&mut body, timeline, names, Angles { bins, is_flat }, &axis, y);
    }
    y = draw_seconds(&mut body, &axis, y);
    y = legend::draw(&mut body, is_flat, y);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{y:.0}\" viewBox=\"0 0 {WIDTH} {y:.0}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{body}</svg>\n"
    )
}

/// Marks on whole seconds of the recording, about a dozen.
fn draw_seconds(out: &mut String, axis: &Axis, y: f64) -> f64 {
    const SECOND_NS: u64 = 1_000_000_000;
    let step = (axis.ended_ns.saturating_sub(axis.began_ns) / SECOND_NS).div_ceil(12).max(1);
    let seconds = axis.began_ns.div_ceil(SECOND_NS)..=axis.ended_ns / SECOND_NS;
    for second in seconds.step_by(step as usize) {
        text(out, axis.x(second * SECOND_NS), y + 12.0, "middle", "normal", &format!("{second} s"));
    }
    y + 30.0
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

/// Draws a dot around this point, with a tool tip.
fn dot(out: &mut String, x: f64, y: f64, radius: f64, colour: &str, tip: &str) {
    let _ = writeln!(
        out,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{colour}\"><title>{}</title></circle>",
        escape(tip)
    );
}

fn escape(words: &str) -> String {
    words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
