//! `andond calibrate`: finds the bench in a picture with four known markers.

use andon_host::exit::Code;
use andon_perception::bench::{BenchMarker, CalibrationError, Examination, examine};
use andon_perception::{BenchPoint, ImageView, PixelFormat};

use super::{ToolError, cannot_write, check_writable, load_config_to_learn, stills};
use crate::cli::Calibrate;
use crate::cli::metres::position;
use crate::picture::with_residuals;
use crate::video::Film;

/// Runs the command.
///
/// # Errors
/// A position that cannot be read, a picture that shows too little, or markers that do not fit their positions.
pub fn run(arguments: &Calibrate) -> Result<Code, ToolError> {
    let markers: Vec<BenchMarker> =
        arguments.markers.iter().map(|text| marker(text, arguments.side)).collect::<Result<_, _>>()?;
    let config = load_config_to_learn(&arguments.config)?;
    check_writable(&arguments.out)?;
    if let Some(plot) = &arguments.plot {
        stills::check("--plot", plot)?;
    }
    let picture = || arguments.picture.clone();
    let mut film = Film::open(&arguments.picture, config.camera.rate_hz)?;
    if film.advance()?.is_none() {
        return Err(ToolError::NoPicture(picture()));
    }
    let (width, height) = (film.format().width as usize, film.format().height as usize);
    let image = ImageView::new(width, height, width * 3, PixelFormat::Bgr8, film.picture())
        .map_err(|source| ToolError::Picture { picture: picture(), source })?;
    let refused = |source| ToolError::Calibration { picture: picture(), source };
    let examined = examine(&image, &markers, config.perception.dictionary).map_err(refused)?;
    // Also where it is refused: the picture shows which marker is wrong.
    if let Some(plot) = &arguments.plot {
        let (format, drawn) = with_residuals(film.format(), film.picture(), &examined)
            .map_err(|error| cannot_draw(plot, &error))?;
        stills::write(plot, format, &drawn)?;
    }
    let residuals = residuals(&examined);
    let calibration = examined.outcome.map_err(refused)?;
    calibration.save(&arguments.out).map_err(|error| match error {
        CalibrationError::File { path, source, .. } => cannot_write(&path)(source),
        other => ToolError::SaveCalibration(other),
    })?;
    println!(
        "{}: each marker lies within {:.1} mm of where the others place it, and its sides fit to {:.1} %\n{residuals}\
         Name the file in bench.calibration of the station: it counts once that is started again.",
        arguments.out.display(),
        1000.0 * calibration.centre_error_m,
        100.0 * calibration.side_error
    );
    Ok(Code::Stopped)
}

fn cannot_draw(plot: &std::path::Path, error: &opencv::Error) -> ToolError {
    cannot_write(plot)(std::io::Error::other(error.to_string()))
}

/// One line for each marker.
fn residuals(examined: &Examination) -> String {
    let line = |marker: &andon_perception::bench::MarkerResidual| {
        let BenchPoint { x, y } = marker.stated;
        let (off_mm, side_mm) = (1000.0 * marker.distance_m(), 1000.0 * marker.side_m);
        format!("  marker {:>2} at {x:.3},{y:.3}: {off_mm:.1} mm off, side {side_mm:.1} mm\n", marker.id)
    };
    examined.markers.iter().map(line).collect()
}

/// A marker as it is given: `ID=X,Y`, in metres.
fn marker(text: &str, side_m: f64) -> Result<BenchMarker, ToolError> {
    let refused = |expected: String| ToolError::Marker { given: text.to_owned(), expected };
    let split = || {
        let (id, place) = text.split_once('=')?;
        let (x, y) = place.split_once(',')?;
        let [x, y] = [x, y].map(|axis| axis.trim().parse::<f64>().is_ok().then_some(axis));
        Some((id.trim().parse().ok()?, x?, y?))
    };
    let Some((id, x, y)) = split() else {
        let example = "give its id and the position of its centre in metres, as in 7=0.10,0.25";
        return Err(refused(example.to_owned()));
    };
    let centre = BenchPoint::new(position(x).map_err(refused)?, position(y).map_err(refused)?);
    Ok(BenchMarker { id, centre, side_m })
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

    #[test]
    fn millimetres_are_refused_with_what_they_are_in_metres() {
        let error = marker("7=100,250", 0.04).unwrap_err().to_string();
        assert_eq!(
            error,
            "--marker \"7=100,250\": 100 m lies on no bench; positions are in metres: 100 mm is 0.1"
        );
    }
}
