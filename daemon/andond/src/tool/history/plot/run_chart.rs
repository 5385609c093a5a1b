//! The shares of wrong and of not judged pieces over time, with the median of the wrong ones, and how many pieces there were.

use andon_core::verdict::Outcome;

use super::{GREY, LINE, NOT_JUDGED, RIGHT, WIDTH, WRONG};
use crate::clock::Clock;
use crate::report::plot::{rectangle, text};
use crate::tool::history::summary::Summary;

// Pixels.
const LEFT: f64 = 60.0;
const CHART: f64 = 180.0;
const BARS: f64 = 40.0;
/// A bar is no wider than this, however few there are.
const MAX_BAR: f64 = 40.0;

/// At most this many points are on the chart.
const MAX_POINTS: u64 = 40;
/// The lengths of time that one point stands for, in seconds: what people divide a shift by.
const STEPS_S: [u64; 10] = [60, 300, 900, 1800, 3600, 7200, 14_400, 28_800, 86_400, 604_800];
/// The shares that the chart may end at, so that a line that has few wrong pieces shows how many.
const TOPS: [f64; 4] = [0.05, 0.1, 0.2, 0.5];

/// What became of the pieces in one length of time.
#[derive(Clone, Copy, Default)]
struct Point {
    all: u32,
    wrong: u32,
    not_judged: u32,
}

impl Point {
    fn add(&mut self, outcome: Outcome) {
        self.all += 1;
        match outcome {
            Outcome::Ok => (),
            Outcome::Anomaly => self.wrong += 1,
            Outcome::NotJudged => self.not_judged += 1,
        }
    }

    /// The share of the wrong ones; `None` where there were no pieces.
    fn wrong(self) -> Option<f64> {
        (self.all > 0).then(|| f64::from(self.wrong) / f64::from(self.all))
    }

    fn not_judged(self) -> Option<f64> {
        (self.all > 0).then(|| f64::from(self.not_judged) / f64::from(self.all))
    }
}

/// The pieces by lengths of time.
struct Points {
    begin_ns: u64,
    step_ns: u64,
    span_ns: u64,
    points: Vec<Point>,
}

impl Points {
    /// `None` where there is no piece.
    fn of(summary: &Summary<'_>) -> Option<Self> {
        let (first, last) = (summary.pieces.first()?, summary.pieces.last()?);
        let span_ns = last.utc_ns.saturating_sub(first.utc_ns);
        let step_ns = 1_000_000_000 * step_s(span_ns / 1_000_000_000);
        let begin_ns = first.utc_ns - first.utc_ns % step_ns;
        let index = |utc_ns: u64| (utc_ns.saturating_sub(begin_ns) / step_ns) as usize;
        let mut points = vec![Point::default(); index(last.utc_ns) + 1];
        for piece in &summary.pieces {
            if let Some(point) = points.get_mut(index(piece.utc_ns)) {
                point.add(piece.outcome);
            }
        }
        Some(Self { begin_ns, step_ns, span_ns, points })
    }

    /// The least share of [`TOPS`] that no point exceeds.
    fn top(&self) -> f64 {
        let shares = self.points.iter().flat_map(|point| [point.wrong(), point.not_judged()]).flatten();
        let most = shares.fold(0.0, f64::max);
        TOPS.into_iter().find(|top| most <= *top).unwrap_or(1.0)
    }

    fn median(&self) -> f64 {
        let mut shares: Vec<f64> = self.points.iter().filter_map(|point| point.wrong()).collect();
        shares.sort_by(f64::total_cmp);
        // One in the middle, or the two of an even number of points.
        let middle = shares.get(shares.len().saturating_sub(1) / 2..=shares.len() / 2).unwrap_or_default();
        if middle.is_empty() { 0.0 } else { middle.iter().sum::<f64>() / middle.len() as f64 }
    }

    /// Where the middle of a point lies, and how far the next one is, in pixels.
    fn x(&self, index: usize) -> (f64, f64) {
        let step = (WIDTH - RIGHT - LEFT) / self.points.len() as f64;
        (LEFT + step * (index as f64 + 0.5), step)
    }

    fn begins(&self, index: usize, clock: &Clock) -> String {
        clock.mark(self.begin_ns + self.step_ns * index as u64, self.span_ns)
    }
}

/// Draws the chart from this height on; the height at which it ends.
pub(super) fn draw(out: &mut String, summary: &Summary<'_>, clock: &Clock, y: f64) -> f64 {
    let Some(points) = Points::of(summary) else { return y };
    let title = format!("share of the pieces in each {}", span_words(points.step_ns / 1_000_000_000));
    text(out, 10.0, y, "start", "bold", &title);
    draw_legend(out, y);
    let (top, bottom) = (points.top(), y + 20.0 + CHART);
    let height = |share: f64| bottom - CHART * share / top;
    let right = WIDTH - RIGHT;
    for quarter in 0..=4 {
        let share = top * f64::from(quarter) / 4.0;
        rectangle(out, LEFT, height(share), right - LEFT, 1.0, "#e5e5e5", "");
        text(out, LEFT - 8.0, height(share) + 4.0, "end", "normal", &percent(share));
    }
    let median = height(points.median());
    *out += &format!(
        "<path d=\"M{LEFT:.1} {median:.1}H{right:.1}\" fill=\"none\" stroke=\"{LINE}\" stroke-dasharray=\"6 4\"/>\n"
    );
    text(out, right + 6.0, median + 4.0, "start", "normal", "median");
    draw_shares(out, &points, clock, &height);
    draw_pieces(out, &points, clock, bottom);
    bottom + 30.0 + BARS + 20.0
}

