//! The paper's first experiment (IV-A): segmentation, and which interactions are alike, for all people and layouts.

use crate::analysis::{Analysis, AnalysisError, Kind, Matrix};
use crate::folder::Labelled;
use crate::run::Run;
use crate::warp::Warp;
use andon_core::config::Method;
use andon_core::couple::{Context, Motion};
use andon_core::dtw::Refused;
use andon_core::job::LocalCost;
use std::fmt;

/// An IU as the paper lists it: whether a hand is there, the object `o_j`, the object `o_l`; by the names of the objects.
type Nominal = (bool, &'static str, Option<&'static str>);

/// The activities of the experiment and the IUs that the paper says they have.
const ACTIVITIES: [(&str, [Nominal; 3]); 6] = [
    ("boxing", placing("box")),
    ("measuring", placing("meter")),
    ("assembly", placing("corner")),
    (
        "disassembly",
        // Two: the third place repeats the second and is not looked at.
        [(true, "profile", Some("corner")), (true, "profile", None), (true, "profile", None)],
    ),
    ("polishing", working("polisher")),
    ("drilling", working("drill")),
];

/// IUs of a disassembly.
const OF_DISASSEMBLY: usize = 2;

/// The beginning of the names of drilling runs; the layout follows.
const DRILLING: &str = "drilling";

const fn placing(at: &'static str) -> [Nominal; 3] {
    [(true, "profile", None), (true, "profile", Some(at)), (false, "profile", Some(at))]
}

const fn working(tool: &'static str) -> [Nominal; 3] {
    [(true, tool, None), (true, tool, Some("brick")), (true, tool, None)]
}

/// How the executions of one activity were segmented.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Segmentation {
    /// The activity.
    pub what: String,
    /// Executions that came out as the IUs that the paper lists.
    pub right: usize,
    /// All executions.
    pub all: usize,
    /// The names of those that did not.
    pub wrong: Vec<String>,
}

/// The drilling IUs of all people in all layouts.
#[derive(Clone, Debug, PartialEq)]
pub struct Drilling {
    /// Distances between all of them, by layout and person.
    pub matrix: Matrix,
    /// Mean distance between two in the same layout.
    pub same_layout: f64,
    /// Mean distance between two in different layouts.
    pub other_layout: f64,
    /// Mean distance to the IUs of the other kinds.
    pub other_kinds: f64,
}

/// What the first experiment gave.
#[derive(Clone, Debug)]
pub struct One {
    /// For each activity.
    pub segmentation: Vec<Segmentation>,
    /// Distances and clusters of the six representative IUs.
    pub analysis: Analysis,
    /// The robustness to layouts, where there are drilling runs.
    pub drilling: Option<Drilling>,
}

/// Runs the experiment. `seed` is that of k-means++; `progress` is called with the share that is done.
///
/// # Errors
/// If a representative IU is nowhere to be found, or is too long to be compared.
pub fn run(
    all: &[Labelled],
    method: &Method,
    cost: LocalCost,
    seed: u64,
    progress: &mut dyn FnMut(f64),
) -> Result<One, AnalysisError> {
    let analysis = Analysis::new(all, Kind::of_paper(), method, cost, seed, progress)?;
    let segmentation = ACTIVITIES
        .iter()
        .map(|(what, nominal)| {
            let count = if *what == "disassembly" { OF_DISASSEMBLY } else { nominal.len() };
            segmentation(all, what, &nominal[..count])
        })
        .filter(|found| found.all > 0)
        .collect();
    let drilling = drilling(all, &analysis, cost)?;
    Ok(One { segmentation, analysis, drilling })
}

fn segmentation(all: &[Labelled], what: &str, nominal: &[Nominal]) -> Segmentation {
    let is = |one: &&Labelled| one.what == what || (what == DRILLING && one.what.starts_with(DRILLING));
    let mut found = Segmentation { what: what.to_owned(), right: 0, all: 0, wrong: Vec::new() };
    for one in all.iter().filter(is) {
        found.all += 1;
        if is_segmented(&one.run, nominal) {
            found.right += 1;
        } else {
            found.wrong.push(one.run.name.clone());
        }
    }
    found
}

