//! Points of the picture and points of the bench: two types, so that pixels are never taken for metres.

macro_rules! point {
    ($(#[$doc:meta])+ $name:ident) => {
        $(#[$doc])+
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct $name {
            /// To the right in the picture.
            pub x: f64,
            /// Down in the picture for pixels, and up in it for metres.
            pub y: f64,
        }

        impl $name {
            /// A point by its coordinates.
            pub const fn new(x: f64, y: f64) -> Self {
                Self { x, y }
            }

            /// The distance of two points, in the unit of their coordinates.
            pub(crate) fn distance(self, other: Self) -> f64 {
                (self.x - other.x).hypot(self.y - other.y)
            }
        }

        impl From<$name> for [f32; 2] {
            fn from($name { x, y }: $name) -> Self {
                [x as f32, y as f32]
            }
        }
    };
}

point! {
    /// A point of a picture in pixels: x right, y down, the centre of the first pixel at (0, 0).
    PixelPoint
}

point! {
    /// A point of the bench plane in metres in the bench frame: x right in the picture, y up in it.
    BenchPoint
}

impl PixelPoint {
    /// The mean of these points.
    pub(crate) fn mean<const COUNT: usize>(points: [Self; COUNT]) -> Self {
        Self {
            x: points.iter().map(|point| point.x).sum::<f64>() / COUNT as f64,
            y: points.iter().map(|point| point.y).sum::<f64>() / COUNT as f64,
        }
    }
}

impl From<[f32; 2]> for PixelPoint {
    fn from([x, y]: [f32; 2]) -> Self {
        Self { x: x.into(), y: y.into() }
    }
}
