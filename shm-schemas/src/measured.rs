//! A measure that is out of its bounds, in words: "4 strokes, shown 6".

use crate::verdict::VerdictMeasure;
use core::fmt;

/// More decimals than this say nothing to anybody: a tenth of a millimetre.
const MAX_DECIMALS: usize = 2;

/// What was measured, beside what was shown, as a person says it. Prints nothing where no measure is out of its bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredWords {
    /// Which measure it is, and the unit of the numbers.
    pub measure: VerdictMeasure,
    /// What was measured.
    pub value: f32,
    /// The minimum that was shown.
    pub shown_min: f32,
    /// The most that was shown.
    pub shown_max: f32,
}

impl fmt::Display for MeasuredWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { measure, value, shown_min: min, shown_max: max } = *self;
        let centimetres = || [value, min, max].map(|metres| 100.0 * metres);
        match measure {
            VerdictMeasure::None => Ok(()),
            VerdictMeasure::Duration => {
                let decimals = decimals([value, min, max], 1);
                write!(f, "{value:.decimals$} s, shown {} s", Shown { min, max, decimals })
            }
            VerdictMeasure::Strokes => {
                let word = if value == 1.0 { "stroke" } else { "strokes" };
                if min == max {
                    write!(f, "{value} {word}, shown {min}")
                } else {
                    write!(f, "{value} {word}, shown {min} to {max}")
                }
            }
            VerdictMeasure::StrokeLength => {
                let ([value, min, max], decimals) = (centimetres(), decimals(centimetres(), 1));
                write!(f, "strokes of {value:.decimals$} cm, shown {} cm", Shown { min, max, decimals })
            }
            VerdictMeasure::Path => write_path(f, centimetres()),
            VerdictMeasure::LateralDeviation => {
                let ([value, _, max], decimals) = (centimetres(), decimals(centimetres(), 0));
                write!(f, "{value:.decimals$} cm off the straight way, shown up to {max:.decimals$} cm")
            }
            VerdictMeasure::Direction => {
                let decimals = decimals([value, min, max], 0);
                write!(f, "{value:.decimals$} degrees off the shown direction, shown up to {max:.decimals$}")
            }
            VerdictMeasure::Place => {
                let ([value, _, max], decimals) = (centimetres(), decimals(centimetres(), 1));
                write!(f, "{value:.decimals$} cm off the shown place, shown up to {max:.decimals$} cm")
            }
        }
    }
}

/// A way round leads off the path and back, so half of what it adds to the length is how far off it led.
fn write_path(f: &mut fmt::Formatter<'_>, centimetres: [f32; 3]) -> fmt::Result {
    let ([value, min, max], decimals) = (centimetres, decimals(centimetres, 0));
    let off = (value - max) / 2.0;
    let shown = Shown { min, max, decimals };
    if off > 0.0 {
        write!(f, "{off:.0} cm off the shown path ({value:.decimals$} cm long, shown {shown} cm)")
    } else {
        write!(f, "a path of {value:.decimals$} cm, shown {shown} cm")
    }
}

/// From the minimum to the maximum; one number where they are the same.
struct Shown {
    min: f32,
    max: f32,
    decimals: usize,
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { min, max, decimals } = *self;
        if min == max {
            write!(f, "{min:.decimals$}")
        } else {
            write!(f, "{min:.decimals$} to {max:.decimals$}")
        }
    }
}

/// The number of decimals, at least `min`, with which a value that differs from what was shown also looks different.
/// The values are what was measured, the minimum and the maximum that were shown; none is negative.
pub fn decimals(values: [f32; 3], min: usize) -> usize {
    let looks_different = |decimals: &usize| {
        let [value, min, max] = values.map(|value| digits(value, *decimals));
        value != min && value != max
    };
    (min..=MAX_DECIMALS).find(looks_different).unwrap_or(min)
}

/// The digits that are printed of a number with so many decimals. As in printing, a half goes to the even digit.
fn digits(value: f32, decimals: usize) -> u64 {
    // Exact: 24 bits times at most 7.
    let scaled = f64::from(value) * [1.0, 10.0, 100.0][decimals];
    let below = scaled as u64;
    let rest = scaled - below as f64;
    below + u64::from(rest > 0.5 || rest == 0.5 && below % 2 == 1)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[track_caller]
    fn check(measure: VerdictMeasure, [value, shown_min, shown_max]: [f32; 3], expected: &str) {
        assert_eq!(MeasuredWords { measure, value, shown_min, shown_max }.to_string(), expected);
    }

    #[test]
    fn strokes_are_counted_as_people_count() {
        check(VerdictMeasure::Strokes, [4.0, 6.0, 6.0], "4 strokes, shown 6");
        check(VerdictMeasure::Strokes, [1.0, 6.0, 7.0], "1 stroke, shown 6 to 7");
        check(VerdictMeasure::Strokes, [5.0, 5.5, 6.5], "5 strokes, shown 5.5 to 6.5");
    }

    #[test]
    fn a_time_is_said_in_seconds() {
        check(VerdictMeasure::Duration, [2.1, 4.8, 5.4], "2.1 s, shown 4.8 to 5.4 s");
        check(VerdictMeasure::Duration, [5.43, 4.8, 5.38], "5.43 s, shown 4.80 to 5.38 s");
        check(VerdictMeasure::Duration, [1.0, 1.0, 1.0], "1.0 s, shown 1.0 s");
        // Printing makes 2.2 of both.
        check(VerdictMeasure::Duration, [2.25, 1.0, 2.2], "2.25 s, shown 1.00 to 2.20 s");
    }

    #[test]
    fn a_way_round_is_said_by_how_far_off_it_led() {
        let detour = "25 cm off the shown path (104 cm long, shown 49 to 54 cm)";
        check(VerdictMeasure::Path, [1.04, 0.49, 0.54], detour);
        let words = "30 cm off the straight way, shown up to 18 cm";
        check(VerdictMeasure::LateralDeviation, [0.3, 0.0, 0.18], words);
        check(VerdictMeasure::Path, [0.2, 0.49, 0.54], "a path of 20 cm, shown 49 to 54 cm");
    }

    #[test]
    fn size_direction_and_place_of_a_motion_are_said_beside_what_was_shown() {
        let strokes = "strokes of 1.8 cm, shown 5.2 to 7.3 cm";
        check(VerdictMeasure::StrokeLength, [0.018, 0.052, 0.073], strokes);
        let across = "82 degrees off the shown direction, shown up to 9";
        check(VerdictMeasure::Direction, [82.0, 0.0, 9.4], across);
        check(VerdictMeasure::Place, [0.061, 0.0, 0.012], "6.1 cm off the shown place, shown up to 1.2 cm");
        check(VerdictMeasure::None, [0.0; 3], "");
    }
}
