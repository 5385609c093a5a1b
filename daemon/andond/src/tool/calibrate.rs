//! `andond calibrate`: places the bench by a picture with four known markers.

use andon_perception::bench::{BenchMarker, calibrate};
use andon_perception::markers::Dictionary;
use andon_perception::{ImageView, PixelFormat};

use super::{Failure, load_config_to_learn, will_write};
use crate::cli::Calibrate;
use crate::exit::Code;
use crate::video::{Film, VideoError};

/// Runs the command.
///
/// # Errors
/// A place that cannot be read, a picture that shows too little, markers that do not fit their places.
pub fn run(arguments: &Calibrate) -> Result<Code, Failure> {
    let config = load_config_to_learn(&arguments.config)?;
    will_write(&arguments.out)?;
    let side_m = f64::from(arguments.side);
    let markers = arguments.markers.iter().map(|text| marker(text, side_m)).collect::<Result<Vec<_>, _>>()?;
    let unusable = |error: &dyn std::fmt::Display| {
        Failure::new(Code::Usage, format!("{}: {error}", arguments.picture.display()))
    };
    // These name the picture themselves.
    let unreadable = |error: VideoError| Failure::new(Code::Usage, error);
    let mut film = Film::open(&arguments.picture, config.camera.rate_hz).map_err(unreadable)?;
    if film.advance().map_err(unreadable)?.is_none() {
        return Err(unusable(&"there is no picture in it"));
    }
    let (width, height) = (film.format().width as usize, film.format().height as usize);
    let image = ImageView::new(width, height, width * 3, PixelFormat::Bgr8, film.picture())
        .map_err(|error| unusable(&error))?;
    let dictionary = Dictionary::named(&config.perception.dictionary.name()).unwrap_or_default();
    let calibration = calibrate(&image, &markers, dictionary).map_err(|error| unusable(&error))?;
    calibration.save(&arguments.out).map_err(|error| Failure::new(Code::Usage, error))?;
    println!(
        "{}: the markers fit their places to {:.1} mm and their sides to {:.1} %; name the file in bench.calibration",
        arguments.out.display(),
        1000.0 * calibration.centre_error_m,
        100.0 * calibration.side_error
    );
    Ok(Code::Stopped)
}

/// A marker as it is given: `ID=X,Y`, in metres.
fn marker(text: &str, side_m: f64) -> Result<BenchMarker, Failure> {
    let parse = || {
        let (id, place) = text.split_once('=')?;
        let (x, y) = place.split_once(',')?;
        let centre_m = [x.trim().parse().ok()?, y.trim().parse().ok()?];
        Some(BenchMarker { id: id.trim().parse().ok()?, centre_m, side_m })
    };
    parse().ok_or_else(|| {
        Failure::new(
            Code::Usage,
            format!("--marker {text:?}: give its id and its place in metres, as 7=0.10,0.25"),
        )
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_marker_has_an_id_and_a_place() {
        let known = marker("7=0.10,-0.25", 0.04).unwrap();
        assert_eq!(known, BenchMarker { id: 7, centre_m: [0.10, -0.25], side_m: 0.04 });
    }

    #[test]
    fn anything_else_is_refused_with_an_example() {
        for text in ["", "7", "7=1", "x=1,2", "7=1;2", "70000=1,2"] {
            assert!(marker(text, 0.04).unwrap_err().to_string().contains("7=0.10,0.25"), "{text}");
        }
    }
}
