//! OpenCV's ArUco detector behind one interface: `aruco` up to OpenCV 4.6, `objdetect` from 4.7 on.

use crate::dictionary::Dictionary;
use opencv::core::{Point2f, ToInputArray, Vector};
use opencv::prelude::*;

/// Window of the adaptive threshold in pixels, odd. One window instead of OpenCV's three is three times as fast; 13 is
/// twice to four times a module of the markers that are read here (3 to 7 pixels, see `Markers::find`).
const THRESHOLD_WINDOW: i32 = 13;

/// Minimum perimeter of a marker as a share of the picture's larger side: OpenCV's default.
const MIN_PERIMETER: f64 = 0.03;

/// Sets the parameters, whose names both interfaces share.
macro_rules! set_parameters {
    ($parameters:ident, $threshold_constant:expr) => {
        $parameters.set_adaptive_thresh_win_size_min(THRESHOLD_WINDOW);
        $parameters.set_adaptive_thresh_win_size_max(THRESHOLD_WINDOW);
        // With one window it only has to be over 0.
        $parameters.set_adaptive_thresh_win_size_step(1);
        $parameters.set_adaptive_thresh_constant($threshold_constant);
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
        pub(in crate::markers) fn new(
            dictionary: Dictionary,
            threshold_constant: f64,
        ) -> opencv::Result<Self> {
            let mut parameters = DetectorParameters::create()?;
            set_parameters!(parameters, threshold_constant);
            Ok(Self {
                dictionary: aruco::get_predefined_dictionary_i32(dictionary.code())?,
                parameters,
                rejected: Vector::new(),
            })
        }

        /// Detects markers in a part of a picture, of which `share` is the length of its larger side in relation to that of the picture:
        /// what is too small for a marker in the picture is so in its part.
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
        pub(in crate::markers) fn new(
            dictionary: Dictionary,
            threshold_constant: f64,
        ) -> opencv::Result<Self> {
            let mut parameters = DetectorParameters::default()?;
            set_parameters!(parameters, threshold_constant);
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
