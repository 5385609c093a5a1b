//! The rules by which thresholds and bounds are chosen. A job file records the rules that it was taught with.

use serde::Deserialize;

/// How the threshold of an IU is derived from its demonstrations.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(tag = "name", rename_all = "snake_case", deny_unknown_fields)]
pub enum ThresholdRule {
    /// The paper's rule (IV-B): the mean plus `sigmas` standard deviations of the distances to the barycentre of all demonstrations.
    /// It is optimistic, because every demonstration has shaped the barycentre that it is measured against.
    Paper {
        /// Number of standard deviations above the mean; 2 in the paper.
        sigmas: f64,
    },
    /// Like the paper's rule, but with the distance of each demonstration to the barycentre of the others.
    LeaveOneOut {
        /// Number of standard deviations above the mean.
        sigmas: f64,
        /// Time in seconds for which an IU may begin or end like its neighbour, with the hand moving in the opposite direction.
        /// Contacts begin and end by distance, and the point of a movement at which that happens differs from one execution to the
        /// next. The allowance widens the thresholds of short IUs, and hardly those of long ones.
        /// A job file without this key was taught without the allowance.
        #[serde(default)]
        border_s: f64,
    },
    /// The leave-one-out distance that at most this share of correct executions exceeds. It is chosen by rank, without any
    /// assumption about the distribution of the distances (jackknife+ style). `n` demonstrations cannot promise less than `1 / (n + 1)`.
    Conformal {
        /// Share of correct executions that may be judged anomalous, 0 to 1.
        false_alarms: f64,
    },
}

impl ThresholdRule {
    /// The paper's rule with the paper's number of standard deviations.
    pub const PAPER: Self = Self::Paper { sigmas: 2.0 };
}

impl Default for ThresholdRule {
    /// The rule that measured best on simulated people who were held out, with the development seeds.
    fn default() -> Self {
        Self::LeaveOneOut { sigmas: 4.0, border_s: 0.17 }
    }
}

/// How the bounds of duration and of the other measures are derived from the demonstrations of an IU.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(from = "BoundsRuleText")]
pub struct BoundsRule {
    /// Maximum duration where the time does not show what is done, as a multiple of the longest demonstration; `pause_s` is added to it.
    pub max_duration: f64,
    /// Length in seconds of a pause that is no anomaly.
    pub pause_s: f64,
    /// The share of right jobs that the minimum durations at other parts and the bounds of reversals, strokes, paths, axes and places together may
    /// accuse. 0 sets no such bounds.
    pub false_alarms: f64,
}

impl BoundsRule {
    /// No bounds, as in the paper.
    pub const NONE: Self = Self { max_duration: f64::MAX, pause_s: 0.0, false_alarms: 0.0 };
}

impl Default for BoundsRule {
    fn default() -> Self {
        Self {
            // Half speed takes twice the time.
            max_duration: 2.5,
            pause_s: 3.0,
            false_alarms: 0.03,
        }
    }
}

/// The same as a job file has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoundsRuleText {
    /// A file with this key was taught when an IU at no other part had a minimum duration. That accused the quick and found nothing. It is not used
    /// any more.
    #[serde(rename = "min_duration")]
    _min_duration: Option<f64>,
    max_duration: f64,
    pause_s: f64,
    false_alarms: f64,
}

impl From<BoundsRuleText> for BoundsRule {
    fn from(text: BoundsRuleText) -> Self {
        let BoundsRuleText { _min_duration, max_duration, pause_s, false_alarms } = text;
        Self { max_duration, pause_s, false_alarms }
    }
}
