//! Metric mode on the line: turns the depth and the optics that come with a frame into a scene in metres.

use andon_core::input::Space;
use andon_host::config::Config;
use andon_perception::Detections;
use andon_perception::bench::{Calibration, CalibrationError};
use andon_perception::config::MarkerObject;
use andon_perception::metric::{
    BenchFrame, DepthImage, Distortion, Lens, Metric, MetricError, MetricScene, Rig, Sampler, rigid,
};
use shm_schemas::{DepthFormat, FrameHeader, Intrinsics};

use crate::perception::{calibration, marker_objects};

/// Why a frame cannot be placed.
#[derive(Debug, thiserror::Error)]
pub enum PlaceError {
    /// Not with this frame; the next one may show the bench.
    #[error(transparent)]
    NoBench(MetricError),
    /// Never with this calibration and this camera.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// Never with these frames.
    #[error(transparent)]
    Frame(MetricError),
}

/// Places what was detected in the frames of one camera in the frame of the bench.
pub struct Placer {
    calibration: Option<Calibration>,
    objects: Vec<MarkerObject>,
    /// Known once a frame has brought the optics and shown the bench.
    placed: Option<(Rig, Metric)>,
}

impl Placer {
    /// The placer of a station; `None` in plane mode.
    ///
    /// # Errors
    /// A calibration that cannot be read.
    pub fn new(config: &Config) -> Result<Option<Self>, CalibrationError> {
        if config.method.space == Space::Plane {
            return Ok(None);
        }
        Ok(Some(Self { calibration: calibration(config)?, objects: marker_objects(config), placed: None }))
    }

    /// The scene of a frame, in the frame of the bench. That is the one of the calibration, or without one that of the plane which the first depth
    /// picture shows. `None` while no frame with depth has come.
    ///
    /// # Errors
    /// [`PlaceError`], with what to do.
    pub fn place(
        &mut self,
        header: &FrameHeader,
        depth: &[u8],
        seen: &Detections,
    ) -> Result<Option<MetricScene>, PlaceError> {
        let depth = image(header, depth).map_err(PlaceError::Frame)?;
        if let Some(depth) = depth {
            let rig = rig(header).ok_or(PlaceError::Frame(MetricError::Optics))?;
            // The optics change where another camera, or another mode of it, takes over.
            if self.placed.as_ref().is_none_or(|(known, _)| *known != rig) {
                let bench = self.bench(depth, &rig)?;
                self.placed = Some((rig, Metric::new(rig, bench, &self.objects)));
            }
        }
        let Some((_, metric)) = &mut self.placed else { return Ok(None) };
        metric.place(depth, seen).map(Some).map_err(PlaceError::Frame)
    }

    fn bench(&self, depth: DepthImage<'_>, rig: &Rig) -> Result<BenchFrame, PlaceError> {
        match &self.calibration {
            Some(calibration) => Ok(calibration.bench_frame(&rig.colour)?),
            None => BenchFrame::from_depth(&Sampler::new(depth, rig)).map_err(PlaceError::NoBench),
        }
    }
}

/// The depth picture in the bytes of a frame; `None` where the frame has none.
fn image<'a>(header: &FrameHeader, depth: &'a [u8]) -> Result<Option<DepthImage<'a>>, MetricError> {
    if header.depth_format != DepthFormat::Z16.code() {
        return Ok(None);
    }
    let size = [header.depth_width as usize, header.depth_height as usize];
    DepthImage::new(size, header.depth_stride as usize, header.depth_unit_m.into(), depth).map(Some)
}

/// `None` where the optics of either camera are unknown.
fn rig(header: &FrameHeader) -> Option<Rig> {
    let between = &header.colour_from_depth;
    Some(Rig {
        colour: lens(&header.colour)?,
        depth: lens(&header.depth)?,
        colour_from_depth: rigid(between.rotation, between.translation_m),
    })
}

fn lens(of: &Intrinsics) -> Option<Lens> {
    let distortion = match shm_schemas::Distortion::try_from(of.model).ok()? {
        shm_schemas::Distortion::None => Distortion::None,
        shm_schemas::Distortion::BrownConrady => Distortion::BrownConrady,
        shm_schemas::Distortion::InverseBrownConrady => Distortion::InverseBrownConrady,
    };
    let is_known = of.fx > 0.0 && of.fy > 0.0;
    is_known.then(|| Lens {
        focal: [of.fx.into(), of.fy.into()],
        centre: [of.cx.into(), of.cy.into()],
        distortion,
        coefficients: of.distortion.map(f64::from),
    })
}
