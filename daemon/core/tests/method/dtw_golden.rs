//! DTW against `dtaidistance` 2.5.1; `tests/golden/dtw/make.py` makes the vectors.

use andon_core::couple::Motion;
use andon_core::dtw::{LocalCosts, OnlineDtw};
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

fn distance(cost: LocalCost, a: &[Motion], b: &[Motion]) -> f64 {
    let mut online = OnlineDtw::new(&LocalCosts::new(cost), b).unwrap();
    a.iter().for_each(|frame| online.append(frame).unwrap());
    online.distance().unwrap()
}

#[test]
fn ordinal_distances_are_those_of_dtaidistance() {
    for vector in vectors("ordinal") {
        let (a, b) = (motions(&vector["a"]), motions(&vector["b"]));
        assert_near(distance(LocalCost::Ordinal, &a, &b), &vector["distance"], 1e-9);
    }
}

#[test]
fn circular_distances_are_those_of_dtaidistance_to_1e_5() {
    for vector in vectors("circular") {
        let bins = from_value(vector["bins"].clone()).unwrap();
        let (a, b) = (motions(&vector["a"]), motions(&vector["b"]));
        assert_near(distance(LocalCost::Circular { bins }, &a, &b), &vector["distance"], 1e-5);
    }
}
