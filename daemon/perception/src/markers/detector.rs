//! Markers in a part of a picture, with exact corners.

use super::aruco::{Aruco, Reading};
use super::{Found, Ids, Marker, edges};
use crate::config::MarkersConfig;
use crate::image::ImageView;
use crate::points::PixelPoint;
use opencv::core::{Mat, Point2f, Rect, Size, Vector};
use opencv::imgproc;
use tracing::trace_span;

/// A module must still measure this many pixels at half size: under 4, OpenCV misreads modules once there is noise.
const MIN_MODULE_PX: f64 = 4.0;

/// OpenCV's detector, and what it works in.
pub(super) struct Detector {
    aruco: Aruco,
    modules: f64,
    half: Mat,
    corners: Vector<Vector<Point2f>>,
    ids: Vector<i32>,
}

impl Detector {
    pub(super) fn new(config: &MarkersConfig, reading: Reading) -> opencv::Result<Self> {
        Ok(Self {
            aruco: Aruco::new(config.dictionary, reading)?,
            modules: config.dictionary.modules(),
            half: Mat::default(),
            corners: Vector::new(),
            ids: Vector::new(),
        })
    }

    /// Adds the markers of a part of the picture whose id is `wanted` to those that were found. Adds the ids that are in view twice to `twice`.
    /// Returns how many others it shows. `min_side_px` is the side of the smallest marker that is expected, if that is known: it decides whether half
    /// the picture's size is enough.
    pub(super) fn search(
        &mut self,
        gray: &ImageView<'_>,
        part: Rect,
        min_side_px: Option<f64>,
        wanted: impl Fn(u16) -> bool,
        found: &mut Found,
        twice: &mut Ids,
    ) -> opencv::Result<usize> {
        let scale = self.detect(gray, part, min_side_px)?;
        let _span = trace_span!("corners").entered();
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
                to.x = f64::from(part.x) + (f64::from(from.x) + 0.5) * scale[0] - 0.5;
                to.y = f64::from(part.y) + (f64::from(from.y) + 0.5) * scale[1] - 0.5;
            }
            let quality = edges::refine(gray, &mut refined, self.modules);
            keep(found, twice, Marker { id, corners: refined, quality });
        }
        Ok(unwanted)
    }

    /// Detects markers, and returns how much larger the part is than the picture that their corners are in.
    fn detect(
        &mut self,
        gray: &ImageView<'_>,
        part: Rect,
        min_side_px: Option<f64>,
    ) -> opencv::Result<[f64; 2]> {
        let _span = trace_span!("ArUco").entered();
        let share = f64::from(part.width.max(part.height)) / gray.width().max(gray.height()) as f64;
        gray.with_pixels(|pixels| {
            let pixels = Mat::roi(pixels, part)?;
            if min_side_px.is_none_or(|side| side / (2.0 * self.modules) < MIN_MODULE_PX) {
                self.aruco.detect(&pixels, share, &mut self.corners, &mut self.ids)?;
                return Ok([1.0; 2]);
            }
            let size = Size::new(part.width / 2, part.height / 2);
            imgproc::resize(&pixels, &mut self.half, size, 0.0, 0.0, imgproc::INTER_AREA)?;
            self.aruco.detect(&self.half, share, &mut self.corners, &mut self.ids)?;
            Ok([(part.width, size.width), (part.height, size.height)]
                .map(|(whole, half)| f64::from(whole) / f64::from(half)))
        })
    }
}

/// Adds a marker. Of two with the same id the one with the better outline stays, and the id is noted if they are two prints.
fn keep(found: &mut Found, twice: &mut Ids, marker: Marker) {
    match found.iter_mut().find(|other| other.id == marker.id) {
        Some(other) => {
            if is_elsewhere(other, &marker) && !twice.contains(&marker.id) {
                // There is room: no more ids are wanted than the list holds.
                let _ = twice.push(marker.id);
            }
            if other.quality < marker.quality {
                *other = marker;
            }
        }
        // There is room: no more ids are wanted than the list holds.
        None => drop(found.push(marker)),
    }
}

/// Whether these are two prints. One has an inner and an outer outline, and is in two windows where these overlap.
fn is_elsewhere(one: &Marker, other: &Marker) -> bool {
    let centre = |marker: &Marker| {
        let [a, _, c, _] = marker.corners;
        PixelPoint::new((a.x + c.x) / 2.0, (a.y + c.y) / 2.0)
    };
    let side = |marker: &Marker| marker.corners[0].distance(marker.corners[1]);
    centre(one).distance(centre(other)) > side(one).max(side(other)) / 2.0
}
