//! DTW against a full matrix in `f64`.

use crate::common::cases::many_cases;
use andon_core::capacity::IU_FRAMES;
use andon_core::couple::Motion;
use andon_core::dtw::{LocalCosts, OnlineDtw, Refused};
use andon_core::job::LocalCost;
use proptest::collection::vec;
use proptest::prelude::*;

const COSTS: [LocalCost; 8] = [
    LocalCost::Ordinal,
    LocalCost::Normalised { bins: 7 },
    LocalCost::Normalised { bins: 8 },
    LocalCost::Normalised { bins: 13 },
    LocalCost::Circular { bins: 8 },
    LocalCost::Circular { bins: 12 },
    LocalCost::Circular { bins: 7 },
    LocalCost::Circular { bins: 16 },
];

/// How far a distance may be from the one in real numbers, relative to it.
const MAX_ERROR: f64 = 0.5e-5;

/// The whole matrix in `f64`, with costs from the definition: independent of the code of `dtw`.
mod oracle {
    use super::*;

    pub(super) fn cost(cost: LocalCost, a: &Motion, b: &Motion) -> f64 {
        let squared = |f: usize| (f64::from(a.0[f]) - f64::from(b.0[f])).powi(2);
        let bins = match cost {
            LocalCost::Ordinal => return (0..7).map(squared).sum(),
            LocalCost::Normalised { bins } => {
                let n = f64::from(bins);
                let ranges = [2.0, n, n, 1.0, n, n, 1.0];
                return (0..7).map(|f| squared(f) / (ranges[f] * ranges[f])).sum();
            }
            LocalCost::Circular { bins } => bins,
        };
        let point = |direction: i8| match direction {
            0 => (0.0, 0.0),
            bin => (f64::from(bin) * std::f64::consts::TAU / f64::from(bins)).sin_cos(),
        };
        let directions = [1, 2, 4, 5].map(|f| {
            let ((ay, ax), (by, bx)) = (point(a.0[f]), point(b.0[f]));
            (ax - bx).powi(2) + (ay - by).powi(2)
        });
        [0, 3, 6].map(squared).iter().sum::<f64>() + directions.iter().sum::<f64>()
    }

    pub(super) fn matrix(local: LocalCost, a: &[Motion], b: &[Motion]) -> Vec<Vec<f64>> {
        let mut sums = vec![vec![f64::INFINITY; b.len()]; a.len()];
        for i in 0..a.len() {
            for j in 0..b.len() {
                let mut best = if (i, j) == (0, 0) { 0.0 } else { f64::INFINITY };
                if i > 0 {
                    best = best.min(sums[i - 1][j]);
                }
                if j > 0 {
                    best = best.min(sums[i][j - 1]);
                }
                if i > 0 && j > 0 {
                    best = best.min(sums[i - 1][j - 1]);
                }
                sums[i][j] = best + cost(local, &a[i], &b[j]);
            }
        }
        sums
    }

    pub(super) fn distance(local: LocalCost, a: &[Motion], b: &[Motion]) -> f64 {
        matrix(local, a, b)[a.len() - 1][b.len() - 1].sqrt()
    }
}

