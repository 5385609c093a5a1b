//! The last hours: alarms over the time, when nobody watched, and which faults were the most frequent.

use crate::address::Address;
use crate::board::Board;
use crate::html::Html;
use crate::shift::{STEP_NS, STEPS};
use crate::told::number;
use crate::words::Table;

/// Faults that are listed.
const FAULTS: usize = 10;

/// The chart, in units of its own: the width of a step, the height of the bars, and of the stripe beneath them.
const STEP: usize = 20;
const HEIGHT: usize = 160;
const STRIPE: usize = 14;
/// Room at the left for the numbers.
const LEFT: usize = 40;
/// A chart of fewer alarms is as high as one of so many.
const LEAST: usize = 4;

/// Steps between two times that are written.
const STEPS_OF_AN_HOUR: u64 = 6;

pub(super) fn draw(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    html.element("<section id=\"shift\"><h2>", words.say("label.shift"), "</h2>");
    chart(html, board, words);
    unwatched(html, board, words);
    faults(html, board, words, address);
    html.raw("</section>");
}

/// A rectangle of the chart.
fn rectangle(html: &mut Html, open: &'static str, [x, y, width, height]: [usize; 4]) {
    html.raw(open);
    for (name, value) in [(" x=\"", x), ("\" y=\"", y), ("\" width=\"", width), ("\" height=\"", height)] {
        html.raw(name).text(&value.to_string());
    }
    html.raw("\"/>");
}

fn text(html: &mut Html, [x, y]: [usize; 2], text: &str) {
    html.raw("<text x=\"")
        .text(&x.to_string())
        .raw("\" y=\"")
        .text(&y.to_string())
        .element("\">", text, "</text>");
}

fn chart(html: &mut Html, board: &Board, words: &Table) {
    let counts = board.shift.counts();
    let most = counts.iter().copied().max().unwrap_or_default().max(LEAST);
    let alarms = counts.iter().sum::<usize>().to_string();
    let said = words.fill("label.alarms", &[("n", &alarms)]);
    let (width, height) = (LEFT + STEPS * STEP, HEIGHT + STRIPE + 30);
    html.raw("<figure class=\"chart\"><svg role=\"img\" viewBox=\"0 -20 ")
        .text(&format!("{width} {}", height + 20));
    html.raw("\" aria-label=\"").text(&said).raw("\">");
    for (step, count) in counts.into_iter().enumerate().filter(|(_, count)| *count > 0) {
        let high = count * HEIGHT / most;
        let place = [LEFT + step * STEP + 2, HEIGHT - high, STEP - 4, high];
        rectangle(html, "<rect class=\"bar\"", place);
    }
    rectangle(html, "<rect class=\"axis\"", [LEFT, HEIGHT, STEPS * STEP, 1]);
    text(html, [LEFT / 2, HEIGHT], "0");
    text(html, [LEFT / 2, 8], &most.to_string());
    stripe(html, board);
    hours(html, board);
    html.raw("</svg>").element("<figcaption>", &said, "</figcaption></figure>");
}

/// When nobody watched, beneath the bars.
fn stripe(html: &mut Html, board: &Board) {
    let began = board.shift.began();
    // At most as wide as the chart.
    let at = |utc_ns: u64| ((utc_ns - began) * STEP as u64 / STEP_NS) as usize;
    for [from, to] in board.shift.unwatched() {
        let width = (at(to) - at(from)).max(2);
        rectangle(html, "<rect class=\"unwatched\"", [LEFT + at(from), HEIGHT + 2, width, STRIPE]);
    }
}

/// The times of the full hours.
fn hours(html: &mut Html, board: &Board) {
    let began = board.shift.began();
    for step in 0..STEPS {
        let utc_ns = began + step as u64 * STEP_NS;
        if (utc_ns / STEP_NS).is_multiple_of(STEPS_OF_AN_HOUR) {
            let time = (board.settings.local_time)(utc_ns);
            text(html, [LEFT + step * STEP, HEIGHT + STRIPE + 24], clock_time(&time));
        }
    }
}

/// Hours and minutes of a date with its time.
fn clock_time(time: &str) -> &str {
    time.split_once(' ').and_then(|(_, clock)| clock.get(..5)).unwrap_or_default()
}

fn unwatched(html: &mut Html, board: &Board, words: &Table) {
    let spans = board.shift.unwatched();
    let nanoseconds: u64 = spans.iter().map(|[from, to]| to - from).sum();
    let minutes = number(nanoseconds as f64 / 60e9, 1, words);
    let times = spans.len().to_string();
    html.raw("<p><svg class=\"sign\" viewBox=\"0 0 14 14\" aria-hidden=\"true\"><rect class=\"unwatched\" width=\"14\" height=\"14\"/></svg> ");
    html.text(&words.fill("label.unwatched", &[("n", &minutes), ("times", &times)])).raw("</p>");
}

/// The most frequent faults, each with a link to its events.
fn faults(html: &mut Html, board: &Board, words: &Table, address: &Address) {
    let faults = board.shift.faults();
    let all: usize = faults.iter().map(|(_, count)| count).sum();
    if all == 0 {
        return;
    }
    html.raw("<div class=\"wide\"><table class=\"pareto\"><thead><tr>");
    html.element("<th scope=\"col\">", words.say("label.fault"), "</th>");
    html.element("<th scope=\"col\" class=\"number\">", words.say("label.count"), "</th>");
    html.element("<th scope=\"col\">", words.say("label.share"), "</th>");
    html.raw("</tr></thead><tbody>");
    for (fault, count) in faults.into_iter().take(FAULTS) {
        let to = Address { fault: fault.to_owned(), at: String::new(), ..address.clone() };
        html.raw("<tr><td>").link(&to.link(), words.say(fault)).raw("</td>");
        html.element("<td class=\"number\">", &count.to_string(), "</td>");
        let share = 100 * count / all;
        html.raw("<td><svg viewBox=\"0 0 100 10\" preserveAspectRatio=\"none\" aria-hidden=\"true\">");
        rectangle(html, "<rect class=\"bar\"", [0, 0, share, 10]);
        html.raw("</svg> ").text(&share.to_string()).raw(" %</td></tr>");
    }
    html.raw("</tbody></table></div>");
}
