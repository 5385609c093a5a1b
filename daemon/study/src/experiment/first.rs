//! The paper's first experiment (IV-A): segmentation, and which interactions are alike across people and layouts.

use crate::analysis::{Analysis, AnalysisError, DRILLING, Drilling, Kind};
use crate::cluster::Table;
use crate::folder::Labelled;
use andon_core::config::Method;
use andon_core::couple::Context;
use andon_core::job::LocalCost;
use andon_learn::run::Run;
use std::fmt;

/// An IU as the paper lists it: whether a hand is involved, the object `o_j`, and the name of the object `o_l`.
type Nominal = (bool, &'static str, Option<&'static str>);

/// The activities of the experiment, and the IUs that they have according to the paper.
const ACTIVITIES: [(&str, [Nominal; 3]); 6] = [
    ("boxing", placing("box")),
    ("measuring", placing("meter")),
    ("assembly", placing("corner")),
    (
        "disassembly",
        // There are two IUs; the third entry only fills the array.
        [(true, "profile", Some("corner")), (true, "profile", None), (true, "profile", None)],
    ),
    ("polishing", working("polisher")),
    ("drilling", working("drill")),
];

/// Number of IUs of a disassembly.
const DISASSEMBLY_IUS: usize = 2;

const fn placing(at: &'static str) -> [Nominal; 3] {
    [(true, "profile", None), (true, "profile", Some(at)), (false, "profile", Some(at))]
}

const fn working(tool: &'static str) -> [Nominal; 3] {
    [(true, tool, None), (true, tool, Some("brick")), (true, tool, None)]
}

/// How the executions of one activity were segmented.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Segmentation {
    /// The name of the activity.
    pub what: String,
    /// Number of executions that were segmented into the IUs that the paper lists.
    pub right: usize,
    /// Number of all executions.
    pub all: usize,
    /// The names of the runs that were segmented differently.
    pub wrong: Vec<String>,
}

/// The result of the first experiment. `Display` prints it for people.
#[derive(Clone, Debug)]
pub struct FirstExperiment {
    /// For each activity.
    pub segmentation: Vec<Segmentation>,
    /// Distances and clusters of the six representative IUs.
    pub analysis: Analysis,
    /// The robustness to layouts, if there are drilling runs.
    pub drilling: Option<Drilling>,
}

/// Runs the experiment. `seed` is that of k-means++; `progress` is called with the share that is done, 0 to 1.
///
/// # Errors
/// If there is no representative IU, or one is too long to be compared.
pub fn run(
    all: &[Labelled],
    method: &Method,
    cost: LocalCost,
    seed: u64,
    progress: &mut dyn FnMut(f64),
) -> Result<FirstExperiment, AnalysisError> {
    let analysis = Analysis::new(all, Kind::of_paper(), method, cost, seed, progress)?;
    let segmentation = ACTIVITIES
        .iter()
        .map(|(what, nominal)| {
            let count = if *what == "disassembly" { DISASSEMBLY_IUS } else { nominal.len() };
            segmentation(all, what, &nominal[..count])
        })
        .filter(|found| found.all > 0)
        .collect();
    let drilling = Drilling::new(all, &analysis)?;
    Ok(FirstExperiment { segmentation, analysis, drilling })
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

/// Whether a run is a single activity with the nominal contexts.
fn is_segmented(run: &Run, nominal: &[Nominal]) -> bool {
    let [activity] = run.activities.as_slice() else { return false };
    let id = |name: &str| run.objects.iter().find(|object| object.name == name).map(|object| object.shape.id);
    let side = activity.side as u16;
    let context = |&(is_touch, j, l): &Nominal| -> Option<Context> {
        let j = id(j)?;
        Some(Context(match (is_touch, l) {
            (_, None) => [side, j, 0, 0],
            (false, Some(l)) => [0, 0, j, id(l)?],
            (true, Some(l)) => [side, j, j, id(l)?],
        }))
    };
    nominal.iter().map(context).collect::<Option<Vec<_>>>() == Some(activity.contexts())
}

impl fmt::Display for FirstExperiment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write_segmentation(f)?;
        self.write_clusters(f)?;
        let Some(drilling) = &self.drilling else { return Ok(()) };
        write!(
            f,
            "\ndrilling: mean distance {:.2} in the same layout, {:.2} between layouts, {:.2} to the other kinds of IU",
            drilling.same_layout, drilling.other_layout, drilling.other_kinds
        )
    }
}

impl FirstExperiment {
    fn write_segmentation(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
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
        let percent = 100.0 * right as f64 / all.max(1) as f64;
        writeln!(f, "  {:12} {right:3} of {all:3}, {percent:.2} %", "all")
    }

    fn write_clusters(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Analysis { kinds, motion, context, .. } = &self.analysis;
        writeln!(f, "clusters: k = {} by the elbow of the WCSS (the paper has 4)", motion.k)?;
        let [motions, contexts] = [self.analysis.motion_table(), self.analysis.context_table()];
        let row = |table: &Table, index: usize| {
            table.counts.get(index).map_or(String::new(), |row| format!("{row:?}"))
        };
        for (index, kind) in kinds.iter().enumerate() {
            let (number, label) = (index + 1, &kind.label);
            let (motions, contexts) = (row(&motions, index), row(&contexts, index));
            writeln!(f, "  u{number} {label:32} motion {motions:24} context {contexts}")?;
        }
        let count = context.iter().max().map_or(0, |max| max + 1);
        write!(f, "contexts: {count} clusters (the paper has 5)")
    }
}
