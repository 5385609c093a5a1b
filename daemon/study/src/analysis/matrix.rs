//! Confidence matrices: distances scaled to 0..1, with a name for each row.

/// A square matrix of scaled distances.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// The group that each row belongs to, and the row's name. Columns are the same.
    pub rows: Vec<(usize, String)>,
    /// Row by row, from 0 (alike) to 1 (the maximum distance of the matrix).
    pub values: Vec<f64>,
    /// The maximum DTW distance, which was scaled to 1.
    pub max_distance: f64,
}

impl Matrix {
    /// Scales the DTW distances `get(i, j)` between rows `i` and `j`.
    pub fn new(rows: Vec<(usize, String)>, get: impl Fn(usize, usize) -> f64) -> Self {
        let side = rows.len();
        let mut values: Vec<f64> = (0..side * side).map(|index| get(index / side, index % side)).collect();
        let max_distance = values.iter().copied().fold(0.0, f64::max);
        if max_distance > 0.0 {
            values.iter_mut().for_each(|value| *value /= max_distance);
        }
        Self { rows, values, max_distance }
    }

    /// The matrix as comma-separated values, with names in the first row and column.
    pub fn csv(&self) -> String {
        let names: Vec<&str> = self.rows.iter().map(|(_, name)| name.as_str()).collect();
        let mut text = format!("scaled distance,{}\n", names.join(","));
        for (name, row) in names.iter().zip(self.values.chunks(names.len().max(1))) {
            let row: Vec<String> = row.iter().map(|value| format!("{value:.4}")).collect();
            text += &format!("{name},{}\n", row.join(","));
        }
        text
    }
}
