//! Looks at one picture after the other, as the line does, and at markers that the station does not know.

use andon_core::input::Side;
use andon_host::config::{Config, Object};
use andon_host::video::pipe::PictureFormat;
use andon_perception::sight::SeenMarker;
use andon_perception::{ImageView, MarkerFinder, Perceiver, Picture, PixelFormat};
use shm_schemas::Detections;

use super::source::View;
use crate::picture::{Marked, with_seen};
use crate::recording::RecordingError;
use crate::tool::ToolError;
use crate::{perception, wire};

/// What one picture showed.
#[derive(Clone)]
pub(super) struct Inspection {
    /// What the line sees in it.
    pub(super) seen: Detections,
    /// How well it can be seen.
    pub(super) picture: Picture,
    /// Markers of parts that are in view twice.
    pub(super) twice: Vec<u16>,
    /// Markers of parts that are only found where the picture is mirrored, and where it is inverted. They are looked for while a part is missing.
    pub(super) odd: [Vec<u16>; 2],
    /// Hands in the picture, also those that the station does not look for.
    pub(super) hands: usize,
    /// Markers of the station's dictionary that belong to no part.
    pub(super) others: Vec<SeenMarker>,
    /// Markers of another dictionary may be among these.
    pub(super) foreign: usize,
}

impl Inspection {
    /// How much it shows: markers and hands.
    pub(super) fn shows(&self) -> usize {
        let parts = self.seen.seen_objects().count();
        parts + self.others.len() + self.seen.hands().len()
    }

    /// The corners of a part's marker, in pixels.
    pub(super) fn part(&self, id: u16) -> Option<[[f32; 2]; 4]> {
        let mut seen = self.seen.seen_objects();
        seen.find(|object| object.id == id).map(|object| object.corners_px)
    }

    pub(super) fn has_hand(&self, side: Side) -> bool {
        let code = wire::verdict::hand(side).code();
        self.seen.hands().iter().any(|hand| hand.hand == code)
    }
}

/// The side of a marker in pixels: the mean of its four edges.
pub(super) fn side_px(corners: &[[f32; 2]; 4]) -> f32 {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    edges.map(|(from, to)| (from[0] - to[0]).hypot(from[1] - to[1])).sum::<f32>() / 4.0
}

/// A part that carries a marker.
struct Part {
    id: u16,
    marker: u16,
    name: String,
}

/// Follows one source.
pub(super) struct Inspector {
    perceiver: Perceiver,
    finder: MarkerFinder,
    parts: Vec<Part>,
    needed_px: f32,
    /// In how many pictures missing markers were looked for in other ways.
    odd_tried: usize,
}

fn part(object: &Object) -> Option<Part> {
    Some(Part { id: object.id, marker: object.marker_id()?, name: object.name.clone() })
}

/// In so many pictures it shows whether they are mirrored or inverted.
const ODD_PICTURES: usize = 10;

impl Inspector {
    /// Where the hands come with the pictures, no hand is looked for.
    pub(super) fn new(config: &Config, has_hands: bool) -> Result<Self, ToolError> {
        let mut config = config.clone();
        // A calibration that is awaited cannot be read yet, and pixels need none.
        config.bench.calibration = None;
        if has_hands {
            config.perception.hands.clear();
        }
        let dictionary = config.perception.dictionary;
        Ok(Self {
            perceiver: perception::perceiver(&config).map_err(RecordingError::from)?,
            finder: MarkerFinder::new(dictionary).map_err(RecordingError::from)?,
            parts: config.objects.iter().filter_map(part).collect(),
            needed_px: dictionary.needed_side_px() as f32,
            odd_tried: 0,
        })
    }

    pub(super) fn inspect(&mut self, view: &View<'_>) -> Result<Inspection, ToolError> {
        let (width, height) = (view.format.width as usize, view.format.height as usize);
        let image = ImageView::new(width, height, width * 3, PixelFormat::Bgr8, view.picture);
        let image = image.map_err(RecordingError::from)?;
        let perceived = self.perceiver.perceive(image, view.at_ns).map_err(RecordingError::from)?;
        let mut seen = Detections { source_ns: view.at_ns, ..Detections::default() };
        wire::detections::write(&perceived, &mut seen);
        if let Some(by_line) = view.seen {
            (seen.hands, seen.hands_len) = (by_line.hands, by_line.hands_len);
        }
        let mut others = self.finder.find(&image).map_err(RecordingError::from)?;
        others.retain(|marker| self.parts.iter().all(|part| part.marker != marker.id));
        let (twice, hands) = (perceived.twice.to_vec(), perceived.hands_in_view);
        let is_missing = |part: &&Part| {
            let mut seen = seen.seen_objects();
            !seen.any(|object| object.id == part.id) && !twice.contains(&part.id)
        };
        let missing: Vec<u16> = self.parts.iter().filter(is_missing).map(|part| part.marker).collect();
        let odd = self.odd(&missing, view)?;
        let (picture, foreign) = (perceived.picture, perceived.foreign_markers);
        Ok(Inspection { seen, picture, twice, odd, hands, others, foreign })
    }

    /// Those of the missing markers that a mirrored picture shows, and an inverted one.
    fn odd(&mut self, missing: &[u16], view: &View<'_>) -> Result<[Vec<u16>; 2], ToolError> {
        if missing.is_empty() || self.odd_tried >= ODD_PICTURES {
            return Ok([Vec::new(), Vec::new()]);
        }
        self.odd_tried += 1;
        let (width, height) = (view.format.width as usize, view.format.height as usize);
        let mirrored: Vec<u8> = view
            .picture
            .chunks_exact(3 * width)
            .flat_map(|row| row.chunks_exact(3).rev().flatten().copied())
            .collect();
        let inverted: Vec<u8> = view.picture.iter().map(|level| 255 - level).collect();
        let mut found = |pixels: &[u8]| -> Result<Vec<u16>, RecordingError> {
            let image = ImageView::new(width, height, width * 3, PixelFormat::Bgr8, pixels)?;
            let markers = self.finder.find(&image)?;
            Ok(markers.into_iter().map(|marker| marker.id).filter(|id| missing.contains(id)).collect())
        };
        Ok([found(&mirrored)?, found(&inverted)?])
    }

    /// A picture with what was seen in it.
    pub(super) fn annotated(
        &self,
        format: PictureFormat,
        picture: &[u8],
        inspection: &Inspection,
    ) -> Result<Vec<u8>, ToolError> {
        let parts = self.parts.iter().filter_map(|Part { id, name, .. }| {
            let corners_px = inspection.part(*id)?;
            let side = side_px(&corners_px);
            let words = format!("{name} {side:.0} px");
            Some(Marked { corners_px, words, is_doubtful: side.round() < self.needed_px })
        });
        let others = inspection.others.iter().map(|marker| Marked {
            corners_px: marker.corners,
            words: format!("marker {}, no part", marker.id),
            is_doubtful: true,
        });
        let marked: Vec<Marked> = parts.chain(others).collect();
        with_seen(format, picture, &marked, &inspection.seen)
            .map_err(|error| ToolError::Annotate(crate::picture::AnnotateError::OpenCv(error)))
    }
}
