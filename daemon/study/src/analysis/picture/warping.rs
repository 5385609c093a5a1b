//! The executions of one kind of IU aligned with their barycentre, and the warping of one of them.

use andon_core::couple::Motion;
use andon_learn::svg::Svg;

const WIDTH: f64 = 920.0;
const LEFT: f64 = 150.0;
const RIGHT: f64 = 16.0;

/// Height of one value of a feature, and of the gap between two lanes, in pixels like all sizes here.
const VALUE: f64 = 9.0;
const GAP: f64 = 22.0;

/// Height of the room in which the warping is drawn, between the execution and the barycentre.
const BETWEEN: f64 = 46.0;

/// Maximum number of lines that show the warping: more would run into each other.
const MAX_LINES: usize = 90;

/// Name, index in `x_m`, and minimum value. The features `jm` follow from the others and are not drawn.
const FEATURES: [(&str, usize, i8); 5] =
    [("a hand", 0, -1), ("θ hand→oj", 1, 0), ("φ hand→oj", 2, 0), ("θ oj→ol", 4, 0), ("φ oj→ol", 5, 0)];

/// An execution and its warping path: frame indices in the execution and in the barycentre, from the last to the first.
pub(crate) type Execution<'a> = (&'a [Motion], Vec<(usize, usize)>);

/// What the picture shows.
pub(crate) struct Shown<'a> {
    /// The barycentre.
    pub(crate) barycentre: &'a [Motion],
    /// All executions.
    pub(crate) executions: Vec<Execution<'a>>,
    /// Index of the execution whose warping is drawn.
    pub(crate) typical: usize,
    /// The name of that execution.
    pub(crate) name: String,
}

/// Draws all executions aligned with the barycentre, then the warping of the typical one.
pub(crate) fn warping(shown: &Shown<'_>, title: &str) -> String {
    let all = || shown.executions.iter().flat_map(|(motion, _)| motion.iter()).chain(shown.barycentre);
    // A feature that is always 0 has no lane; the first one always has a lane, so that there is at least one.
    let has_lane = |index: usize| index == 0 || all().any(|motion| motion.0[index] != 0);
    // In the plane there is no elevation θ, and the one angle that is left needs no letter.
    let is_flat = all().all(|motion| motion.0[1] == 0 && motion.0[4] == 0);
    let lanes: Vec<Lane> = FEATURES
        .into_iter()
        .filter(|(_, index, _)| has_lane(*index))
        .map(|(name, index, min)| Lane {
            name: if is_flat { name.replace('φ', "direction") } else { name.to_owned() },
            index,
            min,
            max: all().map(|motion| motion.0[index]).max().unwrap_or(1).max(1),
        })
        .collect();
    let height: f64 = lanes.iter().map(|lane| lane.height() + GAP).sum();
    let directed = lanes.iter().max_by_key(|lane| changes(shown.barycentre, lane.index));
    let warp = directed.map_or(0.0, |lane| 2.0 * lane.height() + BETWEEN + GAP + 24.0);
    let mut svg = Svg::new(WIDTH, 26.0 + height + warp + 24.0, title);
    svg.text(
        LEFT,
        14.0,
        "n",
        &format!("all {} executions, aligned with the barycentre", shown.executions.len()),
    );
    let mut top = 26.0;
    for lane in &lanes {
        spread(&mut svg, lane, shown, top);
        top += lane.height() + GAP;
    }
    if let Some(lane) = directed {
        links(&mut svg, lane, shown, top + 18.0);
    }
    svg.finish()
}

/// Number of frames in which a feature changes.
fn changes(motion: &[Motion], index: usize) -> usize {
    motion.windows(2).filter(|pair| pair[0].0[index] != pair[1].0[index]).count()
}

/// The part of the picture that shows one feature.
struct Lane {
    name: String,
    index: usize,
    min: i8,
    max: i8,
}

