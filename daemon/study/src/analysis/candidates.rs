//! The selection of candidates (paper III-D): how the nominal activities of a job drop out while one activity is carried out.

use crate::folder::{CORRECT, Labelled};
use andon_core::config::Method;
use andon_core::dtw::{LocalCosts, OnlineDtw};
use andon_core::job::LocalCost;
use andon_learn::job_file::{TaughtActivity, TaughtIu, context_words};
use andon_learn::recording::object_name;
use andon_learn::run::{Activity, Iu, Run};
use andon_learn::teach::{TeachError, TeachOptions, teach};
use std::collections::BTreeSet;

/// Why a candidate is one no more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dropped {
    /// It has another context at this place, or has ended.
    Context,
    /// The motion is further from its reference than its threshold.
    Motion,
}

impl Dropped {
    /// The word for it.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Context => "context",
            Self::Motion => "motion",
        }
    }
}

/// One nominal activity and how far the execution is from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// What people call it.
    pub name: String,
    /// The times of the frames in seconds from the beginning of the activity. With each is the DTW distance to the reference of the IU, as a share of
    /// its threshold. While the IU is open the least that it can become, at its end the distance itself. One list per IU.
    pub distances: Vec<Vec<[f64; 2]>>,
    /// When it dropped out, in seconds from the beginning, and why; `None` if it remains to the end.
    pub dropped: Option<(f64, Dropped)>,
}

/// One activity, carried out by somebody who did not teach, and what became of each candidate.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// The name of the run.
    pub run: String,
    /// When each IU began, in seconds from the beginning of the activity, and its context in words; last the end of the activity.
    pub ius: Vec<(f64, String)>,
    /// The nominal activities of all names in the folder.
    pub candidates: Vec<Candidate>,
}

/// The selection of candidates for the activity of a folder that has the most rivals: nominal activities that begin with the same context. It is
/// carried out by the first person of the folder, where hands and objects meet as the runs are encoded. The nominal activities are taught by all
/// others. `None` where nothing is taught.
pub fn selection(all: &[Labelled], method: &Method, cost: LocalCost) -> Option<Selection> {
    let shown = all.first()?.person;
    let nominal = nominal(all, shown, method, cost);
    let rivals = |activity: &Activity| {
        let begins_alike = |taught: &&(String, TaughtActivity)| {
            taught.1.ius.first().map(|iu| iu.context) == activity.ius.first().map(|iu| iu.context)
        };
        nominal.iter().filter(begins_alike).count()
    };
    let is_correct = |one: &&Labelled| one.what == CORRECT || all.iter().all(|other| other.what != CORRECT);
    let executions = all.iter().filter(|one| one.person == shown).filter(is_correct);
    let activities = executions.flat_map(|one| one.run.activities.iter().map(move |had| (&one.run, had)));
    let is_longer = |(run, activity): &(&Run, &Activity)| {
        (rivals(activity), activity.ius.len(), std::cmp::Reverse(run.name.clone()))
    };
    let (run, activity) = activities.max_by_key(is_longer)?;
    let costs = LocalCosts::new(cost);
    let candidates = nominal.iter().map(|(name, taught)| follow(name, taught, activity, &costs));
    let words = |iu: &Iu| context_words(iu.context, |id| object_name(&run.objects, id));
    let began_ns = activity.ius.first()?.began_ns;
    let ius = activity.ius.iter().map(|iu| (seconds(iu.began_ns, began_ns), words(iu)));
    let end = (seconds(activity.ius.last()?.ended_ns, began_ns), String::new());
    Some(Selection {
        run: run.name.clone(),
        ius: ius.chain([end]).collect(),
        candidates: candidates.collect(),
    })
}

/// The nominal activities of each name, taught by all people but one.
fn nominal(
    all: &[Labelled],
    left_out: u32,
    method: &Method,
    cost: LocalCost,
) -> Vec<(String, TaughtActivity)> {
    let mut names: BTreeSet<&str> = all.iter().map(|one| one.what.as_str()).collect();
    // Where some executions are called correct, no other name is a job.
    if names.contains(CORRECT) {
        names.retain(|name| *name == CORRECT);
    }
    let options = TeachOptions {
        cost,
        // The figure shows the selection as the paper has it.
        has_free_ends: false,
        measure_rate: false,
        examine_runs: false,
        find_contact_regions: false,
        ..TeachOptions::new("", "", *method)
    };
    let taught = |what: &str| -> Result<Vec<TaughtActivity>, TeachError> {
        let others = all.iter().filter(|one| one.what == what && one.person != left_out);
        let runs: Vec<Run> = others.map(|one| one.run.clone()).collect();
        Ok(teach(&runs, &options)?.0.activities)
    };
    let named = |what: &str| {
        // A name of which nothing can be taught has no candidate.
        let activities = taught(what).unwrap_or_default();
        let is_one = activities.len() == 1;
        let name = |activity: u16| {
            if is_one { what.to_owned() } else { format!("{what}, activity {}", activity + 1) }
        };
        activities.into_iter().map(move |activity| (name(activity.activity), activity)).collect::<Vec<_>>()
    };
    names.into_iter().flat_map(named).collect()
}

fn follow(name: &str, taught: &TaughtActivity, activity: &Activity, costs: &LocalCosts) -> Candidate {
    let began_ns = activity.ius.first().map_or(0, |iu| iu.began_ns);
    let mut candidate = Candidate { name: name.to_owned(), distances: Vec::new(), dropped: None };
    for (index, iu) in activity.ius.iter().enumerate() {
        let Some(nominal) = taught.ius.get(index).filter(|nominal| nominal.context == iu.context) else {
            candidate.dropped = Some((seconds(iu.began_ns, began_ns), Dropped::Context));
            break;
        };
        // A release state is judged by its context alone.
        if !iu.context.is_touch() {
            continue;
        }
        let distances = distances(nominal, iu, began_ns, costs);
        let beyond = distances.iter().find(|[_, share]| *share > 1.0).map(|[time, _]| *time);
        candidate.distances.push(distances);
        if let Some(time) = beyond {
            candidate.dropped = Some((time, Dropped::Motion));
            break;
        }
    }
    candidate
}

fn distances(nominal: &TaughtIu, iu: &Iu, began_ns: u64, costs: &LocalCosts) -> Vec<[f64; 2]> {
    let Ok(mut dtw) = OnlineDtw::new(costs, &nominal.reference) else { return Vec::new() };
    let [from, to] = [iu.began_ns, iu.ended_ns].map(|time_ns| seconds(time_ns, began_ns));
    let frames = iu.motion.len().max(1) as f64;
    let share = |distance: f64| distance / f64::from(nominal.threshold).max(f64::MIN_POSITIVE);
    let mut points = Vec::with_capacity(iu.motion.len() + 1);
    for (index, motion) in iu.motion.iter().enumerate() {
        if dtw.append(motion).is_err() {
            break;
        }
        points.push([from + (to - from) * (index + 1) as f64 / frames, share(dtw.lower_bound())]);
    }
    points.extend(dtw.distance().map(|distance| [to, share(distance)]));
    points
}

fn seconds(time_ns: u64, from_ns: u64) -> f64 {
    time_ns.saturating_sub(from_ns) as f64 * 1e-9
}
