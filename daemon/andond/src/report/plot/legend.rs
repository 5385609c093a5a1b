//! What the colours and the curves of a picture of a recording say.

use super::{ASSUMED, LEFT, MOVED, NO_HAND, SEEN, UNSEEN, dot, rectangle, text};

/// What the lanes show; the paper's names are those of III-A.3.
const LANES: [(&str, &str); 7] = [
    (
        "what was seen",
        "what is hidden is assumed to lie where it was, or to move with its hand; after `method.blind_ms` it is unseen",
    ),
    ("context", "one height for each set of parts that are touched, in the colour of what was seen of it"),
    ("a hand", "upper: the hand gets faster; middle: it keeps its pace; lower: it gets slower"),
    ("θ, elevation", "lower: at rest; above it the angles from down to up"),
    (
        "direction",
        "lower: at rest; above it the directions, anticlockwise from the x axis of the second one's marker",
    ),
    ("jm", "upper: both move alike; lower: they do not"),
    (
        "oj, ol",
        "oj: the part that the hand touches; ol: the part that oj touches; a gap: not measured; a dot: measured in one frame only",
    ),
];

const ROW: f64 = 20.0;

/// Draws the legend from this height on; the height at which it ends. In the plane there is no elevation.
pub(super) fn draw(out: &mut String, is_flat: bool, mut y: f64) -> f64 {
    text(out, 10.0, y + 12.0, "start", "bold", "legend");
    let mut x = LEFT;
    for (colour, word) in [SEEN, ASSUMED, UNSEEN, NO_HAND, MOVED] {
        rectangle(out, x, y + 4.0, 18.0, 8.0, colour, word);
        text(out, x + 24.0, y + 12.0, "start", "normal", word);
        // A letter is about 6 pixels wide.
        x += 50.0 + 6.0 * word.chars().count() as f64;
    }
    dot(out, x + 9.0, y + 8.0, 4.0, SEEN.0, "");
    text(out, x + 24.0, y + 12.0, "start", "normal", "seen in one frame only");
    y += ROW;
    for (lane, words) in LANES.iter().filter(|(lane, _)| !(is_flat && lane.starts_with('θ'))) {
        text(out, LEFT - 10.0, y + 12.0, "end", "normal", lane);
        text(out, LEFT, y + 12.0, "start", "normal", words);
        y += ROW;
    }
    y + 4.0
}
