use andon_core::config::Method;
use andon_learn::run::Run;
use andon_learn::teach::*;
use andon_tests::simulator::*;
fn main() {
    let seed: u64 = std::env::args().nth(1).map_or(1, |a| a.parse().unwrap());
    let m = Method::default();
    let t0 = std::time::Instant::now();
    let all = experiment_2(seed, Noise::default());
    println!("sim {:?}", t0.elapsed());
    let t0 = std::time::Instant::now();
    let runs: Vec<Run> = all.iter().map(|r| Run::new(&r.name, "", &r.recording, &m).unwrap()).collect();
    println!("encode {:?}", t0.elapsed());
    let good: Vec<Run> = runs.iter().filter(|r| r.name.contains("none")).cloned().collect();
    let t0 = std::time::Instant::now();
    let (job, rep) = teach(&good, &TeachOptions::new("polish", "2026", m)).unwrap();
    println!("teach {:?}", t0.elapsed());
    println!("{rep}");
    if std::env::args().nth(2).is_some() {
        println!("{}", job.to_toml());
    }
    //PRINT
    for r in &runs[..2] {
        for i in &r.activities[0].ius {
            println!(
                "{:?}",
                i.motion
                    .chunk_by(|a, b| a == b)
                    .map(|c| (c.len(), c[0].0[0], c[0].0[2], c[0].0[3], c[0].0[5], c[0].0[6]))
                    .collect::<Vec<_>>()
            );
        }
    }
    for r in &runs {
        println!(
            "{} {:?}",
            r.name,
            r.activities
                .iter()
                .map(|a| a.ius.iter().map(|i| (i.context.0, i.motion.len(), i.reversals)).collect::<Vec<_>>())
                .collect::<Vec<_>>()
        );
    }
}
