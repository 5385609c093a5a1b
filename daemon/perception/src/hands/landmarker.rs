//! The landmarks of one hand in a region of the picture.

use super::models::{LandmarkModel, Landmarks};
use super::region::Region;
use super::side::Evidence;
use crate::error::PerceptionError;
use crate::image::ImageView;
use std::time::Instant;

/// Below this probability of the side that a hand has, its landmarks may be those of the other side. From above, the back of a right hand and the
/// palm of a left one have the same outline. Their fingers are in the opposite order.
const SURE_OF_SIDE: f32 = 0.8;
/// The regions in which the hand is looked at again then, as shares of the one in which it was expected. The nearer they are, the more of its fingers
/// the model sees.
const NEARER: [f32; 2] = [0.9, 0.8];

/// Has a model of its own, so that two hands are looked at side by side.
pub(super) struct Landmarker<L> {
    model: L,
    /// Minimum probability that there is a hand, 0..1.
    min_presence: f32,
    spent_ns: u64,
}

impl<L: LandmarkModel> Landmarker<L> {
    pub(super) fn new(model: L, min_presence: f32) -> Self {
        Self { model, min_presence, spent_ns: 0 }
    }

    /// What the model sees in a region.
    ///
    /// # Errors
    /// [`PerceptionError::Inference`].
    pub(super) fn at(&mut self, image: &ImageView<'_>, region: Region) -> Result<Landmarks, PerceptionError> {
        let began = Instant::now();
        let seen = self.model.landmarks(image, region)?;
        self.spent_ns += began.elapsed().as_nanos() as u64;
        Ok(seen)
    }

    /// What is seen of a followed hand where it is expected.
    ///
    /// # Errors
    /// [`PerceptionError::Inference`].
    pub(super) fn follow(
        &mut self,
        image: &ImageView<'_>,
        region: Region,
        evidence: Evidence,
    ) -> Result<Landmarks, PerceptionError> {
        let seen = self.at(image, region)?;
        self.nearer(image, region, evidence, seen)
    }

    /// What is seen of a hand from nearer, if it is not sure to be of its side in its region. The first look stays
    /// the evidence for the side: of several, the one that agrees would always be found.
    ///
    /// # Errors
    /// [`PerceptionError::Inference`].
    pub(super) fn nearer(
        &mut self,
        image: &ImageView<'_>,
        region: Region,
        evidence: Evidence,
        first: Landmarks,
    ) -> Result<Landmarks, PerceptionError> {
        let Some(side) = evidence.side() else { return Ok(first) };
        let mut best = first;
        for share in NEARER {
            if best.presence < self.min_presence || best.is_of(side) >= SURE_OF_SIDE {
                break;
            }
            let seen = self.at(image, Region { side: share * region.side, ..region })?;
            if seen.presence >= self.min_presence && seen.is_of(side) > best.is_of(side) {
                best = seen;
            }
        }
        Ok(Landmarks { right: first.right, ..best })
    }

    /// How long it has looked since this was asked last, in nanoseconds.
    pub(super) fn spent_ns(&mut self) -> u64 {
        std::mem::take(&mut self.spent_ns)
    }
}
