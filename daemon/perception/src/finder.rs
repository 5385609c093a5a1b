//! What finds objects in a picture, whatever it goes by.
//!
//! An object has an id of its own, which jobs, verdicts and registers name. What it is found by, as a marker with another id, is the business
//! of its [`ObjectFinder`]. The parts that carry markers have one that is always there; [`crate::Perceiver::with_finder`] takes further ones.

use crate::detections::OBJECTS;
use crate::error::PerceptionError;
use crate::image::ImageView;
use crate::points::PixelPoint;
use heapless::Vec;

/// An object in a picture, before it is placed on the bench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenObject {
    /// The object's id.
    pub id: u16,
    /// The corners of its square, or of its outline, in pixels: top left, top right, bottom right, bottom left, as it is upright. They say where it
    /// is, and how it is turned.
    pub corners: [PixelPoint; 4],
    /// The side of a square of known size, in metres: it gives its own scale, at whatever height it is. Without it the object is taken to lie on the
    /// bench, where something else must give the scale: a calibration, or a marker.
    pub side_m: Option<f64>,
    /// How well it was seen, 0..1.
    pub quality: f64,
}

/// What one finder has found in a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FoundObjects {
    /// The objects, at most one for each id.
    pub objects: Vec<SeenObject, OBJECTS>,
    /// The ids of objects that are in the picture more than once: which of them is the part is not guessed.
    pub twice: Vec<u16, OBJECTS>,
}

impl FoundObjects {
    /// Adds what another finder has found. Of an object that both have found, the first counts.
    pub(crate) fn add(&mut self, other: Self) {
        for object in other.objects {
            if self.objects.iter().all(|known| known.id != object.id) && !self.twice.contains(&object.id) {
                // There is room for as many as a station may have.
                let _ = self.objects.push(object);
            }
        }
        for id in other.twice {
            self.objects.retain(|object| object.id != id);
            if !self.twice.contains(&id) {
                // As above.
                let _ = self.twice.push(id);
            }
        }
    }
}

/// Finds objects, frame by frame.
pub trait ObjectFinder: Send {
    /// What is in a picture. `min_side_px` is the side of the smallest marker that may appear, if that is known.
    ///
    /// # Errors
    /// What the libraries say. The finder stays usable.
    fn find(
        &mut self,
        image: &ImageView<'_>,
        min_side_px: Option<f64>,
    ) -> Result<FoundObjects, PerceptionError>;
}
