//! The bench plane from a picture of markers whose places on the bench are known.

use super::plane::{Matrix, Plane, Point, apply, centre_of_corners};
use crate::config::{MarkerObject, MarkersConfig};
use crate::error::PerceptionError;
use crate::image::ImageView;
use crate::markers::{Dictionary, Marker, Markers};
use crate::metric::{BenchFrame, Lens};
use opencv::core::{Point2d, Vector};
use opencv::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A homography has 8 unknowns, a point gives 2.
const LEAST_MARKERS: usize = 4;
/// Greatest relative error of a marker's sides. Corners are found to 0.1 px, which is 0.3 % of a marker of 30 px; a marker
/// that lies 1 cm from where it is said to be, 40 cm from the next, makes 2.5 %.
const MOST_SIDE_ERROR: f64 = 0.02;
/// Greatest distance of a marker from where it is said to be, in metres: what a ruler on a bench gives.
const MOST_CENTRE_ERROR_M: f64 = 0.003;

/// Where a calibration is looked at, as shares of the picture: around its middle, where its markers lay.
const GRID: [f64; 3] = [0.25, 0.5, 0.75];
/// A camera sees its own calibration to this, in pixels: a lens bends the picture by less, and MOST_CENTRE_ERROR_M is as much.
const MOST_REPROJECTION_PX: f64 = 2.0;

/// A marker that lies flat on the bench at a known place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenchMarker {
    /// Its id in the dictionary.
    pub id: u16,
    /// Its centre in metres in the bench frame.
    pub centre_m: [f64; 2],
    /// Side of its black square in metres.
    pub side_m: f64,
}

/// A calibrated bench plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Width of the pictures that it is for, in pixels.
    pub width: usize,
    /// Height of the pictures that it is for, in pixels.
    pub height: usize,
    /// Homogeneous pixels to homogeneous metres in the bench frame.
    pub bench_from_image: [[f64; 3]; 3],
    /// Greatest relative error of a marker's sides when it was made.
    pub side_error: f64,
    /// Greatest distance of a marker from where it was said to be when it was made, in metres.
    pub centre_error_m: f64,
}

