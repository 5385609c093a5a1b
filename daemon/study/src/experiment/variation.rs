//! The rules that the second experiment compares, from the paper's rules to the default ones, one step at a time.

use crate::folder::Labelled;
use andon_core::job::LocalCost;
use andon_learn::rule::{BoundsRule, ThresholdRule};
use andon_learn::teach::TeachOptions;

/// A combination of rules.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// Its name in the table.
    pub name: &'static str,
    /// Whether `x_m` passes through the opening-closing filter.
    pub(super) is_filtered: bool,
    /// Whether the runs show where and how near hands and objects meet. Otherwise they meet at the points that the recordings give.
    pub(super) finds_contact_regions: bool,
    /// How motions are compared.
    pub(super) cost: LocalCost,
    /// The job's [`max_slowdown`](andon_core::job::Job::max_slowdown).
    pub(super) max_slowdown: f32,
    /// The job's [`has_free_ends`](andon_core::job::Job::has_free_ends).
    pub(super) has_free_ends: bool,
    /// How thresholds are chosen.
    pub(super) rule: ThresholdRule,
    /// How bounds are chosen.
    pub(super) bounds: BoundsRule,
}

impl Variation {
    /// The paper's rules with this number of direction bins. Features are in `[0, 1]`, thresholds the mean and two standard deviations of the
    /// distances to the barycentre, and there are no bounds.
    pub fn paper(bins: u8) -> Self {
        Self {
            name: "paper",
            is_filtered: true,
            finds_contact_regions: false,
            cost: LocalCost::Normalised { bins },
            max_slowdown: 1.0,
            has_free_ends: false,
            rule: ThresholdRule::PAPER,
            bounds: BoundsRule::NONE,
        }
    }

    /// The paper's rules, first without their filter, then with one change added after the other; the last variation is the default.
    pub fn ladder(bins: u8) -> Vec<Self> {
        let paper = Self::paper(bins);
        let bounds = BoundsRule::default();
        let unfiltered = Self { name: "paper without the filter", is_filtered: false, ..paper.clone() };
        let ordinal =
            Self { name: "+ features in their own units", cost: LocalCost::Ordinal, ..paper.clone() };
        let left_out = Self {
            name: "+ leave one out",
            rule: ThresholdRule::LeaveOneOut { sigmas: 2.0, border_s: 0.0 },
            ..ordinal.clone()
        };
        let circular =
            Self { name: "+ circular cost", cost: LocalCost::Circular { bins }, ..left_out.clone() };
        let wider = Self {
            name: "+ 4 sigmas",
            rule: ThresholdRule::LeaveOneOut { sigmas: 4.0, border_s: 0.0 },
            ..circular.clone()
        };
        let borders = Self { name: "+ slack at borders", rule: ThresholdRule::default(), ..wider.clone() };
        let ends = Self { name: "+ any rest at the ends", has_free_ends: true, ..borders.clone() };
        let measures = Self {
            name: "+ bounds of measures",
            bounds: BoundsRule { false_alarms: bounds.false_alarms, ..BoundsRule::NONE },
            ..ends.clone()
        };
        let duration = Self { name: "+ bounds of duration", bounds, ..measures.clone() };
        let default = Self {
            name: "+ slack for the slow (default)",
            max_slowdown: TeachOptions::DEFAULT_MAX_SLOWDOWN,
            ..duration.clone()
        };
        vec![
            unfiltered, paper, ordinal, left_out, circular, wider, borders, ends, measures, duration, default,
        ]
    }

    /// The same [`ladder`](Self::ladder) with one more step behind the paper's rules: hands and objects meet where the runs show it.
    pub fn ladder_with_contact_regions(bins: u8) -> Vec<Self> {
        let paper = Self::paper(bins);
        let found =
            Self { name: "+ contact regions from the runs", finds_contact_regions: true, ..paper.clone() };
        let mut all = Self::ladder(bins);
        let behind = 1 + all.iter().position(|one| *one == paper).unwrap_or_default();
        all[behind..].iter_mut().for_each(|one| one.finds_contact_regions = true);
        all.insert(behind, found);
        all
    }

    /// The same variations for these recordings. If none of them says where its objects are touched, hands and objects meet in each variation where
    /// the training executions show it.
    #[must_use]
    pub fn for_recordings(mut variations: Vec<Self>, all: &[Labelled]) -> Vec<Self> {
        let mut objects = all.iter().flat_map(|one| &one.run.objects);
        let is_any_given = objects.any(|object| object.shape.has_points());
        variations.iter_mut().for_each(|one| one.finds_contact_regions |= !is_any_given);
        variations
    }

    /// The same variations with this cost in each; those that differ in nothing else are left out.
    pub fn with_cost(variations: Vec<Self>, cost: LocalCost) -> Vec<Self> {
        let mut all: Vec<Self> = variations.into_iter().map(|one| Self { cost, ..one }).collect();
        all.dedup_by(|next, one| Self { name: one.name, ..next.clone() } == *one);
        all
    }
}
