//! Why there is no calibration of the bench plane, and what to do.

use super::calibration::MIN_MARKERS;
use super::misfit::MarkerResidual;
use crate::error::PerceptionError;
use crate::points::BenchPoint;
use std::path::PathBuf;

/// Why there is no calibration.
#[derive(Debug, thiserror::Error)]
pub enum CalibrationError {
    /// Too few markers were named.
    #[error(
        "{0} markers are named for the calibration: at least {MIN_MARKERS} are needed, no three of these in a line"
    )]
    TooFew(usize),
    /// A marker has no usable position or size, or is named twice.
    #[error(
        "marker {0} of the calibration: its position and its side must be finite numbers, its side over 0 m, and its id named once"
    )]
    Marker(u16),
    /// Markers are in the picture twice.
    #[error("markers {0:?} are in the picture twice: take the other print of each away")]
    Twice(Vec<u16>),
    /// Markers were not found in the picture.
    #[error(
        "markers {0:?} were not found in the picture: lay them flat, whole and well lit in the camera's view"
    )]
    NotSeen(Vec<u16>),
    /// One marker does not lie where it is said to lie; without it all others fit.
    #[error(
        "marker {id} is said to lie at {}; by the others it lies at {}, {:.0} mm away; measure its position again, or move it",
        metres(stated), metres(measured), 1000.0 * stated.distance(*measured)
    )]
    Elsewhere {
        /// The marker.
        id: u16,
        /// Where it is said to lie.
        stated: BenchPoint,
        /// Where the others place it.
        measured: BenchPoint,
    },
    /// One marker has another size than it is said; without it all others fit.
    #[error(
        "marker {id} has a side of {:.1} mm by the others, not of {:.1} mm: measure its black square, or print it again",
        1000.0 * measured_m, 1000.0 * stated_m
    )]
    Side {
        /// The marker.
        id: u16,
        /// Its side as it is said, in metres.
        stated_m: f64,
        /// Its side as the others measure it, in metres.
        measured_m: f64,
    },
    /// All markers have another size than it is said.
    #[error(
        "by their positions all markers have a side of {:.1} mm, not of {:.1} mm: measure the black square of one of them, and the distance of \
         two centres; one of these is wrong by {:+.1} %",
        1000.0 * measured_m, 1000.0 * stated_m, 100.0 * (measured_m / stated_m - 1.0)
    )]
    Sides {
        /// Their side as it is said, in metres.
        stated_m: f64,
        /// Their side by their positions, in metres.
        measured_m: f64,
    },
    /// Two markers lie at each other's positions.
    #[error("markers {} and {} lie at each other's positions: exchange them", .0[0], .0[1])]
    Exchanged([u16; 2]),
    /// More than one marker is wrong.
    #[error(
        "more than one marker does not fit: {}; measure the positions of their centres again, from one origin, x to the right and y away \
         from the worker", .0.iter().map(off).collect::<Vec<_>>().join(", ")
    )]
    SeveralWrong(Vec<MarkerResidual>),
    /// No four markers lie so that no three of them are in a line.
    #[error(
        "the positions of the markers give no plane: four of them must lie so that no three are in a line"
    )]
    Degenerate,
    /// The positions are those of a mirrored bench.
    #[error("the positions of the markers are mirrored: x runs to the right and y away from the worker")]
    Mirrored,
    /// It was made with another camera or another lens.
    #[error(
        "the calibration is {pixels:.1} px off for this camera: calibrate again with this camera and this size of picture"
    )]
    OtherCamera {
        /// How far it is off in the picture, in pixels.
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
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file is no calibration.
    #[error("{} is not a calibration: {reason}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

/// A position as it is given on a command line.
fn metres(point: &BenchPoint) -> String {
    format!("{:.3},{:.3}", point.x, point.y)
}

fn off(marker: &MarkerResidual) -> String {
    format!("marker {} is {:.0} mm from where the others place it", marker.id, 1000.0 * marker.distance_m())
}

impl CalibrationError {
    /// The one marker that is wrong.
    pub(super) fn one_marker(&self) -> Option<u16> {
        match self {
            Self::Elsewhere { id, .. } | Self::Side { id, .. } => Some(*id),
            _ => None,
        }
    }
}
