//! A confidence matrix as a picture: dark is alike, as in the paper's figures.

use crate::analysis::matrix::Matrix;
use andon_learn::html::escaped;
use andon_learn::svg::Svg;

/// Side of the square that the cells fill, in pixels like all sizes here.
const SIDE: f64 = 560.0;

/// Room for the names of rows and columns.
const MARGIN: f64 = 72.0;

/// About the width of one letter of a group's name.
const LETTER: f64 = 8.5;

/// With more rows than this there is no room for a name per row, so only the groups are named.
const MAX_NAMED_ROWS: usize = 30;

/// Number of shades that the eye can distinguish; neighbouring cells of the same shade are drawn as one.
const SHADES: f64 = 40.0;

/// Red, green and blue from alike to different: a blue that becomes lighter, which is readable on light and on dark pages.
const RAMP: [[f64; 3]; 3] = [[8.0, 48.0, 107.0], [74.0, 144.0, 196.0], [240.0, 246.0, 252.0]];

/// How to read the shades.
pub(crate) const LEGEND: &str = "dark: alike, light: different";

fn shade(value: f64) -> u32 {
    (value.clamp(0.0, 1.0) * SHADES).round() as u32
}

fn colour(shade: u32) -> String {
    let along = f64::from(shade) / SHADES * 2.0;
    let (from, to, share) =
        if along < 1.0 { (RAMP[0], RAMP[1], along) } else { (RAMP[1], RAMP[2], along - 1.0) };
    let mix = |index: usize| (from[index] + (to[index] - from[index]) * share).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// Draws a matrix. `group` gives the name of a group of rows.
pub(crate) fn heat(matrix: &Matrix, title: &str, group: impl Fn(usize) -> String) -> String {
    let rows = matrix.rows.len().max(1);
    let cell = SIDE / rows as f64;
    let mut svg = Svg::new(MARGIN + SIDE + 130.0, MARGIN + SIDE + 14.0, title);
    svg.add(format_args!("<g shape-rendering=\"crispEdges\">"));
    for (row, values) in matrix.values.chunks(rows).enumerate() {
        let y = MARGIN + row as f64 * cell;
        let mut column = 0;
        for same in values.chunk_by(|a, b| shade(*a) == shade(*b)) {
            let (x, width) = (MARGIN + column as f64 * cell, same.len() as f64 * cell);
            svg.add(format_args!(
                "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{cell:.2}\" fill=\"{}\"/>",
                colour(shade(same[0]))
            ));
            column += same.len();
        }
    }
    svg.add(format_args!("</g>"));
    names(&mut svg, matrix, cell, group);
    legend(&mut svg, matrix.max_distance);
    svg.finish()
}

fn names(svg: &mut Svg, matrix: &Matrix, cell: f64, group: impl Fn(usize) -> String) {
    let mut begin = 0;
    for same in matrix.rows.chunk_by(|a, b| a.0 == b.0) {
        let (from, middle) =
            (MARGIN + begin as f64 * cell, MARGIN + (begin as f64 + 0.5 * same.len() as f64) * cell);
        if begin > 0 {
            svg.line("k", [from, MARGIN], [from, MARGIN + SIDE]);
            svg.line("k", [MARGIN, from], [MARGIN + SIDE, from]);
        }
        let name = group(same[0].0);
        let above = if matrix.rows.len() <= MAX_NAMED_ROWS { 28.0 } else { MARGIN - 8.0 };
        if LETTER * name.chars().count() as f64 <= same.len() as f64 * cell {
            svg.text(middle, above, "n m", &name);
        } else {
            upright(svg, middle + 4.0, above, "n", &name);
        }
        if matrix.rows.len() <= MAX_NAMED_ROWS {
            for (index, (_, name)) in same.iter().enumerate() {
                let at = from + (index as f64 + 0.5) * cell;
                svg.text(MARGIN - 5.0, at + 3.5, "s e", name);
                upright(svg, at + 3.5, MARGIN - 5.0, "s", name);
            }
        } else {
            svg.text(MARGIN - 8.0, middle + 4.0, "n e", &name);
        }
        begin += same.len();
    }
}

/// Text that is read from below, for a column that is narrower than its name.
fn upright(svg: &mut Svg, x: f64, y: f64, class: &str, text: &str) {
    svg.add(format_args!(
        "<text class=\"t {class}\" transform=\"translate({x:.1} {y:.1}) rotate(-90)\">{}</text>",
        escaped(text)
    ));
}

fn legend(svg: &mut Svg, max_distance: f64) {
    let (x, step) = (MARGIN + SIDE + 22.0, 200.0 / SHADES);
    for shade in 0..=SHADES as u32 {
        svg.add(format_args!(
            "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"16\" height=\"{:.2}\" fill=\"{}\"/>",
            MARGIN + f64::from(shade) * step,
            step + 0.4,
            colour(shade)
        ));
    }
    svg.text(x + 22.0, MARGIN + 10.0, "s", "0: alike");
    svg.text(x + 22.0, MARGIN + 204.0, "s", "1: furthest");
    svg.text(x + 22.0, MARGIN + 218.0, "s", &format!("(DTW {max_distance:.1})"));
}
