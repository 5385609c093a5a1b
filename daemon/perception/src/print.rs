//! Markers to print: their patterns, how large they must appear, and which ones a picture shows.

use crate::config::MarkersConfig;
use crate::dictionary::Dictionary;
use crate::error::{PerceptionError, while_doing};
use crate::image::ImageView;
use crate::markers::Markers;
use crate::sight::SeenMarker;
use opencv::core::Mat;
use opencv::prelude::*;

/// Pixels that a module should measure from edge to edge. 400 markers of six modules were seen in noise and through a lens that is a little soft. Of
/// these, 400 are found at 5 pixels for each module, 398 at 4.5, 385 at 4 and 265 at 3. In dim light it is 399, 398, 391 and 299: `tests/print.rs`.
const WANTED_MODULE_PX: f64 = 5.0;
/// Pixels of a module from which on hardly a marker is missed.
const NEEDED_MODULE_PX: f64 = 4.5;

/// The modules of a marker.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MarkerPattern {
    /// Modules per side, with the black border of one module.
    pub modules: usize,
    /// Whether each is black, row by row from the top left of the marker's own picture.
    pub black: Vec<bool>,
}

impl Dictionary {
    /// The pattern of a marker.
    ///
    /// # Errors
    /// [`PerceptionError::Setting`] for an id that the dictionary does not have; [`PerceptionError::OpenCv`].
    pub fn pattern(self, id: u16) -> Result<MarkerPattern, PerceptionError> {
        if usize::from(id) >= self.markers() {
            let range = "an id of the marker dictionary";
            return Err(PerceptionError::Setting { key: "id", value: id.to_string(), range });
        }
        let modules = self.modules() as usize;
        // One pixel for each module.
        let picture = draw(self, id, modules as i32).map_err(while_doing("drawing a marker"))?;
        let levels = picture.data_bytes().map_err(while_doing("drawing a marker"))?;
        Ok(MarkerPattern { modules, black: levels.iter().map(|level| *level < 128).collect() })
    }

    /// Side of the black square, in pixels, from which on a marker of this dictionary is found in every ordinary light.
    pub fn wanted_side_px(self) -> f64 {
        WANTED_MODULE_PX * self.modules()
    }

    /// Side of the black square, in pixels, below which too many are missed in bad light.
    pub fn needed_side_px(self) -> f64 {
        NEEDED_MODULE_PX * self.modules()
    }
}

#[cfg(not(aruco_in_objdetect))]
fn draw(dictionary: Dictionary, id: u16, side: i32) -> opencv::Result<Mat> {
    let mut picture = Mat::default();
    let dictionary = opencv::aruco::get_predefined_dictionary_i32(dictionary.code())?;
    opencv::aruco::draw_marker(&dictionary, i32::from(id), side, &mut picture, 1)?;
    Ok(picture)
}

#[cfg(aruco_in_objdetect)]
fn draw(dictionary: Dictionary, id: u16, side: i32) -> opencv::Result<Mat> {
    let mut picture = Mat::default();
    let dictionary = opencv::objdetect::get_predefined_dictionary_i32(dictionary.code())?;
    opencv::objdetect::generate_image_marker(&dictionary, i32::from(id), side, &mut picture, 1)?;
    Ok(picture)
}

/// Finds the markers of a dictionary in a picture, whatever their ids. A [`Perceiver`](crate::Perceiver) finds only those of its objects.
pub struct MarkerFinder(Markers);

impl MarkerFinder {
    /// # Errors
    /// [`PerceptionError::OpenCv`].
    pub fn new(dictionary: Dictionary) -> Result<Self, PerceptionError> {
        Ok(Self(Markers::new(&MarkersConfig { dictionary, ..MarkersConfig::default() })?))
    }

    /// The markers of a picture in order of their ids, at most one of each id.
    ///
    /// # Errors
    /// [`PerceptionError::OpenCv`].
    pub fn find(&mut self, image: &ImageView<'_>) -> Result<Vec<SeenMarker>, PerceptionError> {
        let found = self.0.find(image, None, |_| true)?;
        let seen =
            found.iter().map(|marker| SeenMarker { id: marker.id, corners: marker.corners.map(Into::into) });
        Ok(seen.collect())
    }
}
