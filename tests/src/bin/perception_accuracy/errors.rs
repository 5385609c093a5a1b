//! Statistics of errors.

/// Errors of one kind.
#[derive(Default)]
pub(crate) struct Errors(Vec<f64>);

impl Errors {
    pub(crate) fn push(&mut self, error: f64) {
        self.0.push(error);
    }

    pub(crate) fn extend(&mut self, errors: impl IntoIterator<Item = f64>) {
        self.0.extend(errors);
    }

    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// The error that this share of the errors does not exceed; NaN where there are none.
    pub(crate) fn quantile(&self, share: f64) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let index = (share * sorted.len().saturating_sub(1) as f64).round() as usize;
        sorted.get(index).copied().unwrap_or(f64::NAN)
    }

    pub(crate) fn median(&self) -> f64 {
        self.quantile(0.5)
    }

    pub(crate) fn mean(&self) -> f64 {
        self.0.iter().sum::<f64>() / self.0.len() as f64
    }
}

/// Distance of two points with the same axes.
pub(crate) fn distance<const AXES: usize>(one: [f64; AXES], two: [f64; AXES]) -> f64 {
    (0..AXES).map(|axis| (one[axis] - two[axis]).powi(2)).sum::<f64>().sqrt()
}
