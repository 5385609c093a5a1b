//! Markers that are not the station's: printed from another dictionary, or with other ids than the configuration has.

use super::aruco::{Aruco, Reading};
use crate::dictionary::Dictionary;
use crate::image::ImageView;
use opencv::core::{Point2f, Vector};

/// The dictionaries that markers are printed from. Each holds the smaller ones of its kind.
const OTHERS: [&str; 6] = [
    "DICT_4X4_1000",
    "DICT_5X5_1000",
    "DICT_6X6_1000",
    "DICT_7X7_1000",
    "DICT_ARUCO_ORIGINAL",
    "DICT_APRILTAG_36h11",
];
/// As the markers' own default.
const THRESHOLD_CONSTANT: f64 = 3.0;

/// Looks for foreign markers until the first of the station's own has been seen.
pub(super) struct Foreign {
    own: Dictionary,
    has_seen_own: bool,
    /// The dictionary that is tried next.
    next: usize,
    /// By dictionary, what its newest look found, and how many of these its look before had found as well. A lucky pattern of a cloth is not read
    /// twice alike.
    found: [(Vec<i32>, usize); OTHERS.len()],
    markers: usize,
}

impl Foreign {
    pub(super) fn new(own: Dictionary) -> Self {
        Self { own, has_seen_own: false, next: 0, found: Default::default(), markers: 0 }
    }

    /// Takes how many markers of other ids a frame shows, and whether it shows one of the station's own. One other dictionary is tried in
    /// each frame: all of them at once would hold up the line.
    pub(super) fn look(
        &mut self,
        gray: &ImageView<'_>,
        unwanted: usize,
        has_own: bool,
    ) -> opencv::Result<()> {
        self.has_seen_own |= has_own;
        self.markers = unwanted;
        if self.has_seen_own {
            return Ok(());
        }
        let tried = self.next;
        self.next = (tried + 1) % OTHERS.len();
        let ids = ids_of(OTHERS[tried], self.own, gray)?;
        let before = &self.found[tried].0;
        let again = ids.iter().filter(|id| before.contains(id)).count();
        self.found[tried] = (ids, again);
        self.markers += self.found.iter().map(|(_, again)| *again).max().unwrap_or(0);
        Ok(())
    }

    pub(super) fn markers(&self) -> usize {
        self.markers
    }
}

fn ids_of(name: &str, own: Dictionary, gray: &ImageView<'_>) -> opencv::Result<Vec<i32>> {
    let Some(dictionary) =
        Dictionary::all().find(|dictionary| dictionary.name() == name && *dictionary != own)
    else {
        return Ok(Vec::new());
    };
    let mut aruco = Aruco::new(dictionary, Reading::quick(THRESHOLD_CONSTANT))?;
    let (mut corners, mut ids) = (Vector::<Vector<Point2f>>::new(), Vector::<i32>::new());
    gray.with_pixels(|pixels| aruco.detect(pixels, 1.0, &mut corners, &mut ids))?;
    Ok(ids.iter().collect())
}
