//! The rules that the second experiment compares: from the paper's own to the default, one step at a time.

use crate::teach::{BoundsRule, TeachOptions, ThresholdRule};
use andon_core::job::LocalCost;

/// A choice of rules.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// What it is called in the table.
    pub name: &'static str,
    /// Whether directions are points on a circle.
    pub circular: bool,
    /// Up to how many times slower than shown is no anomaly of the motion.
    pub slowness: f32,
    /// How thresholds are chosen.
    pub rule: ThresholdRule,
    /// How bounds are chosen.
    pub bounds: BoundsRule,
}

impl Variation {
    /// The local cost for this many bins.
    pub fn cost(&self, bins: u8) -> LocalCost {
        if self.circular { LocalCost::Circular { bins } } else { LocalCost::Ordinal }
    }

    /// The paper's own rule: ordinal, mean and two deviations of the distances to one's own barycentre, nothing else.
    pub fn paper() -> Self {
        Self {
            name: "paper",
            circular: false,
            slowness: 1.0,
            rule: ThresholdRule::PAPER,
            bounds: BoundsRule::NONE,
        }
    }

    /// The rules of the paper with one thing added after the other, the default last.
    pub fn ladder() -> Vec<Self> {
        let paper = Self::paper();
        let bounds = BoundsRule::default();
        let still = BoundsRule { fewest: 0.0, most: bounds.most, ..BoundsRule::NONE };
        let left_out = Self {
            name: "+ leave one out",
            rule: ThresholdRule::LeaveOneOut { sigmas: 2.0, border_s: 0.0 },
            ..paper.clone()
        };
        let circular = Self { name: "+ circular cost", circular: true, ..left_out.clone() };
        let wider = Self {
            name: "+ 4 sigmas",
            rule: ThresholdRule::LeaveOneOut { sigmas: 4.0, border_s: 0.0 },
            ..circular.clone()
        };
        let borders = Self { name: "+ slack at borders", rule: ThresholdRule::default(), ..wider.clone() };
        let reversals = Self {
            name: "+ bounds of reversals",
            bounds: BoundsRule { fewest: bounds.fewest, ..still },
            ..borders.clone()
        };
        let duration = Self { name: "+ bounds of duration", bounds, ..reversals.clone() };
        let default = Self {
            name: "+ slack for the slow (default)",
            slowness: TeachOptions::SLOWNESS,
            ..duration.clone()
        };
        vec![paper, left_out, circular, wider, borders, reversals, duration, default]
    }
}
