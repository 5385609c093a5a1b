use andon_core::config::Method;
use andon_learn::experiment::{Outcome, Split, Variation};
use andon_learn::folder::Labelled;
use andon_learn::run::Run;
use andon_tests::simulator::*;
fn main() {
    let seeds: Vec<u64> =
        std::env::args().nth(1).map_or(vec![1], |a| a.split(',').map(|x| x.parse().unwrap()).collect());
    let m = Method::default();
    for seed in seeds {
        let all = experiment_2(seed, Noise::default());
        let t0 = std::time::Instant::now();
        let runs: Vec<Labelled> = all
            .iter()
            .map(|r| {
                let l = andon_learn::folder::label(&format!("{}.tracks.jsonl", r.name)).unwrap();
                Labelled {
                    person: l.0,
                    what: l.1,
                    repetition: l.2,
                    run: Run::new(&r.name, "", &r.recording, &m).unwrap(),
                }
            })
            .collect();
        println!("encode {:?}", t0.elapsed());
        for split in [Split::Random, Split::LeavePersonOut] {
            for v in Variation::ladder() {
                let t0 = std::time::Instant::now();
                let o = &experiment_2_run(&runs, &m, &v, split)[0];
                let (i, a) = (o.ius.sum(), o.activities.sum());
                println!(
                    "{seed} {:?} {:32} IU {:.1}±{:.1} fp {} fn {} j2 {} | act {:.1}±{:.1} fp {} fn {} jobs {:?} {:?} n={} ",
                    split,
                    v.name,
                    100. * o.ius.accuracy().0,
                    100. * o.ius.accuracy().1,
                    i.false_positive,
                    i.false_negative,
                    o.accused_in_j2,
                    100. * o.activities.accuracy().0,
                    100. * o.activities.accuracy().1,
                    a.false_positive,
                    a.false_negative,
                    o.jobs,
                    t0.elapsed(),
                    i.all()
                );
            }
        }
    }
}
fn experiment_2_run(r: &[Labelled], m: &Method, v: &Variation, s: Split) -> Vec<Outcome> {
    andon_learn::experiment::experiment_2(r, m, &[v.clone()], &[s], 7, &mut |_| {}).unwrap()
}
