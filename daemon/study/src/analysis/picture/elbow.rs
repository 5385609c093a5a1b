//! A chart of the WCSS over the number of clusters.

use andon_learn::svg::Svg;

/// Width and height in pixels.
const SIZE: [f64; 2] = [560.0, 300.0];

/// Room for the axes in pixels: left, bottom and top.
const ROOM: [f64; 3] = [70.0, 40.0, 20.0];

/// Draws the WCSS for k = 1, 2, ... and marks the k that was chosen.
pub(crate) fn elbow(wcss: &[f64], k: usize) -> String {
    let mut svg = Svg::new(SIZE[0], SIZE[1], "WCSS over the number of clusters");
    let [left, bottom, above] = ROOM;
    let (floor, end) = (SIZE[1] - bottom, SIZE[0] - 20.0);
    let max = wcss.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let last = wcss.len().saturating_sub(1).max(1) as f64;
    let x = |index: usize| left + (end - left) * index as f64 / last;
    let y = |value: f64| floor - (floor - above) * value / max;
    for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
        svg.line("g", [left, y(share * max)], [end, y(share * max)]);
        svg.text(left - 8.0, y(share * max) + 4.0, "s e", &format!("{:.0}", share * max));
    }
    svg.text(8.0, 12.0, "s", "WCSS");
    for index in 0..wcss.len() {
        svg.text(x(index), floor + 16.0, "s m", &(index + 1).to_string());
    }
    svg.text(0.5 * (left + end), floor + 34.0, "m", "clusters, k");
    if let Some(&chosen) = wcss.get(k.wrapping_sub(1)) {
        svg.line("a", [x(k - 1), above], [x(k - 1), floor]);
        svg.text(x(k - 1) + 8.0, y(chosen) - 10.0, "n", &format!("elbow: k = {k}"));
    }
    svg.polyline("b", wcss.iter().enumerate().map(|(index, &value)| [x(index), y(value)]));
    for (index, &value) in wcss.iter().enumerate() {
        let class = if index + 1 == k { "d" } else { "p" };
        svg.add(format_args!(
            "<circle class=\"{class}\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"4.5\"/>",
            x(index),
            y(value)
        ));
    }
    svg.finish()
}
