//! One bar per fault, the most frequent first.

use andon_core::verdict::Outcome;

use super::{RIGHT, WIDTH, WRONG};
use crate::report::plot::{rectangle, text};
use crate::tool::history::summary::Summary;

const LEFT: f64 = 330.0;
const ROW: f64 = 28.0;

/// How many faults the picture has room for.
const MAX_FAULTS: usize = 12;

/// Draws the bars from this height on, and how many of all wrong pieces the bars so far have. The height at which they end.
pub(super) fn draw(out: &mut String, summary: &Summary<'_>, mut y: f64) -> f64 {
    let wrong = summary.count(Outcome::Anomaly);
    if wrong == 0 {
        text(out, 10.0, y, "start", "bold", "no piece was wrong");
        return y;
    }
    text(out, 10.0, y, "start", "bold", &format!("wrong, by fault: {wrong}"));
    text(out, WIDTH - 10.0, y, "end", "normal", "these and all above");
    y += 14.0;
    let faults = summary.faults(true);
    let most = faults.first().map_or(1, |(_, count)| *count);
    let mut so_far = 0;
    for (fault, count) in faults.iter().take(MAX_FAULTS) {
        so_far += count;
        let width = (WIDTH - LEFT - RIGHT - 90.0) * f64::from(*count) / f64::from(most);
        text(out, LEFT - 10.0, y + 18.0, "end", "normal", &shortened(fault));
        rectangle(out, LEFT, y + 4.0, width, ROW - 8.0, WRONG, fault);
        text(out, LEFT + width + 8.0, y + 18.0, "start", "normal", &count.to_string());
        let share = 100.0 * f64::from(so_far) / wrong as f64;
        text(out, WIDTH - 10.0, y + 18.0, "end", "normal", &format!("{share:.0} %"));
        y += ROW;
    }
    let rest: u32 = faults.iter().skip(MAX_FAULTS).map(|(_, count)| count).sum();
    if rest > 0 {
        text(out, LEFT, y + 18.0, "start", "normal", &format!("and {rest} with other faults"));
        y += ROW;
    }
    y
}

/// What does not fit beside the bars has dots in its middle. The fault stands at its end, and the tool tip has all of it.
fn shortened(fault: &str) -> String {
    const LETTERS: usize = 44;
    let count = fault.chars().count();
    if count <= LETTERS {
        return fault.to_owned();
    }
    let end = LETTERS / 2;
    let begin = fault.chars().take(LETTERS - end - 1);
    begin.chain(['…']).chain(fault.chars().skip(count - end)).collect()
}
