//! The rules that the second experiment compares, from the paper's rules to the default ones, one step at a time.

use crate::rule::{BoundsRule, ThresholdRule};
use crate::teach::TeachOptions;
use andon_core::job::LocalCost;

/// A combination of rules.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// Its name in the table.
    pub name: &'static str,
    /// Whether directions are compared as points on a circle.
    pub(super) is_circular: bool,
    /// The job's [`max_slowdown`](andon_core::job::Job::max_slowdown).
    pub(super) max_slowdown: f32,
    /// How thresholds are chosen.
    pub(super) rule: ThresholdRule,
    /// How bounds are chosen.
    pub(super) bounds: BoundsRule,
}

impl Variation {
    /// The local cost with this number of direction bins.
    pub(super) fn cost(&self, bins: u8) -> LocalCost {
        if self.is_circular { LocalCost::Circular { bins } } else { LocalCost::Ordinal }
    }

    /// The paper's rules: ordinal costs, the mean and two standard deviations of the distances to the barycentre, and no bounds.
    pub fn paper() -> Self {
        Self {
            name: "paper",
            is_circular: false,
            max_slowdown: 1.0,
            rule: ThresholdRule::PAPER,
            bounds: BoundsRule::NONE,
        }
    }

    /// The paper's rules with one change added after the other; the last variation is the default.
    pub fn ladder() -> Vec<Self> {
        let paper = Self::paper();
        let bounds = BoundsRule::default();
        let left_out = Self {
            name: "+ leave one out",
            rule: ThresholdRule::LeaveOneOut { sigmas: 2.0, border_s: 0.0 },
            ..paper.clone()
        };
        let circular = Self { name: "+ circular cost", is_circular: true, ..left_out.clone() };
        let wider = Self {
            name: "+ 4 sigmas",
            rule: ThresholdRule::LeaveOneOut { sigmas: 4.0, border_s: 0.0 },
            ..circular.clone()
        };
        let borders = Self { name: "+ slack at borders", rule: ThresholdRule::default(), ..wider.clone() };
        let measures = Self {
            name: "+ bounds of measures",
            bounds: BoundsRule { false_alarms: bounds.false_alarms, ..BoundsRule::NONE },
            ..borders.clone()
        };
        let duration = Self { name: "+ bounds of duration", bounds, ..measures.clone() };
        let default = Self {
            name: "+ slack for the slow (default)",
            max_slowdown: TeachOptions::DEFAULT_MAX_SLOWDOWN,
            ..duration.clone()
        };
        vec![paper, left_out, circular, wider, borders, measures, duration, default]
    }
}
