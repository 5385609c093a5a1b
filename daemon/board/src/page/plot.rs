//! A measure against what was shown, as a small plot: a bar from the least to the most that was shown, and a line where this one lies.

use crate::html::Html;

/// The plot, in units of its own, with room for the line at both ends.
const WIDTH: f32 = 100.0;
const EDGE: f32 = 3.0;

/// Draws what was measured, and the least and the most that was shown. Beside it stands the same in words.
pub(super) fn measure(html: &mut Html, [measured, shown_min, shown_max]: [f32; 3]) {
    let least = if shown_min.is_finite() { shown_min } else { 0.0 };
    // Where nothing was shown there is no most.
    let most = if shown_max.is_nan() { least } else { shown_max };
    if measured.is_finite() && most.is_finite() {
        runs(html, &[measured], [least, most]);
    }
}

/// Draws what each run measured as a line, over what is right as a bar. Beside it stands the range in words.
pub(super) fn runs(html: &mut Html, values: &[f32], [min, max]: [f32; 2]) {
    let ends = values.iter().copied().chain([min, max]).filter(|value| value.is_finite());
    let (from, to) =
        ends.fold((f32::INFINITY, f32::NEG_INFINITY), |(from, to), end| (from.min(end), to.max(end)));
    if !(from.is_finite() && to > from) {
        return;
    }
    let at = |value: f32| EDGE + (WIDTH - 2.0 * EDGE) * (value.clamp(from, to) - from) / (to - from);
    let (left, right) = (at(min), at(max));
    // What was shown once is a line as well.
    html.raw("<svg class=\"plot\" viewBox=\"0 0 100 16\" aria-hidden=\"true\"><rect class=\"shown\" y=\"4\" height=\"8\" x=\"");
    html.text(&format!("{left:.1}")).raw("\" width=\"").text(&format!("{:.1}", (right - left).max(1.0)));
    html.raw("\"/>");
    for value in values.iter().filter(|value| value.is_finite()) {
        html.raw("<path class=\"measured\" d=\"M").text(&format!("{:.1}", at(*value))).raw(" 0v16\"/>");
    }
    html.raw("</svg>");
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(values: [f32; 3]) -> String {
        let mut html = Html::default();
        measure(&mut html, values);
        html.finish()
    }

    #[test]
    fn the_line_lies_where_the_measure_does_beside_the_bar_of_what_was_shown() {
        let below = drawn([3.0, 6.0, 7.0]);
        assert!(below.contains("x=\"73.5\" width=\"23.5\"") && below.contains("M3.0 0"), "{below}");
        let above = drawn([10.0, f32::NAN, 5.0]);
        assert!(above.contains("x=\"3.0\" width=\"47.0\"") && above.contains("M97.0 0"), "{above}");
        let nothing_shown = drawn([3.0, f32::NAN, f32::NAN]);
        assert!(nothing_shown.contains("x=\"3.0\" width=\"1.0\"") && nothing_shown.contains("M97.0 0"));
        let once = drawn([4.0, 6.0, 6.0]);
        assert!(once.contains("x=\"97.0\" width=\"1.0\""), "{once}");
    }

    #[test]
    fn each_run_is_a_line_over_what_is_right() {
        let mut html = Html::default();
        runs(&mut html, &[4.0, 5.0, 5.5], [4.0, f32::INFINITY]);
        let drawn = html.finish();
        assert!(drawn.contains("x=\"3.0\" width=\"94.0\"") && drawn.matches("M").count() == 3, "{drawn}");
        let mut html = Html::default();
        runs(&mut html, &[f32::NAN, 4.0], [f32::NEG_INFINITY, f32::INFINITY]);
        assert_eq!(html.finish(), "");
    }

    #[test]
    fn what_is_no_number_or_cannot_be_compared_has_no_plot() {
        for values in [[f32::NAN, 1.0, f32::NAN], [2.0, 2.0, 2.0], [f32::INFINITY, 0.0, 1.0]] {
            assert_eq!(drawn(values), "", "{values:?}");
        }
    }
}
