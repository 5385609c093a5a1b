//! The summary as a picture: a Pareto chart of the faults, and a run chart of the wrong pieces over time.

mod pareto;
mod run_chart;

use super::summary::Summary;
use crate::clock::Clock;
use crate::report::plot::text;

// Pixels: a picture that a page shows without scrolling sideways.
const WIDTH: f64 = 900.0;
const RIGHT: f64 = 60.0;

// Colours that stay apart for colour-blind eyes (Okabe and Ito).
const WRONG: &str = "#d55e00";
const NOT_JUDGED: &str = "#56b4e9";
const LINE: &str = "#0072b2";
const GREY: &str = "#8b949e";

/// Draws both.
pub(super) fn draw(summary: &Summary<'_>, clock: &Clock) -> String {
    let mut body = String::new();
    text(&mut body, 10.0, 26.0, "start", "bold", &summary.span(clock));
    let y = pareto::draw(&mut body, summary, 60.0);
    let height = run_chart::draw(&mut body, summary, clock, y + 34.0);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height:.0}\" viewBox=\"0 0 {WIDTH} {height:.0}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{body}</svg>\n"
    )
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::summary::Piece;
    use super::*;
    use crate::tool::known_jobs::KnownJobs;
    use andon_core::verdict::Outcome;
    use andon_host::config::Config;

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
        assert!(
            drawn.contains("150 pieces from 2026-05-28 ")
                && drawn.contains("wrong, by fault: 30")
                && drawn.contains("polish &amp; clean")
        );
        assert!(at(">19<") < at(">8<") && drawn.contains(">63 %<") && drawn.contains(">100 %<"));
        assert!(drawn.contains("share of the pieces in each 15 minutes"), "{drawn}");
        assert!(drawn.starts_with("<svg") && drawn.ends_with("</svg>\n"));
    }
}