/// Why there is no calibration.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationError {
    /// Too few markers were named.
    #[error(
        "{0} markers are named for the calibration: at least {LEAST_MARKERS} are needed, no three of them in a line"
    )]
    TooFew(usize),
    /// A marker has no place or no size.
    #[error(
        "marker {0} of the calibration: its place and its side must be finite numbers, its side over 0 m, and its id named once"
    )]
    Marker(u16),
    /// Markers were not seen.
    #[error(
        "markers {0:?} are not to be seen in the picture: lay them flat, whole and well lit in the camera's view"
    )]
    NotSeen(Vec<u16>),
    /// The markers do not fit their places.
    #[error(
        "marker {id} does not fit where it is said to lie (side off by {:.1} %, place by {:.1} mm): check ids, places and sides", 100.0 * side_error, 1000.0 * centre_error_m
    )]
    Residual {
        /// The worst one.
        id: u16,
        /// Its relative error of a side.
        side_error: f64,
        /// Its distance from where it is said to be, in metres.
        centre_error_m: f64,
    },
    /// Three markers are in a line, or two in one place.
    #[error("the markers' places give no plane: no three of them may be in a line")]
    Degenerate,
    /// The places are those of a mirrored bench.
    #[error("the markers' places are mirrored: x runs to the right and y away from the worker")]
    Mirrored,
    /// It is that of another camera, or of another lens.
    #[error(
        "the calibration is {pixels:.1} px from what this camera can see: calibrate again with this camera and this size of picture"
    )]
    OtherCamera {
        /// How far it is off in the picture.
        pixels: f64,
    },
    /// The picture could not be searched.
    #[error(transparent)]
    Picture(#[from] PerceptionError),
    /// The file cannot be read or written.
    #[error("the calibration {} cannot be {verb}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// `read` or `written`.
        verb: &'static str,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is no calibration.
    #[error("{} is no calibration: {reason}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

impl Calibration {
    /// Reads a calibration from a TOML file.
    ///
    /// # Errors
    /// [`CalibrationError::File`], [`CalibrationError::Content`].
    pub fn load(path: &Path) -> Result<Self, CalibrationError> {
        let text = std::fs::read_to_string(path).map_err(|source| CalibrationError::File {
            path: path.into(),
            verb: "read",
            source,
        })?;
        let content = |reason: String| CalibrationError::Content { path: path.into(), reason };
        let calibration: Self = toml::from_str(&text).map_err(|error| content(error.to_string()))?;
        if calibration.plane().is_none() {
            return Err(content("bench_from_image is no homography".into()));
        }
        Ok(calibration)
    }

    /// Writes the calibration to a TOML file; an older one is replaced as a whole.
    ///
    /// # Errors
    /// [`CalibrationError::File`], [`CalibrationError::Content`].
    pub fn save(&self, path: &Path) -> Result<(), CalibrationError> {
        let text = toml::to_string(self)
            .map_err(|error| CalibrationError::Content { path: path.into(), reason: error.to_string() })?;
        let unfinished = path.with_extension("toml.unfinished");
        std::fs::write(&unfinished, text)
            .and_then(|()| std::fs::rename(&unfinished, path))
            .map_err(|source| CalibrationError::File { path: path.into(), verb: "written", source })
    }

    /// The bench frame of metric mode: where a camera with this lens must be to see the bench like that.
    ///
    /// # Errors
    /// [`CalibrationError::OtherCamera`], [`CalibrationError::Picture`].
    pub fn bench_frame(&self, lens: &Lens) -> Result<BenchFrame, CalibrationError> {
        let (width, height) = (self.width as f64, self.height as f64);
        let pixels: Vec<Point> =
            GRID.iter().flat_map(|&v| GRID.iter().map(move |&u| [u * width, v * height])).collect();
        let places: Vec<Point> = pixels.iter().map(|&pixel| apply(&self.bench_from_image, pixel)).collect();
        let frame = BenchFrame::from_points(&places, &pixels, lens)?;
        match frame {
            Some(frame) if frame.residual <= MOST_REPROJECTION_PX => Ok(frame),
            Some(frame) => Err(CalibrationError::OtherCamera { pixels: frame.residual }),
            None => Err(CalibrationError::Degenerate),
        }
    }

    /// None where the homography is singular or not finite.
    pub(crate) fn plane(&self) -> Option<Plane> {
        Plane::seen_through(self.bench_from_image, self.width, self.height)
    }
}

/// Calibrates the bench plane from one picture of at least four markers that lie flat on the bench.
///
/// The homography is fitted to the markers' centres; their sides, which it was not fitted to, tell whether it is right.
///
/// # Errors
/// [`CalibrationError`]; a calibration whose residuals are bad is refused.
pub fn calibrate(
    image: &ImageView<'_>,
    markers: &[BenchMarker],
    dictionary: Dictionary,
) -> Result<Calibration, CalibrationError> {
    if markers.len() < LEAST_MARKERS {
        return Err(CalibrationError::TooFew(markers.len()));
    }
    for (place, marker) in markers.iter().enumerate() {
        let numbers = [marker.centre_m[0], marker.centre_m[1], marker.side_m];
        let named_twice = markers[..place].iter().any(|other| other.id == marker.id);
        if named_twice || marker.side_m <= 0.0 || !numbers.iter().all(|number| number.is_finite()) {
            return Err(CalibrationError::Marker(marker.id));
        }
    }
    let pairs = see(image, markers, dictionary)?;
    let bench_from_image = fit(&pairs)?;
    let calibration = Calibration {
        width: image.width(),
        height: image.height(),
        bench_from_image,
        side_error: 0.0,
        centre_error_m: 0.0,
    };
    let plane = calibration.plane().ok_or(CalibrationError::Degenerate)?;
    if is_mirrored(&plane, &pairs) {
        return Err(CalibrationError::Mirrored);
    }
    judged(calibration, &plane, &pairs)
}

/// Every named marker with what was seen of it.
fn see(
    image: &ImageView<'_>,
    markers: &[BenchMarker],
    dictionary: Dictionary,
) -> Result<Vec<(BenchMarker, Marker)>, CalibrationError> {
    let objects: Vec<_> =
        markers.iter().map(|marker| MarkerObject { id: marker.id, side_m: marker.side_m as f32 }).collect();
    let config = MarkersConfig { dictionary, objects, ..MarkersConfig::default() };
    let seen = Markers::new(&config)?.find(image, None, |id| markers.iter().any(|marker| marker.id == id))?;
    let found = |marker: &BenchMarker| seen.iter().find(|other| other.id == marker.id).copied();
    let pairs: Vec<_> = markers.iter().filter_map(|marker| Some((*marker, found(marker)?))).collect();
    if pairs.len() < markers.len() {
        let missing = markers.iter().filter(|marker| found(marker).is_none()).map(|marker| marker.id);
        return Err(CalibrationError::NotSeen(missing.collect()));
    }
    Ok(pairs)
}

fn fit(pairs: &[(BenchMarker, Marker)]) -> Result<Matrix, CalibrationError> {
    let solve = || -> opencv::Result<Option<Matrix>> {
        let point = |[x, y]: Point| Point2d::new(x, y);
        let image: Vector<Point2d> =
            pairs.iter().map(|(_, seen)| point(centre_of_corners(&seen.corners))).collect();
        let bench: Vector<Point2d> = pairs.iter().map(|(known, _)| point(known.centre_m)).collect();
        let matrix = opencv::calib3d::find_homography_ext_def(&image, &bench)?;
        if matrix.rows() != 3 || matrix.cols() != 3 {
            return Ok(None);
        }
        let mut found = Matrix::default();
        for (row, line) in found.iter_mut().enumerate() {
            for (column, value) in line.iter_mut().enumerate() {
                *value = *matrix.at_2d::<f64>(row as i32, column as i32)?;
            }
        }
        Ok(Some(found))
    };
    let error = crate::error::while_doing("fitting the bench plane");
    solve().map_err(error)?.ok_or(CalibrationError::Degenerate)
}

/// A marker's corners run clockwise in the picture, so counter-clockwise with y up they must not run.
fn is_mirrored(plane: &Plane, pairs: &[(BenchMarker, Marker)]) -> bool {
    pairs.iter().any(|(_, seen)| {
        let [a, b, c, _] = seen.corners.map(|corner| plane.at(corner));
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) >= 0.0
    })
}

