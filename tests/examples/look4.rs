use andon_learn::run::Run;
use andon_learn::teach::*;
use andon_core::config::Method;
use andon_core::verdict::*;
use andon_tests::simulator::*;
fn main(){
    let a: Vec<String>=std::env::args().collect();
    let seeds: Vec<u64>=a[1].split(',').map(|x|x.parse().unwrap()).collect();
    let verbose=a.len()>3;
    let m=Method::default();
    for sig in a[2].split(',') { let sig:f64=sig.parse().unwrap();
    let mut tally: std::collections::BTreeMap<Flaw,(u32,u32)>=Default::default();
    for &seed in &seeds {
        // leave person out: teach on 6 people x 3, test all flaws of person 7 ... rotate
        let mut runs=vec![];
        for p in 1..=7u64 { for r in 1..=3 { let (rec,_)=perform(&Performance{seed,person:p,repetition:r,noise:Noise::default()},Flaw::None); runs.push((p,Run::new(&format!("p{p}r{r}"),"",&rec,&m).unwrap())); }}
        for p in 1..=7u64 {
            let train:Vec<Run>=runs.iter().filter(|r|r.0!=p).map(|r|r.1.clone()).collect();
            let (job,_)=teach(&train,&TeachOptions{rule:ThresholdRule::LeaveOneOut{sigmas:sig},..TeachOptions::new("x","",m)}).unwrap();
            for f in Flaw::ALL { for rep in 1..=2 {
                let (rec,_)=perform(&Performance{seed,person:p,repetition:10+rep,noise:Noise::default()},f);
                let run=Run::new("t","",&rec,&m).unwrap();
                let v=job.with_job(|j|run.judge(j,&m)).unwrap();
                let bad=v.iter().any(|v|matches!(v.kind,Kind::IuAnomaly|Kind::ActivityAnomaly|Kind::JobAnomaly));
                let nj=v.iter().any(|v|v.kind==Kind::NotJudged);
                let ok=match f.expected(){Expected::Right=>!bad&&!nj,Expected::Anomaly=>bad,Expected::NotOk=>bad||nj};
                let t=tally.entry(f).or_default(); t.1+=1; t.0+=u32::from(ok);
                if !ok&&verbose { println!("{f:?} seed {seed} p{p} rep{rep}"); for v in &v { println!("   {:?} {:?} act {} iu {:?} near {:?} {:?} d {:?} th {:?} early {}",v.kind,v.reason,v.activity,v.iu,v.nearest,v.context.0,v.distance,v.threshold,v.early);} for a in &run.activities {println!("    {:?}",a.ius.iter().map(|i|(i.context.0,i.motion.len(),i.reversals)).collect::<Vec<_>>())} }
            }}
        }
    }
    print!("sigma {sig}: "); for (f,t) in tally { print!("{} {}/{}  ",f.word(),t.0,t.1);} println!();
    }
}
