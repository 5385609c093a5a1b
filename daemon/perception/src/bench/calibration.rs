//! The bench plane from a picture of markers whose positions on the bench are known.

use super::error::CalibrationError;
use super::misfit::{self, MarkerResidual, Pair};
use super::plane::{Matrix, Plane, apply, centre_of_corners, pixel_of};
use crate::config::{MarkerObject, MarkersConfig};
use crate::dictionary::Dictionary;
use crate::image::ImageView;
use crate::markers::{Marker, Markers};
use crate::metric::{BenchFrame, Lens};
use crate::points::{BenchPoint, PixelPoint};
use opencv::core::{Point2d, Vector};
use opencv::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A homography has 8 unknowns, and a point gives 2.
pub(super) const MIN_MARKERS: usize = 4;
/// Maximum relative error of a marker's sides. Corners are found to 0.1 px, which is 0.3 % of a marker of 30 px. A marker that
/// lies 1 cm from its stated position, 40 cm from the next, makes 2.5 %.
pub(super) const MAX_SIDE_ERROR: f64 = 0.02;
/// Maximum distance of a marker from its stated position, in metres: the accuracy of a ruler on a bench.
pub(super) const MAX_CENTRE_ERROR_M: f64 = 0.003;

/// Three markers are in a line where their triangle is lower than this share of its longest side. A ruler places a marker no better.
const MIN_HEIGHT: f64 = 0.01;

/// Where a calibration is compared with a lens, as shares of the picture: around its middle, where the markers lay.
const GRID: [f64; 3] = [0.25, 0.5, 0.75];
/// A camera agrees with its own calibration to this, in pixels: a lens bends the picture by less, and `MAX_CENTRE_ERROR_M` is
/// as much.
const MAX_REPROJECTION_PX: f64 = 2.0;

/// A marker that lies flat on the bench at a known position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenchMarker {
    /// Its id in the dictionary.
    pub id: u16,
    /// Its centre.
    pub centre: BenchPoint,
    /// Side of its black square in metres.
    pub side_m: f64,
}

/// A calibrated bench plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Width in pixels of the pictures that it is for.
    pub width: usize,
    /// Height in pixels of the pictures that it is for.
    pub height: usize,
    /// Homogeneous pixels to homogeneous metres in the bench frame.
    pub bench_from_image: [[f64; 3]; 3],
    /// Maximum relative error of a marker's sides when it was made.
    pub side_error: f64,
    /// Maximum distance of a marker from where the others, with their sides, placed it when it was made, in metres.
    pub centre_error_m: f64,
}

/// What a picture says of markers at stated positions.
#[derive(Debug)]
pub struct Examination {
    /// Every marker by the others; where one is wrong, by all but that one.
    pub markers: Vec<MarkerResidual>,
    /// The plane that is fitted to the markers: homogeneous pixels to homogeneous metres in the bench frame.
    pub bench_from_image: [[f64; 3]; 3],
    /// The calibration, or why it is refused.
    pub outcome: Result<Calibration, CalibrationError>,
}

impl Examination {
    /// The pixel that shows a point of the bench; `None` where no pixel does.
    pub fn pixel(&self, point: BenchPoint) -> Option<[f32; 2]> {
        pixel_of(&self.bench_from_image, point).map(Into::into)
    }
}

impl Calibration {
    /// Reads a calibration from a TOML file.
    ///
    /// # Errors
    /// [`CalibrationError::File`], [`CalibrationError::Content`].
    pub fn load(path: &Path) -> Result<Self, CalibrationError> {
        let unread = |source| CalibrationError::File { path: path.into(), verb: "read", source };
        // The writer of a pipe would be waited for, and a device has no end.
        if path.metadata().is_ok_and(|there| !there.is_file() && !there.is_dir()) {
            return Err(unread(std::io::Error::other("it is a pipe or a device, and a file is needed")));
        }
        let text = std::fs::read_to_string(path).map_err(unread)?;
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
        let write = || -> std::io::Result<()> {
            let mut file = std::fs::File::create(&unfinished)?;
            std::io::Write::write_all(&mut file, text.as_bytes())?;
            // On disk before it takes the place of the one before it.
            file.sync_all()?;
            std::fs::rename(&unfinished, path)
        };
        write().map_err(|source| {
            // What there is of it is of no use, and takes room where there is none.
            let _ = std::fs::remove_file(&unfinished);
            CalibrationError::File { path: path.into(), verb: "written", source }
        })
    }

