//! DTW compared with `dtw_rs` in the same process. `report.py` runs this, adds the Python peers and prints the table.
#![allow(missing_docs, clippy::unwrap_used)]

use andon_core::couple::Motion;
use andon_core::dtw::{LocalCosts, OnlineDtw};
use andon_core::job::LocalCost;
use andon_learn::warp::Warp;
use criterion::{Criterion, criterion_group, criterion_main};
use dtw_rs::{Solution, dtw_with_distance};
use std::hint::black_box;
use std::time::Duration;

/// Number of frames of each sequence.
const FRAMES: usize = 150;

/// The golden pair of this length, without elevation (5 dimensions vary) or with it (7 vary).
fn golden_pair(elevated: bool) -> [Vec<Motion>; 2] {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/dtw/vectors.json");
    let vectors: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let pairs = vectors["ordinal"].as_array().unwrap().iter().map(|pair| {
        ["a", "b"].map(|key| {
            let motions: Vec<[i8; 7]> = serde_json::from_value(pair[key].clone()).unwrap();
            motions.into_iter().map(Motion).collect::<Vec<_>>()
        })
    });
    let is_elevated = |motions: &[Motion]| motions.iter().any(|motion| motion.0[1] != 0);
    let mut pairs =
        pairs.filter(|[a, b]| a.len() == FRAMES && b.len() == FRAMES && is_elevated(a) == elevated);
    pairs.next().unwrap()
}

fn vectors<const D: usize>(motions: &[Motion]) -> Vec<[f64; D]> {
    // In plane mode the elevations do not vary and are left out.
    let features: &[usize] = if D == 5 { &[0, 2, 3, 5, 6] } else { &[0, 1, 2, 3, 4, 5, 6] };
    motions.iter().map(|motion| std::array::from_fn(|k| f64::from(motion.0[features[k]]))).collect()
}

fn dtw_rs_sum<const D: usize>(a: &[[f64; D]], b: &[[f64; D]]) -> f64 {
    let squared = |x: &[f64; D], y: &[f64; D]| x.iter().zip(y).map(|(x, y)| (x - y) * (x - y)).sum::<f64>();
    dtw_with_distance(a, b, squared).distance()
}

fn batch(c: &mut Criterion) {
    for (dimensions, elevated) in [(5, false), (7, true)] {
        let [a, b] = golden_pair(elevated);
        for (name, local) in [("ordinal", LocalCost::Ordinal), ("circular", LocalCost::Circular { bins: 8 })]
        {
            let mut warp = Warp::new(local);
            c.bench_function(&format!("batch_{name}_{dimensions}"), |bench| {
                bench.iter(|| warp.distance(black_box(&a), black_box(&b)));
            });
        }
        let own = Warp::new(LocalCost::Ordinal).distance(&a, &b).unwrap();
        let peer = if elevated {
            dtw_rs_sum(&vectors::<7>(&a), &vectors::<7>(&b))
        } else {
            dtw_rs_sum(&vectors::<5>(&a), &vectors::<5>(&b))
        };
        assert!((own - peer.sqrt()).abs() < 1e-9, "the peer computes a different distance");
    }
    let [a, b] = golden_pair(false).map(|motions| vectors::<5>(&motions));
    c.bench_function("dtw_rs_5", |bench| bench.iter(|| dtw_rs_sum(black_box(&a), black_box(&b))));
    let [a, b] = golden_pair(true).map(|motions| vectors::<7>(&motions));
    c.bench_function("dtw_rs_7", |bench| bench.iter(|| dtw_rs_sum(black_box(&a), black_box(&b))));
}

fn online(c: &mut Criterion) {
    let [frames, reference] = golden_pair(true);
    let costs = LocalCosts::new(LocalCost::Circular { bins: 8 });
    let mut frame = frames.iter().cycle();
    let mut online = Box::new(OnlineDtw::new(&costs, &reference).unwrap());
    c.bench_function("append_7", |bench| {
        bench.iter(|| {
            if online.append(black_box(frame.next().unwrap())).is_err() {
                online.begin(&reference).unwrap();
            }
            online.lower_bound()
        });
    });
}

/// All distances between 240 IUs, as clustering needs them. The IUs and the sum of the distances are written for the peer in `report.py`.
fn matrix(c: &mut Criterion) {
    let mut random = oorandom::Rand32::new(240);
    let ius: Vec<Vec<Motion>> = (0..240).map(|_| iu(&mut random)).collect();
    let mut warp = Warp::new(LocalCost::Ordinal);
    let mut sum = || -> f64 {
        let pairs =
            ius.iter().enumerate().flat_map(|(index, a)| ius[index + 1..].iter().map(move |b| (a, b)));
        pairs.map(|(a, b)| warp.distance(a, b).unwrap()).sum()
    };
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../target/bench");
    std::fs::create_dir_all(folder).unwrap();
    let plain: Vec<Vec<[i8; 7]>> = ius.iter().map(|iu| iu.iter().map(|motion| motion.0).collect()).collect();
    let left = serde_json::json!({ "ius": plain, "sum": sum() });
    std::fs::write(format!("{folder}/matrix.json"), left.to_string()).unwrap();
    let mut group = c.benchmark_group("matrix");
    group.sample_size(10).bench_function("240", |bench| bench.iter(&mut sum));
    group.finish();
}

/// 60 to 180 frames of plane motion, in which each motion lasts for 1 to 12 frames.
fn iu(random: &mut oorandom::Rand32) -> Vec<Motion> {
    let frames = random.rand_range(60..181) as usize;
    let mut motions = Vec::new();
    while motions.len() < frames {
        let mut below = |count: u32| random.rand_range(0..count) as i8;
        let motion = Motion([below(3) - 1, 0, below(9), below(2), 0, below(9), below(2)]);
        motions.extend(std::iter::repeat_n(motion, 1 + below(12) as usize));
    }
    motions.truncate(frames);
    motions
}

/// Measures the processor's clock: 1,000 multiplications, each of which waits for the one before it and takes three cycles.
fn clock(c: &mut Criterion) {
    c.bench_function("multiplications_1000", |bench| {
        bench.iter(|| (0..1000).fold(black_box(3u64), |product, _| black_box(3u64).wrapping_mul(product)));
    });
}

criterion_group! {
    name = dtw;
    config = Criterion::default().warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).without_plots();
    targets = clock, batch, online, matrix
}
criterion_main!(dtw);
