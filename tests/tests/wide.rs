//! Reader's wide generator.
#![allow(clippy::unwrap_used, dead_code)]
#[path = "learn_vmci/capture.rs"]
mod capture;

use andon_core::config::{Contact, Method};
use andon_core::input::{Side, Space};
use andon_core::verdict::{Level, Outcome, Verdict};
use andon_learn::job_file::JobFile;
use andon_learn::recording::{Recording, read};
use andon_learn::run::Run;
use andon_learn::teach::{TeachOptions, teach};
use andon_tests::deletion::{self, jobs, length_s, one_after_the_other};
use andon_tests::environment;
use andon_tests::simulator::{
    Expected, Flaw, Noise, Performance, Random, TwoHanded, perform, perform_with_two_hands,
};
use std::collections::BTreeMap;

#[derive(Clone, Copy, Debug, PartialEq)]
enum What {
    Hands,
    Hand(Side),
    Object(usize),
    Objects,
    All,
    AllBut(Side),
    HandAndObject(Side, usize),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Del {
    Stretch(What, f64, f64),
    Flicker(What, f64, f64, usize, usize),
    Random(What, f64, f64, f64),
    Every(usize, usize),
    Whole(usize),
    Late(f64),
    // Not deletions: misreads.
    SwapHands(f64, usize),
    AsOther(Side, f64, usize),
    Jump(usize, f64, f64),
    SwapIds(usize, usize, f64, usize),
    Jitter(f64),
}

fn t0(r: &Recording) -> u64 {
    r.frames[0].captured_ns
}

fn hide(frame: &mut andon_core::input::Frame, what: What, ids: &[u16]) {
    match what {
        What::Hands => frame.hands.clear(),
        What::Hand(s) => frame.hands.retain(|h| h.side != s),
        What::Object(i) => frame.objects.retain(|o| o.id != ids[i]),
        What::Objects => frame.objects.clear(),
        What::All => {
            frame.hands.clear();
            frame.objects.clear();
        }
        What::AllBut(s) => {
            frame.hands.retain(|h| h.side == s);
            frame.objects.clear();
        }
        What::HandAndObject(s, i) => {
            frame.hands.retain(|h| h.side != s);
            frame.objects.retain(|o| o.id != ids[i]);
        }
    }
}

fn apply(del: Del, r: &Recording, seed: u64) -> Recording {
    let mut random = Random::new(seed, &[7]);
    let mut left = r.clone();
    let ids: Vec<u16> = r.header.objects.iter().map(|o| o.shape.id).collect();
    let began = t0(r);
    let end = length_s(r) - 1.0;
    let at = |ns: u64| (ns - began) as f64 * 1e-9;
    let n_at = |from: f64, count: usize| -> std::ops::Range<usize> {
        let i = r.frames.iter().position(|f| at(f.captured_ns) >= from).unwrap_or(r.frames.len());
        i..(i + count).min(r.frames.len())
    };
    match del {
        Del::Stretch(w, from, s) => {
            for f in left.frames.iter_mut().filter(|f| (from..end.min(from + s)).contains(&at(f.captured_ns)))
            {
                hide(f, w, &ids)
            }
        }
        Del::Flicker(w, from, s, on, off) => {
            let mut k = 0;
            for f in left.frames.iter_mut().filter(|f| (from..end.min(from + s)).contains(&at(f.captured_ns)))
            {
                if k % (on + off) >= on {
                    hide(f, w, &ids)
                }
                k += 1;
            }
        }
        Del::Random(w, from, s, p) => {
            for f in left.frames.iter_mut().filter(|f| (from..end.min(from + s)).contains(&at(f.captured_ns)))
            {
                if random.uniform() < p {
                    hide(f, w, &ids)
                }
            }
        }
        Del::Every(n, ph) => {
            let mut k = 0;
            let last = left.frames.len() - 1;
            left.frames.retain(|_| {
                k += 1;
                (k - 1) % n == ph % n || k - 1 == last
            });
        }
        Del::Whole(i) => {
            for f in left.frames.iter_mut() {
                hide(f, What::Object(i), &ids)
            }
        }
        Del::Late(s) => left.frames.retain(|f| at(f.captured_ns) >= s.min(end)),
        Del::SwapHands(from, n) => {
            for f in &mut left.frames[n_at(from, n)] {
                for h in f.hands.iter_mut() {
                    h.side = h.side.other()
                }
            }
        }
        Del::AsOther(s, from, n) => {
            for f in &mut left.frames[n_at(from, n)] {
                f.hands.retain(|h| h.side == s);
                for h in f.hands.iter_mut() {
                    h.side = s.other()
                }
            }
        }
        Del::Jump(i, from, m) => {
            for f in &mut left.frames[n_at(from, 1)] {
                for o in f.objects.iter_mut().filter(|o| o.id == ids[i]) {
                    o.position[0] += m as f32;
                }
            }
        }
        Del::SwapIds(i, j, from, n) => {
            for f in &mut left.frames[n_at(from, n)] {
                for o in f.objects.iter_mut() {
                    if o.id == ids[i] {
                        o.id = ids[j]
                    } else if o.id == ids[j] {
                        o.id = ids[i]
                    }
                }
            }
        }
        Del::Jitter(ms) => {
            let mut last = 0;
            for f in &mut left.frames {
                let j = random.between(-ms, ms) * 1e6;
                f.captured_ns = ((f.captured_ns as f64 + 1e9 + j) as u64).max(last + 1_000_000);
                last = f.captured_ns;
            }
        }
    }
    left
}

fn time(random: &mut Random, length: f64, events: &[f64]) -> (f64, f64) {
    let s = match random.index(4) {
        0 => random.between(0.03, 0.2),
        1 => random.between(0.1, 0.6),
        2 => random.between(0.3, 1.5),
        _ => random.between(1.0, 6.0),
    };
    let from = if !events.is_empty() && random.index(3) > 0 {
        events[random.index(events.len())] - s * random.uniform()
    } else {
        random.between(-s, length)
    };
    (from.max(0.0), s)
}

fn any(random: &mut Random, length: f64, objects: usize, events: &[f64], class: u64) -> Del {
    let side = Side::ALL[random.index(2)];
    let i = random.index(objects);
    let what = match random.index(8) {
        0 => What::Hands,
        1 | 2 => What::Hand(side),
        3 | 4 => What::Object(i),
        5 => What::Objects,
        6 => What::AllBut(side),
        _ => What::HandAndObject(side, i),
    };
    let (from, s) = time(random, length, events);
    match class {
        0 => match random.index(10) {
            // deletions
            0 => Del::Flicker(what, from, s * 3.0, 1 + random.index(4), 1 + random.index(6)),
            1 => Del::Flicker(what, 0.0, 1e9, 1 + random.index(5), 1 + random.index(5)),
            2 => Del::Random(what, from, s * 4.0, random.between(0.1, 0.95)),
            3 => Del::Random(what, 0.0, 1e9, random.between(0.05, 0.7)),
            4 => Del::Every(2, random.index(2)),
            5 => Del::Late(random.between(0.0, length)),
            _ => Del::Stretch(what, from, s),
        },
        _ => match random.index(5) {
            // misreads
            0 => Del::SwapHands(from, 1 + random.index(6)),
            1 => Del::AsOther(side, from, 1 + random.index(6)),
            2 => Del::Jump(i, from, random.between(-0.5, 0.5)),
            3 => Del::SwapIds(i, random.index(objects), from, 1 + random.index(5)),
            _ => Del::Jitter(random.between(1.0, 25.0)),
        },
    }
}

/// The couples of an encoder that is restarted with a gap, and of a judge that is new from a time on.
fn restarted(
    job: &JobFile,
    r: &Recording,
    encode: Option<(f64, f64)>,
    judge_at: Option<(f64, f64, bool)>,
) -> Vec<Verdict> {
    let b = t0(r);
    let at = |ns: u64| (ns.saturating_sub(b)) as f64 * 1e-9;
    let part = |frames: Vec<andon_core::input::Frame>, flush: bool| {
        let mut rec = r.clone();
        rec.frames = frames;
        let run = Run::new("run", "", &rec, &job.method).unwrap();
        let all = run.couples_for(job).unwrap().to_vec();
        let newest = rec.frames.last().map_or(0, |f| f.captured_ns);
        // A process that is killed does not send what it holds back.
        let hold = (f64::from(job.method.persist_frames) / f64::from(job.method.rate_hz) * 1e9) as u64;
        all.into_iter().filter(|c| flush || c.captured_ns + hold <= newest + 1_000_000).collect::<Vec<_>>()
    };
    let couples = match encode {
        Some((t, gap)) => {
            let before: Vec<_> = r.frames.iter().filter(|f| at(f.captured_ns) < t).cloned().collect();
            let after: Vec<_> = r.frames.iter().filter(|f| at(f.captured_ns) >= t + gap).cloned().collect();
            let mut c = if before.is_empty() { Vec::new() } else { part(before, false) };
            if !after.is_empty() {
                c.extend(part(after, true));
            }
            c
        }
        None => part(r.frames.to_vec(), true),
    };
    job.with_job(|lent| {
        use andon_core::anomaly::Judge;
        let new = || Judge::<Vec<_>>::with_memory(lent, job.method).unwrap();
        let mut judge = new();
        let mut verdicts = Vec::new();
        let mut off = false;
        for c in &couples {
            if let Some((t, gap, says)) = judge_at {
                let now = at(c.captured_ns);
                if now >= t && now < t + gap {
                    if !off {
                        off = true;
                        if says {
                            judge.break_off(&mut |e| verdicts.extend(e.verdict()));
                        }
                        judge = new();
                    }
                    continue;
                }
            }
            judge.step(c, &mut |e| verdicts.extend(e.verdict()));
        }
        judge.finish(&mut |e| verdicts.extend(e.verdict()));
        verdicts
    })
}

fn is_accused(v: &[Verdict]) -> bool {
    v.iter().any(|v| v.outcome == Outcome::Anomaly)
}
fn is_right(v: &[Verdict]) -> bool {
    let j = jobs(v);
    !j.is_empty() && j.iter().all(|o| *o == Outcome::Ok) && v.iter().all(|v| v.outcome == Outcome::Ok)
}

struct Source {
    name: String,
    job: JobFile,
    right: Vec<Recording>,
    wrong: Vec<Recording>,
}

fn run(r: &Recording, m: &Method) -> Run {
    Run::new("run", "", r, m).unwrap()
}

fn sources(seed: u64) -> Vec<Source> {
    let mut all = Vec::new();
    let only = std::env::var("ONLY").unwrap_or_default();
    let want = |n: &str| only.is_empty() || only.split(',').any(|o| n.contains(o));
    let m = Method::default();
    if want("shop") {
        let rec = |person, repetition, flaw| {
            perform(&Performance { seed, person, repetition, noise: Noise::default() }, flaw).0
        };
        let runs: Vec<Run> = (1..=5).map(|p| run(&rec(p, 1, Flaw::None), &m)).collect();
        let job = teach(&runs, &TeachOptions::new("shop", "", m)).unwrap().0;
        let right = (6..=13)
            .map(|p| rec(p, 1, Flaw::None))
            .filter(|r| is_right(&deletion::judged(&job, r)))
            .collect();
        let wrong = Flaw::ALL
            .into_iter()
            .filter(|f| f.expected() == Expected::Anomaly)
            .flat_map(|f| (6..=8).map(move |p| (p, f)))
            .map(|(p, f)| rec(p, 1, f))
            .filter(|r| is_accused(&deletion::judged(&job, r)))
            .collect();
        all.push(Source { name: "shop".into(), job, right, wrong });
    }
    for work in TwoHanded::ALL {
        if !want(&format!("two{work:?}")) {
            continue;
        }
        let rec = |person, faulty| {
            perform_with_two_hands(
                &Performance { seed, person, repetition: 1, noise: Noise::default() },
                work,
                faulty,
            )
        };
        let runs: Vec<Run> = (1..=5).map(|p| run(&rec(p, false), &m)).collect();
        let job =
            teach(&runs, &TeachOptions { measure_rate: false, ..TeachOptions::new("two", "", m) }).unwrap().0;
        let right = (6..14).map(|p| rec(p, false)).filter(|r| is_right(&deletion::judged(&job, r))).collect();
        let wrong =
            (6..14).map(|p| rec(p, true)).filter(|r| is_accused(&deletion::judged(&job, r))).collect();
        all.push(Source { name: format!("two{work:?}"), job, right, wrong });
    }
    if want("clips") {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let job =
            JobFile::parse("job", &std::fs::read(root.join("config/jobs/polish-and-measure.toml")).unwrap())
                .unwrap();
        let get = |c: &str| {
            read(c, &std::fs::read(format!("/tmp/reader_tracks/{c}.tracks.jsonl")).unwrap()).unwrap()
        };
        let right: Vec<Recording> =
            ["p1_none_r1", "p1_none_r2", "p1_none_r3", "p2_none_r1", "p2_none_r2", "p2_none_r3"]
                .iter()
                .map(|c| get(c))
                .filter(|r| {
                    jobs(&deletion::judged(&job, r)) == [Outcome::Ok]
                        && !is_accused(&deletion::judged(&job, r))
                })
                .collect();
        let wrong: Vec<Recording> =
            ["p1_J1_r1", "p1_J2_r1", "p1_order_r1", "p1_wrong_object_r1", "p2_J1_r1", "p2_J2_r1"]
                .iter()
                .map(|c| get(c))
                .filter(|r| is_accused(&deletion::judged(&job, r)))
                .collect();
        all.push(Source { name: "clips".into(), job, right, wrong });
    }
    if want("mocap") {
        let m = Method {
            space: Space::Metric,
            rate_hz: capture::RATE_HZ,
            hand_contact: Contact { on_m: 0.08, off_m: 0.11 },
            object_contact: Contact { on_m: 0.08, off_m: 0.11 },
            persist_frames: 10,
            ..m
        };
        let runs: Vec<Run> = (1..=9).map(|n| run(&capture::Capture::read(n).recording(), &m)).collect();
        let job = teach(&runs, &TeachOptions::new("mocap", "", m)).unwrap().0;
        let right = (1..=9)
            .map(|n| capture::Capture::read(n).recording())
            .filter(|r| !is_accused(&deletion::judged(&job, r)))
            .collect();
        let wrong = (1..=9)
            .flat_map(|n| {
                [
                    capture::Capture::read(n).without_second_half(),
                    capture::Capture::read(n).halves_swapped(),
                    capture::Capture::read(n).cut_short(),
                ]
            })
            .map(|c| c.recording())
            .filter(|r| is_accused(&deletion::judged(&job, r)))
            .collect();
        all.push(Source { name: "mocap".into(), job, right, wrong });
    }
    all
}

fn shown(left: &mut Recording, whole: &Recording) {
    if let Some(first) = left.frames.first_mut()
        && let Some(f) = whole.frames.iter().find(|f| f.captured_ns == first.captured_ns)
    {
        first.objects.clone_from(&f.objects);
    }
}

fn all_of(dels: &[Del], whole: &Recording, seed: u64, show: bool) -> Recording {
    let mut left = whole.clone();
    for (k, d) in dels.iter().enumerate() {
        left = apply(*d, &left, seed + k as u64);
    }
    if show {
        shown(&mut left, whole);
    }
    left
}

fn shrink(dels: Vec<Del>, fails: &dyn Fn(&[Del]) -> bool) -> Vec<Del> {
    let mut best = dels;
    'again: for _ in 0..40 {
        for k in 0..best.len() {
            let mut fewer = best.clone();
            fewer.remove(k);
            if fails(&fewer) {
                best = fewer;
                continue 'again;
            }
            let lesser: Vec<Del> = match best[k] {
                Del::Stretch(w, f, s) if s > 0.05 => vec![
                    Del::Stretch(w, f, s / 2.0),
                    Del::Stretch(w, f + s / 2.0, s / 2.0),
                    Del::Stretch(w, f, s * 0.9),
                    Del::Stretch(w, f + s * 0.1, s * 0.9),
                ],
                Del::Flicker(w, f, s, a, b) if s > 0.05 => {
                    let s = s.min(120.0);
                    vec![
                        Del::Flicker(w, f, s / 2.0, a, b),
                        Del::Flicker(w, f + s / 2.0, s / 2.0, a, b),
                        Del::Stretch(w, f, s),
                    ]
                }
                Del::Random(w, f, s, p) if s > 0.05 => {
                    let s = s.min(120.0);
                    vec![
                        Del::Stretch(w, f, s),
                        Del::Random(w, f, s / 2.0, p),
                        Del::Random(w, f + s / 2.0, s / 2.0, p),
                    ]
                }
                _ => vec![],
            };
            for l in lesser {
                let mut next = best.clone();
                next[k] = l;
                if fails(&next) {
                    best = next;
                    continue 'again;
                }
            }
        }
        break;
    }
    best
}

