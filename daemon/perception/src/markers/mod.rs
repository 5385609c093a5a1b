//! Objects by their ArUco markers, in pixels.

mod aruco;
mod edges;
mod foreign;

use crate::config::MarkersConfig;
use crate::detections::OBJECTS;
use crate::error::{PerceptionError, while_doing};
use crate::image::ImageView;
use crate::pixel_format::PixelFormat;
use crate::points::PixelPoint;
use aruco::Aruco;
use foreign::Foreign;
use heapless::Vec;
use opencv::core::{Mat, Point2f, Size, Vector};
use opencv::{imgproc, prelude::*};
use tracing::trace_span;

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

/// A module must still measure this many pixels at half size: under 4, OpenCV misreads modules once there is noise.
const MIN_MODULE_PX: f64 = 4.0;

/// Finds markers.
pub(crate) struct Markers {
    aruco: Aruco,
    modules: f64,
    gray: Mat,
    half: Mat,
    corners: Vector<Vector<Point2f>>,
    ids: Vector<i32>,
    foreign: Foreign,
}

impl Markers {
    /// # Errors
    /// [`PerceptionError::OpenCv`] when OpenCV refuses the dictionary.
    pub(crate) fn new(config: &MarkersConfig) -> Result<Self, PerceptionError> {
        Ok(Self {
            aruco: Aruco::new(config.dictionary, config.threshold_constant)
                .map_err(while_doing("setting up the marker detector"))?,
            modules: config.dictionary.modules(),
            gray: Mat::default(),
            half: Mat::default(),
            corners: Vector::new(),
            ids: Vector::new(),
            foreign: Foreign::new(config.dictionary),
        })
    }

    /// Finds the markers whose id is `wanted`. `min_side_px` is the side of the smallest marker that is expected, if that is
    /// known: it decides whether half the picture's size is enough to find them.
    ///
    /// # Errors
    /// [`PerceptionError::OpenCv`].
    pub(crate) fn find(
        &mut self,
        image: &ImageView<'_>,
        min_side_px: Option<f64>,
        wanted: impl Fn(u16) -> bool,
    ) -> Result<Found, PerceptionError> {
        let halve = min_side_px.is_some_and(|side| side / (2.0 * self.modules) >= MIN_MODULE_PX);
        self.detect(image, halve).map_err(while_doing("looking for markers"))?;
        let _span = trace_span!("corners").entered();
        let gray = gray_view(image, &self.gray)?;
        let scale = match halve {
            true => [image.width(), image.height()].map(|side| side as f64 / (side / 2) as f64),
            false => [1.0; 2],
        };

        let mut found = Found::default();
        let mut unwanted = 0;
        for (id, corners) in self.ids.iter().zip(self.corners.iter()) {
            let Ok(id) = u16::try_from(id) else { continue };
            if !wanted(id) {
                unwanted += 1;
                continue;
            }
            let mut refined = [PixelPoint::default(); 4];
            for (to, from) in refined.iter_mut().zip(corners.iter()) {
                // Pixel centres are whole numbers; the picture begins half a pixel before the first.
                to.x = (f64::from(from.x) + 0.5) * scale[0] - 0.5;
                to.y = (f64::from(from.y) + 0.5) * scale[1] - 0.5;
            }
            let quality = edges::refine(&gray, &mut refined, self.modules);
            keep(&mut found, Marker { id, corners: refined, quality });
        }
        found.sort_unstable_by_key(|marker| marker.id);
        self.foreign
            .look(&gray, unwanted, !found.is_empty())
            .map_err(while_doing("looking for foreign markers"))?;
        Ok(found)
    }

    /// Markers of the newest frame that nobody wants.
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

    fn detect(&mut self, image: &ImageView<'_>, halve: bool) -> opencv::Result<()> {
        let code = match image.format() {
            PixelFormat::Gray8 => None,
            PixelFormat::Bgr8 => Some(imgproc::COLOR_BGR2GRAY),
            PixelFormat::Rgb8 => Some(imgproc::COLOR_RGB2GRAY),
            PixelFormat::Bgra8 => Some(imgproc::COLOR_BGRA2GRAY),
            PixelFormat::Rgba8 => Some(imgproc::COLOR_RGBA2GRAY),
        };
        image.with_pixels(|pixels| {
            let to_gray = trace_span!("grey").entered();
            if let Some(code) = code {
                imgproc::cvt_color_def(pixels, &mut self.gray, code)?;
            }
            drop(to_gray);
            let _span = trace_span!("ArUco").entered();
            if halve {
                let size = Size::new((image.width() / 2) as i32, (image.height() / 2) as i32);
                if code.is_some() {
                    imgproc::resize(&self.gray, &mut self.half, size, 0.0, 0.0, imgproc::INTER_AREA)?;
                } else {
                    imgproc::resize(pixels, &mut self.half, size, 0.0, 0.0, imgproc::INTER_AREA)?;
                }
                self.aruco.detect(&self.half, &mut self.corners, &mut self.ids)
            } else if code.is_some() {
                self.aruco.detect(&self.gray, &mut self.corners, &mut self.ids)
            } else {
                self.aruco.detect(pixels, &mut self.corners, &mut self.ids)
            }
        })
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

/// Adds a marker; of two with the same id the one with the better outline stays.
fn keep(found: &mut Found, marker: Marker) {
    match found.iter_mut().find(|other| other.id == marker.id) {
        Some(other) if other.quality < marker.quality => *other = marker,
        Some(_) => {}
        // There is room: no more ids are wanted than the list holds.
        None => drop(found.push(marker)),
    }
}
