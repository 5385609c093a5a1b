//! A confidence matrix: distances scaled to 0..1, with what each row is.

/// A square matrix of scaled distances.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// The group that each row belongs to, and its name.
    pub rows: Vec<(usize, String)>,
    /// Row by row, 0 (alike) to 1 (the greatest distance in it).
    pub values: Vec<f64>,
    /// The greatest distance, which became 1.
    pub greatest: f64,
}

impl Matrix {
    /// Scales the distances `get(i, j)` of these rows.
    pub fn new(rows: Vec<(usize, String)>, get: impl Fn(usize, usize) -> f64) -> Self {
        let side = rows.len();
        let mut values: Vec<f64> = (0..side * side).map(|place| get(place / side, place % side)).collect();
        let greatest = values.iter().copied().fold(0.0, f64::max);
        if greatest > 0.0 {
            values.iter_mut().for_each(|value| *value /= greatest);
        }
        Self { rows, values, greatest }
    }

    /// As comma-separated values, names in the first row and column.
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
