//! Objects by their ArUco markers, in pixels.

mod aruco;
mod dictionary;
mod edges;

pub use aruco::draw;
pub use dictionary::Dictionary;

use crate::config::MarkersConfig;
use crate::detections::OBJECTS;
use crate::error::{PerceptionError, while_doing};
use crate::image::{ImageView, PixelFormat};
use aruco::Aruco;
use edges::Point;
use heapless::Vec;
use opencv::core::{Mat, Point2f, Rect, Size, Vector};
use opencv::{imgproc, prelude::*};

/// A marker in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Marker {
    /// Its id in the dictionary.
    pub(crate) id: u16,
    /// Corners in pixels: top left, top right, bottom right, bottom left of the marker's own picture.
    pub(crate) corners: [[f64; 2]; 4],
    /// Share of its edges that were found sharp in the picture, 0..1.
    pub(crate) quality: f64,
}

/// The markers of one frame, at most one an id, in order of their ids.
pub(crate) type Seen = Vec<Marker, OBJECTS>;

/// At half size a module must still measure this many pixels: under 4 OpenCV misreads modules once there is noise.
const LEAST_MODULE_PX: f64 = 4.0;

/// Finds markers.
pub(crate) struct Markers {
    aruco: Aruco,
    modules: f64,
    gray: Mat,
    half: Mat,
    corners: Vector<Vector<Point2f>>,
    ids: Vector<i32>,
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
        })
    }

    /// Finds the markers whose id is `wanted`. `least_side_px` is the side of the smallest one that is expected, where that
    /// is known: it decides whether half the picture's size is enough to find them.
    ///
    /// # Errors
    /// [`PerceptionError::OpenCv`].
    pub(crate) fn find(
        &mut self,
        image: &ImageView<'_>,
        least_side_px: Option<f64>,
        wanted: impl Fn(u16) -> bool,
    ) -> Result<Seen, PerceptionError> {
        let halve = least_side_px.is_some_and(|side| side / (2.0 * self.modules) >= LEAST_MODULE_PX);
        self.detect(image, halve).map_err(while_doing("looking for markers"))?;
        let gray = gray_view(image, &self.gray)?;
        let scale = match halve {
            true => [image.width(), image.height()].map(|side| side as f64 / (side / 2) as f64),
            false => [1.0; 2],
        };

        let mut seen = Seen::default();
        for (id, corners) in self.ids.iter().zip(self.corners.iter()) {
            let Ok(id) = u16::try_from(id) else { continue };
            if !wanted(id) {
                continue;
            }
            let mut at: [Point; 4] = [[0.0; 2]; 4];
            for (to, from) in at.iter_mut().zip(corners.iter()) {
                // Pixel centres are whole numbers, the picture begins half a pixel before the first.
                *to =
                    [(f64::from(from.x) + 0.5) * scale[0] - 0.5, (f64::from(from.y) + 0.5) * scale[1] - 0.5];
            }
            let quality = edges::refine(&gray, &mut at, self.modules);
            keep(&mut seen, Marker { id, corners: at, quality });
        }
        seen.sort_unstable_by_key(|marker| marker.id);
        Ok(seen)
    }

    fn detect(&mut self, image: &ImageView<'_>, halve: bool) -> opencv::Result<()> {
        // Views of the caller's bytes: a row with its padding first, then without, then in pixels.
        let rows = Mat::new_rows_cols_with_data(image.height() as i32, image.stride() as i32, image.data())?;
        let row_bytes = (image.width() * image.format().bytes()) as i32;
        let rows = Mat::roi(&rows, Rect::new(0, 0, row_bytes, image.height() as i32))?;
        let pixels = rows.reshape(image.format().bytes() as i32, 0)?;

        let code = match image.format() {
            PixelFormat::Gray8 => None,
            PixelFormat::Bgr8 => Some(imgproc::COLOR_BGR2GRAY),
            PixelFormat::Rgb8 => Some(imgproc::COLOR_RGB2GRAY),
            PixelFormat::Bgra8 => Some(imgproc::COLOR_BGRA2GRAY),
            PixelFormat::Rgba8 => Some(imgproc::COLOR_RGBA2GRAY),
        };
        if let Some(code) = code {
            imgproc::cvt_color_def(&pixels, &mut self.gray, code)?;
        }
        if halve {
            let size = Size::new((image.width() / 2) as i32, (image.height() / 2) as i32);
            if code.is_some() {
                imgproc::resize(&self.gray, &mut self.half, size, 0.0, 0.0, imgproc::INTER_AREA)?;
            } else {
                imgproc::resize(&pixels, &mut self.half, size, 0.0, 0.0, imgproc::INTER_AREA)?;
            }
            self.aruco.detect(&self.half, &mut self.corners, &mut self.ids)
        } else if code.is_some() {
            self.aruco.detect(&self.gray, &mut self.corners, &mut self.ids)
        } else {
            self.aruco.detect(&pixels, &mut self.corners, &mut self.ids)
        }
    }
}

/// The grey picture: the caller's own where it is one, else the converted one.
fn gray_view<'a>(image: &ImageView<'a>, converted: &'a Mat) -> Result<ImageView<'a>, PerceptionError> {
    if image.format() == PixelFormat::Gray8 {
        return Ok(*image);
    }
    let data = converted.data_bytes().map_err(while_doing("reading the grey picture"))?;
    ImageView::new(image.width(), image.height(), image.width(), PixelFormat::Gray8, data)
}

/// Adds a marker; of two with one id the better outline stays.
fn keep(seen: &mut Seen, marker: Marker) {
    match seen.iter_mut().find(|other| other.id == marker.id) {
        Some(other) if other.quality < marker.quality => *other = marker,
        Some(_) => {}
        // There is room: no more ids are wanted than fit.
        None => drop(seen.push(marker)),
    }
}
