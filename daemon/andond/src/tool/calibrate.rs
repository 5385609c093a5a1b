//! `andond calibrate`: finds the bench in a picture with four known markers.

use andon_perception::bench::{BenchMarker, calibrate};
use andon_perception::{BenchPoint, ImageView, PixelFormat};

use super::{ToolError, check_writable, load_config_to_learn};
use crate::cli::Calibrate;
use crate::exit::Code;
use crate::video::Film;

/// Runs the command.
///
/// # Errors
/// A position that cannot be read, a picture that shows too little, or markers that do not fit their positions.
pub fn run(arguments: &Calibrate) -> Result<Code, ToolError> {
    let config = load_config_to_learn(&arguments.config)?;
    check_writable(&arguments.out)?;
    let side_m = f64::from(arguments.side);
    let markers = arguments.markers.iter().map(|text| marker(text, side_m)).collect::<Result<Vec<_>, _>>()?;
    let picture = || arguments.picture.clone();
    let mut film = Film::open(&arguments.picture, config.camera.rate_hz)?;
    if film.advance()?.is_none() {
        return Err(ToolError::NoPicture(picture()));
    }
    let (width, height) = (film.format().width as usize, film.format().height as usize);
    let image = ImageView::new(width, height, width * 3, PixelFormat::Bgr8, film.picture())
        .map_err(|source| ToolError::Picture { picture: picture(), source })?;
    let calibration = calibrate(&image, &markers, config.perception.dictionary)
        .map_err(|source| ToolError::Calibration { picture: picture(), source })?;
    calibration.save(&arguments.out).map_err(ToolError::SaveCalibration)?;
    println!(
        "{}: the markers fit their positions to {:.1} mm and their sides to {:.1} %; name the file in bench.calibration",
        arguments.out.display(),
        1000.0 * calibration.centre_error_m,
        100.0 * calibration.side_error
    );
    Ok(Code::Stopped)
}

/// A marker as it is given: `ID=X,Y`, in metres.
fn marker(text: &str, side_m: f64) -> Result<BenchMarker, ToolError> {
    let parse = || {
        let (id, position) = text.split_once('=')?;
        let (x, y) = position.split_once(',')?;
        let centre = BenchPoint::new(x.trim().parse().ok()?, y.trim().parse().ok()?);
        Some(BenchMarker { id: id.trim().parse().ok()?, centre, side_m })
    };
    parse().ok_or_else(|| ToolError::Option {
        option: "--marker",
        given: text.to_owned(),
        expected: "give its id and the position of its centre in metres, as in 7=0.10,0.25",
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_marker_has_an_id_and_a_position() {
        let known = marker("7=0.10,-0.25", 0.04).unwrap();
        assert_eq!(known, BenchMarker { id: 7, centre: BenchPoint::new(0.10, -0.25), side_m: 0.04 });
    }

    #[test]
    fn anything_else_is_refused_with_an_example() {
        for text in ["", "7", "7=1", "x=1,2", "7=1;2", "70000=1,2"] {
            assert!(marker(text, 0.04).unwrap_err().to_string().contains("7=0.10,0.25"), "{text}");
        }
    }
}
