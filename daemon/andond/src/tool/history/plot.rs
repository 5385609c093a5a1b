//! The summary as a picture: a Pareto chart of the faults, and a run chart of the wrong pieces over time.

use andon_core::verdict::Outcome;

use super::summary::Summary;
use crate::report::plot::{rectangle, text};
use crate::tool::clock::Clock;

// Pixels: a picture that a page shows without scrolling sideways.
const WIDTH: f64 = 900.0;
const LEFT: f64 = 330.0;
const RIGHT: f64 = 60.0;
const ROW: f64 = 28.0;
const CHART: f64 = 180.0;

// Colours that stay apart for colour-blind eyes (Okabe and Ito).
const WRONG: &str = "#d55e00";
const NOT_JUDGED: &str = "#e69f00";
const LINE: &str = "#0072b2";
const GREY: &str = "#8b949e";

/// How many faults the picture has room for.
const MAX_FAULTS: usize = 12;
/// At most this many points are on the run chart.
const MAX_POINTS: u64 = 40;
/// The lengths of time that one point stands for, in seconds: what people divide a shift by.
const STEPS_S: [u64; 10] = [60, 300, 900, 1800, 3600, 7200, 14_400, 28_800, 86_400, 604_800];

/// Draws both.
pub(super) fn draw(summary: &Summary<'_>, clock: &Clock) -> String {
    let mut body = String::new();
    let y = draw_pareto(&mut body, summary, 30.0);
    let height = draw_run_chart(&mut body, summary, clock, y + 30.0);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height:.0}\" viewBox=\"0 0 {WIDTH} {height:.0}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{body}</svg>\n"
    )
}

/// One bar per fault, the most frequent first, and how many of all wrong pieces the bars so far have.
fn draw_pareto(out: &mut String, summary: &Summary<'_>, mut y: f64) -> f64 {
    let wrong = summary.count(Outcome::Anomaly);
    let title = format!("{wrong} wrong of {} pieces, by fault", summary.pieces.len());
    text(out, 10.0, y, "start", "bold", &title);
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
        let share = 100.0 * f64::from(so_far) / wrong.max(1) as f64;
        text(out, WIDTH - 10.0, y + 18.0, "end", "normal", &format!("{share:.0} %"));
        y += ROW;
    }
    let rest: u32 = faults.iter().skip(MAX_FAULTS).map(|(_, count)| count).sum();
    if rest > 0 {
        text(out, LEFT, y + 18.0, "start", "normal", &format!("and {rest} with other faults"));
        y += ROW;
    }
    if wrong > 0 {
        text(out, WIDTH - 10.0, 44.0 - 14.0, "end", "normal", "these and all above");
    }
    y
}

/// What does not fit beside the bars ends with dots; the tool tip has all of it.
fn shortened(fault: &str) -> String {
    const LETTERS: usize = 44;
    if fault.chars().count() <= LETTERS {
        return fault.to_owned();
    }
    fault.chars().take(LETTERS - 1).chain(['…']).collect()
}

