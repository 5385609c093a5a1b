//! Where markers are looked for. While all are seen, that is around where they were, and now and then in the whole picture.
//!
//! On the clips, with noise and in the dark, this finds the same markers in the same frames, in less than half the time. A marker that is
//! out of sight is looked for everywhere in every frame.

use super::{Found, Marker};
use crate::config::{MarkerSearch, MarkersConfig};
use crate::image::ImageView;
use crate::points::PixelPoint;
use opencv::core::Rect;

/// How far around a marker it is looked for in the next frame, as a share of its side. At 30 frames per second a marker of 36 mm stays within it up
/// to 1 m/s. One that is faster is not found there, and is then looked for everywhere.
const MARGIN: f64 = 1.0;
/// At least this far, in pixels: the window of the threshold and what OpenCV leaves out at a border must fit around the marker.
const MIN_MARGIN_PX: f64 = 16.0;
/// The whole picture is searched once per this number of frames. Only foreign markers wait for it.
const WHOLE_EVERY: u32 = 10;

/// The windows of the next frame, one for each marker.
pub(super) struct Windows {
    search: MarkerSearch,
    /// How many markers there are to be seen.
    wanted: usize,
    windows: Vec<Rect>,
    /// Width and height of the picture that they belong to.
    size: [usize; 2],
    /// Frames since the whole picture was searched.
    since_whole: u32,
}

impl Windows {
    pub(super) fn new(config: &MarkersConfig) -> Self {
        let (search, wanted) = (config.search, config.objects.len());
        Self { search, wanted, windows: Vec::new(), size: [0; 2], since_whole: 0 }
    }

    /// The windows to look into first. `None` as long as any marker is missing, so that one which appears is found in its first frame.
    pub(super) fn near(&mut self, image: &ImageView<'_>) -> Option<&[Rect]> {
        self.since_whole += 1;
        let is_near = self.search == MarkerSearch::Near
            && self.since_whole < WHOLE_EVERY
            && self.windows.len() == self.wanted
            && self.size == [image.width(), image.height()];
        is_near.then_some(self.windows.as_slice())
    }

    /// Whether the windows of this frame held all markers. Otherwise the whole picture is searched.
    pub(super) fn hold_all(&mut self, found: &Found) -> bool {
        let hold_all = found.len() == self.wanted && self.wanted > 0;
        if !hold_all {
            self.since_whole = 0;
        }
        hold_all
    }

    /// Takes the markers of a frame.
    pub(super) fn follow(&mut self, image: &ImageView<'_>, markers: &[Marker]) {
        self.size = [image.width(), image.height()];
        self.windows.clear();
        self.windows.extend(markers.iter().map(|marker| around(&marker.corners, self.size)));
    }
}

/// The part of a picture in which a marker is expected, from an even row and column on. Half the size has the same pixels then.
fn around(corners: &[PixelPoint; 4], [width, height]: [usize; 2]) -> Rect {
    let margin = (MARGIN * corners[0].distance(corners[1])).max(MIN_MARGIN_PX);
    let span = |places: [f64; 4], length: usize| {
        let (min, max) = places
            .into_iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), place| (min.min(place), max.max(place)));
        // The casts saturate.
        let first = ((min - margin) as i32).clamp(0, length as i32 - 1) & !1;
        let past = ((max + margin).ceil() as i32).clamp(first + 1, length as i32);
        (first, past - first)
    };
    let (x, width) = span(corners.map(|corner| corner.x), width);
    let (y, height) = span(corners.map(|corner| corner.y), height);
    Rect::new(x, y, width, height)
}
