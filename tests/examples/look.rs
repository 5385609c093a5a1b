use andon_core::config::Method;
use andon_learn::run::Run;
use andon_tests::simulator::*;
fn rle(run: &Run) -> Vec<([u16; 4], usize)> {
    let mut v: Vec<([u16; 4], usize)> = vec![];
    for c in &run.couples {
        for h in &c.hands {
            {
                if (h.side == andon_core::input::Side::Left) != (run.name == "L") {
                    continue;
                }
                match v.last_mut() {
                    Some(l) if l.0 == h.context.0 => l.1 += 1,
                    _ => v.push((h.context.0, 1)),
                }
            }
        }
    }
    v
}
fn main() {
    let n: u64 = std::env::args().nth(1).map_or(7, |a| a.parse().unwrap());
    let mut bad = 0;
    let mut all = 0;
    for noise in [Noise::none(), Noise::default()] {
        for f in Flaw::ALL {
            for p in 1..=n {
                let perf = Performance { seed: 1, person: p, repetition: 1, noise };
                let (r, t) = perform(&perf, f);
                let run = Run::new(if f == Flaw::WrongHand { "L" } else { "x" }, "", &r, &Method::default())
                    .unwrap();
                let got: Vec<[u16; 4]> = rle(&run).iter().map(|c| c.0).filter(|c| *c != [0; 4]).collect();
                let want: Vec<[u16; 4]> = t.labels.contexts().concat().iter().map(|c| c.0).collect();
                all += 1;
                if got != want {
                    bad += 1;
                    println!(
                        "{f:?} p{p} noise {} got {:?}\n   want {:?}",
                        noise.landmark_px,
                        rle(&run),
                        want
                    );
                }
            }
        }
    }
    println!("{bad} of {all}");
}