/// The share of wrong pieces in each length of time, its median, and how many pieces there were.
fn draw_run_chart(out: &mut String, summary: &Summary<'_>, clock: &Clock, y: f64) -> f64 {
    let (Some(first), Some(last)) = (summary.pieces.first(), summary.pieces.last()) else { return y };
    let (left, right) = (60.0, WIDTH - RIGHT);
    let span_ns = last.utc_ns.saturating_sub(first.utc_ns);
    let step_ns = 1_000_000_000 * step_s(span_ns / 1_000_000_000);
    let begin_ns = first.utc_ns - first.utc_ns % step_ns;
    let count = (last.utc_ns.saturating_sub(begin_ns) / step_ns + 1) as usize;
    let mut points = vec![[0_u32; 3]; count];
    for piece in &summary.pieces {
        let at = (piece.utc_ns.saturating_sub(begin_ns) / step_ns) as usize;
        let column = match piece.outcome {
            Outcome::Ok => 0,
            Outcome::Anomaly => 1,
            Outcome::NotJudged => 2,
        };
        points[at.min(count - 1)][column] += 1;
    }
    let title = format!("wrong pieces, share in each {}", span_words(step_ns / 1_000_000_000));
    text(out, 10.0, y, "start", "bold", &title);
    let (top, bottom) = (y + 20.0, y + 20.0 + CHART);
    let x = |index: usize| left + (right - left) * (index as f64 + 0.5) / count as f64;
    let at = |share: f64| bottom - CHART * share;
    for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
        rectangle(out, left, at(share), right - left, 1.0, "#e5e5e5", "");
        text(out, left - 8.0, at(share) + 4.0, "end", "normal", &format!("{:.0} %", 100.0 * share));
    }
    let share = |[ok, wrong, unjudged]: &[u32; 3]| {
        let all = ok + wrong + unjudged;
        (all > 0).then(|| (f64::from(*wrong) / f64::from(all), f64::from(*unjudged) / f64::from(all), all))
    };
    let mut path = String::new();
    let mut shares = Vec::new();
    let most = points.iter().map(|[ok, wrong, unjudged]| ok + wrong + unjudged).max().unwrap_or(1).max(1);
    let step_px = (right - left) / count as f64;
    for (index, point) in points.iter().enumerate() {
        let begin = clock.mark(begin_ns + step_ns * index as u64, span_ns);
        // About a dozen times are readable.
        if index % count.div_ceil(12) == 0 {
            text(out, x(index), bottom + 18.0, "middle", "normal", &begin);
        }
        let Some((wrong, unjudged, all)) = share(point) else { continue };
        let tip = format!("{begin}: {all} pieces, {} wrong, {} not judged", point[1], point[2]);
        let height = 40.0 * f64::from(all) / f64::from(most);
        rectangle(out, x(index) - 0.35 * step_px, bottom + 72.0 - height, 0.7 * step_px, height, GREY, &tip);
        if unjudged > 0.0 {
            rectangle(out, x(index) - 5.0, at(unjudged) - 5.0, 10.0, 10.0, NOT_JUDGED, &tip);
        }
        rectangle(out, x(index) - 4.0, at(wrong) - 4.0, 8.0, 8.0, WRONG, &tip);
        path += &format!("{}{:.1} {:.1}", if path.is_empty() { "M" } else { "L" }, x(index), at(wrong));
        shares.push(wrong);
    }
    *out += &format!("<path d=\"{path}\" fill=\"none\" stroke=\"{WRONG}\" stroke-width=\"1.5\"/>\n");
    shares.sort_by(f64::total_cmp);
    let median = shares.get(shares.len() / 2).copied().unwrap_or_default();
    *out += &format!(
        "<path d=\"M{left:.1} {0:.1}H{right:.1}\" fill=\"none\" stroke=\"{LINE}\" stroke-dasharray=\"6 4\"/>\n",
        at(median)
    );
    text(out, right + 6.0, at(median) + 4.0, "start", "normal", "median");
    text(out, right + 6.0, bottom + 62.0, "start", "normal", "pieces");
    draw_legend(out, top, right);
    bottom + 90.0
}

fn draw_legend(out: &mut String, top: f64, right: f64) {
    for (colour, word, x) in [(WRONG, "wrong", right - 190.0), (NOT_JUDGED, "not judged", right - 110.0)] {
        rectangle(out, x, top - 29.0, 10.0, 10.0, colour, word);
        text(out, x + 16.0, top - 20.0, "start", "normal", word);
    }
}

/// The length of time of one point, so that the chart has few enough of them.
fn step_s(span_s: u64) -> u64 {
    let fits = |step: &u64| span_s / step < MAX_POINTS;
    STEPS_S.into_iter().find(fits).unwrap_or(span_s / MAX_POINTS + 1)
}

fn span_words(seconds: u64) -> String {
    let (number, unit) = match seconds {
        604_800 => (1, "week"),
        86_400.. => (seconds / 86_400, "day"),
        3600.. => (seconds / 3600, "hour"),
        _ => (seconds / 60, "minute"),
    };
    if number == 1 { unit.to_owned() } else { format!("{number} {unit}s") }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::summary::Piece;
    use super::*;
    use crate::config::Config;
    use crate::tool::known::KnownJobs;

    #[test]
    fn the_picture_has_the_faults_by_their_frequency_and_the_wrong_pieces_over_time() {
        let known = KnownJobs::of(&Config::default());
        let mut summary = Summary::new(&known);
        // A piece every four minutes, of which one in five is wrong, over ten hours.
        for number in 0..150_u64 {
            let outcome = match number % 10 {
                0 | 4 => Outcome::Anomaly,
                7 if number > 100 => Outcome::NotJudged,
                _ => Outcome::Ok,
            };
            summary
                .pieces
                .push(Piece { utc_ns: 1_780_000_000_000_000_000 + number * 240_000_000_000, outcome });
        }
        for (fault, count) in
            [("step 1 (polish & clean): too few strokes", 19), ("step 2: wrong order", 8), ("left out", 3)]
        {
            summary.faults.insert((true, fault.to_owned()), count);
        }
        let drawn = draw(&summary, &Clock::new(true));
        let at = |words: &str| drawn.find(words).unwrap();
        assert!(drawn.contains("30 wrong of 150 pieces, by fault") && drawn.contains("polish &amp; clean"));
        assert!(at(">19<") < at(">8<") && drawn.contains(">63 %<") && drawn.contains(">100 %<"));
        assert!(drawn.contains("wrong pieces, share in each 15 minutes"), "{drawn}");
        assert!(drawn.starts_with("<svg") && drawn.ends_with("</svg>\n"));
    }

    #[test]
    fn the_points_are_as_far_apart_as_people_divide_a_shift() {
        assert_eq!([0, 3000, 8 * 3600, 30 * 86_400].map(step_s), [60, 300, 900, 86_400]);
        assert_eq!(
            [60, 900, 3600, 86_400, 604_800].map(span_words),
            ["minute", "15 minutes", "hour", "day", "week"]
        );
    }
}