    /// The bench frame of metric mode: where a camera with this lens must be for this calibration.
    ///
    /// # Errors
    /// [`CalibrationError::OtherCamera`], [`CalibrationError::Picture`].
    pub fn bench_frame(&self, lens: &Lens) -> Result<BenchFrame, CalibrationError> {
        let (width, height) = (self.width as f64, self.height as f64);
        let row = |v: f64| GRID.map(|u| PixelPoint::new(u * width, v * height));
        let pixels = GRID.map(row).concat();
        let points: Vec<BenchPoint> =
            pixels.iter().map(|&pixel| apply(&self.bench_from_image, pixel)).collect();
        match BenchFrame::from_points(&points, &pixels, lens)? {
            Some((frame, reprojection_px)) if reprojection_px <= MAX_REPROJECTION_PX => Ok(frame),
            Some((_, pixels)) => Err(CalibrationError::OtherCamera { pixels }),
            None => Err(CalibrationError::Degenerate),
        }
    }

    /// `None` where the homography is singular or not finite.
    pub(crate) fn plane(&self) -> Option<Plane> {
        Plane::seen_through(self.bench_from_image, self.width, self.height)
    }
}

/// Calibrates the bench plane from one picture of at least four markers that lie flat on the bench.
///
/// The homography is fitted to the markers' centres; their sides, which it was not fitted to, tell whether it is right.
///
/// # Errors
/// [`CalibrationError`]; a calibration whose residuals are too large is refused, with what is wrong.
pub fn calibrate(
    image: &ImageView<'_>,
    markers: &[BenchMarker],
    dictionary: Dictionary,
) -> Result<Calibration, CalibrationError> {
    examine(image, markers, dictionary)?.outcome
}

/// As [`calibrate`], with how well every marker fits, also where the calibration is refused.
///
/// # Errors
/// [`CalibrationError`] where markers are missing, or can give no plane.
pub fn examine(
    image: &ImageView<'_>,
    markers: &[BenchMarker],
    dictionary: Dictionary,
) -> Result<Examination, CalibrationError> {
    if markers.len() < MIN_MARKERS {
        return Err(CalibrationError::TooFew(markers.len()));
    }
    for (index, marker) in markers.iter().enumerate() {
        let numbers = [marker.centre.x, marker.centre.y, marker.side_m];
        let is_named_twice = markers[..index].iter().any(|other| other.id == marker.id);
        if is_named_twice || marker.side_m <= 0.0 || !numbers.iter().all(|number| number.is_finite()) {
            return Err(CalibrationError::Marker(marker.id));
        }
    }
    if !give_a_plane(markers) {
        return Err(CalibrationError::Degenerate);
    }
    let pairs = find(image, markers, dictionary)?;
    let centres: Vec<_> =
        pairs.iter().map(|(known, found)| (centre_of_corners(&found.corners), known.centre)).collect();
    let bench_from_image = fit(&centres)?;
    let markers = misfit::residuals(&pairs);
    let calibration = Calibration {
        width: image.width(),
        height: image.height(),
        bench_from_image,
        side_error: 0.0,
        centre_error_m: markers.iter().map(MarkerResidual::distance_m).fold(0.0, f64::max),
    };
    let outcome = judge(calibration, &pairs);
    // Beside one that is wrong the others would seem to be wrong as well.
    let without_it = outcome.as_ref().err().and_then(CalibrationError::one_marker);
    let by_others = without_it.and_then(|id| misfit::without(&pairs, id));
    let (markers, bench_from_image) = by_others.unwrap_or((markers, bench_from_image));
    Ok(Examination { markers, bench_from_image, outcome })
}

/// The calibration, if the markers fit.
fn judge(mut calibration: Calibration, pairs: &[Pair]) -> Result<Calibration, CalibrationError> {
    // Where markers are exchanged, the centres may have no plane with a horizon, and still what is wrong can be said.
    let plane = calibration.plane().unwrap_or(Plane::without_foot(calibration.bench_from_image));
    // Two markers that are exchanged across the bench mirror it as well, and make its squares oblique.
    let is_only_mirrored = |(known, found): &Pair| {
        is_mirrored(&plane, found) && side_error(&plane, &found.corners, known.side_m) <= misfit::ALIKE
    };
    if pairs.iter().all(is_only_mirrored) {
        return Err(CalibrationError::Mirrored);
    }
    for (known, found) in pairs {
        let side_error = side_error(&plane, &found.corners, known.side_m);
        let centre_error_m = plane.at(centre_of_corners(&found.corners)).distance(known.centre);
        // Written so that NaN is refused.
        if !(side_error <= MAX_SIDE_ERROR && centre_error_m <= MAX_CENTRE_ERROR_M) {
            return Err(misfit::explain(pairs, &plane));
        }
        calibration.side_error = calibration.side_error.max(side_error);
    }
    if calibration.plane().is_none() { Err(CalibrationError::Degenerate) } else { Ok(calibration) }
}