fn is_segmented(run: &Run, nominal: &[Nominal]) -> bool {
    let [activity] = run.activities.as_slice() else { return false };
    let id = |name: &str| run.objects.iter().find(|object| object.name == name).map(|object| object.shape.id);
    let context = |&(hand, j, l): &Nominal| -> Option<Context> {
        let (hand, j) = (if hand { activity.side as u16 } else { 0 }, id(j)?);
        Some(Context(match l {
            None => [hand, j, 0, 0],
            Some(l) if hand == 0 => [0, 0, j, id(l)?],
            Some(l) => [hand, j, j, id(l)?],
        }))
    };
    nominal.iter().map(context).collect::<Option<Vec<_>>>() == Some(activity.contexts())
}

/// The second IU of every drilling run: the drill at the brick.
fn drilling(all: &[Labelled], analysis: &Analysis, cost: LocalCost) -> Result<Option<Drilling>, Refused> {
    let mut runs: Vec<(&str, u32, &[Motion])> = all
        .iter()
        .filter(|one| one.what.starts_with(DRILLING))
        .filter_map(|one| {
            let iu = one.run.activities.first()?.ius.get(1)?;
            Some((one.what.as_str(), one.person, iu.motion.as_slice()))
        })
        .collect();
    if runs.len() < 2 {
        return Ok(None);
    }
    runs.sort_by_key(|(what, person, _)| (*what, *person));
    let mut warp = Warp::new(cost);
    let motions: Vec<&[Motion]> = runs.iter().map(|(_, _, motion)| *motion).collect();
    let distances = warp.matrix(&motions)?;
    let mut layouts: Vec<&str> = runs.iter().map(|(what, ..)| *what).collect();
    layouts.dedup();
    let layout = |place: usize| layouts.iter().position(|what| *what == runs[place].0).unwrap_or_default();
    let (mut same, mut other) = (Mean::default(), Mean::default());
    for i in 0..runs.len() {
        for j in 0..i {
            let mean = if layout(i) == layout(j) { &mut same } else { &mut other };
            mean.add(distances.get(i, j));
        }
    }
    let mut kinds = Mean::default();
    for motion in &motions {
        for sample in &analysis.samples {
            kinds.add(warp.distance(motion, &sample.motion)?);
        }
    }
    let rows = runs.iter().enumerate().map(|(place, (what, person, _))| {
        let name = what.trim_start_matches(DRILLING).trim_start_matches('_');
        (layout(place), format!("{name} s{person}"))
    });
    let matrix = Matrix::new(rows.collect(), |i, j| distances.get(i, j));
    Ok(Some(Drilling {
        matrix,
        same_layout: same.value(),
        other_layout: other.value(),
        other_kinds: kinds.value(),
    }))
}

#[derive(Default)]
struct Mean {
    sum: f64,
    count: usize,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.count += 1;
    }

    fn value(&self) -> f64 {
        if self.count == 0 { 0.0 } else { self.sum / self.count as f64 }
    }
}

impl fmt::Display for One {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "segmentation: executions whose IUs are those that the paper lists")?;
        let (mut right, mut all) = (0, 0);
        for found in &self.segmentation {
            write!(f, "  {:12} {:3} of {:3}", found.what, found.right, found.all)?;
            for name in &found.wrong {
                write!(f, "  not {name}")?;
            }
            writeln!(f)?;
            (right, all) = (right + found.right, all + found.all);
        }
        writeln!(
            f,
            "  {:12} {right:3} of {all:3}, {:.2} %",
            "all",
            100.0 * right as f64 / all.max(1) as f64
        )?;
        let Analysis { kinds, motion, .. } = &self.analysis;
        writeln!(f, "clusters: k = {} by the elbow of the WCSS (the paper has 4)", motion.k)?;
        let [motions, contexts] = [self.analysis.motion_table(), self.analysis.context_table()];
        for (place, kind) in kinds.iter().enumerate() {
            let row = |table: &crate::cluster::Table| {
                table.counts.get(place).map_or(String::new(), |row| format!("{row:?}"))
            };
            writeln!(
                f,
                "  u{} {:32} motion {:24} context {}",
                place + 1,
                kind.label,
                row(&motions),
                row(&contexts)
            )?;
        }
        let contexts = self.analysis.context.iter().max().map_or(0, |most| most + 1);
        write!(f, "contexts: {contexts} clusters (the paper has 5)")?;
        if let Some(drilling) = &self.drilling {
            write!(
                f,
                "\ndrilling: mean distance {:.2} in the same layout, {:.2} between layouts, {:.2} to the other kinds of IU",
                drilling.same_layout, drilling.other_layout, drilling.other_kinds
            )?;
        }
        Ok(())
    }
}
