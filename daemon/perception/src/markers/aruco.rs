//! OpenCV's ArUco detector behind one interface: `aruco` up to OpenCV 4.6, `objdetect` from 4.7 on.

use crate::dictionary::Dictionary;
use opencv::core::{Point2f, ToInputArray, Vector};
use opencv::prelude::*;

/// How markers are read.
#[derive(Clone, Copy)]
pub(super) struct Reading {
    /// The smallest and the largest window of the adaptive threshold in pixels, odd, and the step between them.
    windows: [i32; 3],
    /// How much darker than its window a pixel must be to count as black, in grey levels of 255.
    constant: f64,
    /// Into how many pixels a module is drawn to be read, along each axis.
    module_px: i32,
    /// The share of a module that does not count, at each of its borders.
    module_margin: f64,
}

impl Reading {
    /// For a single picture. OpenCV's own threshold, which takes three times as long, and only the middle of each module. Where the lens is not
    /// focused, its neighbours shine into the rest.
    pub(super) const PATIENT: Self =
        Self { windows: [3, 23, 10], constant: 7.0, module_px: 8, module_margin: 0.3 };

    /// For a running line: one window of 13 pixels. It is twice to four times a module of the markers that are read here (3 to 7 pixels, see
    /// `Markers::find`). Modules are read as OpenCV does by default.
    pub(super) const fn quick(constant: f64) -> Self {
        // With one window the step only has to be over 0.
        Self { windows: [13, 13, 1], constant, module_px: 4, module_margin: 0.13 }
    }
}

/// Minimum perimeter of a marker as a share of the picture's larger side: OpenCV's default.
const MIN_PERIMETER: f64 = 0.03;

/// Sets the parameters, whose names both interfaces share.
macro_rules! set_parameters {
    ($parameters:ident, $reading:expr) => {
        let Reading { windows: [min, max, step], constant, module_px, module_margin } = $reading;
        $parameters.set_adaptive_thresh_win_size_min(min);
        $parameters.set_adaptive_thresh_win_size_max(max);
        $parameters.set_adaptive_thresh_win_size_step(step);
        $parameters.set_adaptive_thresh_constant(constant);
        $parameters.set_perspective_remove_pixel_per_cell(module_px);
        $parameters.set_perspective_remove_ignored_margin_per_cell(module_margin);
        // The caller refines corners at full size: OpenCV's own refinement snaps to inner modules of small markers.
        $parameters.set_corner_refinement_method(0);
    };
}

#[cfg(not(aruco_in_objdetect))]
mod interface {
    use super::*;
    use opencv::aruco::{self, DetectorParameters};
    use opencv::core::Ptr;

    pub(in crate::markers) struct Aruco {
        dictionary: Ptr<aruco::Dictionary>,
        parameters: Ptr<DetectorParameters>,
        rejected: Vector<Vector<Point2f>>,
    }

    impl Aruco {
        pub(in crate::markers) fn new(dictionary: Dictionary, reading: Reading) -> opencv::Result<Self> {
            let mut parameters = DetectorParameters::create()?;
            set_parameters!(parameters, reading);
            Ok(Self {
                dictionary: aruco::get_predefined_dictionary_i32(dictionary.code())?,
                parameters,
                rejected: Vector::new(),
            })
        }

        /// Detects markers in part of a picture, of which `share` is the length of its larger side relative to that of the picture. What is too small
        /// for a marker in the picture is so in its part.
        pub(in crate::markers) fn detect(
            &mut self,
            gray: &impl ToInputArray,
            share: f64,
            corners: &mut Vector<Vector<Point2f>>,
            ids: &mut Vector<i32>,
        ) -> opencv::Result<()> {
            self.parameters.set_min_marker_perimeter_rate(MIN_PERIMETER / share);
            aruco::detect_markers(gray, &self.dictionary, corners, ids, &self.parameters, &mut self.rejected)
        }
    }
}

#[cfg(aruco_in_objdetect)]
mod interface {
    use super::*;
    use opencv::objdetect::{self, ArucoDetector, DetectorParameters, RefineParameters};

    pub(in crate::markers) struct Aruco {
        detector: ArucoDetector,
        parameters: DetectorParameters,
        rejected: Vector<Vector<Point2f>>,
    }

    impl Aruco {
        pub(in crate::markers) fn new(dictionary: Dictionary, reading: Reading) -> opencv::Result<Self> {
            let mut parameters = DetectorParameters::default()?;
            set_parameters!(parameters, reading);
            let dictionary = objdetect::get_predefined_dictionary_i32(dictionary.code())?;
            let detector = ArucoDetector::new(&dictionary, &parameters, RefineParameters::new_def()?)?;
            Ok(Self { detector, parameters, rejected: Vector::new() })
        }

        /// As with `aruco`.
        pub(in crate::markers) fn detect(
            &mut self,
            gray: &impl ToInputArray,
            share: f64,
            corners: &mut Vector<Vector<Point2f>>,
            ids: &mut Vector<i32>,
        ) -> opencv::Result<()> {
            self.parameters.set_min_marker_perimeter_rate(MIN_PERIMETER / share);
            self.detector.set_detector_parameters(&self.parameters)?;
            self.detector.detect_markers(gray, corners, ids, &mut self.rejected)
        }
    }
}

pub(super) use interface::Aruco;
