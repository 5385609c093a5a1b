//! Errors that last, as of a tracker that filters.

use super::Random;
use std::collections::BTreeMap;

/// The errors of several things along three axes, in standard deviations: first-order autoregressions.
#[derive(Clone, Debug)]
pub struct LastingErrors {
    kept: f64,
    errors: BTreeMap<u16, [f64; 3]>,
}

impl LastingErrors {
    /// Of an error, the share `kept` is left one frame later.
    pub fn new(kept: f64) -> Self {
        Self { kept, errors: BTreeMap::new() }
    }

    /// The error of this thing in the next frame in which it is seen.
    pub fn next(&mut self, id: u16, random: &mut Random) -> [f64; 3] {
        let new = [(); 3].map(|()| random.normal());
        let (kept, added) = (self.kept, (1.0 - self.kept * self.kept).sqrt());
        let error = self.errors.entry(id).or_insert(new);
        *error = [0, 1, 2].map(|axis| kept * error[axis] + added * new[axis]);
        *error
    }
}
