//! What `perceive` does to pictures, without channels: the role does it live, and a replay of a recording once more.

use andon_host::config::Config;
use andon_perception::sight::{Expected, Observation, Rates, SightMonitor, Spell};
use andon_perception::{Detections, ImageView, Perceiver, PerceptionError};
use shm_schemas::Judging;

use crate::perception::{SetupError, perceiver};
use crate::sight;

/// Looks at the pictures of one station, one source after the other.
pub struct Perceiving {
    perceiver: Perceiver,
    expected: Expected,
    sight: SightMonitor,
    /// The pictures per second that the job in force needs.
    needed_hz: Option<f32>,
    /// Of the source that it has seen; 0 before the first.
    source_epoch: u64,
}

impl Perceiving {
    /// Loads the models.
    ///
    /// # Errors
    /// The model, the library or the calibration that is missing or damaged, and what to run.
    pub fn new(config: &Config) -> Result<Self, SetupError> {
        let rate_hz = config.camera.source.is_live().then_some(config.camera.rate_hz);
        let expected = Expected { rate_hz, ..sight::expected(config) };
        Ok(Self {
            perceiver: perceiver(config)?,
            expected,
            sight: SightMonitor::new(expected),
            needed_hz: None,
            source_epoch: 0,
        })
    }

    /// Follows the job in force.
    pub fn watch_for(&mut self, judging: &Judging) {
        self.needed_hz = Some(judging.min_rate_hz).filter(|needed_hz| *needed_hz > 0.0);
        self.sight.set_needed_hz(self.needed_hz);
    }

    /// Nothing that was learnt from the pictures of another source holds. True where a picture of this start of the source is one of another.
    ///
    /// # Errors
    /// As [`Perceiving::new`].
    pub fn follow_source(&mut self, config: &Config, epoch: u64) -> Result<bool, SetupError> {
        let known = std::mem::replace(&mut self.source_epoch, epoch);
        let is_other = known != 0 && known != epoch;
        if is_other {
            self.perceiver = perceiver(config)?;
            self.sight = SightMonitor::new(self.expected);
            self.sight.set_needed_hz(self.needed_hz);
        }
        Ok(is_other)
    }

    /// What a picture of this source time shows, and what keeps the line from seeing. `dropped` are the frames before it that were not processed.
    ///
    /// # Errors
    /// What OpenCV and ONNX Runtime say, and a picture that the calibration is not for.
    pub fn step(
        &mut self,
        image: ImageView<'_>,
        source_ns: u64,
        dropped: u32,
    ) -> Result<(Detections, Option<Spell>), PerceptionError> {
        let seen = self.perceiver.perceive(image, source_ns)?;
        let spell = self.sight.step(&Observation::new(&seen, dropped));
        Ok((seen, spell))
    }

    /// Whether the newest picture shows the bench.
    pub fn is_seen(&self) -> bool {
        self.sight.is_seen()
    }

    /// How many pictures per second are processed, come, and are needed.
    pub fn rates(&self) -> Rates {
        self.sight.rates()
    }
}
