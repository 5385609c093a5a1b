//! DTW against `dtaidistance` 2.5.1; `tests/golden/dtw/make.py` makes the vectors.

use andon_core::couple::Motion;
use andon_core::dtw::{LocalCosts, OnlineDtw, Scratch, distance, path, path_memory};
use andon_core::job::LocalCost;
use serde_json::{Value, from_value};

fn vectors(kind: &str) -> Vec<Value> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/golden/dtw/vectors.json");
    let mut all: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let vectors: Vec<Value> = from_value(all[kind].take()).unwrap();
    assert!(!vectors.is_empty());
    vectors
}

fn motions(values: &Value) -> Vec<Motion> {
    from_value::<Vec<[i8; 7]>>(values.clone()).unwrap().into_iter().map(Motion).collect()
}

fn assert_near(got: f64, golden: &Value, relative: f64) {
    let golden = golden.as_f64().unwrap();
    assert!((got - golden).abs() <= relative * golden, "{got} instead of {golden}");
}

/// The distance, which must be the same online.
fn both_ways(cost: LocalCost, a: &[Motion], b: &[Motion]) -> f64 {
    let costs = LocalCosts::new(cost);
    let whole = distance(&costs, a, b, &mut Scratch::default()).unwrap();
    let mut online = OnlineDtw::new(&costs, b).unwrap();
    a.iter().for_each(|frame| online.append(frame).unwrap());
    assert_eq!(online.distance(), Some(whole));
    whole
}

#[test]
fn ordinal_distances_and_paths_are_those_of_dtaidistance() {
    for vector in vectors("ordinal") {
        let (a, b) = (motions(&vector["a"]), motions(&vector["b"]));
        assert_near(both_ways(LocalCost::Ordinal, &a, &b), &vector["distance"], 1e-9);

        let costs = LocalCosts::new(LocalCost::Ordinal);
        let mut memory = vec![[0; 32]; path_memory(a.len(), b.len())];
        let mut pairs: Vec<_> =
            path(&costs, &a, &b, &mut memory, &mut Scratch::default()).unwrap().1.collect();
        pairs.reverse();
        assert_eq!(pairs, from_value::<Vec<(usize, usize)>>(vector["path"].clone()).unwrap());
    }
}

#[test]
fn circular_distances_are_those_of_dtaidistance_to_1e_5() {
    for vector in vectors("circular") {
        let bins = from_value(vector["bins"].clone()).unwrap();
        let (a, b) = (motions(&vector["a"]), motions(&vector["b"]));
        assert_near(both_ways(LocalCost::Circular { bins }, &a, &b), &vector["distance"], 1e-5);
    }
}
