//! DBSCAN on contexts (paper III-C: Euclidean distance, ε = 1).
//!
//! Neighbours are nearer than ε here, and not at most ε away. The paper says both. Contexts are similar "if their distance is smaller than 1", and
//! the library that it names (scikit-learn) takes at most ε. The two differ where ids differ by one. With at most ε, the hand with object 5 and that
//! with object 6 would be one IU. A chain of neighbouring ids would be one cluster. That contradicts that "two distinct `x_c` are representative of
//! different IUs". Ids that are two apart or more give the same clusters either way.
//!
//! It is written out here because the only well-maintained crate with DBSCAN, linfa-clustering, brings 50 more crates and takes at most ε.
//! Every point is a core point (one neighbour is enough), so there is no noise. An IU that was seen once is still an IU.

use andon_core::couple::Context;

/// The paper's ε.
const EPSILON: f64 = 1.0;

/// The cluster of each context. Clusters are numbered from 0 in the order in which they first appear.
pub fn by_context(contexts: &[Context]) -> Vec<usize> {
    let mut labels: Vec<Option<usize>> = vec![None; contexts.len()];
    let mut clusters = 0;
    for start in 0..contexts.len() {
        if labels[start].is_some() {
            continue;
        }
        let mut reached = vec![start];
        labels[start] = Some(clusters);
        while let Some(index) = reached.pop() {
            for other in 0..contexts.len() {
                if labels[other].is_none() && distance(contexts[index], contexts[other]) < EPSILON {
                    labels[other] = Some(clusters);
                    reached.push(other);
                }
            }
        }
        clusters += 1;
    }
    labels.into_iter().flatten().collect()
}

fn distance(Context(a): Context, Context(b): Context) -> f64 {
    a.iter().zip(b).map(|(a, b)| (f64::from(*a) - f64::from(b)).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn contexts_whose_ids_differ_by_one_stay_apart() {
        let contexts = [[1, 5, 0, 0], [1, 6, 0, 0], [1, 5, 0, 0], [2, 5, 0, 0]].map(Context);
        assert_eq!(by_context(&contexts), [0, 1, 0, 2]);
    }

    proptest! {
        #[test]
        fn two_contexts_share_a_cluster_exactly_when_they_are_equal(
            contexts in proptest::collection::vec(proptest::array::uniform4(0u16..4), 0..40)
        ) {
            let contexts: Vec<Context> = contexts.into_iter().map(Context).collect();
            let labels = by_context(&contexts);
            for i in 0..contexts.len() {
                for j in 0..contexts.len() {
                    prop_assert_eq!(labels[i] == labels[j], contexts[i] == contexts[j]);
                }
            }
        }
    }
}