fn line(v: &[Verdict], from: u64) -> String {
    v.iter()
        .filter(|v| v.outcome == Outcome::Anomaly || v.level == Level::Job)
        .map(|v| {
            format!(
                "{:?} {:?} {:?} {:?} act {} near {:?} {:.2}..{:.2}",
                v.level,
                v.outcome,
                v.reason,
                v.side,
                v.activity,
                v.nearest,
                (v.began_ns.saturating_sub(from)) as f64 * 1e-9,
                (v.ended_ns.saturating_sub(from)) as f64 * 1e-9
            )
        })
        .collect::<Vec<_>>()
        .join(" | ")
}

fn label(v: &[Verdict]) -> &'static str {
    if is_accused(v) {
        "accused"
    } else if jobs(v).is_empty() {
        "nothing"
    } else if jobs(v).iter().all(|o| *o == Outcome::Ok) {
        "right"
    } else {
        "notjudged"
    }
}

#[test]
fn wide() {
    let (seed, cases) = (environment::number("ANDON_SEED", 71), environment::number("ANDON_CASES", 100));
    let classes = std::env::var("CLASSES").unwrap_or("single,never,span,three,fault,misread".into());
    let started = std::time::Instant::now();
    for src in sources(seed) {
        let Source { name, job, right, wrong } = &src;
        if name == "shop" && std::env::var("CASE").is_ok() { println!("{}", job.to_toml().lines().filter(|l| l.len() < 300).collect::<Vec<_>>().join("\n")); for w in wrong { let run = Run::new("w", "", w, &job.method).unwrap(); for (h, a) in run.activities.iter().enumerate() { for iu in &a.ius { println!("wrong {h} {:?} {} frames {:?}", iu.context.0, iu.motion.len(), iu.measures); } } } }
        println!(
            "== {name}: {} right, {} wrong, {:.0} s",
            right.len(),
            wrong.len(),
            started.elapsed().as_secs_f64()
        );
        if right.is_empty() {
            continue;
        }
        let events_of = |r: &Recording| -> Vec<f64> {
            let b = t0(r);
            let mut e: Vec<f64> = deletion::judged(job, r)
                .iter()
                .filter(|v| v.level == Level::Iu)
                .flat_map(|v| [v.began_ns, v.ended_ns])
                .map(|n| n.saturating_sub(b) as f64 * 1e-9)
                .collect();
            e.sort_by(f64::total_cmp);
            e
        };
        let right_events: Vec<Vec<f64>> = right.iter().map(&events_of).collect();
        let wrong_events: Vec<Vec<f64>> = wrong.iter().map(&events_of).collect();
        for class in classes.split(',') {
            let mut table: BTreeMap<&str, u64> = BTreeMap::new();
            let mut shown_cases = 0;
            let mut seen_shapes: Vec<String> = Vec::new();
            for case in 0..cases {
                if let Ok(one) = std::env::var("CASE") {
                    if one != case.to_string() {
                        continue;
                    }
                }
                let mut random =
                    Random::new(seed, &[1234, case, class.len() as u64, class.as_bytes()[0].into()]);
                let k = random.index(right.len());
                let count = 1 + random.index(3);
                let (whole, events, good_tail): (Recording, Vec<f64>, usize) = match class {
                    "fault" | "flick" => {
                        if wrong.is_empty() {
                            continue;
                        }
                        let w = random.index(wrong.len());
                        (wrong[w].clone(), wrong_events[w].clone(), 0)
                    }
                    "span" => {
                        let j = random.index(right.len());
                        let pause = random.between(0.2, 3.0);
                        let both = one_after_the_other(&[&right[k], &right[j]], pause);
                        let l = length_s(&right[k]);
                        let border = vec![
                            l,
                            l,
                            l + pause,
                            right_events[k].last().copied().unwrap_or(l),
                            l + pause + right_events[j].first().copied().unwrap_or(0.0),
                        ];
                        (both, border, 0)
                    }
                    "aftfault" => {
                        if wrong.is_empty() {
                            continue;
                        }
                        let w = random.index(wrong.len());
                        let (i, j) = (random.index(right.len()), random.index(right.len()));
                        let pause = random.between(0.2, 3.0);
                        (
                            one_after_the_other(&[&wrong[w], &right[i], &right[j]], pause),
                            wrong_events[w].clone(),
                            2,
                        )
                    }
                    "long" => {
                        let mut pieces = vec![&right[k]];
                        for _ in 0..6 {
                            pieces.push(&right[random.index(right.len())]);
                        }
                        let pause = random.between(0.2, 3.0);
                        (one_after_the_other(&pieces, pause), right_events[k].clone(), 6)
                    }
                    "second" => {
                        let i = random.index(right.len());
                        let pause = random.between(0.2, 3.0);
                        let shift = length_s(&right[i]) + pause;
                        (
                            one_after_the_other(&[&right[i], &right[k]], pause),
                            right_events[k].iter().map(|e| e + shift).collect(),
                            0,
                        )
                    }
                    "three" => {
                        let (i, j) = (random.index(right.len()), random.index(right.len()));
                        let pause = random.between(0.2, 3.0);
                        (
                            one_after_the_other(&[&right[k], &right[i], &right[j]], pause),
                            right_events[k].clone(),
                            2,
                        )
                    }
                    _ => (right[k].clone(), right_events[k].clone(), 0),
                };
                let length =
                    if class == "three" || class == "long" { length_s(&right[k]) } else { length_s(&whole) };
                let objects = whole.header.objects.len();
                let mut dels: Vec<Del> = (0..count)
                    .map(|_| any(&mut random, length, objects, &events, u64::from(class == "misread")))
                    .collect();
                if class == "start" {
                    let i = random.index(objects);
                    let sd = Side::ALL[random.index(2)];
                    let w =
                        [What::HandAndObject(sd, i), What::HandAndObject(sd, i), What::AllBut(sd), What::All]
                            [random.index(4)];
                    dels = vec![Del::Stretch(w, 0.0, random.between(0.3, length))];
                    if random.index(3) == 0 {
                        dels.push(Del::Stretch(What::Hand(sd.other()), 0.0, random.between(0.3, length)));
                    }
                }
                if class == "three" || class == "long" {
                    dels.retain(|d| matches!(d, Del::Stretch(..)));
                    if dels.is_empty() {
                        continue;
                    }
                    for d in &mut dels {
                        if let Del::Stretch(_, f, s) = d {
                            *s = s.min((length + 0.3 - *f).max(0.03));
                        }
                    }
                }
                if class == "second" {
                    dels.retain(|d| matches!(d, Del::Stretch(..)));
                    for d in &mut dels {
                        if let Del::Stretch(_, f, _) = d {
                            if *f < length * 0.4 {
                                *f += length * 0.5;
                            }
                        }
                    }
                    if dels.is_empty() {
                        continue;
                    }
                }
                if class == "flick" {
                    dels = vec![if random.index(2) == 0 {
                        Del::Flicker(
                            [What::Object(random.index(objects)), What::Hands, What::Objects, What::All]
                                [random.index(4)],
                            0.0,
                            1e9,
                            1 + random.index(4),
                            1 + random.index(4),
                        )
                    } else {
                        Del::Random(
                            [What::Object(random.index(objects)), What::Hands, What::Objects, What::All]
                                [random.index(4)],
                            0.0,
                            1e9,
                            random.between(0.2, 0.7),
                        )
                    }];
                }
                if class == "span" {
                    dels.retain(|d| !matches!(d, Del::Late(..)));
                    if dels.is_empty() {
                        continue;
                    }
                }
                if class == "never" {
                    dels.insert(0, Del::Whole(random.index(objects)));
                }
                let show = class != "never";
                let v0 = deletion::judged(job, &whole);
                if class != "fault" && class != "flick" && class != "aftfault" && is_accused(&v0) {
                    *table.entry("whole accused").or_default() += 1;
                    continue;
                }
                let restart_s = if random.index(2) == 0 || events.is_empty() {
                    random.between(0.2, length)
                } else {
                    events[random.index(events.len())] + random.between(-1.0, 1.0)
                };
                let gap_s = [0.05, 0.2, 0.5, 1.5, 4.0][random.index(5)] * random.between(0.5, 1.5);
                if class.starts_with("encode") || class.starts_with("judge") {
                    dels.retain(|d| matches!(d, Del::Stretch(..) | Del::Flicker(..) | Del::Random(..)));
                    if class.ends_with('0') || random.index(2) == 0 {
                        dels.clear();
                    }
                    for d in &mut dels {
                        if random.index(2) == 0 {
                            if let Del::Stretch(_, f, s) = d {
                                *f = (restart_s - *s * random.uniform()).max(0.0);
                            }
                        }
                    }
                }
                let judge = |d: &[Del]| {
                    let left = all_of(d, &whole, seed ^ case, show);
                    match class.split(['0', '+']).next() {
                        Some("encode") => restarted(job, &left, Some((restart_s, gap_s)), None),
                        Some("judge") => restarted(job, &left, None, Some((restart_s, gap_s, case % 2 == 0))),
                        _ => deletion::judged(job, &left),
                    }
                };
                let bad: Box<dyn Fn(&[Verdict]) -> bool> = match class {
                    "aftfault" => Box::new(|v| {
                        let border =
                            t0(&whole) + ((events.last().copied().unwrap_or(0.0) + 0.3) * 1e9) as u64;
                        v.iter().any(|v| v.outcome == Outcome::Anomaly && v.began_ns > border)
                            || jobs(v).last() != Some(&Outcome::Ok)
                    }),
                    "fault" | "flick" => Box::new(|v| {
                        !jobs(v).is_empty() && jobs(v).iter().all(|o| *o == Outcome::Ok) && !is_accused(v)
                    }),
                    "three" | "long" => Box::new(|v| is_accused(v) || jobs(v).last() != Some(&Outcome::Ok)),
                    _ => Box::new(|v| is_accused(v)),
                };
                let _ = good_tail;
                if class == "aftfault" {
                    dels.retain(|d| matches!(d, Del::Stretch(_, _, s) if *s < 3.9));
                    if let Some(Del::Stretch(_, f, s)) = dels.first_mut() {
                        let end = events.last().copied().unwrap_or(0.0) + 0.2;
                        if *f + *s > end {
                            *s = (end - *f).max(0.03);
                        }
                    }
                    dels.truncate(1);
                    if dels.is_empty() {
                        continue;
                    }
                }
                let v = judge(&dels);
                let mut what = label(&v);
                if class == "long" && what != "accused" {
                    let j = jobs(&v);
                    let back = j.iter().rev().take_while(|o| **o == Outcome::Ok).count();
                    let name: &'static str = [
                        "back 0 ok",
                        "back 1 ok",
                        "back 2 ok",
                        "back 3 ok",
                        "back 4 ok",
                        "back 5 ok",
                        "back 6 ok",
                        "back 7 ok",
                    ][back.min(7)];
                    what = name;
                }
                if class == "aftfault" {
                    let border = t0(&whole) + ((events.last().copied().unwrap_or(0.0) + 0.3) * 1e9) as u64;
                    let late = v.iter().any(|v| v.outcome == Outcome::Anomaly && v.began_ns > border);
                    let late0 = v0.iter().any(|v| v.outcome == Outcome::Anomaly && v.began_ns > border);
                    what = if late && !late0 {
                        "next accused"
                    } else if late0 {
                        "next accused whole"
                    } else if jobs(&v).last() == Some(&Outcome::Ok) {
                        "found back"
                    } else {
                        "lost"
                    };
                }
                if class == "three" && what != "accused" {
                    what = if jobs(&v).last() == Some(&Outcome::Ok) { "found back" } else { "lost" }
                }
                *table.entry(what).or_default() += 1;
                if bad(&v)
                    && (!matches!(what, "lost" | "back 0 ok") || jobs(&v0).last() == Some(&Outcome::Ok))
                    && shown_cases < 6
                {
                    let small = shrink(dels.clone(), &|d| bad(&judge(d)));
                    let vs = judge(&small);
                    println!(
                        "  {name}/{class} case {case} rec {k} restart {restart_s:.2} gap {gap_s:.2} {what} {small:?}\n     -> {}\n     whole: {}\n     events {:.2?}",
                        line(&vs, t0(&whole)),
                        line(&v0, t0(&whole)),
                        events
                    );
                    if std::env::var("CASE").is_ok() {
                        for (n, v) in [("whole", &v0), ("left", &vs)] {
                            println!("  -- {n}");
                            for v in v.iter() {
                                println!(
                                    "     {:?} {:?} {:?} {:?} act {} near {:?} ctx {:?} {:.2}..{:.2} {:?} {:?}",
                                    v.level,
                                    v.outcome,
                                    v.reason,
                                    v.side,
                                    v.activity,
                                    v.nearest,
                                    v.context.0,
                                    (v.began_ns - t0(&whole)) as f64 * 1e-9,
                                    (v.ended_ns.saturating_sub(t0(&whole))) as f64 * 1e-9,
                                    v.measured,
                                    v.broken
                                );
                            }
                        }
                    }
                    seen_shapes.push(format!("{small:?}"));
                    shown_cases += 1;
                }
            }
            println!("{name:28} {class:8} seed {seed} {table:?}");
        }
    }
    println!("{:.0} s", started.elapsed().as_secs_f64());
}

