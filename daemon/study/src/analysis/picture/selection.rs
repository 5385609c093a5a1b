//! How candidates drop out while an activity is carried out (the paper's figure of the selection of candidates).

use crate::analysis::candidates::{Candidate, Selection};
use andon_learn::svg::Svg;

const WIDTH: f64 = 920.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 190.0;

/// Height of the room for distances, in pixels like all sizes here.
const HEIGHT: f64 = 260.0;

/// Room for the names of the IUs above the distances.
const TOP: f64 = 44.0;

/// Height of a line of the list below.
const LINE: f64 = 18.0;

/// Distances beyond this share of the threshold are cut off: the candidate has long dropped out.
const MOST: f64 = 1.5;

/// Dashes that tell candidates apart without colour.
const DASHES: [&str; 4] = ["none", "7 3", "2 3", "9 3 2 3"];

/// Draws a selection of candidates.
pub(crate) fn selection(selection: &Selection, title: &str) -> String {
    let end = selection.ius.last().map_or(1.0, |(time, _)| *time).max(0.1);
    let plot = Plot { end };
    let list = LINE * selection.candidates.len() as f64;
    let mut svg = Svg::new(WIDTH, TOP + HEIGHT + 50.0 + list + 8.0, title);
    plot.axes(&mut svg, selection);
    for (index, candidate) in selection.candidates.iter().enumerate() {
        plot.candidate(&mut svg, index, candidate);
    }
    svg.finish()
}

struct Plot {
    /// The end of the activity in seconds.
    end: f64,
}

impl Plot {
    fn x(&self, time: f64) -> f64 {
        LEFT + (WIDTH - LEFT - RIGHT) * time / self.end
    }

    fn y(share: f64) -> f64 {
        TOP + HEIGHT * (1.0 - share.min(MOST) / MOST)
    }

    fn axes(&self, svg: &mut Svg, selection: &Selection) {
        let [left, right, floor] = [self.x(0.0), self.x(self.end), Self::y(0.0)];
        for share in [0.0, 0.5, 1.5] {
            svg.line("g", [left, Self::y(share)], [right, Self::y(share)]);
            svg.text(left - 6.0, Self::y(share) + 4.0, "s e", &format!("{share:.1}"));
        }
        svg.line("o", [left, Self::y(1.0)], [right, Self::y(1.0)]);
        svg.text(left - 6.0, Self::y(1.0) + 4.0, "s e", "1.0");
        svg.text(right + 8.0, Self::y(1.0) + 4.0, "s", "threshold");
        svg.text(2.0, 12.0, "s", "distance / threshold");
        for (index, (time, what)) in selection.ius.iter().enumerate() {
            svg.line("w", [self.x(*time), TOP - 8.0], [self.x(*time), floor]);
            // Two rows, so that the names of short IUs do not run into each other.
            svg.text(self.x(*time) + 3.0, TOP - 14.0 + 12.0 * (index % 2) as f64, "s", what);
        }
        for second in 0..=self.end as u32 {
            svg.text(self.x(f64::from(second)), floor + 14.0, "s m", &second.to_string());
        }
        svg.text(right, floor + 30.0, "s e", "time from the beginning of the activity, s →");
    }

    fn candidate(&self, svg: &mut Svg, index: usize, candidate: &Candidate) {
        let class = format!("c{}", index % 6);
        let dashes = DASHES[index % DASHES.len()];
        svg.add(format_args!("<g stroke-dasharray=\"{dashes}\">"));
        for distances in &candidate.distances {
            svg.polyline(&class, distances.iter().map(|&[time, share]| [self.x(time), Self::y(share)]));
        }
        let row = TOP + HEIGHT + 50.0 + LINE * index as f64;
        svg.line(&class, [LEFT, row - 4.0], [LEFT + 34.0, row - 4.0]);
        svg.add(format_args!("</g>"));
        let fate = match candidate.dropped {
            None => "remains to the end".to_owned(),
            Some((time, why)) => {
                let line = candidate.distances.last();
                let share = line.and_then(|all| all.iter().rev().find(|at| at[0] <= time)).map(|at| at[1]);
                // Those that drop out at once have no line, and would lie upon each other.
                let y = share.map_or(Self::y(0.0) - 3.0 * index as f64, Self::y);
                svg.text(self.x(time) - 4.0, y + 4.0, "n", "✕");
                let when = if time > 0.0 { format!("after {time:.1} s") } else { "at once".to_owned() };
                format!("drops out {when} by {}", why.word())
            }
        };
        svg.text(LEFT + 42.0, row, "", &format!("{}: {fate}", candidate.name));
    }
}
