//! How much larger than on the bench plane a thing appears, settled over time.

/// A deviation of about this share of the size is noise: corners to 0.1 px on a marker of 30 px.
const NOISE: f64 = 0.004;

/// The nearness of one thing: its size on the bench plane over the size it appears with; 1 on the plane, less above it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearness(f64);

impl Nearness {
    pub(crate) fn new(measured: f64) -> Self {
        Self(measured)
    }

    /// Takes a measurement in. A deviation within the noise hardly moves the value, so that a thing at rest stays at rest. A larger one is followed
    /// at once, so that a thing that is lifted does not lag.
    pub(crate) fn settle(&mut self, measured: f64) {
        let deviation = measured - self.0;
        let (signal, noise) = (deviation * deviation, NOISE * NOISE);
        self.0 += deviation * signal / (signal + noise);
    }

    pub(crate) fn value(self) -> f64 {
        self.0
    }
}
