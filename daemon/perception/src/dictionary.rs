//! The marker dictionaries that OpenCV knows.

/// A marker dictionary, as its index in [`DICTIONARIES`].
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Dictionary(usize);

/// OpenCV's name, the modules per side without the black border, and the number of markers. The index is OpenCV's own number.
const DICTIONARIES: [(&str, u8, u16); 21] = [
    ("DICT_4X4_50", 4, 50),
    ("DICT_4X4_100", 4, 100),
    ("DICT_4X4_250", 4, 250),
    ("DICT_4X4_1000", 4, 1000),
    ("DICT_5X5_50", 5, 50),
    ("DICT_5X5_100", 5, 100),
    ("DICT_5X5_250", 5, 250),
    ("DICT_5X5_1000", 5, 1000),
    ("DICT_6X6_50", 6, 50),
    ("DICT_6X6_100", 6, 100),
    ("DICT_6X6_250", 6, 250),
    ("DICT_6X6_1000", 6, 1000),
    ("DICT_7X7_50", 7, 50),
    ("DICT_7X7_100", 7, 100),
    ("DICT_7X7_250", 7, 250),
    ("DICT_7X7_1000", 7, 1000),
    ("DICT_ARUCO_ORIGINAL", 5, 1024),
    ("DICT_APRILTAG_16h5", 4, 30),
    ("DICT_APRILTAG_25h9", 5, 35),
    ("DICT_APRILTAG_36h10", 6, 2320),
    ("DICT_APRILTAG_36h11", 6, 587),
];

impl Dictionary {
    /// All dictionaries, in OpenCV's order.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..DICTIONARIES.len()).map(Self)
    }

    /// OpenCV's name, such as `DICT_4X4_50`.
    pub fn name(self) -> &'static str {
        DICTIONARIES[self.0].0
    }

    /// Modules per side, including the black border of one module.
    pub(crate) fn modules(self) -> f64 {
        f64::from(DICTIONARIES[self.0].1) + 2.0
    }

    /// Number of markers; their ids run from 0.
    pub fn markers(self) -> usize {
        usize::from(DICTIONARIES[self.0].2)
    }

    /// OpenCV's number.
    pub(crate) fn code(self) -> i32 {
        self.0 as i32
    }
}

impl Default for Dictionary {
    /// `DICT_4X4_50`: the fewest modules, and therefore the largest ones on a marker of a given size.
    fn default() -> Self {
        Self(0)
    }
}

impl std::fmt::Debug for Dictionary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
