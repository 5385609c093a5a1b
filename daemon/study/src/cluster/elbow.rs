//! The elbow of a falling curve.

/// Of the WCSS of one cluster: what is less is nothing.
const MIN_SHARE: f64 = 1e-6;

/// The k at the elbow of a curve of WCSS over k = 1, 2, .... It is the point furthest below the straight line from the first point to the last. Both
/// axes are scaled to 0..1, that of the sums by their logarithms (the "kneedle" rule, Satopää et al. 2011). Ties go to the smaller k. A curve that
/// does not fall has its elbow at 1.
pub(super) fn elbow(wcss: &[f64]) -> usize {
    let (Some(first), Some(last)) = (wcss.first(), wcss.last()) else { return 1 };
    let fall = first - last;
    if wcss.len() < 3 || fall <= 0.0 {
        return 1;
    }
    // The sums fall by ratios. A cluster more may take away a third of what is left, whether that is much or little of the whole.
    let logarithm = |sum: f64| sum.max(MIN_SHARE * first).ln();
    let depth = |index: usize| {
        let along = index as f64 / (wcss.len() - 1) as f64;
        1.0 - along - (logarithm(wcss[index]) - logarithm(*last)) / (logarithm(*first) - logarithm(*last))
    };
    let best = (0..wcss.len()).max_by(|&a, &b| depth(a).total_cmp(&depth(b)).then(b.cmp(&a)));
    best.map_or(1, |index| index + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_elbow_is_where_the_curve_bends() {
        assert_eq!(elbow(&[100.0, 60.0, 30.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0]), 4);
        assert_eq!(elbow(&[100.0, 10.0, 9.0, 8.0]), 2);
    }

    #[test]
    fn a_curve_that_does_not_fall_has_one_cluster() {
        assert_eq!(elbow(&[5.0, 5.0, 5.0]), 1);
        assert_eq!(elbow(&[5.0]), 1);
        assert_eq!(elbow(&[]), 1);
    }
}