/// Sequences as the method makes them: features in range, with or without elevation.
fn motions(frames: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Motion>> {
    let direction = || 0..=7i8;
    let frame = (-1..=1i8, direction(), direction(), 0..=1i8, direction(), direction(), 0..=1i8);
    (vec(frame, frames), any::<bool>()).prop_map(|(frames, elevated)| {
        let elevation = |bin| if elevated { bin } else { 0 };
        let motion = |(a, t, p, j, u, q, k)| Motion([a, elevation(t), p, j, elevation(u), q, k]);
        frames.into_iter().map(motion).collect()
    })
}

/// Features that no encoder makes.
fn wild(frames: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Motion>> {
    vec(any::<[i8; 7]>().prop_map(Motion), frames)
}

fn online(costs: &LocalCosts, frames: &[Motion], reference: &[Motion]) -> (f64, Vec<f64>) {
    let mut online = OnlineDtw::new(costs, reference).unwrap();
    let bounds = frames.iter().map(|frame| {
        online.append(frame).unwrap();
        online.lower_bound()
    });
    let bounds = bounds.collect();
    (online.distance().unwrap(), bounds)
}

fn batch(costs: &LocalCosts, a: &[Motion], b: &[Motion]) -> f64 {
    online(costs, a, b).0
}

/// Checks everything that must hold for two sequences with any features.
fn check(local: LocalCost, a: &[Motion], b: &[Motion]) {
    let costs = LocalCosts::new(local);
    let (distance, bounds) = online(&costs, a, b);
    assert_eq!(batch(&costs, b, a), distance, "symmetric");
    assert_eq!(batch(&costs, a, a), 0.0, "the distance of a sequence to itself is 0");
    assert!(bounds.is_sorted(), "the minimum of the newest row never falls");
    assert!(bounds[a.len() - 1] <= distance);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_distance_is_the_same_to_the_bit_the_other_way_round_and_no_less_than_its_bounds(a in motions(1..200), b in motions(1..200)) {
        for local in COSTS {
            check(local, &a, &b);
        }
    }

    #[test]
    fn so_it_is_with_features_out_of_range(
        mut a in motions(1..60),
        b in wild(1..60),
        index in 0..60usize,
    ) {
        for local in COSTS {
            check(local, &a, &b);
        }
        let index = index % a.len();
        a[index] = b[0];
        for local in COSTS {
            check(local, &b, &a);
        }
    }

    #[test]
    fn the_distance_is_that_of_the_full_matrix_in_f64(a in motions(1..120), b in motions(1..120)) {
        for local in COSTS {
            let costs = LocalCosts::new(local);
            let (got, exact) = (batch(&costs, &a, &b), oracle::distance(local, &a, &b));
            prop_assert!((got - exact).abs() <= MAX_ERROR * exact + 1e-12, "{local:?}: {got} {exact}");
        }
    }

    #[test]
    fn the_lower_bound_is_the_minimum_of_the_newest_row(a in motions(1..60), b in motions(1..60)) {
        let rows = oracle::matrix(LocalCost::Ordinal, &a, &b);
        let (_, bounds) = online(&LocalCosts::new(LocalCost::Ordinal), &a, &b);
        for (row, bound) in rows.iter().zip(bounds) {
            prop_assert_eq!(row.iter().copied().fold(f64::INFINITY, f64::min).sqrt(), bound);
        }
    }

    #[test]
    fn ordinal_distances_of_any_features_are_exact(a in wild(1..40), b in wild(1..40)) {
        prop_assert_eq!(batch(&LocalCosts::new(LocalCost::Ordinal), &a, &b), oracle::distance(LocalCost::Ordinal, &a, &b));
    }
}

proptest! {
    #![proptest_config(many_cases())]

    /// Whoever knows fewer frames has no greater distance and no greater bound, after each frame. An unknown frame may have been the motion that was
    /// made.
    #[test]
    fn a_distance_over_unknown_frames_is_no_greater_than_with_them(
        frames in vec((motions(1..2), any::<bool>()), 1..60),
        reference in motions(1..60),
        local in prop::sample::select(COSTS.to_vec()),
    ) {
        let costs = LocalCosts::new(local);
        let (mut whole, mut less) = (OnlineDtw::new(&costs, &reference).unwrap(), OnlineDtw::new(&costs, &reference).unwrap());
        for (frame, is_known) in &frames {
            whole.append(&frame[0]).unwrap();
            if *is_known {
                less.append(&frame[0]).unwrap();
            } else {
                less.append_unknown();
            }
            prop_assert!(less.lower_bound() <= whole.lower_bound());
            prop_assert!(less.distance() <= whole.distance(), "{:?} > {:?}", less.distance(), whole.distance());
        }
    }
}

#[test]
fn rounding_moves_a_distance_by_less_than_half_of_1e_5_with_up_to_37_bins() {
    for bins in 1..=37 {
        let local = LocalCost::Circular { bins };
        let costs = LocalCosts::new(local);
        // The distance of sequences of one frame is the root of the cost.
        for (a, b) in (0..=bins as i8).flat_map(|a| (0..=bins as i8).map(move |b| (a, b))) {
            let [a, b] = [a, b].map(|bin| Motion([0, 0, bin, 0, 0, 0, 0]));
            let (got, exact) = (batch(&costs, &[a], &[b]), oracle::distance(local, &[a], &[b]));
            assert!(
                (got - exact).abs() <= MAX_ERROR * exact + 1e-12,
                "{bins} bins, {a:?} {b:?}: {got} {exact}"
            );
        }
    }
}

#[test]
fn the_longest_and_farthest_sequences_do_not_overflow() {
    // No warping path is longer than along both sides, and no cost is greater than that from the minimum to the maximum features.
    let (low, high) = (vec![Motion([i8::MIN; 7]); IU_FRAMES], vec![Motion([i8::MAX; 7]); IU_FRAMES]);
    let costs = LocalCosts::new(LocalCost::Ordinal);
    let cells = IU_FRAMES as f64;
    assert_eq!(batch(&costs, &low, &high), (cells * 7.0 * 255.0 * 255.0).sqrt());
    let opposite = |bin| vec![Motion([0, bin, bin, 0, bin, bin, 0]); IU_FRAMES];
    let costs = LocalCosts::new(LocalCost::Circular { bins: 8 });
    assert_eq!(batch(&costs, &opposite(1), &opposite(5)), (cells * 16.0).sqrt());
    let (distance, _) = online(&costs, &opposite(1), &opposite(5));
    assert_eq!(distance, (cells * 16.0).sqrt());
}

#[test]
fn sequences_of_unusable_length_are_refused() {
    let costs = LocalCosts::new(LocalCost::Ordinal);
    let long = vec![Motion::default(); IU_FRAMES + 1];
    let (one, full) = (&long[..1], &long[..IU_FRAMES]);
    let too_long = Refused::TooLong { frames: IU_FRAMES + 1 };

    assert_eq!(OnlineDtw::new(&costs, &[]).err(), Some(Refused::Empty));
    assert_eq!(OnlineDtw::new(&costs, &long).err(), Some(too_long));

    let mut online = OnlineDtw::new(&costs, full).unwrap();
    assert_eq!((online.distance(), online.lower_bound()), (None, 0.0));
    for frame in full {
        online.append(frame).unwrap();
    }
    assert_eq!(online.append(&one[0]), Err(too_long));
    assert_eq!(online.distance(), Some(0.0));
}

#[test]
fn a_reference_can_be_replaced_in_place() {
    let costs = LocalCosts::new(LocalCost::Ordinal);
    let [a, b] = [2, 3].map(|bin| [Motion([0, 0, bin, 0, 0, 0, 0]); 40]);
    let mut online = OnlineDtw::new(&costs, &a).unwrap();
    online.append(&b[0]).unwrap();
    online.begin(&b[..3]).unwrap();
    assert_eq!(online.distance(), None);
    online.append(&b[0]).unwrap();
    assert_eq!(online.distance(), Some(0.0));
    assert_eq!(online.begin(&[]), Err(Refused::Empty));
    assert_eq!(online.distance(), Some(0.0), "a refused reference changes nothing");
}
