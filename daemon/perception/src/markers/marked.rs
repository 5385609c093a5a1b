//! The parts that carry a marker.

use super::Markers;
use crate::config::{MarkerObject, MarkersConfig};
use crate::error::PerceptionError;
use crate::finder::{FoundObjects, ObjectFinder, SeenObject};
use crate::image::ImageView;

/// Finds parts by their markers.
pub(crate) struct MarkedObjects {
    markers: Markers,
    objects: Vec<MarkerObject>,
}

impl MarkedObjects {
    /// # Errors
    /// As [`Markers::new`].
    pub(crate) fn new(config: &MarkersConfig) -> Result<Self, PerceptionError> {
        Ok(Self { markers: Markers::new(config)?, objects: config.objects.clone() })
    }

    /// What they are found by.
    pub(crate) fn markers(&self) -> &Markers {
        &self.markers
    }
}

impl ObjectFinder for MarkedObjects {
    fn find(
        &mut self,
        image: &ImageView<'_>,
        min_side_px: Option<f64>,
    ) -> Result<FoundObjects, PerceptionError> {
        let Self { markers, objects } = self;
        let object = |marker: u16| objects.iter().find(|object| object.marker == marker);
        let found = markers.find(image, min_side_px, |marker| object(marker).is_some())?;
        // Which of two prints lies on the part is a guess: neither is it.
        let single = found.iter().filter(|marker| !markers.twice().contains(&marker.id));
        let seen = single.filter_map(|marker| {
            object(marker.id).map(|object| SeenObject {
                id: object.id,
                corners: marker.corners,
                side_m: Some(object.side_m.into()),
                quality: marker.quality,
            })
        });
        let twice = markers.twice().iter().filter_map(|marker| object(*marker).map(|object| object.id));
        Ok(FoundObjects { objects: seen.collect(), twice: twice.collect() })
    }
}
