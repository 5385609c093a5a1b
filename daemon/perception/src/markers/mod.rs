//! Objects by their ArUco markers, in pixels.

mod aruco;
mod detector;
mod edges;
mod foreign;
mod marked;
mod windows;

use crate::config::MarkersConfig;
use crate::detections::OBJECTS;
use crate::error::{PerceptionError, while_doing};
use crate::image::ImageView;
use crate::pixel_format::PixelFormat;
use crate::points::PixelPoint;
use crate::workers::keep_opencv_to_one_thread;
use aruco::Reading;
use detector::Detector;
use foreign::Foreign;
use heapless::Vec;
pub(crate) use marked::MarkedObjects;
use opencv::core::{Mat, Rect};
use opencv::prelude::*;
use tracing::trace_span;
use windows::Windows;

/// A marker in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Marker {
    /// Its id in the dictionary.
    pub(crate) id: u16,
    /// Top left, top right, bottom right, bottom left of the marker's own picture.
    pub(crate) corners: [PixelPoint; 4],
    /// Share of its edges that were found sharp in the picture, 0..1.
    pub(crate) quality: f64,
}

/// The markers of one frame, at most one per id, in order of their ids.
pub(crate) type Found = Vec<Marker, OBJECTS>;

/// Ids of markers.
pub(crate) type Ids = Vec<u16, OBJECTS>;

/// Finds markers.
pub(crate) struct Markers {
    detector: Detector,
    windows: Windows,
    gray: Mat,
    /// For the step between the picture and its brightness.
    between: Mat,
    foreign: Foreign,
    twice: Ids,
}

impl Markers {
    /// # Errors
    /// [`PerceptionError::OpenCv`] when OpenCV refuses the dictionary.
    pub(crate) fn new(config: &MarkersConfig) -> Result<Self, PerceptionError> {
        Self::with(config, Reading::quick(config.threshold_constant))
    }

    /// For a single picture, on which more time may be spent.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(crate) fn patient(config: &MarkersConfig) -> Result<Self, PerceptionError> {
        Self::with(config, Reading::PATIENT)
    }

    fn with(config: &MarkersConfig, reading: Reading) -> Result<Self, PerceptionError> {
        keep_opencv_to_one_thread()?;
        Ok(Self {
            detector: Detector::new(config, reading)
                .map_err(while_doing("setting up the marker detector"))?,
            windows: Windows::new(config),
            gray: Mat::default(),
            between: Mat::default(),
            foreign: Foreign::new(config.dictionary),
            twice: Ids::new(),
        })
    }

    /// Finds the markers whose id is `wanted`, the better of two with one id: see [`Self::twice`]. `min_side_px` is the side of the smallest marker that is expected, if that is
    /// known.
    ///
    /// # Errors
    /// [`PerceptionError::OpenCv`].
    pub(crate) fn find(
        &mut self,
        image: &ImageView<'_>,
        min_side_px: Option<f64>,
        wanted: impl Fn(u16) -> bool,
    ) -> Result<Found, PerceptionError> {
        let Self { detector, windows, gray, between, foreign, twice } = self;
        if image.format() != PixelFormat::Gray8 {
            let _span = trace_span!("grey").entered();
            image.write_gray(between, gray).map_err(while_doing("looking for markers"))?;
        }
        let gray = gray_view(image, gray)?;
        let mut search = |parts: &[Rect]| {
            let (mut found, mut unwanted) = (Found::default(), 0);
            twice.clear();
            for part in parts {
                unwanted += detector
                    .search(&gray, *part, min_side_px, &wanted, &mut found, twice)
                    .map_err(while_doing("looking for markers"))?;
            }
            let mut single = found.clone();
            single.retain(|marker| !twice.contains(&marker.id));
            Ok::<_, PerceptionError>((found, single, unwanted))
        };
        let (mut found, mut single) = (Found::default(), Found::default());
        if let Some(near) = windows.near(image) {
            (found, single, _) = search(near)?;
        }
        // Which of two prints is to be followed nobody knows: the whole picture is searched for as long as both are in view.
        if !windows.hold_all(&single) {
            let unwanted;
            (found, single, unwanted) =
                search(&[Rect::new(0, 0, image.width() as i32, image.height() as i32)])?;
            foreign
                .look(&gray, unwanted, !found.is_empty())
                .map_err(while_doing("looking for foreign markers"))?;
        }
        found.sort_unstable_by_key(|marker| marker.id);
        windows.follow(image, &single);
        Ok(found)
    }

    /// The ids that the newest frame shows twice.
    pub(crate) fn twice(&self) -> &[u16] {
        &self.twice
    }

    /// Markers of the newest frame whose whole picture was searched that nobody wants.
    pub(crate) fn foreign(&self) -> usize {
        self.foreign.markers()
    }

    /// The brightness of the newest frame, which is `image`.
    ///
    /// # Errors
    /// [`PerceptionError::OpenCv`].
    pub(crate) fn gray<'a>(&'a self, image: &ImageView<'a>) -> Result<ImageView<'a>, PerceptionError> {
        gray_view(image, &self.gray)
    }
}

/// The grey picture: the caller's own if it is grey, and otherwise the converted one.
fn gray_view<'a>(image: &ImageView<'a>, converted: &'a Mat) -> Result<ImageView<'a>, PerceptionError> {
    if image.format() == PixelFormat::Gray8 {
        return Ok(*image);
    }
    let data = converted.data_bytes().map_err(while_doing("reading the grey picture"))?;
    ImageView::new(image.width(), image.height(), image.width(), PixelFormat::Gray8, data)
}