#[test]
fn live_windows() {
    let rec = |person, repetition| {
        perform(&Performance { seed: 4, person, repetition, noise: Noise::default() }, Flaw::None).0
    };
    let m = Method::default();
    let runs: Vec<Run> = [(1, 1), (2, 1), (3, 1), (4, 1), (9, 2), (9, 3)]
        .into_iter()
        .map(|(p, r)| run(&rec(p, r), &m))
        .collect();
    let job = teach(&runs, &TeachOptions::new("shop", "", m)).unwrap().0;
    for person in 1..14 {
        let r = rec(person, 1);
        let v = deletion::judged(&job, &r);
        let mut w = Vec::new();
        for t in (10..120).step_by(2) {
            for gap in [0.5, 1.0, 1.5, 2.0, 2.5, 3.0] {
                let t = f64::from(t) / 10.0;
                if is_accused(&restarted(&job, &r, Some((t, gap)), None)) {
                    w.push((t, gap));
                }
            }
        }
        println!(
            "person {person} whole {:?} length {:.1} first IU ends {:.2}: {} {:?}",
            jobs(&v),
            length_s(&r),
            v.iter().find(|v| v.level == Level::Iu).map_or(0.0, |v| v.ended_ns as f64 * 1e-9),
            w.len(),
            w
        );
    }
}