/// The wrong ones as squares that a line joins, and what was not judged as rings.
fn draw_shares(out: &mut String, points: &Points, clock: &Clock, height: &dyn Fn(f64) -> f64) {
    let mut path = String::new();
    for (index, point) in points.points.iter().enumerate() {
        let (Some(wrong), Some(not_judged)) = (point.wrong(), point.not_judged()) else { continue };
        let x = points.x(index).0;
        let tip = tip(point, &points.begins(index, clock));
        path += &format!("{}{x:.1} {:.1}", if path.is_empty() { "M" } else { "L" }, height(wrong));
        rectangle(out, x - 4.0, height(wrong) - 4.0, 8.0, 8.0, WRONG, &tip);
        if not_judged > 0.0 {
            draw_ring(out, x, height(not_judged));
        }
    }
    *out += &format!("<path d=\"{path}\" fill=\"none\" stroke=\"{WRONG}\" stroke-width=\"1.5\"/>\n");
}

/// How many pieces there were, as bars below the times.
fn draw_pieces(out: &mut String, points: &Points, clock: &Clock, bottom: f64) {
    let most = points.points.iter().map(|point| point.all).max().unwrap_or(1).max(1);
    let foot = bottom + 30.0 + BARS;
    for (index, point) in points.points.iter().enumerate() {
        let (x, step) = points.x(index);
        let begins = points.begins(index, clock);
        // About a dozen times are readable.
        if index % points.points.len().div_ceil(12) == 0 {
            text(out, x, bottom + 18.0, "middle", "normal", &begins);
        }
        let width = f64::min(0.7 * step, MAX_BAR);
        let height = BARS * f64::from(point.all) / f64::from(most);
        if point.all > 0 {
            rectangle(out, x - width / 2.0, foot - height, width, height, GREY, &tip(point, &begins));
        }
    }
    text(out, WIDTH - RIGHT + 6.0, foot - BARS + 10.0, "start", "normal", &most.to_string());
    text(out, WIDTH - RIGHT + 6.0, foot, "start", "normal", "pieces");
}

fn tip(point: &Point, begins: &str) -> String {
    format!("{begins}: pieces {}, wrong {}, not judged {}", point.all, point.wrong, point.not_judged)
}

fn draw_ring(out: &mut String, x: f64, y: f64) {
    *out += &format!(
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\" fill=\"none\" stroke=\"{NOT_JUDGED}\" stroke-width=\"2.5\"/>\n"
    );
}

fn draw_legend(out: &mut String, y: f64) {
    let x = WIDTH - RIGHT - 170.0;
    rectangle(out, x, y - 9.0, 9.0, 9.0, WRONG, "wrong");
    text(out, x + 16.0, y, "start", "normal", "wrong");
    draw_ring(out, x + 86.0, y - 4.5);
    text(out, x + 98.0, y, "start", "normal", "not judged");
}

fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent.fract().abs() < 0.001 { format!("{percent:.0} %") } else { format!("{percent:.1} %") }
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
    use super::super::super::summary::Piece;
    use super::*;
    use crate::tool::known_jobs::KnownJobs;
    use andon_host::config::Config;

    fn points(outcomes: &[Outcome]) -> Points {
        let known = KnownJobs::of(&Config::default());
        let mut summary = Summary::new(&known);
        summary.pieces = outcomes.iter().map(|outcome| Piece { utc_ns: 0, outcome: *outcome }).collect();
        Points::of(&summary).unwrap()
    }

    #[test]
    fn the_chart_ends_just_above_the_largest_share() {
        let mut outcomes = vec![Outcome::Ok; 99];
        assert_eq!(points(&outcomes).top(), 0.05);
        outcomes.push(Outcome::Anomaly);
        assert_eq!((points(&outcomes).top(), points(&outcomes).median()), (0.05, 0.01));
        outcomes.extend([Outcome::NotJudged; 20]);
        assert_eq!(points(&outcomes).top(), 0.2);
        assert_eq!(points(&[Outcome::Anomaly]).top(), 1.0);
        assert_eq!([0.05, 0.025].map(percent), ["5 %", "2.5 %"]);
    }

    #[test]
    fn the_median_of_an_even_number_of_points_lies_between_the_two_in_the_middle() {
        let known = KnownJobs::of(&Config::default());
        let mut summary = Summary::new(&known);
        let piece = |minute: u64, outcome| Piece { utc_ns: minute * 60_000_000_000, outcome };
        summary.pieces = vec![piece(0, Outcome::Ok), piece(1, Outcome::Anomaly)];
        let points = Points::of(&summary).unwrap();
        assert_eq!((points.points.len(), points.median()), (2, 0.5));
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
