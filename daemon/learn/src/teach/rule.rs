//! The rules that thresholds and bounds are chosen by. They stand in the job file.

use serde::Deserialize;

/// How the threshold of an IU comes from its demonstrations.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(tag = "name", rename_all = "snake_case", deny_unknown_fields)]
pub enum ThresholdRule {
    /// The paper's (IV-B): mean and `sigmas` standard deviations of the distances to one's own barycentre.
    /// Optimistic, because every demonstration has shaped the barycentre that it is measured against.
    Paper {
        /// 2 in the paper.
        sigmas: f64,
    },
    /// The same of the distances of each demonstration to the barycentre of the others.
    LeaveOneOut {
        /// Standard deviations over the mean.
        sigmas: f64,
        /// Seconds of a neighbouring IU, in the opposite direction, that an IU may begin or end with: contacts begin and end by distance,
        /// and where in a movement that happens differs. It widens the thresholds of short IUs, and hardly those of long ones.
        /// A job file that does not say was taught with none.
        #[serde(default)]
        border_s: f64,
    },
    /// The leave-one-out distance that at most this share of correct executions exceeds, by rank and without any
    /// assumption about how distances are spread (jackknife+ style). `n` demonstrations cannot promise less than `1 / (n + 1)`.
    Conformal {
        /// Share of correct executions that may be accused, 0..1.
        false_alarms: f64,
    },
}

impl ThresholdRule {
    /// The paper's own rule.
    pub const PAPER: Self = Self::Paper { sigmas: 2.0 };
}

impl Default for ThresholdRule {
    /// What measured best on held-out simulated people of the development seeds.
    fn default() -> Self {
        Self::LeaveOneOut { sigmas: 4.0, border_s: 0.17 }
    }
}

/// How the bounds of duration and of reversals come from the demonstrations.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoundsRule {
    /// Least duration, as a share of the shortest demonstration.
    pub shortest: f64,
    /// Greatest duration, as a multiple of the longest demonstration; `pause_s` comes on top.
    pub longest: f64,
    /// A pause that is no anomaly, in seconds.
    pub pause_s: f64,
    /// Least reversals, as a share of the fewest of any demonstration.
    pub fewest: f64,
    /// Most reversals, as a multiple of the most of any demonstration.
    pub most: f64,
}
