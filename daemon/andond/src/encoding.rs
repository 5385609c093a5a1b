//! What `encode` does to detections, without channels: the role does it live, and a replay of a recording once more.

use andon_core::config::Method;
use andon_core::couple::{Couples, Encoder, Refused, Unusable};
use andon_core::input::Frame;
use andon_core::object::ObjectShape;
use andon_host::config::Config;
use andon_learn::job_file::JobFile;

/// An encoder of a station, made for one job.
pub struct Encoding {
    method: Method,
    shapes: Vec<ObjectShape>,
    model_hash: u64,
    encoder: Encoder,
    /// Source time of the newest frame.
    newest_ns: u64,
    /// CLOCK_MONOTONIC of the first frame since the encoder has begun; 0 before it.
    began_ns: u64,
}

impl Encoding {
    /// Begins with the objects as the job shows them.
    ///
    /// # Errors
    /// A constant or an object that cannot be used.
    pub fn new(config: &Config, job: Option<&JobFile>) -> Result<Self, Unusable> {
        let mut shapes = config.shapes();
        for shown in job.iter().flat_map(|job| job.shapes()) {
            if let Some(shape) = shapes.iter_mut().find(|shape| shape.id == shown.id) {
                *shape = shown;
            }
        }
        let method = config.method();
        let encoder = Encoder::new(method, &shapes)?;
        let model_hash = job.map_or(0, JobFile::model_hash);
        Ok(Self { method, shapes, model_hash, encoder, newest_ns: 0, began_ns: 0 })
    }

    /// The hash of the job that shows where the objects are met and what they are used for; 0 where there is none.
    pub fn model_hash(&self) -> u64 {
        self.model_hash
    }

    /// CLOCK_MONOTONIC of the first frame that its couples depend on, nanoseconds; 0 before it.
    pub fn began_ns(&self) -> u64 {
        self.began_ns
    }

    /// Whether a frame of this source time is one of a recording that starts again. It then begins at zero. A frame that is only out of order is not
    /// so far back.
    pub fn begins_again(&self, source_ns: u64) -> bool {
        source_ns < self.newest_ns / 2
    }

    /// Takes a frame that was captured at this time of CLOCK_MONOTONIC.
    ///
    /// # Errors
    /// That it is out of order; then nothing has changed.
    pub fn step(
        &mut self,
        frame: &Frame,
        captured_ns: u64,
        take: &mut impl FnMut(Couples),
    ) -> Result<(), Refused> {
        self.newest_ns = frame.captured_ns;
        if self.began_ns == 0 {
            self.began_ns = captured_ns;
        }
        self.encoder.step(frame, take)
    }

    /// Gives what the encoder still holds back.
    pub fn flush(&mut self, take: &mut impl FnMut(Couples)) {
        self.encoder.flush(take);
    }

    /// Begins with a new encoder.
    ///
    /// # Errors
    /// As [`Encoding::new`].
    pub fn begin(&mut self) -> Result<(), Unusable> {
        self.encoder = Encoder::new(self.method, &self.shapes)?;
        (self.newest_ns, self.began_ns) = (0, 0);
        Ok(())
    }
}