/// The calibration with its residuals, or why it is refused.
fn judged(
    mut calibration: Calibration,
    plane: &Plane,
    pairs: &[(BenchMarker, Marker)],
) -> Result<Calibration, CalibrationError> {
    for (known, seen) in pairs {
        let side_error = side_error(plane, &seen.corners, known.side_m);
        let centre_error_m =
            distance(apply(&calibration.bench_from_image, centre_of_corners(&seen.corners)), known.centre_m);
        // Written so that NaN is refused.
        if !(side_error <= MOST_SIDE_ERROR && centre_error_m <= MOST_CENTRE_ERROR_M) {
            return Err(CalibrationError::Residual { id: known.id, side_error, centre_error_m });
        }
        calibration.side_error = calibration.side_error.max(side_error);
        calibration.centre_error_m = calibration.centre_error_m.max(centre_error_m);
    }
    Ok(calibration)
}

/// Greatest relative error of the two mean sides and the two diagonals.
fn side_error(plane: &Plane, corners: &[Point; 4], side: f64) -> f64 {
    let [a, b, c, d] = corners.map(|corner| plane.at(corner));
    let diagonal = side * std::f64::consts::SQRT_2;
    [
        ((distance(a, b) + distance(d, c)) / 2.0, side),
        ((distance(a, d) + distance(b, c)) / 2.0, side),
        (distance(a, c), diagonal),
        (distance(b, d), diagonal),
    ]
    .into_iter()
    .map(|(measured, known)| (measured / known - 1.0).abs())
    .fold(0.0, f64::max)
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