impl Lane {
    fn height(&self) -> f64 {
        f64::from(self.max - self.min + 1) * VALUE
    }

    /// Middle of the row of a value, measured down from the top of the lane.
    fn y(&self, value: i8) -> f64 {
        (f64::from(self.max - value) + 0.5) * VALUE
    }

    fn axis(&self, svg: &mut Svg, top: f64) {
        svg.line("a", [LEFT, top], [LEFT, top + self.height()]);
        svg.text(LEFT - 26.0, top + 0.5 * self.height() + 4.0, "e", &self.name);
        for value in [self.min, 0, self.max] {
            svg.text(LEFT - 6.0, top + self.y(value) + 3.5, "s e", &value.to_string());
        }
        svg.line("g", [LEFT, top + self.y(0)], [WIDTH - RIGHT, top + self.y(0)]);
    }

    fn steps(&self, svg: &mut Svg, class: &str, motion: &[Motion], step: f64, top: f64) {
        let frame = |(index, motion): (usize, &Motion)| {
            let y = top + self.y(motion.0[self.index]);
            [[LEFT + index as f64 * step, y], [LEFT + (index + 1) as f64 * step, y]]
        };
        svg.polyline(class, motion.iter().enumerate().flat_map(frame));
    }
}

/// Draws how many executions have each value at each frame of the barycentre, and the barycentre over it.
fn spread(svg: &mut Svg, lane: &Lane, shown: &Shown<'_>, top: f64) {
    lane.axis(svg, top);
    let frames = shown.barycentre.len().max(1);
    let step = (WIDTH - LEFT - RIGHT) / frames as f64;
    let rows = usize::from(lane.max.abs_diff(lane.min)) + 1;
    let mut counts = vec![vec![0_u32; rows]; frames];
    for (motion, path) in &shown.executions {
        for &(frame, index) in path {
            let row = usize::from(motion[frame].0[lane.index].abs_diff(lane.min)).min(rows - 1);
            counts[index][row] += 1;
        }
    }
    for (index, counts) in counts.iter().enumerate() {
        let all: u32 = counts.iter().sum();
        for (row, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            let value = lane.min + row as i8;
            svg.add(format_args!(
                "<rect class=\"h\" x=\"{:.1}\" y=\"{:.1}\" width=\"{step:.1}\" height=\"{VALUE}\" opacity=\"{:.2}\"/>",
                LEFT + index as f64 * step,
                top + lane.y(value) - 0.5 * VALUE,
                (0.9 * f64::from(count) / f64::from(all.max(1))).max(0.04)
            ));
        }
    }
    lane.steps(svg, "o", shown.barycentre, step, top);
}

/// Draws one execution above the barycentre, with lines between the frames that DTW aligns.
fn links(svg: &mut Svg, lane: &Lane, shown: &Shown<'_>, top: f64) {
    let Some((motion, path)) = shown.executions.get(shown.typical) else { return };
    let longest = motion.len().max(shown.barycentre.len()).max(1);
    let step = (WIDTH - LEFT - RIGHT) / longest as f64;
    let below = top + lane.height() + BETWEEN;
    svg.text(
        LEFT,
        top - 6.0,
        "n",
        &format!("{} (above) warped onto the barycentre (below): {}", shown.name, lane.name),
    );
    lane.axis(svg, top);
    lane.axis(svg, below);
    let every = path.len().div_ceil(MAX_LINES).max(1);
    for &(frame, index) in path.iter().step_by(every) {
        let x = |index: usize| LEFT + (index as f64 + 0.5) * step;
        let from = top + lane.y(motion[frame].0[lane.index]);
        svg.line("w", [x(frame), from], [x(index), below + lane.y(shown.barycentre[index].0[lane.index])]);
    }
    lane.steps(svg, "b", motion, step, top);
    lane.steps(svg, "o", shown.barycentre, step, below);
    svg.text(WIDTH - RIGHT, below + lane.height() + 16.0, "s e", "time, frames →");
}
