//! What is right of a count, of a length and of a place.

/// An inclusive range of counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// Minimum of the right range.
    pub min: u32,
    /// Maximum of the right range.
    pub max: u32,
}

/// An inclusive range of lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Minimum of the right range.
    pub min: f32,
    /// Maximum of the right range.
    pub max: f32,
}

/// What is right within a distance of a centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Around<const N: usize> {
    /// The centre.
    pub centre: [f32; N],
    /// Maximum distance from it that is right.
    pub max: f32,
}

impl<const N: usize> Around<N> {
    /// Whether the centre is finite and the distance is at least 0.
    pub fn is_valid(&self) -> bool {
        self.centre.iter().all(|value| value.is_finite()) && self.max >= 0.0
    }

    /// How far a value lies from the centre.
    pub fn distance(&self, value: [f32; N]) -> f32 {
        let square: f32 =
            value.iter().zip(self.centre).map(|(value, centre)| (value - centre) * (value - centre)).sum();
        libm::sqrtf(square)
    }
}