/// Whether four of the markers lie so that no three of them are in a line: otherwise many planes fit them.
fn give_a_plane(markers: &[BenchMarker]) -> bool {
    let is_triangle = |corners: [usize; 3]| is_triangle(corners.map(|index| markers[index].centre));
    let are_general = |a, b, c, d| [[a, b, c], [a, b, d], [a, c, d], [b, c, d]].into_iter().all(is_triangle);
    (0..markers.len()).any(|a| (0..a).any(|b| (0..b).any(|c| (0..c).any(|d| are_general(a, b, c, d)))))
}

fn is_triangle([a, b, c]: [BenchPoint; 3]) -> bool {
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let twice_the_area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    twice_the_area.abs() > MIN_HEIGHT * longest * longest
}

/// Every named marker with its marker in the picture.
fn find(
    image: &ImageView<'_>,
    markers: &[BenchMarker],
    dictionary: Dictionary,
) -> Result<Vec<Pair>, CalibrationError> {
    let objects: Vec<_> = markers
        .iter()
        .map(|&BenchMarker { id, side_m, .. }| MarkerObject { id, marker: id, side_m: side_m as f32 })
        .collect();
    let config = MarkersConfig { dictionary, objects, ..MarkersConfig::default() };
    let is_named = |id| markers.iter().any(|marker| marker.id == id);
    let mut finder = Markers::new(&config)?;
    let mut found = finder.find(image, None, is_named)?;
    if !finder.twice().is_empty() {
        return Err(CalibrationError::Twice(finder.twice().to_vec()));
    }
    if found.len() < markers.len() {
        let is_missing = |id| is_named(id) && found.iter().all(|other| other.id != id);
        let others = Markers::patient(&config)?.find(image, None, is_missing)?;
        found.extend(others);
    }
    let with_id = |marker: &BenchMarker| found.iter().find(|other| other.id == marker.id).copied();
    let pairs: Vec<_> = markers.iter().filter_map(|marker| Some((*marker, with_id(marker)?))).collect();
    if pairs.len() < markers.len() {
        let missing = markers.iter().filter(|marker| with_id(marker).is_none()).map(|marker| marker.id);
        return Err(CalibrationError::NotSeen(missing.collect()));
    }
    Ok(pairs)
}

/// The homography that comes nearest to taking pixels to these points of the bench.
pub(super) fn fit(points: &[(PixelPoint, BenchPoint)]) -> Result<Matrix, CalibrationError> {
    let solve = || -> opencv::Result<Option<Matrix>> {
        let image: Vector<Point2d> = points.iter().map(|(pixel, _)| Point2d::new(pixel.x, pixel.y)).collect();
        let bench: Vector<Point2d> = points.iter().map(|(_, point)| Point2d::new(point.x, point.y)).collect();
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

/// A marker's corners run clockwise in the picture, where y is down, and therefore clockwise on the bench, where y is up.
fn is_mirrored(plane: &Plane, found: &Marker) -> bool {
    let [a, b, c, _] = found.corners.map(|corner| plane.at(corner));
    (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x) >= 0.0
}

/// Maximum relative error of the two mean sides and the two diagonals.
pub(super) fn side_error(plane: &Plane, corners: &[PixelPoint; 4], side_m: f64) -> f64 {
    let [a, b, c, d] = corners.map(|corner| plane.at(corner));
    let diagonal_m = side_m * std::f64::consts::SQRT_2;
    [
        ((a.distance(b) + d.distance(c)) / 2.0, side_m),
        ((a.distance(d) + b.distance(c)) / 2.0, side_m),
        (a.distance(c), diagonal_m),
        (b.distance(d), diagonal_m),
    ]
    .into_iter()
    .map(|(measured, known)| (measured / known - 1.0).abs())
    .fold(0.0, f64::max)
}
