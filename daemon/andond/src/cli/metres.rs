//! Lengths on a command line, which are in metres: who gives millimetres is told so.

/// The smallest and the largest side of a marker that a station file allows, in metres.
const SIDES_M: [f64; 2] = [0.005, 0.5];
/// No bench is larger, in metres.
const BENCH_M: f64 = 5.0;

/// A part as it is given: its name, and the side of its marker in metres, if it has one of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// What people call it.
    pub name: String,
    /// Side of its marker's black square in metres.
    pub side_m: Option<f64>,
}

/// A length in metres.
///
/// # Errors
/// That it is no number, with an example.
pub fn metres(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| format!("{text:?} is not a length in metres, such as 0.04"))
}

/// The side of a marker, in metres.
///
/// # Errors
/// Why it cannot be one, and what may have been meant.
pub fn side(text: &str) -> Result<f64, String> {
    let side_m = metres(text)?;
    let [min, max] = SIDES_M;
    if (min..=max).contains(&side_m) {
        return Ok(side_m);
    }
    let meant = side_m / 1000.0;
    if side_m > max && (min..=max).contains(&meant) {
        return Err(format!(
            "{side_m} m is no side of a marker; lengths are in metres: {side_m} mm is {meant}"
        ));
    }
    Err(format!("{side_m} m is no side of a marker; it must be from {min} to {max} m"))
}

/// A position on the bench along one axis, in metres.
///
/// # Errors
/// As [`side`].
pub fn position(text: &str) -> Result<f64, String> {
    let at_m = metres(text)?;
    if at_m.abs() <= BENCH_M {
        return Ok(at_m);
    }
    let meant = at_m / 1000.0;
    Err(format!("{at_m} m lies on no bench; positions are in metres: {at_m} mm is {meant}"))
}

/// A part: `NAME` or `NAME=METRES`.
///
/// # Errors
/// As [`side`].
pub fn named(text: &str) -> Result<Named, String> {
    let (name, side_m) = match text.rsplit_once('=') {
        Some((name, given)) => (name, Some(side(given)?)),
        None => (text, None),
    };
    let name = name.trim();
    if !(1..=32).contains(&name.chars().count()) || name.contains(char::is_control) {
        return Err(format!(
            "{name:?} cannot be the name of a part; it must have 1 to 32 characters on one line"
        ));
    }
    Ok(Named { name: name.to_owned(), side_m })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn millimetres_are_refused_with_what_they_are_in_metres() {
        assert_eq!(side("0.04").unwrap(), 0.04);
        assert_eq!(
            side("40").unwrap_err(),
            "40 m is no side of a marker; lengths are in metres: 40 mm is 0.04"
        );
        assert_eq!(position("-0.25").unwrap(), -0.25);
        assert_eq!(
            position("-250").unwrap_err(),
            "-250 m lies on no bench; positions are in metres: -250 mm is -0.25"
        );
    }

    #[test]
    fn what_is_no_length_is_refused_with_an_example() {
        for text in ["", "x", "4 cm", "inf", "NaN"] {
            assert!(side(text).unwrap_err().contains("such as 0.04"), "{text}");
        }
        assert!(side("0.7").unwrap_err().ends_with("from 0.005 to 0.5 m"));
        assert!(side("-0.04").unwrap_err().ends_with("from 0.005 to 0.5 m"));
    }

    #[test]
    fn a_part_has_a_name_and_may_have_a_side() {
        assert_eq!(named("brick").unwrap(), Named { name: "brick".into(), side_m: None });
        assert_eq!(
            named("base plate=0.033").unwrap(),
            Named { name: "base plate".into(), side_m: Some(0.033) }
        );
        assert!(named("brick=33").unwrap_err().ends_with("33 mm is 0.033"));
        for text in ["", "=0.04", "a part whose name is longer than a name may be"] {
            assert!(named(text).unwrap_err().contains("name of a part"), "{text}");
        }
    }
}
